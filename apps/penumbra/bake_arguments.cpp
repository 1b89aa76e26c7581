#include "bake_arguments.h"

#include <algorithm>
#include <cmath>
#include <filesystem>

#include "lightmap_bake.h"
#include "penumbra/file/output_file.h"
#include "report.h"
#include "usage_error.h"

namespace penumbra::cli {
namespace {

constexpr double most_stops = 64;
const std::vector<std::pair<std::string, std::string>> profiles{
    {"unlit", "unlit"}, {"hdr", "hdr"}, {"lightmap", "lightmap"}, {"vertex", "vertex"}};

void check_output(const BakeArguments& a) {
  if (a.output.empty()) throw UsageError("no file to write to; add -o OUT, such as -o solution.npz or -o lit.glb");
  const std::string extension = std::filesystem::path(a.output).extension().string();
  const std::vector<std::string> known{".npz", ".csv", ".ply", ".vtu", ".glb"};
  if (std::find(known.begin(), known.end(), extension) == known.end()) {
    throw UsageError(fmt::format("-o {}: a solution is written as {}; end the name in one of them", a.output,
                                 fmt::join(known, ", ")));
  }
  const bool coloured = a.snapshots || extension == ".glb" || extension == ".ply";
  if (a.profile && extension != ".glb") throw UsageError("--profile belongs to a .glb output");
  if (a.exposure && !coloured) {
    throw UsageError("--exposure belongs to .glb and .ply outputs; " + extension + " holds the values themselves");
  }
  if (a.common.stats == a.output) {
    throw UsageError("--stats and -o both name " + a.output + "; give the report a name of its own");
  }
  check_creatable(a.output);
}

void check_lightmap(const BakeArguments& a) {
  if (!a.makes_lightmap()) {
    if (a.lightmap_size || a.texels_per_metre || a.noise) {
      throw UsageError(fmt::format("--{} belongs to a .glb with --profile unlit, hdr or lightmap",
                                   a.lightmap_size      ? "lightmap-size"
                                   : a.texels_per_metre ? "texels-per-metre"
                                                        : "noise"));
    }
    return;
  }
  if (a.lightmap_size && a.texels_per_metre) {
    throw UsageError("--lightmap-size and --texels-per-metre follow from each other; give one of them");
  }
  if (a.radiosity.given) {
    throw UsageError(
        "the options of the radiosity solver belong to --profile vertex and to .npz, .csv, .ply and .vtu; "
        "the light of a texture is found texel by texel");
  }
  if (a.snapshots) throw UsageError("--snapshots belongs to --profile vertex and to .npz, .csv, .ply and .vtu");
  if (a.profile != "lightmap") return;
  if (a.exposure)
    throw UsageError("--exposure does not apply to --profile lightmap, which holds the values themselves");
  check_creatable(lightmap_picture_name(a.output));
  check_creatable(lightmap_description_name(a.output));
  if (a.common.stats == lightmap_description_name(a.output)) {
    throw UsageError("--stats names " + *a.common.stats +
                     ", which describes the lightmap; give the report another name");
  }
}

void add_lightmap_options(OptionParser& parser, BakeArguments& a) {
  parser.group("Texture of a .glb");
  parser.value("--lightmap-size", "PX", "texels along the longer side, a multiple of 4 up to 16384 (default: 1024)",
               [&](const OptionValue& v) {
                 a.lightmap_size = static_cast<int>(whole_number(v, 4, 16384, "texels"));
                 if (*a.lightmap_size % 4 != 0) {
                   throw UsageError("--lightmap-size takes a multiple of 4 texels, not " + v.text);
                 }
               });
  parser.value("--texels-per-metre", "X", "make the texture as large as this density needs, texels a metre",
               [&](const OptionValue& v) {
                 a.texels_per_metre = real_number(v, "a positive number of texels a metre");
                 if (!(*a.texels_per_metre > 0)) {
                   throw UsageError("--texels-per-metre takes a positive number, not '" + v.text + "'");
                 }
               });
  parser.value("--noise", "R", "RMS error of the light to aim at, relative to each surface's mean (default: 0.01)",
               [&](const OptionValue& v) {
                 a.noise = real_number(v, "a number between 0 and 1");
                 if (!(*a.noise > 0 && *a.noise < 1)) {
                   throw UsageError("--noise takes a number between 0 and 1, not '" + v.text + "'");
                 }
               });
}

void add_checkpoint_options(OptionParser& parser, BakeArguments& a) {
  parser.group("Baking again");
  parser.value("--checkpoint", "FILE",
               "keep elements, form factors and what each light brings in this file, for --resume",
               [&](const OptionValue& v) { a.checkpoint = v.text; });
  parser.value("--resume", "FILE",
               "solve on what --checkpoint kept, without new rays: the scene may have other colours and intensities of "
               "lights and surfaces since, the same geometry, mirrors and glass",
               [&](const OptionValue& v) { a.resume = v.text; });
}

void check_checkpoint(const BakeArguments& a) {
  if (!a.checkpoint && !a.resume) return;
  if (a.makes_lightmap()) {
    throw UsageError(
        fmt::format("{} does not apply to --profile unlit, hdr and lightmap; it belongs to solutions on "
                    "elements: .npz, .csv, .ply, .vtu or --profile vertex",
                    a.resume ? "--resume" : "--checkpoint"));
  }
  if (a.checkpoint && a.radiosity.solver == "shooting") {
    throw UsageError("--checkpoint does not apply to --solver shooting, which keeps no form factors; use gauss-seidel");
  }
  if (a.checkpoint && a.resume) throw UsageError("--resume FILE is the checkpoint already; leave --checkpoint away");
  if (a.checkpoint) check_creatable(*a.checkpoint);
  const RadiosityOptions& r = a.radiosity;
  const bool makes = r.subdivision != Subdivision::uniform || r.form_factors != "auto" || r.element_size ||
                     r.elements || r.contrast || r.factor_tolerance || r.rays || r.resolution || r.specular_rays;
  if (a.resume && makes) {
    throw UsageError(
        "--resume brings its own elements and form factors; leave the options away that make them (--subdivide, "
        "--elements, --element-size, --contrast, --form-factors and theirs, --specular-rays)");
  }
}

void add_snapshot_options(OptionParser& parser, BakeArguments& a) {
  parser.group("Snapshots");
  parser.value(
      "--snapshots", "DIR",
      "write a picture of each stage there, stage-00001.png and on, 400 pixels wide, exposed as --exposure says",
      [&](const OptionValue& v) { a.snapshots = v.text; });
  parser.value("--snapshot-every", "K", "a picture every K sweeps, bounces or shots (default: 1; 100 for shooting)",
               [&](const OptionValue& v) {
                 a.snapshot_every = static_cast<std::size_t>(whole_number(v, 1, 1'000'000'000, "stages"));
               });
  parser.flag("--snapshot-meshes", "write each stage's elements beside its picture, as .ply", a.snapshot_meshes);
  add_camera_options(parser, a.camera);
}

void check_snapshots(const BakeArguments& a) {
  if (!a.snapshots) {
    if (a.snapshot_every) throw UsageError("--snapshot-every belongs to --snapshots DIR");
    if (a.snapshot_meshes) throw UsageError("--snapshot-meshes belongs to --snapshots DIR");
    if (a.camera.name || a.camera.eye || a.camera.look_at || a.camera.up || a.camera.lens.given()) {
      throw UsageError("the camera's options belong to --snapshots DIR; a solution is for every view");
    }
    return;
  }
  check(a.camera);
  if (a.radiosity.solver == "direct") {
    throw UsageError("--snapshots does not apply to --solver direct, which has no stages");
  }
  std::error_code error;
  std::filesystem::create_directories(*a.snapshots, error);
  if (error || !std::filesystem::is_directory(*a.snapshots)) {
    throw UsageError("--snapshots " + *a.snapshots + ": the folder cannot be made; name another");
  }
}

}  // namespace

bool BakeArguments::makes_lightmap() const {
  if (std::filesystem::path(output).extension() != ".glb") return false;
  return profile ? *profile != "vertex" : !radiosity.given && !snapshots;
}

std::optional<BakeArguments> parse_bake_arguments(const std::vector<std::string>& arguments) {
  BakeArguments result;
  OptionParser parser("bake", "SCENE -o OUT [options]", "solves the diffuse light of a scene once, for every view");
  parser.group("Output");
  parser.value("-o,--output", "OUT",
               "the file to write: .npz or .csv (the solution, a row for each side of an element), .ply or .vtu (the "
               "elements with their values), or .glb (for viewers)",
               [&](const OptionValue& v) { result.output = v.text; });
  parser.value(
      "--profile", "unlit|hdr|lightmap|vertex",
      "how a .glb carries the light: unlit is a texture of albedo times light, cut at 1, that every viewer "
      "shows; hdr the same as emission, not cut; lightmap leaves the materials and adds a texture of irradiance "
      "(and OUT-lightmap.exr, OUT-lightmap.json); vertex is radiance B / pi as vertex colours of the elements "
      "(default: unlit, or vertex where options of the solver or of snapshots are given)",
      [&](const OptionValue& v) { result.profile = choice<std::string>(v, profiles); });
  parser.value("--exposure", "EV",
               "brighten colours by this many stops, a factor of 2 each, before they are cut at 1 (default: 0)",
               [&](const OptionValue& v) {
                 result.exposure = real_number(v, "a number of stops (EV) from -64 to 64");
                 if (std::abs(*result.exposure) > most_stops) {
                   throw UsageError("--exposure takes a number of stops (EV) from -64 to 64, not '" + v.text + "'");
                 }
               });
  add_lightmap_options(parser, result);
  add_radiosity_options(parser, result.radiosity);
  add_checkpoint_options(parser, result);
  add_snapshot_options(parser, result);
  add_scene_options(parser, result.scene);
  add_world_options(parser, result.scene.world, WorldMedia::fog_alone);
  add_common_options(parser, result.common);
  parser.examples({"penumbra bake builtin:cornell-box --elements 10000 -o cornell.npz",
                   "penumbra bake room.glb --lightmap-size 2048 -o room-baked.glb"});
  if (!parser.parse(arguments)) return std::nullopt;
  check(result.scene);
  check(result.radiosity);
  check_output(result);
  check_lightmap(result);
  check_checkpoint(result);
  check_snapshots(result);
  check_report(result.common);
  return result;
}

}  // namespace penumbra::cli
