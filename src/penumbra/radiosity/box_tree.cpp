#include "penumbra/radiosity/box_tree.h"

#include <algorithm>
#include <utility>

namespace penumbra {

BoxTree::BoxTree(std::span<const Bounds> bounds, std::vector<std::uint32_t> items, std::uint32_t leaf_size)
    : leaf_size_(leaf_size), items_(std::move(items)) {
  if (!items_.empty()) build(bounds, 0, static_cast<std::uint32_t>(items_.size()));
}

std::uint32_t BoxTree::build(std::span<const Bounds> bounds, std::uint32_t first, std::uint32_t last) {
  const auto number = static_cast<std::uint32_t>(nodes_.size());
  const auto centre = [&](std::uint32_t item) { return 0.5 * (bounds[item].lower + bounds[item].upper); };
  Bounds all, centres;
  for (std::uint32_t k = first; k < last; ++k) {
    all.grow(bounds[items_[k]].lower);
    all.grow(bounds[items_[k]].upper);
    centres.grow(centre(items_[k]));
  }
  nodes_.push_back({all, first, last, 0});
  if (last - first <= leaf_size_) return number;
  const Vec3d size = centres.upper - centres.lower;
  const int axis = size.x >= size.y && size.x >= size.z ? 0 : size.y >= size.z ? 1 : 2;
  const std::uint32_t middle = (first + last) / 2;
  std::nth_element(items_.begin() + first, items_.begin() + middle, items_.begin() + last,
                   [&](std::uint32_t a, std::uint32_t b) {
                     const double ca = centre(a)[axis], cb = centre(b)[axis];
                     return ca != cb ? ca < cb : a < b;
                   });
  build(bounds, first, middle);
  const std::uint32_t right = build(bounds, middle, last);
  nodes_[number].right = right;
  return number;
}

}  // namespace penumbra
