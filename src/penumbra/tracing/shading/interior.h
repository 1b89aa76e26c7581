#pragma once

#include <array>
#include <optional>

#include "penumbra/math/bands.h"
#include "penumbra/scene/scene.h"
#include "penumbra/tracing/hit.h"
#include "penumbra/tracing/shading/fresnel.h"

namespace penumbra {

/// The closed surfaces seen through that a ray is inside of, innermost last: glass, which absorbs along the way
/// (Beer-Lambert), and what holds a medium (see Media).
class Interior {
 public:
  /// What is left of light after the segment that ends at `point`: by the innermost solid, or, when none was entered
  /// (the camera may stand inside one), by the solid whose inside was hit.
  [[nodiscard]] Rgb transmittance(const Scene& scene, const SurfacePoint& point, bool hit_front, double distance,
                                  const Bands& bands = {}) const {
    const auto solid = around(scene, point, hit_front);
    return solid && is_solid_glass(scene.materials[*solid]) ? absorb(scene.materials[*solid], distance, bands) : Rgb(1);
  }

  /// The material of the innermost; none in the open.
  [[nodiscard]] std::optional<std::uint32_t> innermost() const {
    return depth_ > 0 ? std::optional(solids_[depth_ - 1]) : std::nullopt;
  }
  /// The same of the segment that ends at `point`, as above.
  [[nodiscard]] std::optional<std::uint32_t> around(const Scene& scene, const SurfacePoint& point,
                                                    bool hit_front) const {
    if (depth_ > 0 || hit_front || !encloses(scene.materials[point.material])) return innermost();
    return point.material;
  }

  /// Notes that the ray is inside of `material`: what a hit from within has told.
  void note_inside(std::uint32_t material) {
    if (depth_ == 0) solids_[depth_++] = material;
  }

  /// Notes that the ray goes on from `point` towards `direction`, through the surface when `transmitted`.
  void cross(const Scene& scene, const SurfacePoint& point, const Vec3d& direction, bool transmitted) {
    if (!transmitted || !encloses(scene.materials[point.material])) return;
    if (dot(point.geometric_normal, direction) < 0) {
      if (depth_ < solids_.size()) solids_[depth_++] = point.material;
      return;
    }
    // Solids may overlap: the one that ends is the last entered of its material.
    for (std::size_t i = depth_; i-- > 0;) {
      if (solids_[i] != point.material) continue;
      for (std::size_t k = i + 1; k < depth_; ++k) solids_[k - 1] = solids_[k];
      --depth_;
      return;
    }
  }

 private:
  static bool encloses(const Material& m) { return is_solid_glass(m) || m.medium.has_value(); }
  static bool is_solid_glass(const Material& m) { return m.transmission > 0 && !m.thin_walled; }
  static Rgb absorb(const Material& m, double distance, const Bands& bands) {
    return volume_transmittance(bands.reflectance(m.attenuation_colour), m.attenuation_distance, distance);
  }

  std::array<std::uint32_t, 8> solids_{};
  std::size_t depth_ = 0;
};

}  // namespace penumbra
