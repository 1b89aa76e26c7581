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

PointTree::PointTree(std::span<const Vec3d> points) : points_(points) {
  std::vector<Bounds> bounds(points.size());
  for (std::size_t k = 0; k < points.size(); ++k) bounds[k].grow(points[k]);
  std::vector<std::uint32_t> all(points.size());
  std::iota(all.begin(), all.end(), 0U);
  tree_ = BoxTree(bounds, std::move(all), leaf_size);
}

void PointTree::on_segment(const Vec3d& a, const Vec3d& b, double tolerance, std::vector<std::uint32_t>& found) const {
  const Vec3d along = b - a;
  const double length2 = length_squared(along);
  tree_.search([&](const Bounds& box) { return !crosses(box, a, along, tolerance); },
               [&](std::uint32_t p) {
                 if (distance_squared(points_[p], a, along, length2) <= tolerance * tolerance) found.push_back(p);
               });
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
