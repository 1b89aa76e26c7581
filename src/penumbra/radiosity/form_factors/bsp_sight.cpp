#include "penumbra/radiosity/form_factors/bsp_sight.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "penumbra/radiosity/form_factors/nusselt.h"

namespace penumbra {

// What is outside the first plane of the pyramid stays, then what is inside it but outside the second, and so on.
void BspSight::cut_shadow(const Vec3d& point, std::span<const Vec3d> blocker) {
  const Vec3d plane = newell_vector(blocker);
  const double side = dot(plane, blocker[0] - point);
  if (std::abs(side) <= 1e-12 * length(plane) * polygon_size(blocker)) return;  // seen from the edge
  const double turn = side > 0 ? 1 : -1;
  next_.clear();
  for (std::vector<Vec3d>& piece : pieces_) {
    rest_ = std::move(piece);
    for (std::size_t k = 0; k < blocker.size() && rest_.size() >= 3; ++k) {
      const Vec3d inward = turn * cross(blocker[k] - point, blocker[(k + 1) % blocker.size()] - point);
      const double size = length(inward);
      if (!(size > 0)) continue;
      const Plane3 inner{inward / size, dot(inward, point) / size};
      clip_polygon(rest_, {-inner.normal, -inner.offset}, 0, outside_);
      if (outside_.size() >= 3) next_.push_back(outside_);
      clip_polygon(rest_, inner, 0, inside_);
      std::swap(rest_, inside_);
    }
  }
  std::swap(pieces_, next_);
}

double BspSight::factor(const Vec3d& point, const Vec3d& normal, std::uint32_t patch, const std::vector<char>& blocks) {
  double sum = 0;
  before_.clear();
  tree_.front_to_back(point, {normal, dot(normal, point)}, [&](const BspTree::Fragment& fragment) {
    if (fragment.patch != patch) {
      if (blocks[fragment.patch] != 0) before_.push_back(fragment.polygon);
      return;
    }
    pieces_.assign(1, std::vector<Vec3d>(fragment.polygon.begin(), fragment.polygon.end()));
    for (std::size_t k = 0; k < before_.size() && !pieces_.empty(); ++k) cut_shadow(point, before_[k]);
    for (const auto& piece : pieces_) sum += point_to_polygon(point, normal, piece);
  });
  return sum;
}

}  // namespace penumbra
