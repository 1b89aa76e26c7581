#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <optional>

#include "bake_arguments.h"
#include "checkpoint.h"
#include "command.h"
#include "console.h"
#include "exit_code.h"
#include "interrupt.h"
#include "lightmap_bake.h"
#include "occlusion_bake.h"
#include "penumbra/parallel/parallel_for.h"
#include "penumbra/radiosity/pipeline/spectral_radiosity.h"
#include "penumbra/radiosity/specular/specular_surfaces.h"
#include "probe_bake.h"
#include "report.h"
#include "run_limits.h"
#include "scene_options.h"
#include "snapshots.h"
#include "solution_file.h"
#include "world_options.h"

namespace penumbra::cli {
namespace {

/// Where the time of a bake went, s.
struct Seconds {
  double load = 0, solve = 0, write = 0;
};

/// A number that JSON can hold: infinite ones are null.
Report finite_or_null(double x) { return std::isfinite(x) ? Report(x) : Report(nullptr); }

Report report_on(const BakeArguments& arguments, const RadiositySetup& setup, const SceneRadiosity& solved,
                 const Seconds& seconds, const std::vector<std::string>& warnings) {
  const RadiositySolution& s = solved.solution;
  return {{"command", "bake"},
          {"version", PENUMBRA_VERSION},
          {"scene", arguments.scene.source},
          {"output", arguments.output},
          {"solver", arguments.radiosity.solver},
          {"form_factors", setup.form_factors.empty() ? Report(nullptr) : Report(setup.form_factors)},
          {"seed", arguments.common.seed},
          {"resumed", arguments.resume.has_value()},
          {"spectral", arguments.spectral},
          {"elements", setup.mesh.surface_count()},
          {"links", setup.factors.values.size()},
          {"iterations", s.iterations},
          {"converged", s.converged},
          {"residual", s.residuals},
          {"unshot_fraction", s.unshot_fraction},
          {"energy",
           {{"emitted", s.energy.emitted},
            {"absorbed", s.energy.absorbed},
            {"escaped", s.energy.escaped},
            {"absorbed_by_air", solved.absorbed_by_air},
            {"absorbed_by_backs", solved.absorbed_by_backs},
            {"unshot", s.energy.unshot}}},
          {"specular", {{"rays", setup.specular_rays}, {"irradiance_error", solved.specular_error}}},
          {"error_bound", finite_or_null(s.error_bound)},
          {"seconds",
           {{"load", seconds.load},
            {"mesh", setup.seconds.mesh},
            {"form_factors", setup.seconds.form_factors},
            {"direct", setup.seconds.direct},
            {"specular", setup.seconds.specular},
            {"solve", seconds.solve},
            {"gather", 0.0},
            {"write", seconds.write}}},
          {"threads", thread_count()},
          {"peak_rss_bytes", peak_memory()},
          {"partial", s.partial},
          {"warnings", warnings}};
}

std::vector<std::string> remarks(const BakeArguments& arguments, const SceneRadiosity& solved) {
  constexpr double notable = 0.01;
  std::vector<std::string> sentences;
  const EnergyBalance& energy = solved.solution.energy;
  if (solved.leak > 0) {
    sentences.push_back(
        fmt::format("{:.3g} % of the light escapes although the scene looks closed; penumbra check {} "
                    "shows where it leaks",
                    100 * solved.leak / energy.emitted, arguments.scene.source));
  }
  if (solved.absorbed_by_backs > notable * energy.emitted) {
    sentences.push_back(
        fmt::format("{:.3g} % of the light ends on backs, which are black with --sides front; penumbra "
                    "check {} names flipped faces",
                    100 * solved.absorbed_by_backs / energy.emitted, arguments.scene.source));
  }
  if (!solved.solution.converged && !solved.solution.partial) {
    sentences.push_back(fmt::format(
        "the solution has not converged after {} iterations (residual {:.2g}); raise "
        "--max-iterations",
        solved.solution.iterations, solved.solution.residuals.empty() ? 0.0 : solved.solution.residuals.back()));
  }
  return sentences;
}

void say_result(const BakeArguments& arguments, const RadiositySetup& setup, const SceneRadiosity& solved,
                const Seconds& seconds, Console& console) {
  const RadiositySolution& s = solved.solution;
  if (s.partial) {
    console.insist(arguments.output + ": partial solution, the computation was stopped; light is missing");
  }
  const auto percent = [&](double power) {  // to a tenth, and 0 never below 0
    return s.energy.emitted > 0 ? std::round(1000 * power / s.energy.emitted) / 10 + 0.0 : 0.0;
  };
  console.say(
      fmt::format("{}: {} elements, {} links, {} iterations ({}), {:.4g} W emitted, {:.1f} % absorbed, {:.1f} % "
                  "escaped, {:.2f} s",
                  arguments.output, setup.mesh.surface_count(), setup.factors.values.size(), s.iterations,
                  arguments.radiosity.solver, s.energy.emitted, percent(s.energy.absorbed), percent(s.energy.escaped),
                  seconds.load + setup.seconds.mesh + setup.seconds.direct + setup.seconds.form_factors +
                      setup.seconds.specular + seconds.solve + seconds.write));
}

// Light by way of mirrors and glass is followed in red, green and blue only.
void warn_of_mirrors(const Scene& scene, std::vector<std::string>& warnings) {
  const auto mirror = std::find_if(scene.materials.begin(), scene.materials.end(), is_specular);
  if (mirror == scene.materials.end()) return;
  warnings.push_back(fmt::format(
      "with --spectral mirrors and glass, such as '{}', pass no light on; what they bring to other surfaces "
      "is missing (bake without --spectral, or render by path, has it)",
      mirror->name));
}

std::unique_ptr<RadiositySetup> set_up(const BakeArguments& arguments, const Scene& scene, const Progress& progress) {
  RadiositySetupOptions options =
      setup_options(arguments.radiosity, arguments.scene.front_sides_only, arguments.common.seed);
  if (arguments.spectral) options.specular_rays = 0;
  if (arguments.resume) return read_checkpoint(*arguments.resume, scene, options);
  auto setup = make_radiosity_setup(scene, options, progress);
  if (arguments.checkpoint && setup->partial) {
    setup->warnings.push_back(*arguments.checkpoint +
                              ": no checkpoint was written, the computation was stopped before");
  } else if (arguments.checkpoint) {
    write_checkpoint(*arguments.checkpoint, scene, *setup);
  }
  return setup;
}

int bake_scene(const BakeArguments& arguments) {
  Console console(arguments.common);
  Interrupt interrupt;  // before the first thread of the work
  const RunLimits limits(arguments.common);
  Seconds seconds;

  const Stopwatch load_watch;
  console.progress("load", 0);
  std::vector<std::string> warnings;
  const Scene scene = load_scene(arguments.scene, warnings);
  if (arguments.output.ends_with(".glb")) refuse_air(scene, arguments.output);
  warn_of_dyes(scene, arguments.spectral, warnings);
  if (arguments.spectral) warn_of_mirrors(scene, warnings);
  console.warn(warnings);
  require_room_for_faces(scene, arguments.scene.source);
  seconds.load = load_watch.seconds();

  const Progress progress{[&](std::string_view stage, double fraction) { console.progress(stage, fraction); },
                          interrupt.token()};
  interrupt.something_to_keep();
  const auto setup = set_up(arguments, scene, progress);
  console.warn(setup->warnings);
  warnings.insert(warnings.end(), setup->warnings.begin(), setup->warnings.end());

  const Stopwatch solve_watch;
  SolverOptions options = solver_options(arguments.radiosity);
  options.progress = progress;
  std::optional<Snapshots> snapshots;
  if (arguments.snapshots) {
    snapshots.emplace(arguments, scene, *setup);
    options.on_stage = [&](const SolverStage& stage) { snapshots->take(stage); };
  }
  SpectralRadiosity spectral;
  if (arguments.spectral) spectral = solve_spectral(scene, *setup, options);
  const SceneRadiosity solved = arguments.spectral ? std::move(spectral.rgb) : solve(*setup, options);
  seconds.solve = solve_watch.seconds();

  const Stopwatch write_watch;
  console.progress("write", 0);
  DiffuseSolution solution = diffuse_solution(scene, setup->mesh, solved.solution, solved.caustics);
  solution.wavelength_edges = std::move(spectral.edges);
  solution.spectral_radiosity = std::move(spectral.bands.radiosity);
  std::vector<std::string> said =
      write_solution(arguments.output, solution, scene, {arguments.exposure.value_or(0), arguments.scene.photometric});
  for (std::string& sentence : remarks(arguments, solved)) said.push_back(std::move(sentence));
  console.warn(said);
  warnings.insert(warnings.end(), said.begin(), said.end());
  seconds.write = write_watch.seconds();

  say_result(arguments, *setup, solved, seconds, console);
  write_report(arguments.common, report_on(arguments, *setup, solved, seconds, warnings));
  return interrupt.requested() ? exit_interrupted : exit_done;
}

}  // namespace

int run_bake(const std::vector<std::string>& arguments) {
  const auto parsed = parse_bake_arguments(arguments);
  if (!parsed) return exit_done;
  switch (parsed->kind()) {
    case BakeKind::lightmap:
      return bake_lightmap(*parsed);
    case BakeKind::occlusion:
      return bake_occlusion(*parsed);
    case BakeKind::probes:
      return bake_probe_grid(*parsed);
    case BakeKind::solution:
      break;
  }
  return bake_scene(*parsed);
}

}  // namespace penumbra::cli
