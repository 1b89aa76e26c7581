#include "camera_options.h"

#include <charconv>
#include <numbers>

#include "penumbra/math/transform.h"
#include "penumbra/render/framing.h"

namespace penumbra::cli {
namespace {

constexpr double radians_per_degree = std::numbers::pi / 180;
constexpr double usual_fov = 40 * radians_per_degree;

Vec3d direction(const OptionValue& value) {
  const Vec3d v = triple(value, "a direction x,y,z, such as 0,0,1");
  if (length(v) == 0) throw UsageError(value.option + " takes a direction, which 0,0,0 is not");
  return normalize(v);
}

bool nearly_parallel(const Vec3d& a, const Vec3d& b) { return length(cross(normalize(a), normalize(b))) < 1e-6; }

Camera eye_camera(const CameraOptions& options) {
  const Vec3d view = *options.look_at - *options.eye;
  Vec3d up = options.up.value_or(Vec3d(0, 1, 0));
  if (nearly_parallel(view, up)) {
    if (options.up) throw UsageError("--up points along the view from --eye to --look-at; choose another up");
    up = Vec3d(0, 0, -1);  // straight up or down: the top of the picture is the far side of a map
  }
  return {.name = "eye", .to_world = look_at(*options.eye, *options.look_at, up), .lens = PerspectiveLens{usual_fov}};
}

std::string listed(const std::vector<Camera>& cameras) {
  std::string text;
  for (std::size_t i = 0; i < cameras.size(); ++i) {
    text += fmt::format("{}{}{}", i == 0 ? "" : ", ", i, cameras[i].name.empty() ? "" : " '" + cameras[i].name + "'");
  }
  return text;
}

const Camera& file_camera(const std::string& name, const std::vector<Camera>& cameras, const std::string& source) {
  if (cameras.empty()) {
    throw UsageError(
        fmt::format("--camera {}: {} has no camera; leave it away, or give --eye and --look-at", name, source));
  }
  for (const Camera& camera : cameras) {
    if (camera.name == name) return camera;
  }
  std::size_t index = 0;
  const char* end = name.data() + name.size();
  const auto [stop, error] = std::from_chars(name.data(), end, index);
  if (error == std::errc{} && stop == end && index < cameras.size()) return cameras[index];
  throw UsageError(fmt::format("--camera {}: {} has no such camera; it has {}", name, source, listed(cameras)));
}

// The field of view of a camera that comes from nowhere but the options.
std::optional<double> plane_fov(const LensOptions& lens) {
  return lens.projection == LensOptions::Projection::fisheye ? std::nullopt : lens.fov;
}

Camera choose_eye(const CameraOptions& options, const RayTracer& tracer, double aspect, const std::string& source) {
  const std::vector<Camera>& cameras = tracer.scene().cameras;
  if (options.eye) return eye_camera(options);
  if (options.name) return file_camera(*options.name, cameras, source);
  if (!cameras.empty() && !options.up) return cameras.front();
  return framing_camera(tracer, plane_fov(options.lens), aspect, options.up.value_or(Vec3d(0, 1, 0)));
}

// Adding 0 turns -0 into 0.
std::string text(const Vec3d& v) { return fmt::format("{} {} {}", v.x + 0.0, v.y + 0.0, v.z + 0.0); }

}  // namespace

void add_camera_options(OptionParser& parser, CameraOptions& options) {
  parser.group("Camera");
  parser.value("--camera", "NAME|INDEX",
               "a camera of the scene, counted from 0 (default: 0; one that frames the scene when it has none)",
               [&](const OptionValue& v) { options.name = v.text; });
  parser.value("--eye", "x,y,z", "where the eye is, in metres; needs --look-at",
               [&](const OptionValue& v) { options.eye = triple(v, "a point x,y,z in metres, such as 0,1.5,4"); });
  parser.value("--look-at", "x,y,z", "the point that the eye looks at, in metres",
               [&](const OptionValue& v) { options.look_at = triple(v, "a point x,y,z in metres, such as 0,1,0"); });
  parser.value("--up", "x,y,z",
               "which way is up in the picture, for --eye and for the camera that frames the scene (default: 0,1,0); "
               "without --eye it asks for the latter",
               [&](const OptionValue& v) { options.up = direction(v); });
  add_lens_options(parser, options.lens);
}

void check(const CameraOptions& options) {
  check(options.lens);
  if (options.eye && !options.look_at) throw UsageError("--eye needs --look-at x,y,z, the point to look at");
  if (options.look_at && !options.eye) throw UsageError("--look-at needs --eye x,y,z, the point to look from");
  if (options.eye && options.name) throw UsageError("--camera and --eye both choose the camera; give one of them");
  if (options.up && options.name)
    throw UsageError("--up does not apply to --camera, which has an up of its own; leave it away");
  if (options.eye && length(*options.eye - *options.look_at) == 0) {
    throw UsageError("--eye and --look-at are the same point; move one of them");
  }
}

Camera choose_camera(const CameraOptions& options, const RayTracer& tracer, double aspect, const std::string& source) {
  return with_lens(choose_eye(options, tracer, aspect, source), options.lens, tracer, aspect);
}

std::map<std::string, std::string> camera_metadata(const Camera& camera) {
  std::map<std::string, std::string> metadata{{"camera.eye", text(Vec3d(camera.to_world[3]))},
                                              {"camera.direction", text(-normalize(Vec3d(camera.to_world[2])))},
                                              {"camera.up", text(normalize(Vec3d(camera.to_world[1])))}};
  if (!camera.name.empty()) metadata["camera.name"] = camera.name;
  if (const auto* flat = std::get_if<OrthographicLens>(&camera.lens)) {
    metadata["camera.height_m"] = fmt::format("{}", flat->height);
  } else if (const auto* perspective = std::get_if<PerspectiveLens>(&camera.lens)) {
    metadata["camera.fov_degrees"] = fmt::format("{}", perspective->vertical_fov / radians_per_degree);
  } else if (const auto* round = std::get_if<FisheyeLens>(&camera.lens)) {
    metadata["camera.fisheye_degrees"] = fmt::format("{}", round->fov / radians_per_degree);
  } else {
    metadata["camera.projection"] = "panorama";
  }
  if (camera.thin_lens) {
    metadata["camera.lens_radius_m"] = fmt::format("{}", camera.thin_lens->radius);
    metadata["camera.focus_m"] = fmt::format("{}", camera.thin_lens->focus);
  }
  return metadata;
}

}  // namespace penumbra::cli
