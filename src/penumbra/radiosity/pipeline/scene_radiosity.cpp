#include "penumbra/radiosity/pipeline/scene_radiosity.h"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <stdexcept>
#include <utility>

#include "penumbra/radiosity/direct_irradiance.h"
#include "penumbra/radiosity/form_factors/crowding.h"
#include "penumbra/radiosity/form_factors/normalization.h"
#include "penumbra/radiosity/meshing/adaptive_elements.h"
#include "penumbra/radiosity/meshing/element_builder.h"
#include "penumbra/radiosity/meshing/uniform.h"
#include "penumbra/radiosity/pipeline/weakened_factors.h"
#include "penumbra/radiosity/solvers/direct.h"
#include "penumbra/radiosity/solvers/energy_balance.h"
#include "penumbra/radiosity/solvers/factor_rows.h"
#include "penumbra/radiosity/solvers/shooting.h"
#include "penumbra/radiosity/solvers/solver.h"
#include "penumbra/radiosity/specular/extended_factors.h"
#include "penumbra/radiosity/specular/specular_surfaces.h"

namespace penumbra {
namespace {

// Elements of which shooting keeps the matrix (some 40 MB) when `auto` computes it: a patch shoots several times, and
// its row would be computed each time.
constexpr std::size_t most_with_matrix = 2000;

constexpr int rays_in_crowds = 1024;  // an element

// What a matrix takes while it is assembled, bytes: a third of all pairs see each other, 24 bytes a factor.
constexpr double bytes_a_pair = 8;
// A side sees a closed scene when its factors sum to this much, and the scene looks closed when most sides do.
constexpr double full_row = 0.98;
constexpr double most_sides = 0.9;
constexpr double negligible_leak = 1e-4;  // of the power emitted
constexpr double notable_excess = 0.05;   // of a row's sum over 1

class Stopwatch {
 public:
  /// Seconds since the last call.
  double lap() {
    const auto now = std::chrono::steady_clock::now();
    return std::chrono::duration<double>(now - std::exchange(began_, now)).count();
  }

 private:
  std::chrono::steady_clock::time_point began_ = std::chrono::steady_clock::now();
};

void cut_evenly(const Scene& scene, const RadiositySetupOptions& options, RadiositySetup& setup) {
  MeshingOptions meshing;
  if (options.subdivision == Subdivision::uniform) {
    meshing.element_size = options.element_size;
    meshing.element_count = options.element_size > 0 ? 0 : options.element_count;
  }
  MadePatchMesh made = make_uniform_elements(scene, meshing);
  setup.mesh = std::move(made.mesh);
  setup.warnings = std::move(made.warnings);
}

void cut_where_light_varies(const Scene& scene, const RadiositySetupOptions& options, const Progress& progress,
                            RadiositySetup& setup) {
  AdaptiveMeshingOptions meshing;
  meshing.element_count = options.element_count;
  meshing.element_size = options.element_size;
  meshing.contrast = options.contrast;
  meshing.progress = progress;
  AdaptiveMesh made = make_adaptive_elements(scene, meshing);
  setup.mesh = std::move(made.elements);
  setup.warnings = std::move(made.warnings);
  setup.partial = made.partial;
}

void blacken_backs(PatchMesh& mesh) {
  for (std::size_t i = 0; i < mesh.surface_count(); ++i) {
    if (!mesh.surfaces[i].back) continue;
    for (std::size_t b = 0; b < 3; ++b) mesh.reflectance[3 * i + b] = mesh.emission[3 * i + b] = 0;
  }
}

void make_elements(const Scene& scene, const RadiositySetupOptions& options, const Progress& progress,
                   RadiositySetup& setup) {
  if (options.subdivision == Subdivision::adaptive) {
    cut_where_light_varies(scene, options, progress, setup);
  } else {
    cut_evenly(scene, options, setup);
  }
  if (setup.mesh.surface_count() == 0) {
    throw std::invalid_argument("the scene has no surface, so there is nothing to distribute light on");
  }
  if (options.front_sides_only) blacken_backs(setup.mesh);
}

void refuse_what_does_not_fit(const RadiositySetupOptions& options, std::size_t elements) {
  if (options.solver == "direct") refuse_what_direct_does_not_take(elements);
  const double bytes = bytes_a_pair * static_cast<double>(elements) * static_cast<double>(elements);
  if (options.factor_memory <= 0 || bytes <= options.factor_memory) return;
  throw std::invalid_argument(
      fmt::format("{} elements need about {:.0f} GB for their form factors, and {:.0f} GB are free; use fewer "
                  "(--elements N, --element-size M), or --solver shooting --form-factors hemicube, which keeps no "
                  "matrix",
                  elements, bytes / 1e9, options.factor_memory / 1e9));
}

// The method asked for, or rays where it would take too long.
std::unique_ptr<FormFactorMethod> make_method(const RadiositySetupOptions& options, RadiositySetup& setup) {
  FormFactorOptions factors = options.factors;
  factors.seed = options.seed;
  setup.form_factors = options.form_factors;
  if (options.form_factors == "auto" && std::isfinite(options.most_crowding) &&
      crowding(setup.mesh) > options.most_crowding) {
    setup.form_factors = "ray-cast";
    factors.rays = rays_in_crowds;
    setup.warnings.push_back(
        fmt::format("so many polygons stand between the {} elements that exact form factors would take very long; {} "
                    "rays from each element estimate them, and light of small lamps is grainy (--form-factors ray-cast "
                    "--rays N takes more rays, --factor-tolerance X asks for exact ones)",
                    setup.mesh.surface_count(), rays_in_crowds));
  }
  return make_form_factor_method(setup.form_factors, setup.mesh, factors);
}

// Area-weighted share of the sides that see anything and see a closed scene.
bool looks_closed(const RadiositySetup& setup) {
  double seeing = 0, closed = 0;
  for (std::size_t i = 0; i < setup.factors.rows(); ++i) {
    const double sum = setup.factors.row_sum(i), area = setup.mesh.surfaces[i].area;
    if (sum == 0) continue;
    seeing += area;
    if (sum > full_row) closed += area;
  }
  return seeing > 0 && closed > most_sides * seeing;
}

// What left sides that see something and arrived nowhere, W, and what of it the factors' errors explain. Sides that see
// nothing, as the outside of a room, leak nothing.
struct Escape {
  double power = 0, by_errors = 0;
};

Escape escape_from_seeing_sides(const RadiositySetup& setup, const RadiositySolution& solution) {
  Escape escape;
  for (std::size_t i = 0; i < setup.factors.rows(); ++i) {
    const double sum = setup.factors.row_sum(i);
    if (sum == 0) continue;
    for (std::size_t b = 0; b < 3; ++b) {
      const double leaves = setup.mesh.surfaces[i].area * solution.radiosity[3 * i + b];
      escape.power += leaves * (1 - sum);
      escape.by_errors += leaves * setup.factors.row_errors[i];
    }
  }
  return escape;
}

double absorbed_by_backs(const RadiositySetup& setup, const RadiositySolution& solution) {
  double power = 0;
  for (std::size_t i = 0; i < setup.mesh.surface_count(); ++i) {
    if (!setup.mesh.surfaces[i].back || (!setup.passes_light.empty() && setup.passes_light[i])) continue;
    for (std::size_t b = 0; b < 3; ++b) power += setup.mesh.surfaces[i].area * solution.irradiance[3 * i + b];
  }
  return power;
}

// Factors are no more exact than their method, and faces that lie on one another in part count twice. Where light would
// grow by it, or rows are far above 1, they are limited. What mirrors and glass pass on has rows of its own.
void keep_from_making_light(RadiositySetup& setup) {
  double excess = 0;
  bool grows = false;
  for (std::size_t i = 0; i < setup.factors.rows(); ++i) {
    if (!setup.passes_light.empty() && setup.passes_light[i]) continue;
    const double sum = setup.factors.row_sum(i);
    excess = std::max(excess, sum - 1);
    for (std::size_t b = 0; b < 3; ++b) {
      const double rho = setup.mesh.reflectance[3 * i + b];
      grows = grows || (rho < 1 && rho * sum >= 1);
    }
  }
  if (!grows && excess < notable_excess) return;
  (void)limit_row_sums(setup.factors);
  if (excess < notable_excess) return;
  setup.warnings.push_back(fmt::format(
      "form factors of an element sum to {:.3g}, more than 1: faces that lie on one another count twice (penumbra "
      "check names them), a closed body with two-sided faces stands on another face, or the method is too rough; they "
      "were lowered so that no light is made",
      1 + excess));
}

// What mirrors and glass pass on is not theirs to reflect diffusely. None are found when their light is not wanted.
SpecularElements leave_to_mirrors(const Scene& scene, bool wanted, RadiositySetup& setup) {
  setup.passes_light.assign(setup.mesh.surface_count(), false);
  if (!wanted) return {};
  SpecularElements specular = find_specular_elements(scene, setup.mesh, MeshingOptions{}.shape_segments);
  if (!specular.any()) return specular;
  share_reflectance(scene, specular, setup.mesh);
  setup.passes_light = specular.only_specular;
  return specular;
}

void add_light_by_mirrors(const Scene& scene, const RadiositySetupOptions& options, const SpecularElements& specular,
                          const Progress& progress, RadiositySetup& setup) {
  std::unique_ptr<FactorRowSource> rows;
  if (setup.row_method) {
    rows = std::make_unique<MethodRows>(*setup.row_method, setup.mesh);
  } else {
    rows = std::make_unique<MatrixRows>(setup.factors);
  }
  ExtendedFactors found = make_extended_factors(scene, setup.mesh, specular, *rows,
                                                {.rays = options.specular_rays,
                                                 .front_sides_only = options.front_sides_only,
                                                 .seed = options.seed,
                                                 .progress = progress});
  setup.problem.specular = std::make_shared<const SpecularTransport>(std::move(found.transport));
  setup.specular_lights = std::move(found.lights);
  setup.specular_rays = found.rays;
  setup.partial = setup.partial || found.partial;
}

double absorbed_by_air(const RadiositySetup& setup, const RadiositySolution& solution) {
  double power = 0;
  for (std::size_t i = 0; i < setup.taken_by_air.size(); ++i) {
    for (std::size_t b = 0; b < 3; ++b) {
      power += setup.mesh.surfaces[i].area * solution.radiosity[3 * i + b] * setup.taken_by_air[i];
    }
  }
  return power;
}

void refuse_mirrors_in_air(const SpecularElements& specular, const AbsorbingAir& air) {
  if (air.is_clear() || !specular.any()) return;
  throw std::invalid_argument(
      "light by way of mirrors and glass is not followed through absorbing air; --specular-rays 0 leaves it out");
}

// Mean standard error of what comes by way of mirrors and glass, as a share of the mean irradiance.
double specular_error(const RadiositySetup& setup, const RadiositySolution& solution) {
  const double all = power_of(setup.problem, solution.irradiance);
  return all > 0 ? power_of(setup.problem, setup.problem.specular->standard_errors(solution.radiosity)) / all : 0;
}

// What mirrors and glass bring straight from lights, with a body and without.
std::vector<double> caustic_irradiance(const RadiosityProblem& problem) {
  std::vector<double> irradiance = problem.specular_irradiance;
  irradiance.resize(problem.bands * problem.element_count(), 0);
  problem.specular->gather(0, problem.element_count(), problem.emission, irradiance);
  return irradiance;
}

// Where mirrors and glass pass light on, elements stay as they were made.
bool refines_as_it_shoots(const Scene& scene, const RadiositySetupOptions& options) {
  const bool specular =
      options.specular_rays > 0 && std::any_of(scene.materials.begin(), scene.materials.end(), is_specular);
  return !specular && options.solver == "shooting" && options.subdivision == Subdivision::adaptive &&
         options.form_factors == "auto";
}

void prepare_refining(const Scene& scene, const RadiositySetupOptions& options, const Progress& progress,
                      RadiositySetup& setup) {
  RefiningShootingOptions shooting;
  shooting.element_count = options.element_count;
  shooting.element_size = options.element_size;
  shooting.contrast = options.contrast;
  shooting.front_sides_only = options.front_sides_only;
  shooting.factors = options.factors;
  shooting.seed = options.seed;
  setup.refining = std::make_unique<RefiningShooting>(scene, shooting, progress);
  setup.mesh = setup.refining->mesh();
  setup.problem = setup.refining->problem();
  setup.warnings = setup.refining->warnings();
}

RadiositySolution refine_and_shoot(RadiositySetup& setup, const SolverOptions& options) {
  SolverOptions own = options;
  const auto update = [&] {
    if (setup.mesh.surface_count() == setup.refining->mesh().surface_count()) return;
    setup.mesh = setup.refining->mesh();
    setup.problem = setup.refining->problem();
  };
  own.on_stage = [&](const SolverStage& stage) {
    if (!options.on_stage) return;
    update();
    options.on_stage(stage);
  };
  RadiositySolution solution = setup.refining->solve(own);
  update();
  setup.problem = setup.refining->problem();
  return solution;
}

}  // namespace

std::unique_ptr<RadiositySetup> make_radiosity_setup(const Scene& scene, const RadiositySetupOptions& options,
                                                     const Progress& progress) {
  auto setup = std::make_unique<RadiositySetup>();
  setup->solver = options.solver;
  setup->front_sides_only = options.front_sides_only;
  Stopwatch watch;
  progress.tell("mesh", 0);
  const AbsorbingAir air(scene);
  if (air.is_clear() && refines_as_it_shoots(scene, options)) {
    setup->form_factors = options.form_factors;
    prepare_refining(scene, options, progress, *setup);
    setup->seconds.mesh = watch.lap();
    return setup;
  }
  make_elements(scene, options, progress, *setup);
  const SpecularElements specular = leave_to_mirrors(scene, options.specular_rays > 0, *setup);
  refuse_mirrors_in_air(specular, air);
  setup->problem = make_radiosity_problem(setup->mesh);
  setup->seconds.mesh = watch.lap();

  DirectIrradiance direct = direct_irradiance(scene, setup->mesh, {.seed = options.seed, .progress = progress});
  setup->lights = std::move(direct.lights);
  setup->seconds.direct = watch.lap();

  auto method = make_method(options, *setup);
  const bool small = options.form_factors == "auto" && setup->mesh.surface_count() <= most_with_matrix;
  if (options.solver == "shooting" && method->computes_rows() && !small && air.is_clear()) {
    setup->row_method = std::move(method);
  } else {
    refuse_what_does_not_fit(options, setup->mesh.surface_count());
    setup->factors = assemble_factor_matrix(*method, setup->mesh, progress);
    keep_from_making_light(*setup);
    if (!air.is_clear()) setup->taken_by_air = weaken_factors(setup->mesh, air, setup->factors);
  }
  setup->partial = setup->partial || direct.partial || setup->factors.partial;
  setup->seconds.form_factors = watch.lap();
  if (specular.any()) add_light_by_mirrors(scene, options, specular, progress, *setup);
  setup->seconds.specular = watch.lap();
  relight(scene, *setup);
  return setup;
}

void repaint(const Scene& scene, bool with_mirrors, RadiositySetup& setup) {
  paint_elements(scene, MeshingOptions{}.shape_segments, setup.mesh);
  if (setup.front_sides_only) blacken_backs(setup.mesh);
  (void)leave_to_mirrors(scene, with_mirrors, setup);
}

void relight(const Scene& scene, RadiositySetup& setup) {
  setup.problem.irradiance = irradiance_of(scene, setup.lights);
  setup.problem.light_power = power_of(scene, setup.lights);
  setup.problem.specular_irradiance = irradiance_of(scene, setup.specular_lights);
}

void leave_caustics_out(RadiositySetup& setup) {
  setup.specular_lights.clear();
  setup.problem.specular_irradiance.clear();
  if (!setup.problem.specular) return;
  SpecularTransport transport = *setup.problem.specular;
  for (std::size_t k = 0; k < transport.columns.size(); ++k) {
    const double* const emission = &setup.problem.emission[std::size_t{3} * transport.columns[k]];
    if (emission[0] + emission[1] + emission[2] > 0) std::fill_n(&transport.values[3 * k], 3, 0.0F);
  }
  setup.problem.specular = std::make_shared<const SpecularTransport>(std::move(transport));
}

SceneRadiosity solve(RadiositySetup& setup, const SolverOptions& options) {
  SceneRadiosity result;
  RadiositySolution& solution = result.solution;
  if (setup.refining) {
    solution = refine_and_shoot(setup, options);
  } else if (setup.row_method) {
    const MethodRows rows(*setup.row_method, setup.mesh);
    const LimitedRows limited(rows);
    solution = solve_shooting(setup.problem, KeptRows(limited), options);
  } else {
    solution = solve_radiosity(setup.solver, setup.problem, setup.factors, options);
  }
  solution.partial = solution.partial || setup.partial;
  if (setup.problem.specular) {
    result.specular_error = specular_error(setup, solution);
    result.caustics = caustic_irradiance(setup.problem);
  }
  result.absorbed_by_air = absorbed_by_air(setup, solution);
  solution.energy.escaped -= result.absorbed_by_air;
  if (setup.front_sides_only) {
    result.absorbed_by_backs = absorbed_by_backs(setup, solution);
    solution.energy.absorbed -= result.absorbed_by_backs;
  }
  Escape escape = escape_from_seeing_sides(setup, solution);
  escape.power -= result.absorbed_by_air;
  const double explained = 2 * escape.by_errors + negligible_leak * solution.energy.emitted;
  if (!solution.partial && escape.power > explained && looks_closed(setup)) result.leak = escape.power;
  return result;
}

}  // namespace penumbra
