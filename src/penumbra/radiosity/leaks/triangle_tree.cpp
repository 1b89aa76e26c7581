#include "penumbra/radiosity/leaks/triangle_tree.h"

#include <algorithm>
#include <numeric>
#include <utility>

namespace penumbra {
namespace {

constexpr std::uint32_t leaf_size = 4;

Bounds bounds_of(const TriangleTree::Triangle& t) {
  Bounds b;
  for (const Vec3d& p : t) b.grow(p);
  return b;
}

double squared_distance(const Bounds& b, const Vec3d& p) {
  const Vec3d outside = glm::max(glm::max(b.lower - p, p - b.upper), Vec3d(0));
  return length_squared(outside);
}

bool meet(const Bounds& a, const Bounds& b) {
  return glm::all(glm::lessThanEqual(a.lower, b.upper)) && glm::all(glm::lessThanEqual(b.lower, a.upper));
}

}  // namespace

Vec3d nearest_point(const TriangleTree::Triangle& triangle, const Vec3d& p) {
  const auto& [a, b, c] = triangle;
  const Vec3d ab = b - a, ac = c - a, ap = p - a;
  const double d1 = dot(ab, ap), d2 = dot(ac, ap);
  if (d1 <= 0 && d2 <= 0) return a;
  const Vec3d bp = p - b;
  const double d3 = dot(ab, bp), d4 = dot(ac, bp);
  if (d3 >= 0 && d4 <= d3) return b;
  const double vc = d1 * d4 - d3 * d2;
  if (vc <= 0 && d1 >= 0 && d3 <= 0) return d1 > d3 ? a + d1 / (d1 - d3) * ab : a;
  const Vec3d cp = p - c;
  const double d5 = dot(ab, cp), d6 = dot(ac, cp);
  if (d6 >= 0 && d5 <= d6) return c;
  const double vb = d5 * d2 - d1 * d6;
  if (vb <= 0 && d2 >= 0 && d6 <= 0) return d2 > d6 ? a + d2 / (d2 - d6) * ac : a;
  const double va = d3 * d6 - d5 * d4;
  if (va <= 0 && d4 - d3 >= 0 && d5 - d6 >= 0) {
    const double sum = (d4 - d3) + (d5 - d6);
    return sum > 0 ? b + (d4 - d3) / sum * (c - b) : b;
  }
  const double all = va + vb + vc;
  return a + vb / all * ab + vc / all * ac;
}

TriangleTree::TriangleTree(std::vector<Triangle> triangles) : triangles_(std::move(triangles)) {
  order_.resize(triangles_.size());
  std::iota(order_.begin(), order_.end(), 0U);
  nodes_.emplace_back();
  build(0, 0, static_cast<std::uint32_t>(order_.size()));
}

void TriangleTree::build(std::uint32_t node, std::uint32_t first, std::uint32_t last) {
  Bounds box, centres;
  for (std::uint32_t k = first; k < last; ++k) {
    const Bounds b = bounds_of(triangles_[order_[k]]);
    box.grow(b);
    centres.grow(b.centre());
  }
  nodes_[node].box = box;
  nodes_[node].first = first;
  nodes_[node].count = last - first;
  if (last - first <= leaf_size) return;

  const Vec3d extent = centres.extent();
  const int axis = extent.x >= extent.y && extent.x >= extent.z ? 0 : extent.y >= extent.z ? 1 : 2;
  const std::uint32_t middle = first + (last - first) / 2;
  const auto at = [&](std::uint32_t k) { return order_.begin() + static_cast<std::ptrdiff_t>(k); };
  std::nth_element(at(first), at(middle), at(last), [&](std::uint32_t i, std::uint32_t j) {
    const double x = bounds_of(triangles_[i]).centre()[axis], y = bounds_of(triangles_[j]).centre()[axis];
    return x < y || (x == y && i < j);
  });
  const auto left = static_cast<std::uint32_t>(nodes_.size());
  nodes_.resize(nodes_.size() + 2);
  nodes_[node].first = left;
  nodes_[node].count = 0;
  build(left, first, middle);
  build(left + 1, middle, last);
}

std::optional<TriangleTree::Nearest> TriangleTree::nearest(const Vec3d& p, double within,
                                                           const std::function<bool(std::uint32_t)>& skip) const {
  std::optional<Nearest> best;
  double limit = within * within;
  std::vector<std::uint32_t> open{0};
  while (!open.empty()) {
    const Node& node = nodes_[open.back()];
    open.pop_back();
    if (node.box.empty() || squared_distance(node.box, p) > limit) continue;
    if (node.count == 0) {
      const bool left_first =
          squared_distance(nodes_[node.first].box, p) <= squared_distance(nodes_[node.first + 1].box, p);
      open.push_back(node.first + (left_first ? 1 : 0));
      open.push_back(node.first + (left_first ? 0 : 1));
      continue;
    }
    for (std::uint32_t k = node.first; k < node.first + node.count; ++k) {
      const std::uint32_t t = order_[k];
      if (skip(t)) continue;
      const Vec3d q = nearest_point(triangles_[t], p);
      const double d = length_squared(q - p);
      if (d > limit || (best && d >= limit)) continue;
      limit = d;
      best = Nearest{t, q, 0};
    }
  }
  if (best) best->distance = length(best->point - p);
  return best;
}

void TriangleTree::overlapping(const Bounds& box, const std::function<void(std::uint32_t)>& visit) const {
  std::vector<std::uint32_t> open{0};
  while (!open.empty()) {
    const Node& node = nodes_[open.back()];
    open.pop_back();
    if (node.box.empty() || !meet(node.box, box)) continue;
    if (node.count == 0) {
      open.push_back(node.first);
      open.push_back(node.first + 1);
      continue;
    }
    for (std::uint32_t k = node.first; k < node.first + node.count; ++k) {
      if (meet(bounds_of(triangles_[order_[k]]), box)) visit(order_[k]);
    }
  }
}

}  // namespace penumbra
