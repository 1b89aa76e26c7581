#include "lightmap_bake.h"

#include <fmt/core.h>

#include <filesystem>
#include <map>
#include <span>
#include <utility>
#include <variant>

#include "console.h"
#include "exit_code.h"
#include "interrupt.h"
#include "penumbra/baking/atlas_light.h"
#include "penumbra/baking/baked_scene.h"
#include "penumbra/baking/lightmap_atlas.h"
#include "penumbra/baking/texel_light.h"
#include "penumbra/baking/texels.h"
#include "penumbra/file/output_file.h"
#include "penumbra/image/exr_file.h"
#include "penumbra/io/gltf_writer.h"
#include "penumbra/parallel/parallel_for.h"
#include "penumbra/scene/shape_mesh.h"
#include "report.h"
#include "run_limits.h"
#include "scene_options.h"
#include "usage_error.h"
#include "world_options.h"

namespace penumbra::cli {
namespace {

/// Where the time went, s.
struct Seconds {
  double load = 0, mesh = 0, solve = 0, gather = 0, write = 0;
};

/// What the report tells of the light once it is written.
struct Outcome {
  std::size_t texels = 0, rays = 0;
  int iterations = 0;
  double noise = 0, worst_noise = 0;
  int width = 0, height = 0;
  double texels_per_metre = 0;
  std::size_t charts = 0, triangles = 0;
  bool partial = false;
};

BakeProfile profile_of(const BakeArguments& arguments) {
  static const std::map<std::string, BakeProfile> profiles{
      {"unlit", BakeProfile::unlit}, {"hdr", BakeProfile::hdr}, {"lightmap", BakeProfile::lightmap}};
  return profiles.at(arguments.profile.value_or("unlit"));
}

Scene without_shapes(Scene scene, std::vector<std::string>& warnings) {
  bool exact = false, endless = false;
  for (const ShapeObject& object : scene.shapes) {
    (std::holds_alternative<Plane>(object.shape) ? endless : exact) = true;
  }
  if (exact) warnings.emplace_back("exact spheres, disks and cylinders are baked as triangles");
  if (endless) {
    warnings.push_back(fmt::format("planes without end are cut to squares of {} m", 2 * plane_cut(scene).half));
  }
  return tessellated(std::move(scene));
}

AtlasOptions atlas_options(const BakeArguments& arguments) {
  AtlasOptions options;
  options.size = arguments.lightmap_size.value_or(0);
  options.texels_per_metre = arguments.texels_per_metre.value_or(0);
  return options;
}

LightmapAtlas made_atlas(Scene scene, const AtlasOptions& options) {
  try {
    return make_lightmap_atlas(std::move(scene), options);
  } catch (const std::invalid_argument& refused) {
    throw UsageError(
        fmt::format("--{}: {}", options.texels_per_metre > 0 ? "texels-per-metre" : "lightmap-size", refused.what()));
  }
}

Outcome outcome(const LightmapAtlas& atlas, const Texels& texels, const TexelLight& light) {
  return {.texels = texels.count(),
          .rays = light.rays,
          .iterations = light.iterations,
          .noise = light.noise,
          .worst_noise = light.worst_noise,
          .width = atlas.width,
          .height = atlas.height,
          .texels_per_metre = atlas.texels_per_metre,
          .charts = atlas.charts.size(),
          .triangles = atlas.first_triangle.back(),
          .partial = light.partial};
}

/// The picture of irradiance and its description beside the .glb.
void write_lightmap(const BakeArguments& arguments, Image image, const Outcome& done) {
  const std::string picture = lightmap_picture_name(arguments.output);
  image.metadata = {{"quantity", "irradiance, W/m^2"}, {"partial", done.partial ? "true" : "false"}};
  OutputFile exr(picture);
  exr.write(std::span<const std::byte>(encode_exr(image, ExrDepth::half)));
  exr.commit();
  const Report description{{"lightmap", std::filesystem::path(picture).filename().string()},
                           {"scene", std::filesystem::path(arguments.output).filename().string()},
                           {"quantity", "irradiance"},
                           {"unit", "W/m^2"},
                           {"photometric", arguments.scene.photometric},
                           {"colour", "linear Rec. 709"},
                           {"radiance", "emission + albedo x irradiance / pi"},
                           {"tex_coord", 1},
                           {"flip_y", false},
                           {"width", done.width},
                           {"height", done.height},
                           {"texels_per_metre", done.texels_per_metre},
                           {"charts", done.charts},
                           {"partial", done.partial}};
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

Report report_on(const BakeArguments& arguments, const Outcome& done, const Seconds& seconds,
                 const std::vector<std::string>& warnings) {
  return {{"command", "bake"},
          {"version", PENUMBRA_VERSION},
          {"scene", arguments.scene.source},
          {"output", arguments.output},
          {"profile", arguments.profile.value_or("unlit")},
          {"seed", arguments.common.seed},
          {"elements", done.texels},
          {"links", done.rays},
          {"iterations", done.iterations},
          {"atlas",
           {{"width", done.width},
            {"height", done.height},
            {"charts", done.charts},
            {"triangles", done.triangles},
            {"texels", done.texels},
            {"texels_per_metre", done.texels_per_metre}}},
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
                          arguments.output, done.texels, done.charts, done.width, done.height, done.texels_per_metre,
                          100 * done.noise, s.load + s.mesh + s.solve + s.gather + s.write));
}

}  // namespace

std::string lightmap_picture_name(const std::string& output) {
  return std::filesystem::path(output).replace_extension().string() + "-lightmap.exr";
}
std::string lightmap_description_name(const std::string& output) {
  return std::filesystem::path(output).replace_extension().string() + "-lightmap.json";
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

  console.progress("load", 0);
  Scene scene = timed(seconds.load, [&] { return without_shapes(load_scene(arguments.scene, warnings), warnings); });
  refuse_air(scene, arguments.output);
  console.warn(warnings);
  require_room_for_faces(scene, arguments.scene.source);
  interrupt.something_to_keep();

  console.progress("mesh", 0);
  LightmapAtlas atlas = timed(seconds.mesh, [&] { return made_atlas(std::move(scene), atlas_options(arguments)); });
  Texels texels = timed(seconds.mesh, [&] { return make_texels(atlas); });

  TexelLightOptions options;
  options.noise = arguments.noise.value_or(options.noise);
  options.front_sides_only = arguments.scene.front_sides_only;
  options.seed = arguments.common.seed;
  options.progress = {[&](std::string_view stage, double fraction) { console.progress(stage, fraction); },
                      interrupt.token()};
  TexelLight light = timed(seconds.solve, [&] { return bake_texel_light(atlas, texels, options); });
  const Outcome done = outcome(atlas, texels, light);

  console.progress("gather", 0);
  AtlasLight picture = timed(seconds.gather, [&] {
    AtlasLight made = make_atlas_light(atlas, texels, light.irradiance);
    light = {};
    if (profile_of(arguments) != BakeProfile::lightmap) turn_into_radiance(made, atlas, texels);
    texels = {};
    fill_gaps(made);
    return made;
  });

  console.progress("write", 0);
  const std::vector<std::string> said =
      timed(seconds.write, [&] { return write_files(arguments, std::move(atlas), std::move(picture), done); });
  console.warn(said);
  warnings.insert(warnings.end(), said.begin(), said.end());

  say_result(arguments, done, seconds, console);
  write_report(arguments.common, report_on(arguments, done, seconds, warnings));
  return interrupt.requested() ? exit_interrupted : exit_done;
}

}  // namespace penumbra::cli
