#pragma once

#include <string>

#include "penumbra/io/element_table.h"
#include "penumbra/radiosity/patch_mesh.h"
#include "penumbra/radiosity/pipeline/scene_radiosity.h"
#include "penumbra/scene/fingerprint.h"

namespace penumbra::cli {

/// A diffuse solution: the elements and the light on each, however it was come by.
struct DiffuseSolution {
  PatchMesh mesh;                         ///< each patch an element and a surface
  std::vector<double> irradiance;         ///< from everywhere, [element * 3 + band], W/m^2
  std::vector<double> radiosity;          ///< W/m^2
  std::vector<double> caustics;           ///< SceneRadiosity::caustics; empty: none, or not known
  std::vector<std::string> object_names;  ///< by the objects' numbers in the mesh's surfaces
  bool partial = false;
  /// Of a solution over bands of wavelength: edges in nm and W/m^2, [element * bands + band]. Else empty.
  std::vector<double> wavelength_edges, spectral_radiosity;
  SceneFingerprint scene;  ///< of the scene that it is of
};

/// Of a scene that was just solved.
[[nodiscard]] DiffuseSolution diffuse_solution(const Scene& scene, const PatchMesh& mesh,
                                               const RadiositySolution& solution, std::vector<double> caustics = {});

/// As columns, for .npz and .csv.
[[nodiscard]] ElementTable element_table(const DiffuseSolution& solution);

/// Reads what `bake` wrote as .npz. Throws FileError, also when it is of another scene than this one.
[[nodiscard]] DiffuseSolution read_solution(const std::string& path, const Scene& scene);

/// How colours come from radiosity.
struct ColourScale {
  double exposure = 0;       ///< stops (EV)
  bool photometric = false;  ///< emission was read as nit
};

/// Writes the solution by the extension of `path`: .npz, .csv, .ply, .vtu or .glb. Elements that no light reaches and
/// that send none are left out of .ply and .vtu. Returns warnings. Throws FileError, std::system_error.
std::vector<std::string> write_solution(const std::string& path, const DiffuseSolution& solution, const Scene& scene,
                                        const ColourScale& scale);

}  // namespace penumbra::cli
