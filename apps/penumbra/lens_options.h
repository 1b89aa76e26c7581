#pragma once

#include <optional>
#include <string>

#include "option_parser.h"
#include "penumbra/tracing/ray_tracer.h"

namespace penumbra::cli {

/// How a camera's eye is built, as far as the user said.
struct LensOptions {
  enum class Projection { perspective, panorama, fisheye };
  std::optional<Projection> projection;
  std::optional<double> fov;  ///< rad; vertical, or across a fisheye's circle
  std::optional<double> f_number;
  std::optional<double> focus;         ///< m
  std::optional<double> frame_height;  ///< m
  std::optional<double> cat_eye;
  std::optional<std::string> aperture;  ///< disk, blades:N[:DEGREES] or a picture

  [[nodiscard]] bool given() const {
    return projection || fov || f_number || focus || frame_height || cat_eye || aperture;
  }
};

/// `options` must outlive `parser`'s last parse.
void add_lens_options(OptionParser& parser, LensOptions& options);

/// Throws UsageError when options contradict each other.
void check(const LensOptions& options);

/// The camera with the lens asked for. Without a distance it focuses on what it sees in the middle of its picture.
/// @param aspect width / height of the picture. Throws UsageError, FileError.
[[nodiscard]] Camera with_lens(Camera camera, const LensOptions& options, const RayTracer& tracer, double aspect);

}  // namespace penumbra::cli
