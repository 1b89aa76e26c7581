#pragma once

#include <optional>
#include <string>
#include <vector>

#include "camera_options.h"
#include "common_options.h"
#include "penumbra/render/render.h"
#include "picture_file.h"
#include "picture_size.h"
#include "radiosity_options.h"
#include "scene_options.h"
#include "shadow_options.h"

namespace penumbra::cli {

/// Everything that `penumbra render` was asked for.
struct RenderArguments {
  SceneOptions scene;
  CameraOptions camera;
  PictureFile picture;
  PictureSize size;
  RenderOptions render;
  ShadowOptions shadows;
  CommonOptions common;
  std::optional<std::string> show;      ///< a layer to be drawn in place of the colour
  std::string integrator = "whitted";   ///< as the user named it
  RadiosityOptions radiosity;           ///< of --integrator radiosity and two-pass
  std::optional<std::string> solution;  ///< an .npz that `bake` wrote, to be shown instead of solving
  bool flat = false;                    ///< each element in its one colour
  bool outlines = false;                ///< elements outlined

  [[nodiscard]] bool shows_radiosity() const { return integrator == "radiosity"; }
  [[nodiscard]] bool is_two_pass() const { return integrator == "two-pass"; }
  /// Whether a diffuse solution is needed.
  [[nodiscard]] bool needs_solution() const { return shows_radiosity() || is_two_pass(); }
};

/// Reads and checks the arguments; none when the user asked for help. Throws UsageError, FileError.
[[nodiscard]] std::optional<RenderArguments> parse_render_arguments(const std::vector<std::string>& arguments);

}  // namespace penumbra::cli
