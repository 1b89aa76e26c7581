#pragma once

#include <cstdint>
#include <limits>
#include <optional>
#include <string>
#include <variant>

#include "penumbra/math/spectrum.h"
#include "penumbra/scene/photometric_web.h"

namespace penumbra {

// Lights without a body. Area lights are the emissive surfaces of the scene itself.

/// Shines from one point: the same in all directions, or as a photometric web says.
struct PointLight {
  Vec3d position{0};
  Rgb intensity{1.0F};                                     ///< W/sr
  double range = std::numeric_limits<double>::infinity();  ///< m; no light beyond (KHR_lights_punctual)
  /// Whitted 1979 and many classical scenes know no distance falloff: then `intensity` / pi is not divided
  /// by the squared distance, and a matt surface facing the light reflects radiance base_colour * intensity.
  bool inverse_square = true;
  /// A luminaire that was measured: `intensity` is then that of 1 cd, times candela_towards().
  std::optional<WebPlacement> web{};
};

/// A point light in a cone, with the falloff of KHR_lights_punctual between the two half-angles.
struct SpotLight {
  Vec3d position{0};
  Vec3d direction{0, 0, -1};                ///< unit, the way light goes
  Rgb intensity{1.0F};                      ///< W/sr on the axis
  double inner_angle = 0;                   ///< rad, half-angle
  double outer_angle = 0.7853981633974483;  ///< rad, half-angle, > inner_angle
  double range = std::numeric_limits<double>::infinity();
};

/// A far light: parallel rays, or those of a disk in the sky such as the sun.
struct DirectionalLight {
  Vec3d direction{0, 0, -1};  ///< unit, the way light goes
  Rgb irradiance{1.0F};       ///< W/m^2 on a surface that faces it
  double angular_radius = 0;  ///< rad, of an even disk around -direction; 0: parallel rays
};

/// The classical stand-in for interreflection (the I_a of Phong 1975 and Whitted 1979): `appel` and `whitted`
/// add radiance * diffuse reflectance at every hit. `path` and radiosity compute interreflection and leave it out.
struct AmbientLight {
  Rgb radiance{0.1F};
};

struct Light {
  std::string name;
  std::variant<PointLight, SpotLight, DirectionalLight, AmbientLight> kind;
  std::string extras{};  ///< as Instance::extras
};

/// Light from everywhere outside: a colour, times a latitude-longitude picture if there is one.
struct Environment {
  Rgb radiance{1.0F};                  ///< W/(m^2 sr)
  std::optional<std::uint32_t> image;  ///< index into Scene::images; +Y up, centre of the picture towards -Z
  bool backdrop_only =
      false;  ///< seen by rays that leave the scene, but no light for its surfaces (`appel`, `whitted`)
};

}  // namespace penumbra
