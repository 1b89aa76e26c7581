#include "render_arguments.h"

#include <algorithm>
#include <limits>

#include "penumbra/image/image_io.h"
#include "report.h"

namespace penumbra::cli {
namespace {

constexpr int usual_samples = 4;
constexpr int usual_path_samples = 64;
constexpr int usual_samples_by_noise = 4096;
constexpr int usual_samples_by_contrast = 9;
constexpr int most_samples = 1 << 24;  // what render() takes
constexpr int most_segments = std::numeric_limits<int>::max();

const std::vector<std::pair<std::string, IntegratorKind>> integrators{{"appel", IntegratorKind::appel},
                                                                      {"whitted", IntegratorKind::whitted},
                                                                      {"path", IntegratorKind::path},
                                                                      {"light", IntegratorKind::light}};
const std::vector<std::pair<std::string, std::optional<IntegratorKind>>> integrator_choices = [] {
  std::vector<std::pair<std::string, std::optional<IntegratorKind>>> all(integrators.begin(), integrators.end());
  all.emplace_back("radiosity", std::nullopt);
  all.emplace_back("two-pass", std::nullopt);
  return all;
}();
const std::vector<std::pair<std::string, FilterKind>> filters{{"box", FilterKind::box},
                                                              {"tent", FilterKind::tent},
                                                              {"gaussian", FilterKind::gaussian},
                                                              {"mitchell", FilterKind::mitchell},
                                                              {"blackman-harris", FilterKind::blackman_harris}};
const std::vector<std::pair<std::string, Aov>> layers{
    {"albedo", Aov::albedo},     {"normal", Aov::normal},     {"depth", Aov::depth},
    {"position", Aov::position}, {"object", Aov::object},     {"direct", Aov::direct},
    {"indirect", Aov::indirect}, {"variance", Aov::variance}, {"rays", Aov::rays}};

/// Options that not every method has, as far as the user gave them.
struct Given {
  std::optional<int> samples, max_depth;
  std::optional<double> min_throughput;
  std::optional<int> final_gather;
  bool no_caustics = false;
};

Region region(const OptionValue& value) {
  constexpr const char* what = "four whole numbers x0,y0,x1,y1 in pixels, such as 0,0,400,300";
  const auto n = number_list(value, 4, what);
  const auto whole = [](double v) { return v == static_cast<int>(std::clamp(v, -1.0, 1e6)); };
  if (!std::all_of(n.begin(), n.end(), whole))
    throw UsageError(fmt::format("{} takes {}, not '{}'", value.option, what, value.text));
  return {static_cast<int>(n[0]), static_cast<int>(n[1]), static_cast<int>(n[2]), static_cast<int>(n[3])};
}

double throughput(const OptionValue& value) {
  const double bound = real_number(value, "a share of the light from 0 to 1");
  if (bound < 0 || bound > 1)
    throw UsageError(fmt::format("{} takes a share of the light from 0 to 1, not '{}'", value.option, value.text));
  return bound;
}

std::vector<Aov> aovs(const OptionValue& value) {
  std::vector<Aov> wanted;
  for (const std::string& name : split_at_commas(value.text)) {
    const Aov layer = choice<Aov>({value.option, name}, layers);
    if (std::find(wanted.begin(), wanted.end(), layer) == wanted.end()) wanted.push_back(layer);
  }
  return wanted;
}

void add_picture_shape_options(OptionParser& parser, RenderArguments& arguments) {
  RenderOptions& options = arguments.render;
  add_picture_size_option(parser, arguments.size);
  parser.value("--region", "x0,y0,x1,y1",
               "draw these pixels only: from x0,y0 to before x1,y1, with 0,0 at the top left (default: all)",
               [&](const OptionValue& v) { options.region = region(v); });
  parser.value(
      "--aov", "LIST",
      "layers to add to an .exr, with commas between: albedo, normal, depth (m), position (m), object, direct, "
      "indirect, variance, rays (default: none)",
      [&](const OptionValue& v) { options.aovs = aovs(v); });
  parser.value(
      "--show", "LAYER",
      "draw this layer in place of the colour: counts and distances in grey from 0 to the largest (default: the "
      "colour)",
      [&](const OptionValue& v) {
        (void)choice<Aov>(v, layers);
        arguments.show = v.text;
      });
}

void add_method_options(OptionParser& parser, RenderArguments& arguments, Given& given) {
  RenderOptions& options = arguments.render;
  parser.group("Method");
  parser.value(
      "--integrator", "NAME",
      "appel (primary and shadow rays), whitted (adds reflection and refraction), path (the reference: all light "
      "paths), light (particles from the lamps), radiosity (a diffuse solution, see below) or two-pass (that light, "
      "and mirrors and glass) (default: whitted)",
      [&](const OptionValue& v) {
        const auto kind = choice<std::optional<IntegratorKind>>(v, integrator_choices);
        options.integrator = kind.value_or(options.integrator);
        arguments.integrator = v.text;
      });
  parser.value(
      "--spp", "N",
      "samples a pixel, at most with --noise and --edge-contrast; particles a pixel for light (default: 4; 64 for path "
      "and "
      "light; 4096 with --noise, 9 with --edge-contrast)",
      [&](const OptionValue& v) { given.samples = static_cast<int>(whole_number(v, 1, most_samples, "samples")); });
  parser.value(
      "--noise", "X",
      "adaptive sampling: sample until the standard error of pixels is this share of their brightness, such as "
      "0.02; quiet parts get 16 samples (default: the same number everywhere)",
      [&](const OptionValue& v) {
        options.noise = number_above_zero(v, "a share above 0 and below 1, such as 0.02");
        if (options.noise >= 1) throw UsageError("--noise takes a share below 1, not '" + v.text + "'");
      });
  parser.value(
      "--edge-contrast", "X",
      "adaptive sampling of edges: one sample a pixel (4 with soft light), and --spp where its colour differs from a "
      "neighbour's by more than X of their sum, such as 0.1; not for path and light (default: the same number "
      "everywhere)",
      [&](const OptionValue& v) {
        options.contrast = number_above_zero(v, "a share above 0 and below 1, such as 0.1");
        if (options.contrast >= 1) throw UsageError("--edge-contrast takes a share below 1, not '" + v.text + "'");
      });
  parser.value("--filter", "NAME",
               "how samples become pixels: box, tent, gaussian, mitchell or blackman-harris (default: box)",
               [&](const OptionValue& v) { options.filter = choice<FilterKind>(v, filters); });
  parser.value(
      "--max-depth", "N",
      "longest path after the primary ray, in segments (default: 16 for whitted and two-pass, no limit for path)",
      [&](const OptionValue& v) { given.max_depth = static_cast<int>(whole_number(v, 1, most_segments, "segments")); });
  parser.value("--min-throughput", "X",
               "share of the light, 0 to 1: whitted and two-pass end a ray that weighs less, path starts Russian "
               "roulette there (default: 0.001)",
               [&](const OptionValue& v) { given.min_throughput = throughput(v); });
  add_shadow_options(parser, arguments.shadows);
  parser.flag(
      "--no-caustics",
      "path, two-pass and radiosity: leave out light that reaches rough surfaces from lights by way of mirrors and "
      "glass (default: it is there; path finds it with much noise)",
      given.no_caustics);
  parser.flag(
      "--spectral",
      "path, whitted and light: samples carry wavelengths instead of red, green and blue, so that glass disperses and "
      "dyes fluoresce (default: red, green and blue)",
      options.spectral);
  parser.value(
      "--final-gather", "N",
      "two-pass: gather indirect light by N rays a sample, for crisp contact shadows (default: 0, interpolated "
      "between the elements)",
      [&](const OptionValue& v) {
        given.final_gather = static_cast<int>(whole_number(v, 0, 1 << 20, "rays a sample"));
      });
  parser.value("--time-limit", "SECONDS", "stop after this time and keep the samples done by then (default: none)",
               [&](const OptionValue& v) { options.time_limit = number_above_zero(v, "a number of seconds above 0"); });
}

void add_solution_options(OptionParser& parser, RenderArguments& arguments) {
  add_radiosity_options(parser, arguments.radiosity);
  parser.value("--solution", "FILE.npz", "show this solution, which bake wrote, instead of computing one",
               [&](const OptionValue& v) { arguments.solution = v.text; });
  parser.flag("--flat", "show each element in its one colour (default: smooth)", arguments.flat);
  parser.flag("--outlines", "draw the outlines of the elements", arguments.outlines);
}

void check_solution_options(const RenderArguments& a) {
  const auto refuse = [&](const char* option, const char* owners) {
    throw UsageError(
        fmt::format("{} does not apply to --integrator {}; it belongs to {}", option, a.integrator, owners));
  };
  if (!a.shows_radiosity() && a.flat) refuse("--flat", "radiosity");
  if (!a.shows_radiosity() && a.outlines) refuse("--outlines", "radiosity");
  if (!a.needs_solution() && a.solution) refuse("--solution", "radiosity and two-pass");
  if (a.solution && !a.render.caustics) {
    throw UsageError("--no-caustics does not apply to --solution, in which they are; leave --solution away");
  }
  if (!a.needs_solution() && a.radiosity.given) refuse("--solver and its options", "radiosity and two-pass");
  if (!a.needs_solution()) return;
  if (a.solution && a.radiosity.given) {
    throw UsageError("--solution shows what was solved before; leave --solver and its options away");
  }
  check(a.radiosity);
}

void apply(const Given& given, const std::string& integrator, RenderOptions& options) {
  const bool radiosity = integrator == "radiosity";
  const bool two_pass = integrator == "two-pass";
  const bool path = !radiosity && !two_pass && options.integrator == IntegratorKind::path;
  const bool appel = !radiosity && !two_pass && options.integrator == IntegratorKind::appel;
  const bool light = !radiosity && !two_pass && options.integrator == IntegratorKind::light;
  const int usual = options.noise > 0      ? usual_samples_by_noise
                    : options.contrast > 0 ? usual_samples_by_contrast
                    : path || light        ? usual_path_samples
                                           : usual_samples;
  options.samples_per_pixel = given.samples.value_or(usual);
  if (options.noise > 0 && options.samples_per_pixel < 32) {
    throw UsageError("--noise needs some samples to judge by; raise --spp to 32 or more, or leave it away");
  }
  const auto refuse = [&](const char* option, const char* reason) {
    throw UsageError(
        fmt::format("{} does not apply to --integrator {}, {}; leave it away", option, integrator, reason));
  };
  if (radiosity && given.max_depth) refuse("--max-depth", "which shows light that was computed before");
  if (radiosity && given.min_throughput) refuse("--min-throughput", "which shows light that was computed before");
  if (!two_pass && given.final_gather) refuse("--final-gather", "which gathers no light from a solution");
  if (radiosity && options.spectral) refuse("--spectral", "which shows light that was computed before");
  if (two_pass && options.spectral) refuse("--spectral", "whose solution is in red, green and blue");
  if (appel && options.spectral) refuse("--spectral", "which follows no light that has a wavelength of its own");
  if (appel && given.max_depth) refuse("--max-depth", "which follows no reflection or refraction");
  if (appel && given.min_throughput) refuse("--min-throughput", "which follows no reflection or refraction");
  if (light && given.min_throughput) refuse("--min-throughput", "whose particles die by chance after three bounces");
  if (light && options.noise > 0) refuse("--noise", "whose particles go where the light does");
  if (light && options.filter != FilterKind::box) refuse("--filter", "whose pixels count particles");
  if (light && !options.aovs.empty()) refuse("--aov", "which sends no rays from the eye");
  if (options.contrast > 0 && options.noise > 0) {
    throw UsageError("--edge-contrast and --noise both say where samples go; leave one away");
  }
  if (path && options.contrast > 0) refuse("--edge-contrast", "whose pixels differ by noise everywhere; use --noise");
  if (light && options.contrast > 0) refuse("--edge-contrast", "whose particles go where the light does");
  const bool has_caustics = path || two_pass || radiosity;
  if (!has_caustics && given.no_caustics) {
    refuse("--no-caustics", light ? "whose particles bring them along" : "which has none");
  }
  options.caustics = !given.no_caustics;
  options.final_gather = given.final_gather.value_or(0);
  options.max_depth = given.max_depth.value_or(options.max_depth);
  options.min_throughput = given.min_throughput.value_or(options.min_throughput);
}

void check_region(const RenderOptions& options) {
  if (!options.region) return;
  const auto [x0, y0, x1, y1] = *options.region;
  const bool inside = x0 >= 0 && y0 >= 0 && x0 < x1 && y0 < y1 && x1 <= options.width && y1 <= options.height;
  if (inside) return;
  throw UsageError(
      fmt::format("--region {},{},{},{} is no part of a picture of {}x{}; it takes x0 < x1 <= {} and y0 < y1 <= {}", x0,
                  y0, x1, y1, options.width, options.height, options.width, options.height));
}

void check_shutter(const RenderArguments& arguments) {
  if (!arguments.scene.shutter) return;
  if (arguments.needs_solution()) {
    throw UsageError(
        fmt::format("--shutter does not apply to --integrator {}, whose light is solved for a scene at rest; "
                    "leave it away or show one instant by --time",
                    arguments.integrator));
  }
  if (arguments.integrator == "light") {
    throw UsageError(
        "--shutter does not apply to --integrator light, which traces through things at rest; leave it away or show "
        "one "
        "instant by --time");
  }
  if (arguments.render.exact_shadows) {
    throw UsageError("--shutter does not apply to --exact-shadows, which are those of things at rest; leave one away");
  }
}

void check_all(const RenderArguments& arguments) {
  check(arguments.scene);
  check_shutter(arguments);
  check(arguments.camera);
  check_region(arguments.render);
  check_solution_options(arguments);
  check(arguments.picture);
  if (!arguments.render.aovs.empty() && !holds_layers(arguments.picture)) {
    throw UsageError("--aov needs a file that holds layers; write -o NAME.exr instead of " + arguments.picture.path);
  }
  if (arguments.common.stats == arguments.picture.path) {
    throw UsageError("--stats and -o both name " + arguments.picture.path + "; give the report a name of its own");
  }
  check_report(arguments.common);
}

}  // namespace

std::optional<RenderArguments> parse_render_arguments(const std::vector<std::string>& arguments) {
  RenderArguments result;
  Given given;
  OptionParser parser("render", "SCENE -o IMAGE [options]", "draws a picture of a scene");
  add_picture_options(parser, result.picture);
  add_picture_shape_options(parser, result);
  add_method_options(parser, result, given);
  add_solution_options(parser, result);
  add_camera_options(parser, result.camera);
  add_scene_options(parser, result.scene);
  add_shutter_option(parser, result.scene);
  add_world_options(parser, result.scene.world, WorldMedia::any);
  add_common_options(parser, result.common);
  parser.examples({"penumbra render builtin:cornell-box --integrator path --size 512x512 --spp 256 -o cornell.png",
                   "penumbra render model.glb --eye 3,2,4 --look-at 0,1,0 --fov 35 --aov normal,depth -o model.exr"});
  if (!parser.parse(arguments)) return std::nullopt;
  result.render.width = result.size.width;
  result.render.height = result.size.height;
  apply(given, result.integrator, result.render);
  apply(result.shadows, result.integrator, result.render);
  result.render.seed = result.common.seed;
  result.render.front_sides_only = result.scene.front_sides_only;
  check_all(result);
  if (result.show) {
    if (result.render.integrator == IntegratorKind::light && !result.needs_solution()) {
      throw UsageError("--show does not apply to --integrator light, which sends no rays from the eye; leave it away");
    }
    result.render.aovs.push_back(choice<Aov>({"--show", *result.show}, layers));
  }
  return result;
}

}  // namespace penumbra::cli
