#pragma once

#include <optional>
#include <vector>

#include "penumbra/tracing/shading/light_sampling.h"

namespace penumbra {

/// One light whose points can be drawn without knowing who asks: an emissive mesh of constant radiance, a point light
/// or a far light.
struct PacketLight {
  enum class Kind { area, point, far };
  struct Triangle {
    Vec3f v0, e1, e2, normal;
    float inverse_density;
    Rgb radiance;
    bool both_sides;
  };
  Kind kind = Kind::area;
  std::vector<Triangle> triangles;
  std::vector<float> cdf;  ///< over `triangles`, ends with 1
  bool at_middle = false;  ///< its one triangle is a point, the middle of the lamp
  Vec3f position{0};       ///< or direction towards a far light, unit
  Rgb strength{0};         ///< of a point light W/sr, of a far one W/m^2
  float range = 0;         ///< of a point light, m; 0: none
  bool inverse_square = true;

  /// The triangle in which `u` falls; `u` becomes uniform again.
  [[nodiscard]] const Triangle& choose(float& u) const;
};

/// The lights of a scene for packets, in the order of `lights`; none when one of them is of another kind (spots, exact
/// shapes, textured emission, an environment).
[[nodiscard]] std::optional<std::vector<PacketLight>> packet_lights(const Scene& scene, const LightSampler& lights,
                                                                    bool at_middles);

}  // namespace penumbra
