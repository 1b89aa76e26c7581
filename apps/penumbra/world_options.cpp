#include "world_options.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "penumbra/io/density_grid_reader.h"
#include "penumbra/io/ies_reader.h"
#include "penumbra/scene/luminaire.h"
#include "penumbra/tracing/shading/media.h"

namespace penumbra::cli {
namespace {

constexpr double degree = std::numbers::pi / 180;

[[noreturn]] void refuse(const OptionValue& value, std::string_view what) {
  throw UsageError(fmt::format("{} takes {}, not '{}'", value.option, what, value.text));
}

Medium fog(const OptionValue& value) {
  constexpr const char* what =
      "SIGMA_T,ALBEDO,G: extinction in 1/m above 0, the share of it that scatters (0 to 1) and the mean cosine of "
      "scattering (between -1 and 1), such as 0.05,0.9,0.3";
  const auto n = number_list(value, 3, what);
  if (!(n[0] > 0) || n[1] < 0 || n[1] > 1 || !(std::abs(n[2]) < 1)) refuse(value, what);
  return {.name = "fog",
          .absorption = Rgb(static_cast<float>(n[0] * (1 - n[1]))),
          .scattering = Rgb(static_cast<float>(n[0] * n[1])),
          .asymmetry = static_cast<float>(n[2])};
}

DaylightOptions daylight(const OptionValue& value) {
  constexpr const char* what =
      "SUN_ELEVATION,AZIMUTH[,TURBIDITY]: 0 to 90 degrees above the horizon, degrees clockwise from north (-Z), and 2 "
      "(clear) to 10 (hazy), such as 40,135,3";
  const std::size_t parts = split_at_commas(value.text).size();
  const auto n = number_list(value, std::clamp<std::size_t>(parts, 2, 3), what);
  DaylightOptions sky;
  sky.elevation = n[0] * degree;
  sky.azimuth = n[1] * degree;
  if (n.size() > 2) sky.turbidity = n[2];
  if (n[0] < 0 || n[0] > 90 || sky.turbidity < 2 || sky.turbidity > 10) refuse(value, what);
  return sky;
}

WorldOptions::Ies ies(const OptionValue& value) {
  const std::size_t at = value.text.rfind('@');
  if (at == std::string::npos || at == 0 || at + 1 == value.text.size()) {
    refuse(value, "FILE@LIGHT, a photometric file and the name of a point or spot light, such as lamp.ies@ceiling");
  }
  return {value.text.substr(0, at), value.text.substr(at + 1)};
}

// The box around all that stands; a flat one gets some height. Without end when nothing finite stands.
std::optional<Bounds> box_around(const Scene& scene) {
  Bounds box = scene.bounds();
  if (box.empty() || !(box.diagonal() > 0)) return std::nullopt;
  const Vec3d least = glm::max(box.extent(), Vec3d(0.1 * box.diagonal()));
  const Vec3d centre = box.centre();
  return Bounds{glm::min(box.lower, centre - 0.5 * least), glm::max(box.upper, centre + 0.5 * least)};
}

void add_to_air(Scene& scene, Medium medium) {
  scene.air.push_back(static_cast<std::uint32_t>(scene.media.size()));
  scene.media.push_back(std::move(medium));
}

void put_on(const WorldOptions::Ies& ies, Scene& scene) {
  std::vector<std::string> names;
  bool found = false;
  for (std::size_t i = 0; i < scene.lights.size(); ++i) {
    if (!can_wear_web(scene.lights[i])) continue;
    names.push_back(scene.lights[i].name);
    if (scene.lights[i].name != ies.light) continue;
    wear_web(scene, i, read_ies(ies.file));
    found = true;
  }
  if (found) return;
  throw UsageError(fmt::format("--ies {}@{}: the scene has no point or spot light of that name{} (it has: {})",
                               ies.file, ies.light, did_you_mean(ies.light, names),
                               names.empty() ? "none" : fmt::format("{}", fmt::join(names, ", "))));
}

}  // namespace

void add_world_options(OptionParser& parser, WorldOptions& options, WorldMedia media) {
  parser.group("Air and sky");
  parser.value("--fog", "SIGMA_T,ALBEDO,G",
               "fog in the box around the scene: extinction in 1/m, the share of it that scatters, and the mean cosine "
               "of scattering (default: none)",
               [&](const OptionValue& v) { options.fog = fog(v); });
  if (media == WorldMedia::any) {
    parser.repeated("--smoke", "FILE",
                    "smoke from a density grid in an .npz or .vdb file, which says where it stands; may be given "
                    "several times (default: none)",
                    [&](const OptionValue& v) { options.smoke.push_back(v.text); });
  }
  parser.value(
      "--sky", "SUN_ELEVATION,AZIMUTH[,TURBIDITY]",
      "a clear sky with its sun (Preetham 1999): degrees above the horizon, degrees clockwise from north (-Z), "
      "and haze from 2 to 10 (default: none; turbidity 3)",
      [&](const OptionValue& v) { options.sky = daylight(v); });
  parser.repeated(
      "--ies", "FILE@LIGHT",
      "the photometric file (IES LM-63) of a point or spot light, by its name: candela by direction; may be "
      "given several times (default: none)",
      [&](const OptionValue& v) { options.ies.push_back(ies(v)); });
}

void furnish(const WorldOptions& options, Scene& scene, std::vector<std::string>& warnings) {
  if (options.sky) {
    Daylight day = make_daylight(*options.sky);
    if (scene.environment)
      warnings.push_back(fmt::format("{} takes the place of the scene's own environment", "--sky"));
    scene.environment = Environment{.radiance = Rgb(1), .image = static_cast<std::uint32_t>(scene.images.size())};
    scene.images.push_back(std::move(day.sky));
    scene.lights.push_back({.name = "sun", .kind = day.sun});
  }
  for (const WorldOptions::Ies& web : options.ies) put_on(web, scene);
  if (options.fog) {
    Medium medium = *options.fog;
    medium.box = box_around(scene);
    add_to_air(scene, std::move(medium));
  }
  for (const std::string& file : options.smoke) add_to_air(scene, read_density_grid(file));
  if (scene.air.size() > most_media_in_air) {
    throw UsageError(fmt::format("the scene holds {} media with --fog and --smoke, but {} are the most",
                                 scene.air.size(), most_media_in_air));
  }
}

void refuse_air(const Scene& scene, const std::string& output) {
  if (Media(scene).none()) return;
  throw UsageError(output +
                   ": light is baked into a .glb as it is in clear air, and the scene holds fog or other media; write "
                   "the solution to .npz, .csv, .ply or .vtu, or leave the media out");
}

}  // namespace penumbra::cli
