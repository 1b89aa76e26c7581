#include "lightmap_bake.h"

#include <fmt/core.h>

#include <cmath>
#include <filesystem>
#include <map>
#include <memory>
#include <span>
#include <utility>

#include "console.h"
#include "exit_code.h"
#include "interrupt.h"
#include "penumbra/baking/atlas_light.h"
#include "penumbra/baking/baked_scene.h"
#include "penumbra/baking/directional_texels.h"
#include "penumbra/baking/texel_light.h"
#include "penumbra/baking/texel_solution.h"
#include "penumbra/file/output_file.h"
#include "penumbra/image/exr_file.h"
#include "penumbra/io/gltf_writer.h"
#include "penumbra/parallel/parallel_for.h"
#include "report.h"
#include "run_limits.h"
#include "unfolded_scene.h"

namespace penumbra::cli {
namespace {

/// Where the time went, s.
struct Seconds {
  double load = 0, mesh = 0, solve = 0, gather = 0, write = 0;
};

/// What the report tells of the light once it is written.
struct Outcome {
  AtlasFacts atlas;
  std::size_t rays = 0;
  std::vector<double> residuals;
  TexelEnergy energy;
  double noise = 0, worst_noise = 0;
  bool partial = false;
};

BakeProfile profile_of(const BakeArguments& arguments) {
  static const std::map<std::string, BakeProfile> profiles{
      {"unlit", BakeProfile::unlit}, {"hdr", BakeProfile::hdr}, {"lightmap", BakeProfile::lightmap}};
  return profiles.at(arguments.profile.value_or("unlit"));
}

Outcome outcome(const UnfoldedScene& scene, const TexelLight& light) {
  return {.atlas = facts_of(scene),
          .rays = light.rays,
          .residuals = light.residuals,
          .energy = light.energy,
          .noise = light.noise,
          .worst_noise = light.worst_noise,
          .partial = light.partial};
}

/// Coefficients of the incoming radiance as layers of one picture.
void write_directional(const BakeArguments& arguments, const UnfoldedScene& scene, const DirectionalTexels& light,
                       std::span<const std::uint8_t> buried) {
  AtlasLightOptions options;
  options.channels.clear();
  for (const char* harmonic : {"L00", "L1-1", "L10", "L11"}) {
    for (const char* band : {"R", "G", "B"}) options.channels.push_back(fmt::format("{}.{}", harmonic, band));
  }
  options.lowest = -HUGE_VALF;
  options.buried = buried;
  AtlasLight made = make_atlas_light(scene.atlas, scene.texels, light.coefficients, options);
  fill_gaps(made);
  made.image.metadata = {{"quantity", "incoming radiance as spherical harmonics of order 1, W/(m^2 sr)"},
                         {"partial", light.partial ? "true" : "false"}};
  OutputFile exr(directional_picture_name(arguments.output));
  exr.write(std::span<const std::byte>(encode_exr(made.image, ExrDepth::half)));
  exr.commit();
}

/// The picture of irradiance and its description beside the .glb.
void write_lightmap(const BakeArguments& arguments, Image image, const Outcome& done) {
  const std::string picture = lightmap_picture_name(arguments.output);
  image.metadata = {{"quantity", "irradiance, W/m^2"}, {"partial", done.partial ? "true" : "false"}};
  OutputFile exr(picture);
  exr.write(std::span<const std::byte>(encode_exr(image, ExrDepth::half)));
  exr.commit();
  Report description{{"lightmap", std::filesystem::path(picture).filename().string()},
                     {"scene", std::filesystem::path(arguments.output).filename().string()},
                     {"quantity", "irradiance"},
                     {"unit", "W/m^2"},
                     {"photometric", arguments.scene.photometric},
                     {"colour", "linear Rec. 709"},
                     {"radiance", "emission + albedo x irradiance / pi"},
                     {"tex_coord", 1},
                     {"flip_y", false},
                     {"width", done.atlas.width},
                     {"height", done.atlas.height},
                     {"texels_per_metre", done.atlas.texels_per_metre},
                     {"charts", done.atlas.charts},
                     {"partial", done.partial}};
  if (arguments.directional) {
    description["directional"] = {
        {"file", std::filesystem::path(directional_picture_name(arguments.output)).filename().string()},
        {"quantity", "incoming radiance, real spherical harmonics of order 1, world axes (+Y up)"},
        {"unit", "W/(m^2 sr)"},
        {"layers", {"L00", "L1-1", "L10", "L11"}},
        {"basis", {"sqrt(1/4pi)", "sqrt(3/4pi) y", "sqrt(3/4pi) z", "sqrt(3/4pi) x"}},
        {"irradiance", "at normal n: pi L00 Y00 + 2pi/3 (L1-1 Y1-1(n) + L10 Y10(n) + L11 Y11(n))"}};
  }
  OutputFile json(lightmap_description_name(arguments.output));
  json.write(description.dump(2, ' ', false, Report::error_handler_t::replace) + "\n");
  json.commit();
}

std::vector<std::string> write_files(const BakeArguments& arguments, LightmapAtlas atlas, AtlasLight light,
                                     const Outcome& done) {
  const BakeProfile profile = profile_of(arguments);
  if (profile == BakeProfile::lightmap) write_lightmap(arguments, light.image, done);
  BakedScene baked = baked_scene(std::move(atlas), std::move(light), profile, arguments.exposure.value_or(0));
  if (arguments.scene.photometric) baked.notes["quantity"] += ", from luminance in nit / 683 lm/W";
  baked.notes["partial"] = done.partial ? "true" : "false";
  std::optional<GltfLightmap> lightmap;
  if (baked.lightmap) {
    baked.notes["lightmap"] = std::filesystem::path(lightmap_picture_name(arguments.output)).filename().string();
    lightmap = GltfLightmap{.texture = *baked.lightmap, .uv_set = 1, .strength = baked.lightmap_strength};
  }
  return write_glb(arguments.output, baked.scene, baked.notes, lightmap);
}

std::vector<std::string> remarks(const BakeArguments& arguments, const Outcome& done) {
  constexpr double notable = 0.01;
  if (!(done.energy.absorbed_by_backs > notable * done.energy.emitted)) return {};
  return {
      fmt::format("{:.2g} % of the light ends on backs, which are black with --sides front; penumbra check {} names "
                  "flipped faces",
                  100 * done.energy.absorbed_by_backs / done.energy.emitted, arguments.scene.source)};
}

Report report_on(const BakeArguments& arguments, const Outcome& done, const Seconds& seconds,
                 const std::vector<std::string>& warnings) {
  const TexelEnergy& energy = done.energy;
  return {{"command", "bake"},
          {"version", PENUMBRA_VERSION},
          {"scene", arguments.scene.source},
          {"output", arguments.output},
          {"profile", arguments.profile.value_or("unlit")},
          {"seed", arguments.common.seed},
          {"elements", done.atlas.texels},
          {"links", done.rays},
          {"iterations", done.residuals.size()},
          {"residual", done.residuals},
          {"unshot_fraction", energy.emitted > 0 ? energy.unshot / energy.emitted : 0.0},
          {"energy",
           {{"emitted", energy.emitted},
            {"absorbed", energy.absorbed},
            {"escaped", energy.escaped},
            {"absorbed_by_backs", energy.absorbed_by_backs},
            {"unshot", energy.unshot}}},
          {"error_bound", nullptr},
          {"atlas", report_on(done.atlas)},
          {"noise", {{"rms", done.noise}, {"worst_surface", done.worst_noise}}},
          {"rays", done.rays},
          {"seconds",
           {{"load", seconds.load},
            {"mesh", seconds.mesh},
            {"form_factors", 0.0},
            {"solve", seconds.solve},
            {"gather", seconds.gather},
            {"write", seconds.write}}},
          {"threads", thread_count()},
          {"peak_rss_bytes", peak_memory()},
          {"partial", done.partial},
          {"warnings", warnings}};
}

void say_result(const BakeArguments& arguments, const Outcome& done, const Seconds& s, Console& console) {
  if (done.partial) console.insist(arguments.output + ": partial, the computation was stopped; light is missing");
  console.say(fmt::format("{}: {} texels in {} charts on {} x {}, {:.4g} texels a metre, {:.3g} % noise, {:.2f} s",
                          arguments.output, done.atlas.texels, done.atlas.charts, done.atlas.width, done.atlas.height,
                          done.atlas.texels_per_metre, 100 * done.noise,
                          s.load + s.mesh + s.solve + s.gather + s.write));
}

}  // namespace

std::string lightmap_picture_name(const std::string& output) {
  return std::filesystem::path(output).replace_extension().string() + "-lightmap.exr";
}
std::string lightmap_description_name(const std::string& output) {
  return std::filesystem::path(output).replace_extension().string() + "-lightmap.json";
}

std::string directional_picture_name(const std::string& output) {
  return std::filesystem::path(output).replace_extension().string() + "-directional.exr";
}

int bake_lightmap(const BakeArguments& arguments) {
  Console console(arguments.common);
  Interrupt interrupt;  // before the first thread of the work
  const RunLimits limits(arguments.common);
  Seconds seconds;
  std::vector<std::string> warnings;
  const auto timed = [](double& time, const auto& work) {
    const Stopwatch watch;
    auto result = work();
    time += watch.seconds();
    return result;
  };

  UnfoldedScene scene = unfold_scene(arguments, console, interrupt, warnings);
  seconds.load = scene.load_seconds, seconds.mesh = scene.mesh_seconds;

  const Progress progress{[&](std::string_view stage, double fraction) { console.progress(stage, fraction); },
                          interrupt.token()};
  TexelLightOptions options;
  options.noise = arguments.noise.value_or(options.noise);
  options.denoise = arguments.denoise;
  options.seed = arguments.common.seed;
  options.progress = progress;
  auto solution = timed(seconds.solve, [&] {
    return std::make_unique<TexelSolution>(scene.atlas, scene.texels, solution_options(arguments, options.noise),
                                           progress);
  });
  TexelLight light = timed(seconds.gather, [&] { return bake_texel_light(*solution, options); });
  Outcome done = outcome(scene, light);
  if (arguments.directional) {
    const DirectionalTexels directions = timed(seconds.gather, [&] {
      return bake_directional_texels(*solution, {.seed = arguments.common.seed, .progress = progress});
    });
    done.partial = done.partial || directions.partial;
    write_directional(arguments, scene, directions, light.buried);
  }
  solution.reset();
  const std::vector<std::string> odd = remarks(arguments, done);
  console.warn(odd);
  warnings.insert(warnings.end(), odd.begin(), odd.end());

  AtlasLight picture = timed(seconds.gather, [&] {
    AtlasLight made = make_atlas_light(scene.atlas, scene.texels, light.irradiance);
    light = {};
    if (profile_of(arguments) != BakeProfile::lightmap) turn_into_radiance(made, scene.atlas, scene.texels);
    scene.texels = {};
    fill_gaps(made);
    return made;
  });

  console.progress("write", 0);
  const std::vector<std::string> said =
      timed(seconds.write, [&] { return write_files(arguments, std::move(scene.atlas), std::move(picture), done); });
  console.warn(said);
  warnings.insert(warnings.end(), said.begin(), said.end());

  say_result(arguments, done, seconds, console);
  write_report(arguments.common, report_on(arguments, done, seconds, warnings));
  return interrupt.requested() ? exit_interrupted : exit_done;
}

}  // namespace penumbra::cli
