#include <fmt/core.h>

#include <utility>

#include "command.h"
#include "console.h"
#include "exit_code.h"
#include "interrupt.h"
#include "penumbra/image/layer_picture.h"
#include "penumbra/parallel/parallel_for.h"
#include "penumbra/radiosity/meshing/element_builder.h"
#include "penumbra/radiosity/meshing/uniform.h"
#include "penumbra/render/radiosity_view.h"
#include "penumbra/render/solution_light.h"
#include "penumbra/render/two_pass.h"
#include "penumbra/tracing/shading/media.h"
#include "render_arguments.h"
#include "report.h"
#include "run_limits.h"
#include "solution_file.h"

namespace penumbra::cli {
namespace {

/// Where the time of a render went, s.
struct Seconds {
  double load = 0, build = 0, solve = 0, render = 0, write = 0;
};

double rays_per_second(const RenderResult& result) {
  return result.seconds > 0 ? static_cast<double>(result.rays.total()) / result.seconds : 0;
}

/// What was drawn, and the solution's warnings when one was computed.
struct Drawn {
  RenderResult result;
  double solve_seconds = 0;
};

DiffuseSolution solve_for(const RenderArguments& arguments, const Scene& scene, const Progress& progress,
                          Console& console) {
  if (arguments.solution) return read_solution(*arguments.solution, scene);
  const auto setup = make_radiosity_setup(
      scene, setup_options(arguments.radiosity, arguments.scene.front_sides_only, arguments.common.seed), progress);
  console.warn(setup->warnings);
  if (!arguments.render.caustics) leave_caustics_out(*setup);
  SolverOptions options = solver_options(arguments.radiosity);
  options.progress = progress;
  SceneRadiosity solved = solve(*setup, options);
  return diffuse_solution(scene, setup->mesh, solved.solution, std::move(solved.caustics));
}

/// A picture with the light of a solution.
Drawn show_two_pass(const RenderArguments& arguments, const RayTracer& tracer, const DiffuseSolution& solution,
                    const Camera& camera, const Progress& progress, const Stopwatch& watch) {
  const MadePatchMesh faces = make_element_faces(tracer.scene(), PatchSides::both, MeshingOptions{}.shape_segments);
  const LampIrradiance lamps(tracer.scene(), faces.mesh);
  const SolutionLight light(tracer, solution.mesh, solution.irradiance, solution.caustics, lamps);
  Drawn drawn;
  drawn.solve_seconds = watch.seconds();
  drawn.result = render(tracer, light, camera, arguments.render, progress);
  drawn.result.partial = drawn.result.partial || solution.partial;
  return drawn;
}

Drawn show_solution(const RenderArguments& arguments, const RayTracer& tracer, const Camera& camera,
                    const Progress& progress, Console& console) {
  const Scene& scene = tracer.scene();
  const Stopwatch watch;
  const DiffuseSolution solution = solve_for(arguments, scene, progress, console);
  if (solution.partial) {
    console.insist("partial: the solution was stopped, light is missing");
  }
  if (arguments.is_two_pass()) return show_two_pass(arguments, tracer, solution, camera, progress, watch);
  std::optional<MadePatchMesh> faces;
  std::optional<LampIrradiance> lamps;
  // Lamps are exact in clear air alone.
  if (!arguments.flat && !solution.partial && Media(scene).none()) {
    faces = make_element_faces(scene, PatchSides::both, MeshingOptions{}.shape_segments);
    lamps.emplace(scene, faces->mesh);
  }
  const RadiosityView view(solution.mesh, solution.irradiance, scene,
                           {.smooth = !arguments.flat,
                            .lamps = lamps ? &*lamps : nullptr,
                            .outlines = arguments.outlines ? ElementOutlines::dark : ElementOutlines::none});
  Drawn drawn;
  drawn.solve_seconds = watch.seconds();
  drawn.result = render(view, camera, arguments.render, progress);
  drawn.result.partial = drawn.result.partial || solution.partial;
  return drawn;
}

Drawn draw(const RenderArguments& arguments, const RayTracer& tracer, const Camera& camera, Interrupt& interrupt,
           Console& console) {
  const Progress progress{[&](std::string_view stage, double fraction) { console.progress(stage, fraction); },
                          interrupt.token()};
  interrupt.something_to_keep();
  if (arguments.needs_solution()) return show_solution(arguments, tracer, camera, progress, console);
  return {render(tracer, camera, arguments.render, progress), 0};
}

void describe(const RenderArguments& arguments, const Camera& camera, const RenderResult& result, Image& image) {
  image.metadata.merge(camera_metadata(camera));
  image.metadata["renderer"] = "penumbra " PENUMBRA_VERSION;
  image.metadata["scene"] = arguments.scene.source;
  image.metadata["integrator"] = arguments.integrator;
  image.metadata["samples_per_pixel"] = fmt::format("{}", result.mean_samples);
  image.metadata["seed"] = fmt::format("{}", arguments.render.seed);
  image.metadata["partial"] = result.partial ? "true" : "false";
}

/// The share of particles that something did not happen to.
double share_without(const ParticleFates& fates, std::uint64_t happened) {
  return fates.shot > 0 ? 1 - static_cast<double>(happened) / static_cast<double>(fates.shot) : 1;
}

Report report_on(const ParticleFates& fates) {
  return {{"shot", fates.shot},
          {"met_eye", fates.met_eye},
          {"never_met_eye_share", share_without(fates, fates.met_eye)},
          {"seen", fates.seen},
          {"never_seen_share", share_without(fates, fates.seen)}};
}

Report report_on(const RenderArguments& arguments, const RenderResult& result, const RayTracer& tracer,
                 const Seconds& seconds) {
  const RayCounts& rays = result.rays;
  Report report = {
      {"command", "render"},
      {"version", PENUMBRA_VERSION},
      {"scene", arguments.scene.source},
      {"output", arguments.picture.path},
      {"integrator", arguments.integrator},
      {"seed", arguments.render.seed},
      {"seconds",
       {{"load", seconds.load},
        {"build", seconds.build},
        {"solve", seconds.solve},
        {"render", seconds.render},
        {"write", seconds.write}}},
      {"rays",
       {{"primary", rays.primary},
        {"shadow", rays.shadow},
        {"reflection", rays.reflection},
        {"refraction", rays.refraction},
        {"diffuse", rays.diffuse},
        {"total", rays.total()}}},
      {"rays_by_depth", rays.by_depth},
      {"rays_per_second", rays_per_second(result)},
      {"triangles", tracer.triangle_count()},
      {"threads", thread_count()},
      {"peak_rss_bytes", peak_memory()},
      {"image",
       {{"width", arguments.render.width}, {"height", arguments.render.height}, {"spp_mean", result.mean_samples}}},
      {"partial", result.partial}};
  if (result.particles) report["particles"] = report_on(*result.particles);
  return report;
}

void say_result(const RenderArguments& arguments, const RenderResult& result, Console& console) {
  if (result.partial) {
    console.insist(fmt::format("{}: partial picture, {:.3g} of {} samples a pixel were drawn", arguments.picture.path,
                               result.mean_samples, arguments.render.samples_per_pixel));
  }
  console.say(fmt::format("{}: {}x{}, {:.4g} samples a pixel ({}), {:.2f} s, {:.2f} Mrays/s", arguments.picture.path,
                          arguments.render.width, arguments.render.height, result.mean_samples, arguments.integrator,
                          result.seconds, rays_per_second(result) / 1e6));
  if (result.particles) {
    const ParticleFates& fates = *result.particles;
    console.say(fmt::format(
        "of {} particles {} came into the eye's pupil by themselves ({:.6g} % never did); joined to the eye by a ray, "
        "{:.4g} % were never seen",
        fates.shot, fates.met_eye, 100 * share_without(fates, fates.met_eye), 100 * share_without(fates, fates.seen)));
  }
}

int render_picture(const RenderArguments& arguments) {
  Console console(arguments.common);
  Interrupt interrupt;  // before the first thread of the work
  const RunLimits limits(arguments.common);
  Seconds seconds;

  const Stopwatch load_watch;
  console.progress("load", 0);
  std::vector<std::string> warnings;
  const Scene scene = load_scene(arguments.scene, warnings);
  warn_of_dyes(scene, arguments.render.spectral, warnings);
  console.warn(warnings);
  seconds.load = load_watch.seconds();

  const Stopwatch build_watch;
  console.progress("build", 0);
  const RayTracer tracer(scene);
  const double aspect = static_cast<double>(arguments.render.width) / arguments.render.height;
  const Camera camera = choose_camera(arguments.camera, tracer, aspect, arguments.scene.source);
  seconds.build = build_watch.seconds();

  const Stopwatch render_watch;
  auto [result, solve_seconds] = draw(arguments, tracer, camera, interrupt, console);
  seconds.solve = solve_seconds;
  seconds.render = render_watch.seconds() - solve_seconds;

  const Stopwatch write_watch;
  if (arguments.show) result.image = layer_picture(result.image, *arguments.show);
  describe(arguments, camera, result, result.image);
  write_picture(arguments.picture, std::move(result.image));
  seconds.write = write_watch.seconds();

  say_result(arguments, result, console);
  write_report(arguments.common, report_on(arguments, result, tracer, seconds));
  return interrupt.requested() ? exit_interrupted : exit_done;
}

}  // namespace

int run_render(const std::vector<std::string>& arguments) {
  const auto parsed = parse_render_arguments(arguments);
  return parsed ? render_picture(*parsed) : exit_done;
}

}  // namespace penumbra::cli
