#pragma once

#include <optional>
#include <vector>

#include "penumbra/tracing/shading/light_sampling.h"

namespace penumbra {

/// Draws what leaves the lights of a scene: a light, three times in four in proportion to its power, else any that
/// shines (a fine beam is worth seeing, however little power it has), a point of its, a direction. Lights of a
/// LightSampler; infinite planes that emit and ambient light are not among them. Thread-safe.
class LightEmission {
 public:
  /// Both must outlive it. Throws std::invalid_argument for lights that send out no countable power: point lights
  /// without falloff, and far lights over infinite planes.
  LightEmission(const Scene& scene, const LightSampler& lights);

  [[nodiscard]] bool empty() const { return chances_.empty(); }

  /// Where light leaves.
  struct Origin {
    std::size_t light = 0;
    double inverse_chance = 1;  ///< over the density, 1/m^2, of the point; of a light without a body over its chance
    std::optional<SurfacePoint> point;  ///< of a lamp's surface; none: a light without a body, or the sky
    Rgb radiance{0};                    ///< of a lamp's point or of the sky, W/(m^2 sr)
    Vec3d direction{0};                 ///< of the sky and far lights: unit, towards where the light comes from
  };
  [[nodiscard]] std::optional<Origin> sample_origin(double u_light, const Vec2d& u) const;

  /// A particle that sets out.
  struct Particle {
    Ray ray;
    Rgb power{0};      ///< W: the mean over particles is what all lights send out (the sky: into the scene's sphere)
    double range = 0;  ///< m, see range_window(); 0: no bound
  };
  [[nodiscard]] Particle sample_direction(const Origin& origin, double u_side, const Vec2d& u) const;

 private:
  [[nodiscard]] Particle from_lamp(const Origin& origin, double u_side, const Vec2d& u) const;
  [[nodiscard]] Particle from_afar(const Vec3d& way, const Rgb& irradiance, const Vec2d& u) const;

  const Scene* scene_;
  const LightSampler* lights_;
  std::vector<double> chances_;  // cumulative, from 0 to 1
  Vec3d centre_{0};
  double radius_ = 1;
};

}  // namespace penumbra
