#include "penumbra/io/gltf_camera.h"

#include <cmath>
#include <numbers>
#include <string>

namespace penumbra {
namespace {

// The axes made rigid: the camera keeps where it looks (-z) and what is up as nearly as it can.
Mat4d rigid(const Mat4d& m, const JsonPlace& place) {
  const Vec3d back(m[2]);
  const Vec3d right = cross(Vec3d(m[1]), back);
  if (!(length(back) > 0) || !(length(right) > 0)) {
    place.fail("the node that it hangs on is scaled to nothing, so it looks nowhere; export the file again");
  }
  const Vec3d z = normalize(back);
  const Vec3d x = normalize(right);
  return {Vec4d(x, 0), Vec4d(cross(z, x), 0), Vec4d(z, 0), m[3]};
}

}  // namespace

Camera read_gltf_camera(const JsonPlace& place, const Mat4d& to_world) {
  Camera camera{.name = place.text("name"), .to_world = rigid(to_world, place), .lens = PerspectiveLens{}};
  const std::string type = place.text("type");
  const auto lens = type == "perspective" || type == "orthographic" ? place.object(type) : std::nullopt;
  if (!lens)
    place.fail(
        "its type is neither perspective nor orthographic, or it lacks the object of that name; export the file again");
  if (type == "perspective") {
    const double fov = lens->number("yfov", 0);
    if (!(fov > 0 && fov < std::numbers::pi))
      lens->fail("its yfov must be between 0 and pi radians; export the file again");
    camera.lens = PerspectiveLens{.vertical_fov = fov};
  } else {
    const double half_height = lens->number("ymag", 0);
    if (half_height == 0) lens->fail("its ymag must not be 0; export the file again");
    camera.lens = OrthographicLens{.height = 2 * std::abs(half_height)};
  }
  return camera;
}

}  // namespace penumbra
