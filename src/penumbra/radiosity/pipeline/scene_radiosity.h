#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "penumbra/parallel/progress.h"
#include "penumbra/radiosity/form_factors/factor_matrix.h"
#include "penumbra/radiosity/form_factors/form_factor_method.h"
#include "penumbra/radiosity/patch_mesh.h"
#include "penumbra/radiosity/solvers/radiosity_problem.h"
#include "penumbra/radiosity/solvers/radiosity_solution.h"
#include "penumbra/scene/scene.h"

namespace penumbra {

enum class Subdivision {
  none,      ///< one element an input polygon
  uniform,   ///< elements of one size
  adaptive,  ///< elements cut along shadow lines and where the light varies
};

/// How a scene becomes a system of equations.
struct RadiositySetupOptions {
  Subdivision subdivision = Subdivision::uniform;
  double element_size = 0;           ///< m, the longest edge allowed; 0: by count
  std::size_t element_count = 5000;  ///< about this many, both sides counted
  double contrast = 1e-3;            ///< adaptive: see AdaptiveMeshingOptions
  bool front_sides_only = false;     ///< backs are black and opaque
  std::string form_factors = "auto";
  FormFactorOptions factors;
  std::string solver = "gauss-seidel";
  /// The matrix may take this many bytes; 0: as many as it wants.
  double factor_memory = 0;
  std::uint64_t seed = 0;
};

/// The system of a scene: elements, sources, and factors as a matrix or, for shooting with a method that computes
/// single rows, as that method. Stays where it was made: the method points to the mesh.
struct RadiositySetup {
  RadiositySetup() = default;
  RadiositySetup(const RadiositySetup&) = delete;
  RadiositySetup& operator=(const RadiositySetup&) = delete;

  PatchMesh mesh;  ///< each patch an element and a surface
  RadiosityProblem problem;
  std::unique_ptr<FormFactorMethod> row_method;  ///< none: the matrix holds the factors
  FactorMatrix factors;
  std::string solver;
  bool front_sides_only = false;
  bool partial = false;  ///< stopped before factors and direct light were complete
  std::vector<std::string> warnings;
  struct Seconds {
    double mesh = 0, form_factors = 0, direct = 0;
  } seconds;
};

/// Elements, direct irradiance of the lights without a body, and form factors. Stopped early it returns what there is,
/// marked partial: missing factors read as 0. Throws std::invalid_argument for options out of range, a scene that has
/// no elements, or factors beyond `factor_memory`.
[[nodiscard]] std::unique_ptr<RadiositySetup> make_radiosity_setup(const Scene& scene,
                                                                   const RadiositySetupOptions& options,
                                                                   const Progress& progress = {});

/// A solved scene.
struct SceneRadiosity {
  RadiositySolution solution;    ///< its energy without what backs absorbed, when they are black
  double absorbed_by_backs = 0;  ///< W, summed over bands; 0 unless front_sides_only
  double leak = 0;               ///< W: what escaped from a scene that looks closed, beyond the factors' errors; else 0
};

[[nodiscard]] SceneRadiosity solve(const RadiositySetup& setup, const SolverOptions& options);

}  // namespace penumbra
