#pragma once

#include <map>
#include <optional>
#include <string>

#include "lens_options.h"
#include "penumbra/tracing/ray_tracer.h"

namespace penumbra::cli {

/// Where to look from: a camera of the file by name or index, an eye of one's own, or whatever frames the scene.
struct CameraOptions {
  std::optional<std::string> name;
  std::optional<Vec3d> eye, look_at;  ///< m
  std::optional<Vec3d> up;            ///< unit
  LensOptions lens;
};

/// `options` must outlive `parser`'s last parse.
void add_camera_options(OptionParser& parser, CameraOptions& options);

/// Throws UsageError when options contradict each other.
void check(const CameraOptions& options);

/// @param aspect width / height of the picture. @param source the scene as the user named it.
/// Throws UsageError that lists the cameras when the one asked for is not there.
[[nodiscard]] Camera choose_camera(const CameraOptions& options, const RayTracer& tracer, double aspect,
                                   const std::string& source);

/// Eye, direction, up and field of view as text, for a picture's metadata.
[[nodiscard]] std::map<std::string, std::string> camera_metadata(const Camera& camera);

}  // namespace penumbra::cli
