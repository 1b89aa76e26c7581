#pragma once

#include <array>
#include <optional>
#include <string>
#include <vector>

#include "camera_options.h"
#include "common_options.h"
#include "penumbra/math/bounds.h"
#include "radiosity_options.h"
#include "scene_options.h"

namespace penumbra::cli {

/// What a bake makes.
enum class BakeKind {
  solution,   ///< light on elements: .npz, .csv, .ply, .vtu, or a .glb with vertex colours
  lightmap,   ///< a .glb whose light lies in a texture over the scene's own triangles
  occlusion,  ///< a .glb with a texture of ambient occlusion
  probes,     ///< light at points in space: .json and .npz
};

/// Everything that `penumbra bake` was asked for.
struct BakeArguments {
  SceneOptions scene;
  RadiosityOptions radiosity;
  std::string output;
  std::optional<double> exposure;  ///< stops (EV), of a .glb
  std::optional<std::string> profile;
  std::optional<int> lightmap_size;          ///< texels
  std::optional<double> texels_per_metre;    ///< of the lightmap
  std::optional<double> noise;               ///< aimed at, of the lightmap, relative
  bool opaque_shadows = false;               ///< glass stops shadow rays
  bool denoise = false;                      ///< of the lightmap
  bool directional = false;                  ///< a directional lightmap beside the lightmap
  std::optional<double> occlusion_distance;  ///< m
  std::optional<std::array<int, 3>> probes;  ///< how many along x, y and z
  std::optional<Bounds> probe_bounds;        ///< with probes at its ends
  std::optional<std::string> checkpoint;     ///< a file to keep elements, form factors and lights in
  std::optional<std::string> resume;         ///< such a file, instead of computing them
  std::optional<std::string> snapshots;      ///< a folder for a picture of each stage
  std::optional<std::size_t> snapshot_every;
  bool snapshot_meshes = false;
  bool spectral = false;  ///< solve over bands of wavelength
  CameraOptions camera;   ///< of the snapshots
  CommonOptions common;

  [[nodiscard]] BakeKind kind() const;
};

/// Reads and checks the arguments; none when the user asked for help. Throws UsageError, FileError.
[[nodiscard]] std::optional<BakeArguments> parse_bake_arguments(const std::vector<std::string>& arguments);

}  // namespace penumbra::cli
