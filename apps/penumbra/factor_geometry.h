#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "penumbra/radiosity/patch_mesh.h"

namespace penumbra::cli {

/// The meshes of the `factors` command and how to read them.
struct FactorGeometryOptions {
  std::vector<std::string> meshes;
  std::string from, to;  ///< the pair form: two meshes, each one surface
  std::vector<std::string> blockers;
  double unit = 1;             ///< metres per file unit
  bool allow_outside = false;  ///< read what the meshes name outside their folders
  SurfaceGrouping grouping = SurfaceGrouping::face;
  PatchSides sides = PatchSides::front;

  [[nodiscard]] bool is_pair() const { return !from.empty() || !to.empty(); }
};

/// Reads all meshes into one patch mesh, rows in input order; in the pair form row 0 is the one mesh and row 1 the
/// other. Throws FileError that names file and line, std::invalid_argument for a wrong builtin.
[[nodiscard]] PatchMesh load_factor_geometry(const FactorGeometryOptions& options, std::vector<std::string>& warnings);

}  // namespace penumbra::cli
