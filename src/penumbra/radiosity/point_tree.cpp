#include "penumbra/radiosity/point_tree.h"

#include <algorithm>
#include <numeric>

namespace penumbra {
namespace {

constexpr std::uint32_t leaf_size = 8;

double distance_squared(const Vec3d& p, const Vec3d& a, const Vec3d& along, double length2) {
  const double t = length2 > 0 ? std::clamp(dot(p - a, along) / length2, 0.0, 1.0) : 0;
  return length_squared(a + t * along - p);
}

/// Whether a segment meets a box grown by `tolerance` on all sides.
bool crosses(const Bounds& box, const Vec3d& a, const Vec3d& along, double tolerance) {
  double enter = 0, exit = 1;
  for (int axis = 0; axis < 3; ++axis) {
    const double low = box.lower[axis] - tolerance - a[axis], high = box.upper[axis] + tolerance - a[axis];
    if (along[axis] == 0) {
      if (low > 0 || high < 0) return false;
      continue;
    }
    const double t0 = low / along[axis], t1 = high / along[axis];
    enter = std::max(enter, std::min(t0, t1));
    exit = std::min(exit, std::max(t0, t1));
  }
  return enter <= exit;
}

}  // namespace

PointTree::PointTree(std::span<const Vec3d> points) : points_(points), order_(points.size()) {
  std::iota(order_.begin(), order_.end(), 0U);
  if (!points.empty()) build(0, static_cast<std::uint32_t>(points.size()));
}

std::uint32_t PointTree::build(std::uint32_t first, std::uint32_t last) {
  const auto number = static_cast<std::uint32_t>(nodes_.size());
  Bounds bounds;
  for (std::uint32_t k = first; k < last; ++k) bounds.grow(points_[order_[k]]);
  nodes_.push_back({bounds, first, last, 0});
  if (last - first <= leaf_size) return number;
  const Vec3d size = bounds.upper - bounds.lower;
  const int axis = size.x >= size.y && size.x >= size.z ? 0 : size.y >= size.z ? 1 : 2;
  const std::uint32_t middle = (first + last) / 2;
  std::nth_element(order_.begin() + first, order_.begin() + middle, order_.begin() + last,
                   [&](std::uint32_t a, std::uint32_t b) {
                     return points_[a][axis] != points_[b][axis] ? points_[a][axis] < points_[b][axis] : a < b;
                   });
  build(first, middle);
  const std::uint32_t right = build(middle, last);
  nodes_[number].right = right;
  return number;
}

void PointTree::on_segment(const Vec3d& a, const Vec3d& b, double tolerance, std::vector<std::uint32_t>& found) const {
  if (nodes_.empty()) return;
  const Vec3d along = b - a;
  const double length2 = length_squared(along);
  std::uint32_t stack[64];
  int top = 0;
  stack[top++] = 0;
  while (top > 0) {
    const std::uint32_t number = stack[--top];
    const Node& node = nodes_[number];
    if (!crosses(node.bounds, a, along, tolerance)) continue;
    if (node.right != 0) {
      stack[top++] = node.right;
      stack[top++] = number + 1;
      continue;
    }
    for (std::uint32_t k = node.first; k < node.last; ++k) {
      if (distance_squared(points_[order_[k]], a, along, length2) <= tolerance * tolerance) found.push_back(order_[k]);
    }
  }
}

std::vector<std::uint32_t> weld_points(std::span<const Vec3d> points, double tolerance) {
  const PointTree tree(points);
  std::vector<std::uint32_t> welded(points.size());
  std::vector<std::uint32_t> near;
  for (std::uint32_t p = 0; p < points.size(); ++p) {
    near.clear();
    tree.on_segment(points[p], points[p], tolerance, near);
    const std::uint32_t first = *std::min_element(near.begin(), near.end());
    welded[p] = first < p ? welded[first] : p;
  }
  return welded;
}

}  // namespace penumbra
