#include "penumbra/baking/rectangle_packing.h"

#include <gtest/gtest.h>

#include <cstdint>
#include <random>
#include <vector>

namespace penumbra {
namespace {

std::vector<PackedSize> random_sizes(std::size_t count, int largest) {
  std::mt19937 random(7);
  std::uniform_int_distribution<int> side(1, largest);
  std::vector<PackedSize> sizes;
  for (std::size_t i = 0; i < count; ++i) sizes.push_back({side(random), side(random)});
  return sizes;
}

void expect_no_overlap(const std::vector<PackedSize>& sizes, const std::vector<PackedPlace>& places, int side) {
  std::vector<std::uint8_t> taken(static_cast<std::size_t>(side) * static_cast<std::size_t>(side), 0);
  for (std::size_t i = 0; i < sizes.size(); ++i) {
    ASSERT_GE(places[i].x, 0);
    ASSERT_GE(places[i].y, 0);
    ASSERT_LE(places[i].x + sizes[i].width, side);
    ASSERT_LE(places[i].y + sizes[i].height, side);
    for (int y = 0; y < sizes[i].height; ++y) {
      for (int x = 0; x < sizes[i].width; ++x) {
        std::uint8_t& cell = taken[static_cast<std::size_t>((places[i].y + y) * side + places[i].x + x)];
        ASSERT_EQ(cell, 0) << "rectangle " << i;
        cell = 1;
      }
    }
  }
}

double area(const std::vector<PackedSize>& sizes) {
  double sum = 0;
  for (const PackedSize& s : sizes) sum += static_cast<double>(s.width) * s.height;
  return sum;
}

TEST(RectanglePacking, FewOnASkylineDoNotOverlapAndWasteLittle) {
  const std::vector<PackedSize> sizes = random_sizes(500, 60);
  const int side = static_cast<int>(std::sqrt(area(sizes) / 0.9));
  const auto places = pack_rectangles(sizes, side, side);
  ASSERT_TRUE(places.has_value()) << "more than a tenth is wasted";
  expect_no_overlap(sizes, *places, side);
}

TEST(RectanglePacking, ManyOnShelvesDoNotOverlapAndWasteLittle) {
  const std::vector<PackedSize> sizes = random_sizes(20000, 12);
  const int side = static_cast<int>(std::sqrt(area(sizes) / 0.9));
  const auto places = pack_rectangles(sizes, side, side);
  ASSERT_TRUE(places.has_value()) << "more than a tenth is wasted";
  expect_no_overlap(sizes, *places, side);
}

TEST(RectanglePacking, WhatFillsTheSquareExactlyFits) {
  const std::vector<PackedSize> sizes(16, {16, 16});
  const auto places = pack_rectangles(sizes, 64, 64);
  ASSERT_TRUE(places.has_value());
  expect_no_overlap(sizes, *places, 64);
  EXPECT_FALSE(pack_rectangles(std::vector<PackedSize>(17, {16, 16}), 64, 64).has_value());
}

TEST(RectanglePacking, WhatIsWiderThanTheSquareDoesNotFit) {
  EXPECT_FALSE(pack_rectangles(std::vector<PackedSize>{{65, 1}}, 64, 64).has_value());
  EXPECT_FALSE(pack_rectangles(std::vector<PackedSize>{{1, 65}}, 64, 64).has_value());
  EXPECT_FALSE(pack_rectangles(std::vector<PackedSize>(10000, {1, 65}), 10000, 64).has_value());
}

}  // namespace
}  // namespace penumbra
