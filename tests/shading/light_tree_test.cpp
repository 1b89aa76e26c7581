#include "penumbra/tracing/shading/light_tree.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <vector>

#include "tracing/soup.h"

namespace penumbra {
namespace {

using std::numbers::pi;
using testing::Dice;
using Emitter = LightTree::Emitter;

// Small one-sided lamps, points and balls.
std::vector<Emitter> emitters(Dice& dice, std::size_t count) {
  std::vector<Emitter> all;
  for (std::size_t i = 0; i < count; ++i) {
    Emitter e{.bounds = {}, .axis = dice.direction(), .spread = 0, .beam = pi / 2, .power = dice.between(0.1, 10)};
    const Vec3d centre = dice.cube(10);
    e.bounds.grow(centre);
    if (i % 3 == 0) e.spread = pi;
    if (i % 3 == 1) e.bounds.grow(centre + 0.1 * Vec3d(dice.unit(), dice.unit(), dice.unit()));
    if (i % 5 == 0) e.both_sides = true;
    all.push_back(e);
  }
  return all;
}

TEST(LightTree, ChancesSumToOneAndAreThoseOfChoosing) {
  Dice dice(1);
  for (const std::size_t count : {std::size_t{1}, std::size_t{2}, std::size_t{7}, std::size_t{100}}) {
    const std::vector<Emitter> all = emitters(dice, count);
    const LightTree tree(all);
    for (int n = 0; n < 20; ++n) {
      const Vec3d point = dice.cube(15);
      const Vec3d normal = n % 2 == 0 ? dice.direction() : Vec3d(0);
      double sum = 0;
      for (std::uint32_t i = 0; i < count; ++i) sum += tree.chance(i, point, normal);
      constexpr int draws = 2000;
      std::vector<int> chosen(count, 0);
      int none = 0;
      for (int k = 0; k < draws; ++k) {
        const auto choice = tree.choose(point, normal, (k + 0.5) / draws);
        if (!choice) {
          ++none;
          continue;
        }
        ASSERT_NEAR(choice->chance, tree.chance(choice->emitter, point, normal), 1e-12);
        ASSERT_GE(choice->leftover, 0);
        ASSERT_LT(choice->leftover, 1);
        ++chosen[choice->emitter];
      }
      // A branch in which nothing can shine is found out on the way down: its share is lost, not chosen.
      EXPECT_NEAR(sum, 1 - static_cast<double>(none) / draws, 2e-2);
      for (std::uint32_t i = 0; i < count; ++i) {
        EXPECT_NEAR(chosen[i], draws * tree.chance(i, point, normal), 1.0001) << i;
      }
    }
  }
}

// Whatever can send light to a point may be chosen there, else light would be missing.
TEST(LightTree, EveryEmitterThatShinesOnAPointHasAChance) {
  Dice dice(2);
  const std::vector<Emitter> all = emitters(dice, 300);
  const LightTree tree(all);
  for (int n = 0; n < 100; ++n) {
    const Vec3d point = dice.cube(15), normal = dice.direction();
    for (std::uint32_t i = 0; i < all.size(); ++i) {
      const Vec3d way = normalize(point - all[i].bounds.centre());
      const bool shines = all[i].spread > 0 || all[i].both_sides || dot(way, all[i].axis) > 0;
      if (shines) {
        ASSERT_GT(tree.chance(i, point, normal), 0) << i;
      }
    }
  }
}

// A street of lamps: near ones are chosen far more often than their share of the power, so that the light of a point
// is estimated with much less noise.
TEST(LightTree, NearLampsAreChosenMoreOften) {
  std::vector<Emitter> lamps;
  for (int i = 0; i < 1000; ++i) {
    Emitter e{.bounds = {}, .axis = {0, -1, 0}, .spread = 0, .beam = pi / 2, .power = 1};
    e.bounds.grow(Vec3d(3.0 * i, 3, 0));
    e.bounds.grow(Vec3d(3.0 * i + 0.2, 3, 0.2));
    lamps.push_back(e);
  }
  const LightTree tree(lamps);
  const Vec3d point(1501, 0, 0), normal(0, 1, 0);
  const auto contribution = [&](std::uint32_t i) {
    const Vec3d way = lamps[i].bounds.centre() - point;
    return std::pow(way.y / length(way), 2) / length_squared(way);
  };
  double light = 0, square_by_tree = 0, square_by_power = 0;
  for (std::uint32_t i = 0; i < lamps.size(); ++i) {
    const double c = contribution(i);
    light += c;
    square_by_tree += c * c / tree.chance(i, point, normal);
    square_by_power += c * c * static_cast<double>(lamps.size());
  }
  const double variance_by_tree = square_by_tree - light * light;
  const double variance_by_power = square_by_power - light * light;
  EXPECT_LT(variance_by_tree, variance_by_power / 100);
}

}  // namespace
}  // namespace penumbra
