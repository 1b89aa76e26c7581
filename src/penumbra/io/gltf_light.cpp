#include "penumbra/io/gltf_light.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <string>

namespace penumbra {
namespace {

Vec3d direction_of(const Mat4d& to_world, const JsonPlace& place) {
  const Vec3d along = -Vec3d(to_world[2]);
  const double size = length(along);
  if (!(size > 0))
    place.fail("the node that it hangs on is scaled to nothing, so it has no direction; export the file again");
  return along / size;
}

SpotLight spot_of(const JsonPlace& place, const Rgb& intensity, double range, const Mat4d& to_world) {
  const auto cone = place.object("spot");
  if (!cone) place.fail("is a spot light without its spot object; export the file again");
  const double inner = cone->number("innerConeAngle", 0);
  const double outer = cone->number("outerConeAngle", std::numbers::pi / 4);
  // A float of pi/2 may be a little more than the double.
  if (!(inner >= 0) || !(inner < outer) || outer > std::numbers::pi / 2 + 1e-6) {
    cone->fail("its cone angles must be 0 <= innerConeAngle < outerConeAngle <= pi/2; export the file again");
  }
  return {.position = Vec3d(to_world[3]),
          .direction = direction_of(to_world, place),
          .intensity = intensity,
          .inner_angle = inner,
          .outer_angle = std::min(outer, std::numbers::pi / 2),
          .range = range};
}

}  // namespace

Light read_gltf_light(const JsonPlace& place, const Mat4d& to_world) {
  const double strength = place.number("intensity", 1);
  const auto colour = place.numbers<3>("color", {1, 1, 1});
  const Rgb scaled(Vec3d(colour[0], colour[1], colour[2]) * (strength / gltf_lumens_per_watt));
  if (!(scaled.x >= 0 && scaled.y >= 0 && scaled.z >= 0 &&
        max_component(scaled) <= std::numeric_limits<float>::max())) {
    place.fail("its intensity and color must not be negative or beyond 3.4e38; export the file again");
  }
  const double range = place.number("range", std::numeric_limits<double>::infinity());
  if (!(range > 0)) place.fail("its range must be more than 0 metres; leave it out for a light without limit");

  Light light{.name = place.text("name"), .kind = PointLight{}};
  const std::string type = place.text("type");
  if (type == "point") {
    const auto extras = place.extras("penumbra");
    light.kind = PointLight{.position = Vec3d(to_world[3]),
                            .intensity = scaled,
                            .range = range,
                            .inverse_square = !extras || extras->text("falloff") != "none"};
  } else if (type == "spot") {
    light.kind = spot_of(place, scaled, range, to_world);
  } else if (type == "directional") {
    const auto extras = place.extras("penumbra");
    const double radius = extras ? extras->number("angular_radius", 0) : 0;
    if (!(radius >= 0 && radius < 1)) place.fail("its angular_radius must lie in 0 to 1 rad");
    light.kind =
        DirectionalLight{.direction = direction_of(to_world, place), .irradiance = scaled, .angular_radius = radius};
  } else {
    place.fail("its type is none of point, spot and directional; export the file again");
  }
  return light;
}

}  // namespace penumbra
