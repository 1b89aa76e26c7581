#include "probe_bake.h"

#include <fmt/core.h>

#include <algorithm>
#include <filesystem>
#include <utility>

#include "console.h"
#include "exit_code.h"
#include "interrupt.h"
#include "penumbra/baking/probes.h"
#include "penumbra/file/output_file.h"
#include "penumbra/io/probe_file.h"
#include "penumbra/parallel/parallel_for.h"
#include "report.h"
#include "run_limits.h"
#include "unfolded_scene.h"

namespace penumbra::cli {
namespace {

/// Probes hold smooth light, so the cells that they look at need not be fine.
constexpr double usual_noise = 0.02;

Report vector_of(const Vec3d& v) { return {v.x, v.y, v.z}; }

/// Everything, for programs that read JSON.
Report description(const BakeArguments& arguments, const ProbeGrid& grid) {
  Report coefficients = Report::array(), positions = Report::array(), inside = Report::array();
  for (std::size_t p = 0; p < grid.positions.size(); ++p) {
    positions.push_back(vector_of(grid.positions[p]));
    inside.push_back(grid.is_inside[p] != 0);
    Report of_probe = Report::array();
    for (const Rgb& c : grid.radiance(p)) of_probe.push_back({c.x, c.y, c.z});
    coefficients.push_back(std::move(of_probe));
  }
  return {{"quantity", "incoming radiance, real spherical harmonics of order 2, world axes (+Y up)"},
          {"unit", "W/(m^2 sr)"},
          {"photometric", arguments.scene.photometric},
          {"colour", "linear Rec. 709"},
          {"harmonics", {"L00", "L1-1", "L10", "L11", "L2-2", "L2-1", "L20", "L21", "L22"}},
          {"irradiance", "at normal n: sum over l and m of A_l Llm Ylm(n), A = pi, 2pi/3, pi/4"},
          {"scene", arguments.scene.source},
          {"arrays", std::filesystem::path(probe_arrays_name(arguments.output)).filename().string()},
          {"partial", grid.partial},
          {"count", {grid.count[0], grid.count[1], grid.count[2]}},
          {"order", "x fastest, then y, then z"},
          {"lower", vector_of(grid.positions.front())},
          {"upper", vector_of(grid.positions.back())},
          {"positions", std::move(positions)},
          {"inside", std::move(inside)},
          {"coefficients", std::move(coefficients)}};
}

void write_files(const BakeArguments& arguments, const ProbeGrid& grid) {
  OutputFile json(arguments.output);
  json.write(description(arguments, grid).dump(-1, ' ', false, Report::error_handler_t::replace) + "\n");
  json.commit();
  write_probe_arrays(probe_arrays_name(arguments.output), {.count = grid.count,
                                                           .positions = grid.positions,
                                                           .coefficients = grid.coefficients,
                                                           .inside = grid.is_inside,
                                                           .partial = grid.partial});
}

}  // namespace

std::string probe_arrays_name(const std::string& output) {
  return std::filesystem::path(output).replace_extension(".npz").string();
}

int bake_probe_grid(const BakeArguments& arguments) {
  Console console(arguments.common);
  Interrupt interrupt;  // before the first thread of the work
  const RunLimits limits(arguments.common);
  std::vector<std::string> warnings;
  const UnfoldedScene scene = unfold_scene(arguments, console, interrupt, warnings);

  const Progress progress{[&](std::string_view stage, double fraction) { console.progress(stage, fraction); },
                          interrupt.token()};
  const Stopwatch solve_watch;
  const TexelSolution solution(scene.atlas, scene.texels,
                               solution_options(arguments, arguments.noise.value_or(usual_noise)), progress);
  const double solve = solve_watch.seconds();

  const Stopwatch gather_watch;
  ProbeOptions options;
  options.bounds = arguments.probe_bounds.value_or(options.bounds);
  options.count = *arguments.probes;
  options.seed = arguments.common.seed;
  options.progress = progress;
  ProbeGrid grid = bake_probes(solution, options);
  grid.partial = grid.partial || solution.is_partial();
  const double gather = gather_watch.seconds();

  const Stopwatch write_watch;
  console.progress("write", 0);
  write_files(arguments, grid);
  const double write = write_watch.seconds();

  const auto buried = std::ranges::count(grid.is_inside, 1);
  if (grid.partial) console.insist(arguments.output + ": partial, the computation was stopped; light is missing");
  console.say(fmt::format("{}: {} probes, {} of them inside solid matter, {:.2f} s", arguments.output,
                          grid.positions.size(), buried,
                          scene.load_seconds + scene.mesh_seconds + solve + gather + write));
  write_report(arguments.common, {{"command", "bake"},
                                  {"version", PENUMBRA_VERSION},
                                  {"scene", arguments.scene.source},
                                  {"output", arguments.output},
                                  {"seed", arguments.common.seed},
                                  {"elements", scene.texels.count()},
                                  {"iterations", solution.cells().residuals().size()},
                                  {"residual", solution.cells().residuals()},
                                  {"probes", grid.positions.size()},
                                  {"probes_inside", buried},
                                  {"atlas", report_on(facts_of(scene))},
                                  {"seconds",
                                   {{"load", scene.load_seconds},
                                    {"mesh", scene.mesh_seconds},
                                    {"solve", solve},
                                    {"gather", gather},
                                    {"write", write}}},
                                  {"threads", thread_count()},
                                  {"peak_rss_bytes", peak_memory()},
                                  {"partial", grid.partial},
                                  {"warnings", warnings}});
  return interrupt.requested() ? exit_interrupted : exit_done;
}

}  // namespace penumbra::cli
