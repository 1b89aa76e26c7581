#include "bake_arguments.h"

#include <algorithm>
#include <cmath>
#include <filesystem>

#include "lightmap_bake.h"
#include "penumbra/file/output_file.h"
#include "probe_bake.h"
#include "report.h"
#include "usage_error.h"

namespace penumbra::cli {
namespace {

constexpr double most_stops = 64;
constexpr int most_probes_along = 1024;
constexpr long long most_probes = 1'000'000;
const std::vector<std::pair<std::string, std::string>> profiles{
    {"unlit", "unlit"}, {"hdr", "hdr"}, {"lightmap", "lightmap"}, {"vertex", "vertex"}, {"ao", "ao"}};

/// "4x3x5".
std::array<int, 3> grid_count(const OptionValue& value) {
  std::array<int, 3> count{};
  std::size_t begin = 0;
  try {
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const std::size_t end = axis < 2 ? value.text.find('x', begin) : value.text.size();
      if (end == std::string::npos) throw UsageError("too few");
      count[axis] =
          static_cast<int>(whole_number({"", value.text.substr(begin, end - begin)}, 1, most_probes_along, ""));
      begin = end + 1;
    }
  } catch (const UsageError&) {
    throw UsageError(fmt::format("{} takes NXxNYxNZ, each from 1 to {}, such as 8x4x8, not '{}'", value.option,
                                 most_probes_along, value.text));
  }
  if (static_cast<long long>(count[0]) * count[1] * count[2] > most_probes) {
    throw UsageError(fmt::format("{} {}: at most {} probes are made", value.option, value.text, most_probes));
  }
  return count;
}

void check_output(const BakeArguments& a) {
  if (a.output.empty()) throw UsageError("no file to write to; add -o OUT, such as -o solution.npz or -o lit.glb");
  const std::string extension = std::filesystem::path(a.output).extension().string();
  const std::vector<std::string> known{".npz", ".csv", ".ply", ".vtu", ".glb", ".json"};
  if (std::find(known.begin(), known.end(), extension) == known.end()) {
    throw UsageError(fmt::format("-o {}: what was baked is written as {}; end the name in one of them", a.output,
                                 fmt::join(known, ", ")));
  }
  if (a.probes && extension != ".json") throw UsageError("--probes are written as .json, such as -o probes.json");
  if (!a.probes && extension == ".json")
    throw UsageError("-o " + a.output + ": a .json holds probes; add --probes NXxNYxNZ");
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

/// A file that is written beside the output.
void check_beside(const BakeArguments& a, const std::string& name, const char* what) {
  check_creatable(name);
  if (a.common.stats == name) {
    throw UsageError(fmt::format("--stats names {}, which {}; give the report another name", name, what));
  }
}

/// Options that belong to textures, or to solutions on elements.
void check_kind(const BakeArguments& a) {
  const BakeKind kind = a.kind();
  if (kind == BakeKind::solution) {
    if (a.lightmap_size || a.texels_per_metre || a.noise || a.opaque_shadows) {
      throw UsageError(fmt::format("--{} belongs to a .glb with --profile unlit, hdr or lightmap, and to --probes",
                                   a.lightmap_size      ? "lightmap-size"
                                   : a.texels_per_metre ? "texels-per-metre"
                                   : a.noise            ? "noise"
                                                        : "opaque-shadows"));
    }
    return;
  }
  if (a.lightmap_size && a.texels_per_metre) {
    throw UsageError("--lightmap-size and --texels-per-metre follow from each other; give one of them");
  }
  if (a.radiosity.given) {
    throw UsageError(
        "the options of the radiosity solver belong to --profile vertex and to .npz, .csv, .ply and .vtu; "
        "the light of textures and probes is found texel by texel");
  }
  if (a.snapshots) throw UsageError("--snapshots belongs to --profile vertex and to .npz, .csv, .ply and .vtu");
  if (a.exposure && (kind == BakeKind::occlusion || a.profile == "lightmap")) {
    throw UsageError("--exposure does not apply to --profile " + *a.profile + ", which holds the values themselves");
  }
}

void check_lightmap(const BakeArguments& a) {
  if (a.directional && a.profile != "lightmap") throw UsageError("--directional belongs to --profile lightmap");
  if (a.denoise && a.kind() != BakeKind::lightmap) {
    throw UsageError("--denoise belongs to a .glb with --profile unlit, hdr or lightmap");
  }
  if (a.profile != "lightmap") return;
  check_beside(a, lightmap_picture_name(a.output), "holds the lightmap");
  check_beside(a, lightmap_description_name(a.output), "describes the lightmap");
  if (a.directional) check_beside(a, directional_picture_name(a.output), "holds the directional lightmap");
}

void check_occlusion(const BakeArguments& a) {
  if (a.kind() != BakeKind::occlusion) {
    if (a.occlusion_distance) throw UsageError("--ao-distance belongs to --profile ao");
    return;
  }
  const char* const of_light = a.noise                    ? "--noise"
                               : a.opaque_shadows         ? "--opaque-shadows"
                               : a.scene.environment      ? "--environment"
                               : a.scene.photometric      ? "--photometric"
                               : a.scene.front_sides_only ? "--sides"
                                                          : nullptr;
  if (of_light != nullptr) {
    throw UsageError(
        fmt::format("{} does not apply to --profile ao, which asks what is open, not what shines", of_light));
  }
}

void check_probes(const BakeArguments& a) {
  if (!a.probes) {
    if (a.probe_bounds) throw UsageError("--probe-bounds belongs to --probes");
    return;
  }
  check_beside(a, probe_arrays_name(a.output), "holds the probes");
}

void add_probe_options(OptionParser& parser, BakeArguments& a) {
  parser.group("Probes");
  parser.value("--probes", "NXxNYxNZ",
               "light at points in space instead, for things that move: spherical harmonics of order 2 on a grid of so "
               "many points along x, y and z, as -o OUT.json, with OUT.npz beside it",
               [&](const OptionValue& v) { a.probes = grid_count(v); });
  parser.value("--probe-bounds", "x0,y0,z0,x1,y1,z1",
               "the grid's outermost probes, m (default: the middles of even cells of the scene's bounds)",
               [&](const OptionValue& v) {
                 const auto n = number_list(v, 6, "two corners, m, such as 0,0,0,5,3,4");
                 a.probe_bounds = Bounds{{n[0], n[1], n[2]}, {n[3], n[4], n[5]}};
                 if (glm::any(glm::greaterThan(a.probe_bounds->lower, a.probe_bounds->upper))) {
                   throw UsageError("--probe-bounds takes the lower corner first, not '" + v.text + "'");
                 }
               });
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
  parser.flag("--denoise",
              "with --profile unlit, hdr and lightmap: smooth what rays bring where neighbouring texels agree within "
              "their noise, never across creases and charts (default: left as it is)",
              a.denoise);
  parser.flag("--directional",
              "with --profile lightmap: also the directions that light comes from, OUT-directional.exr (spherical "
              "harmonics of order 1)",
              a.directional);
  parser.value("--ao-distance", "M", "with --profile ao: what is farther does not darken, m (default: no limit)",
               [&](const OptionValue& v) { a.occlusion_distance = number_above_zero(v, "a length above 0, m"); });
  parser.flag("--opaque-shadows", "glass stops the shadow rays of points, spots and suns (default: it attenuates them)",
              a.opaque_shadows);
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
  if (a.kind() != BakeKind::solution) {
    throw UsageError(
        fmt::format("{} does not apply to textures and probes; it belongs to solutions on "
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

void check_spectral(const BakeArguments& a) {
  if (!a.spectral) return;
  const auto refuse = [](const std::string& what, const char* reason) {
    throw UsageError(fmt::format("--spectral does not go with {}, {}", what, reason));
  };
  if (std::filesystem::path(a.output).extension() == ".glb") {
    refuse(a.output, "whose light is red, green and blue; write .npz, .csv, .ply or .vtu");
  }
  if (a.radiosity.solver == "shooting") refuse("--solver shooting", "which keeps no form factors; use gauss-seidel");
  if (a.snapshots) refuse("--snapshots", "as bands are solved one after another; leave it away");
  if (a.radiosity.specular_rays.value_or(0) > 0) {
    refuse("--specular-rays", "as mirrors and glass pass no light on between bands; leave it away");
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

BakeKind BakeArguments::kind() const {
  if (probes) return BakeKind::probes;
  if (std::filesystem::path(output).extension() != ".glb") return BakeKind::solution;
  if (profile == "ao") return BakeKind::occlusion;
  const bool on_elements = profile ? *profile == "vertex" : radiosity.given || snapshots;
  return on_elements ? BakeKind::solution : BakeKind::lightmap;
}

std::optional<BakeArguments> parse_bake_arguments(const std::vector<std::string>& arguments) {
  BakeArguments result;
  OptionParser parser("bake", "SCENE -o OUT [options]", "solves the diffuse light of a scene once, for every view");
  parser.group("Output");
  parser.value("-o,--output", "OUT",
               "the file to write: .npz or .csv (the solution, a row for each side of an element), .ply or .vtu (the "
               "elements with their values), .glb (for viewers), or .json (probes)",
               [&](const OptionValue& v) { result.output = v.text; });
  parser.value(
      "--profile", "unlit|hdr|lightmap|vertex|ao",
      "how a .glb carries the light: unlit is a texture of albedo times light, cut at 1, that every viewer "
      "shows; hdr the same as emission, not cut; lightmap leaves the materials and adds a texture of irradiance "
      "(and OUT-lightmap.exr, OUT-lightmap.json); vertex is radiance B / pi as vertex colours of the elements; ao "
      "leaves materials and lights and adds ambient occlusion as their occlusion texture "
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
  add_probe_options(parser, result);
  add_radiosity_options(parser, result.radiosity);
  parser.flag(
      "--spectral",
      "solve over bands of wavelength, at most 10 nm wide, with fluorescence; .npz then holds them too. Mirrors "
      "and glass pass no light on (default: red, green and blue)",
      result.spectral);
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
  check_kind(result);
  check_lightmap(result);
  check_occlusion(result);
  check_probes(result);
  check_checkpoint(result);
  check_snapshots(result);
  check_spectral(result);
  check_report(result.common);
  return result;
}

}  // namespace penumbra::cli
