#include "scene_options.h"

#include <algorithm>
#include <cctype>
#include <filesystem>
#include <limits>

#include "memory_limit.h"
#include "penumbra/file/file_error.h"
#include "penumbra/image/image_io.h"
#include "penumbra/io/scene_reader.h"
#include "penumbra/scene/energy.h"
#include "penumbra/scene/lit.h"

namespace penumbra::cli {
namespace {

const std::vector<std::pair<std::string, double>> units{{"mm", 0.001}, {"cm", 0.01}, {"m", 1.0}, {"in", 0.0254}};
const std::vector<std::pair<std::string, bool>> sides{{"both", false}, {"front", true}};

bool is_builtin(const std::string& source) { return source.starts_with("builtin:"); }

bool knows_its_unit(const std::string& source) {
  const std::string extension = std::filesystem::path(source).extension().string();
  return is_builtin(source) || extension == ".glb" || extension == ".gltf";
}

/// Red, green and blue of a picture by their names, or its only channel three times.
TextureImage environment_image(const std::string& path) {
  const Image picture = read_image(path);
  const auto channel = [&](const char* name, std::size_t otherwise) {
    const auto found = std::find(picture.channels.begin(), picture.channels.end(), name);
    const auto at = static_cast<std::size_t>(found - picture.channels.begin());
    return at < picture.channels.size() ? at : std::min(otherwise, picture.channels.size() - 1);
  };
  const std::size_t from[] = {channel("R", 0), channel("G", 1), channel("B", 2)};
  std::vector<float> texels;
  texels.reserve(static_cast<std::size_t>(picture.width) * static_cast<std::size_t>(picture.height) * 3);
  for (std::size_t at = 0; at < picture.data.size(); at += picture.channels.size()) {
    for (const std::size_t c : from) texels.push_back(picture.data[at + c]);
  }
  const auto is_radiance = [](float v) { return v >= 0 && v <= std::numeric_limits<float>::max(); };
  if (!std::all_of(texels.begin(), texels.end(), is_radiance)) {
    throw FileError(path, "",
                    "holds negative or non-finite values, so it cannot be an environment; repair the picture");
  }
  return {.name = path, .width = picture.width, .height = picture.height, .channels = 3, .texels = std::move(texels)};
}

bool looks_like_numbers(const std::string& text) {
  return text.find_first_not_of("0123456789+-.,eE") == std::string::npos;
}

Environment make_environment(const std::string& argument, Scene& scene) {
  if (!looks_like_numbers(argument)) {
    scene.images.push_back(environment_image(argument));
    return {.radiance = Rgb(1.0F), .image = static_cast<std::uint32_t>(scene.images.size() - 1)};
  }
  const Vec3d radiance =
      triple({"--environment", argument}, "a radiance R,G,B in W/(m^2 sr), such as 1,1,1, or a picture");
  if (radiance.x < 0 || radiance.y < 0 || radiance.z < 0) {
    throw UsageError("--environment takes a radiance of 0 or more in each band, not '" + argument + "'");
  }
  return {.radiance = Rgb(radiance), .image = std::nullopt};
}

void keep_energy(const SceneOptions& options, Scene& scene, std::vector<std::string>& warnings) {
  const std::vector<std::uint32_t> beyond = materials_beyond_energy(scene);
  if (beyond.empty()) return;
  const SentOn sent = sent_on(scene.materials[beyond.front()]);
  const std::string more = beyond.size() > 1 ? fmt::format(" (and {} more materials do)", beyond.size() - 1) : "";
  const std::string excess = fmt::format(
      "{} reflects {:.3g} % and transmits {:.3g} %, which makes {:.4g} % of the light that arrives{}",
      material_label(scene, beyond.front()), 100 * sent.reflected, 100 * sent.transmitted, 100 * sent.sum(), more);
  if (!options.fix_energy) {
    throw FileError(options.source, "", excess + "; lower its colours, or let --fix-energy scale them");
  }
  fix_energy(scene);
  warnings.push_back(fmt::format("{}: {}; scaled to 100 %", options.source, excess));
}

bool is_gltf(const std::string& source) {
  std::string extension = std::filesystem::path(source).extension().string();
  std::ranges::transform(extension, extension.begin(), [](unsigned char c) { return std::tolower(c); });
  return !is_builtin(source) && (extension == ".glb" || extension == ".gltf");
}

void check_animation(const SceneOptions& options) {
  const char* given = options.scene       ? "--scene"
                      : options.animation ? "--animation"
                      : options.time      ? "--time"
                      : options.shutter   ? "--shutter"
                                          : nullptr;
  if (given != nullptr && !is_gltf(options.source)) {
    throw UsageError(fmt::format("{} does not apply to {}; only glTF files have {}; leave it away", given,
                                 options.source, options.scene ? "scenes to choose among" : "animations"));
  }
  if (options.time && options.shutter) {
    throw UsageError("--time and --shutter both say when the animation is shown; leave one away");
  }
  if (options.animation && !options.time && !options.shutter) {
    throw UsageError("--animation belongs to --time T or --shutter T0,T1, which play it");
  }
}

}  // namespace

void check(const SceneOptions& options) {
  if (options.world.sky && options.environment) {
    throw UsageError("--sky and --environment both say what is outside; leave one of them away");
  }
  if (options.source.empty())
    throw UsageError("no SCENE given; name a .glb, .gltf or .obj file, or builtin:cornell-box");
  if (options.unit && knows_its_unit(options.source)) {
    throw UsageError("--unit does not apply to " + options.source +
                     ", which is in metres by definition; leave it away");
  }
  if (options.photometric && is_builtin(options.source)) {
    throw UsageError("--photometric does not apply to " + options.source +
                     ", whose emission is in W/(m^2 sr); leave it away");
  }
  check_animation(options);
}

void add_scene_source(OptionParser& parser, SceneOptions& options) {
  parser.positional("SCENE", "a .glb, .gltf or .obj file, or builtin:NAME?key=value (penumbra scene --list shows them)",
                    options.source);
  parser.group("Scene");
  parser.value("--unit", "mm|cm|m|in", "length of one unit of an OBJ file (default: m); glTF is in metres",
               [&](const OptionValue& v) { options.unit = choice<double>(v, units); });
  parser.value("--scene", "NAME|INDEX", "which scene of a glTF file (default: its default one, else the first)",
               [&](const OptionValue& v) { options.scene = v.text; });
  parser.value("--time", "T", "play a glTF animation and show this instant, seconds (default: at rest)",
               [&](const OptionValue& v) { options.time = real_number(v, "a time in seconds"); });
  parser.value("--animation", "NAME|INDEX", "which animation of a glTF file is played (default: the first)",
               [&](const OptionValue& v) { options.animation = v.text; });
  add_allow_outside(parser, options.allow_outside);
}

void add_allow_outside(OptionParser& parser, bool& allow_outside) {
  parser.flag(
      "--allow-outside",
      "read pictures, buffers and materials that the file names by absolute paths, .. or links out of its folder "
      "(default: they are refused)",
      allow_outside);
}

void add_shutter_option(OptionParser& parser, SceneOptions& options) {
  parser.value(
      "--shutter", "T0,T1",
      "motion blur: play a glTF animation while the shutter is open, from T0 to T1 seconds (default: no motion)",
      [&](const OptionValue& v) {
        constexpr const char* what = "two times in seconds T0,T1, such as 0,0.02";
        const auto times = number_list(v, 2, what);
        if (times[1] < times[0]) {
          throw UsageError(fmt::format("--shutter takes {}, the earlier one first, not '{}'", what, v.text));
        }
        options.shutter = Shutter{times[0], times[1]};
      });
}

LoadedScene read_source(const SceneOptions& options) {
  return read_scene(options.source, {.unit = options.unit.value_or(1.0),
                                     .allow_outside = options.allow_outside,
                                     .scene = options.scene,
                                     .animation = options.animation,
                                     .time = options.time,
                                     .shutter = options.shutter});
}

void add_scene_options(OptionParser& parser, SceneOptions& options) {
  add_scene_source(parser, options);
  parser.value("--environment", "R,G,B|FILE",
               "light from everywhere outside: a radiance in W/(m^2 sr), or a latitude-longitude picture (.hdr, .exr, "
               ".png; +Y up, "
               "its centre towards -Z) (default: the scene's own; 1,1,1 when the scene has no light at all)",
               [&](const OptionValue& v) { options.environment = v.text; });
  parser.value("--sides", "both|front",
               "which sides of surfaces reflect; with front, backs are black and opaque (default: both)",
               [&](const OptionValue& v) { options.front_sides_only = choice<bool>(v, sides); });
  parser.flag("--fix-energy",
              "scale materials that would reflect and transmit more light than arrives (default: they are refused)",
              options.fix_energy);
  parser.flag("--photometric",
              "the file's emission is in nit: divide it by 683 lm/W (default: it is radiance in W/(m^2 sr))",
              options.photometric);
}

void require_room_for_faces(const Scene& scene, const std::string& source) {
  constexpr double bytes_a_face = 400;  // of a patch, with the edges and boxes that are made for it
  const double needed = bytes_a_face * static_cast<double>(scene.triangle_count());
  if (needed <= memory_left()) return;
  throw FileError(
      source, "",
      fmt::format("has {} triangles, instances counted each time, which take about {:.1f} GB as faces of their "
                  "own; that is more than --max-memory allows ({:.1f} GB left)",
                  scene.triangle_count(), needed / 1e9, memory_left() / 1e9));
}

Scene load_scene(const SceneOptions& options, std::vector<std::string>& warnings) {
  LoadedScene loaded = read_source(options);
  Scene scene = std::move(loaded.scene);
  warnings.insert(warnings.end(), loaded.warnings.begin(), loaded.warnings.end());
  keep_energy(options, scene, warnings);
  furnish(options.world, scene, warnings);
  const bool lit = is_lit(scene);  // judged by the file's own numbers, whatever their unit
  if (options.photometric) {
    constexpr float lumens_per_watt = 683;  // CIE: the luminous efficacy K_cd, lm/W
    for (Material& material : scene.materials) {
      if (!material.emission_spectrum) material.emission /= lumens_per_watt;  // spectra are in W
    }
  }
  if (options.environment) {
    scene.environment = make_environment(*options.environment, scene);
  } else if (!lit) {
    scene.environment = Environment{};
    warnings.push_back(options.source +
                       ": has no light, so a uniform white environment of radiance 1 lights it; --environment "
                       "R,G,B|FILE sets another");
  }
  return scene;
}

void warn_of_dyes(const Scene& scene, bool spectral, std::vector<std::string>& warnings) {
  if (spectral) return;
  const auto is_dye = [](const Material& m) { return m.fluorescence.has_value(); };
  const auto dyes = std::count_if(scene.materials.begin(), scene.materials.end(), is_dye);
  if (dyes == 0) return;
  const Material& first = *std::find_if(scene.materials.begin(), scene.materials.end(), is_dye);
  const std::string others = dyes > 1 ? fmt::format(" (and {} more)", dyes - 1) : std::string();
  warnings.push_back(
      fmt::format("the dye '{}'{} is shown by its base colour alone, for red, green and blue know no fluorescence; "
                  "--spectral follows it (bake, and render by path or whitted)",
                  first.name, others));
}

}  // namespace penumbra::cli
