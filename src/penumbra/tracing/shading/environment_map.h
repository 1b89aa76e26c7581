#pragma once

#include <vector>

#include "penumbra/math/spectrum.h"
#include "penumbra/scene/scene.h"

namespace penumbra {

/// The scene's environment as a light: looked up by direction, and sampled in proportion to its brightness.
///
/// Latitude-longitude picture, +Y up, its centre towards -Z, u to the right as seen from inside. Sampling by the
/// piecewise-constant distribution of Pharr, Jakob & Humphreys (PBRT, 4th ed., A.5); without a picture uniform over the
/// sphere.
class EnvironmentMap {
 public:
  /// A black one when the scene has none.
  explicit EnvironmentMap(const Scene& scene);

  /// Radiance arriving from `direction` (unit, pointing outwards), W/(m^2 sr).
  [[nodiscard]] Rgb radiance(const Vec3d& direction) const;

  /// Whether surfaces are lit by it (a backdrop is only seen).
  [[nodiscard]] bool lights_surfaces() const { return lights_; }
  /// Whether it varies with direction.
  [[nodiscard]] bool has_picture() const { return image_ != nullptr; }

  struct Sample {
    Vec3d direction{0, 1, 0};
    double pdf = 0;  ///< 1/sr
  };
  [[nodiscard]] Sample sample(const Vec2d& u) const;
  [[nodiscard]] double pdf(const Vec3d& direction) const;

  /// Mean radiance over the sphere.
  [[nodiscard]] Rgb mean_radiance() const { return mean_; }

 private:
  [[nodiscard]] Rgb texel(int x, int y) const;

  const TextureImage* image_ = nullptr;
  Rgb factor_{0};
  Rgb mean_{0};
  bool lights_ = false;
  std::vector<double> row_cdf_;     // height + 1
  std::vector<double> column_cdf_;  // height rows of width + 1
};

}  // namespace penumbra
