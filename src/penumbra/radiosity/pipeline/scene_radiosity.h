#pragma once

#include <cstddef>
#include <cstdint>
#include <limits>
#include <memory>
#include <string>
#include <vector>

#include "penumbra/parallel/progress.h"
#include "penumbra/radiosity/form_factors/factor_matrix.h"
#include "penumbra/radiosity/form_factors/form_factor_method.h"
#include "penumbra/radiosity/light_irradiance.h"
#include "penumbra/radiosity/patch_mesh.h"
#include "penumbra/radiosity/pipeline/refining_shooting.h"
#include "penumbra/radiosity/solvers/radiosity_problem.h"
#include "penumbra/radiosity/solvers/radiosity_solution.h"
#include "penumbra/scene/scene.h"

namespace penumbra {

enum class Subdivision {
  none,      ///< one element an input polygon
  uniform,   ///< elements of one size
  adaptive,  ///< elements cut along shadow lines and where the light varies: the lamps' for most solvers, all light
             ///< for shooting with `auto`, which cuts as it goes (RefiningShooting)
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
  /// With `auto`: where more polygons than this stand in doubt between the elements (crowding), as on finely faceted
  /// bodies, rays are cast instead, and a warning says so. Infinite: never.
  double most_crowding = std::numeric_limits<double>::infinity();
  std::string solver = "gauss-seidel";
  /// The matrix may take this many bytes; 0: as many as it wants.
  double factor_memory = 0;
  /// Rays from each element to the mirrors and glass that it sees, for light that comes that way (extended form
  /// factors). 0: such surfaces absorb what they do not reflect diffusely. Not read when the scene has none.
  int specular_rays = 256;
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
  std::unique_ptr<RefiningShooting> refining;    ///< instead of both: mesh and problem change as it goes
  FactorMatrix factors;
  /// What lights without a body bring, straight and by way of mirrors and glass, by their strength.
  std::vector<LightIrradiance> lights, specular_lights;
  std::uint64_t specular_rays = 0;   ///< traced
  std::vector<double> taken_by_air;  ///< by element: what absorbing air took of its row sum; empty in clear air
  std::vector<bool> passes_light;    ///< by element: all light that it does not absorb goes on by mirrors and glass
  std::string solver;
  std::string form_factors;  ///< the method's name; empty where the factors come from a checkpoint
  bool front_sides_only = false;
  bool partial = false;  ///< stopped before factors and direct light were complete
  std::vector<std::string> warnings;
  struct Seconds {
    double mesh = 0, form_factors = 0, direct = 0, specular = 0;
  } seconds;
};

/// The scene must outlive the setup. Elements, direct irradiance of the lights without a body, and form factors.
/// Stopped early it returns what there is, marked partial: missing factors read as 0. Throws std::invalid_argument for
/// options out of range, a scene that has no elements, factors beyond `factor_memory`, or air that radiosity does not
/// know (AbsorbingAir).
[[nodiscard]] std::unique_ptr<RadiositySetup> make_radiosity_setup(const Scene& scene,
                                                                   const RadiositySetupOptions& options,
                                                                   const Progress& progress = {});

/// Colours and emission of the elements as `scene` has them now. @param with_mirrors whether mirrors and glass pass
/// light on, by extended form factors.
void repaint(const Scene& scene, bool with_mirrors, RadiositySetup& setup);
/// Lights without a body at the strength that they have in `scene` now, by what they brought when the setup was made.
void relight(const Scene& scene, RadiositySetup& setup);

/// Takes out what mirrors and glass bring straight from lights, on every bounce; what they bring from other surfaces
/// stays.
void leave_caustics_out(RadiositySetup& setup);

/// A solved scene.
struct SceneRadiosity {
  RadiositySolution solution;    ///< its energy without what backs absorbed, when they are black
  double absorbed_by_air = 0;    ///< W, summed over bands, on the way between elements; no part of what escaped
  double absorbed_by_backs = 0;  ///< W, summed over bands; 0 unless front_sides_only
  /// The part of the irradiance that comes straight from lights by way of mirrors and glass, [element * 3 + band],
  /// W/m^2; empty without such surfaces.
  std::vector<double> caustics;
  /// Standard error of the irradiance that comes by way of mirrors and glass, for it is sampled: mean over the
  /// elements' area, as a share of the mean irradiance. 0 without such light.
  double specular_error = 0;
  double leak =
      0;  ///< W: what escaped from the inside of a scene that looks closed, beyond the factors' errors; else 0
};

/// Solves it. Where elements are refined as light arrives, the setup's mesh and problem are those of each stage, and of
/// the solution at the end; solve such a setup once.
[[nodiscard]] SceneRadiosity solve(RadiositySetup& setup, const SolverOptions& options);

}  // namespace penumbra
