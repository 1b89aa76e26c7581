#include "solution_file.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <map>
#include <numbers>
#include <utility>

#include "penumbra/file/file_error.h"
#include "penumbra/image/tonemap.h"
#include "penumbra/io/gltf_writer.h"
#include "penumbra/io/ply_writer.h"
#include "penumbra/radiosity/meshing/element_builder.h"
#include "penumbra/radiosity/meshing/lamp_irradiance.h"
#include "penumbra/radiosity/meshing/uniform.h"
#include "penumbra/radiosity/meshing/vertex_coloured_scene.h"
#include "penumbra/scene/object_label.h"

namespace penumbra::cli {
namespace {

constexpr const char* bands[] = {"red", "green", "blue"};

bool is_dark(const DiffuseSolution& s, std::size_t i) {
  return s.irradiance[3 * i] == 0 && s.irradiance[3 * i + 1] == 0 && s.irradiance[3 * i + 2] == 0 &&
         s.radiosity[3 * i] == 0 && s.radiosity[3 * i + 1] == 0 && s.radiosity[3 * i + 2] == 0;
}

PolygonCells cells_of(const DiffuseSolution& s, const ColourScale& scale, std::vector<std::uint8_t>& colours) {
  PolygonCells cells;
  cells.points = s.mesh.vertices;
  cells.values.push_back({"area", {}});
  cells.values.push_back({"surface", {}});
  cells.values.push_back({"back", {}});
  for (const char* quantity : {"reflectance", "emission", "irradiance", "radiosity"}) {
    for (const char* band : bands) cells.values.push_back({std::string(quantity) + " " + band, {}});
  }
  const std::vector<double>* const quantities[] = {&s.mesh.reflectance, &s.mesh.emission, &s.irradiance, &s.radiosity};
  const double to_colour = std::exp2(scale.exposure) / std::numbers::pi;
  for (std::size_t i = 0; i < s.mesh.radiating_count; ++i) {
    if (is_dark(s, i)) continue;
    const auto corners = s.mesh.patch_corners(i);
    cells.corners.insert(cells.corners.end(), corners.begin(), corners.end());
    cells.offsets.push_back(cells.corners.size());
    cells.values[0].values.push_back(s.mesh.areas[i]);
    cells.values[1].values.push_back(s.mesh.surfaces[i].face);
    cells.values[2].values.push_back(s.mesh.surfaces[i].back ? 1 : 0);
    for (std::size_t q = 0; q < 4; ++q) {
      for (std::size_t b = 0; b < 3; ++b) cells.values[3 + 3 * q + b].values.push_back((*quantities[q])[3 * i + b]);
    }
    for (std::size_t b = 0; b < 3; ++b) {
      colours.push_back(srgb_encode8(static_cast<float>(s.radiosity[3 * i + b] * to_colour)));
    }
  }
  return cells;
}

}  // namespace

DiffuseSolution diffuse_solution(const Scene& scene, const PatchMesh& mesh, const RadiositySolution& solution,
                                 std::vector<double> caustics) {
  DiffuseSolution s{.mesh = mesh,
                    .irradiance = solution.irradiance,
                    .radiosity = solution.radiosity,
                    .caustics = std::move(caustics),
                    .object_names = {},
                    .partial = solution.partial,
                    .wavelength_edges = {},
                    .spectral_radiosity = {},
                    .scene = fingerprint(scene)};
  for (std::size_t i = 0; i < scene.object_count(); ++i) s.object_names.push_back(object_label(scene, i));
  return s;
}

ElementTable element_table(const DiffuseSolution& s) {
  ElementTable t;
  const std::size_t rows = s.mesh.radiating_count;
  t.centres.assign(s.mesh.centroids.begin(), s.mesh.centroids.begin() + static_cast<std::ptrdiff_t>(rows));
  t.normals.assign(s.mesh.normals.begin(), s.mesh.normals.begin() + static_cast<std::ptrdiff_t>(rows));
  t.areas.assign(s.mesh.areas.begin(), s.mesh.areas.begin() + static_cast<std::ptrdiff_t>(rows));
  t.reflectance = s.mesh.reflectance;
  t.emission = s.mesh.emission;
  t.irradiance = s.irradiance;
  t.radiosity = s.radiosity;
  t.caustics = s.caustics;
  t.partial = s.partial;
  t.wavelength_edges = s.wavelength_edges;
  t.spectral_radiosity = s.spectral_radiosity;
  t.fingerprints = {to_text(s.scene.ways), to_text(s.scene.light)};
  t.vertices = s.mesh.vertices;
  t.corner_offsets.push_back(0);
  for (std::size_t i = 0; i < rows; ++i) {
    const PatchSurface& surface = s.mesh.surfaces[i];
    t.surfaces.push_back(surface.face);
    t.objects.push_back(s.object_names[surface.object]);
    t.backs.push_back(surface.back);
    for (const std::uint32_t c : s.mesh.patch_corners(i)) t.corners.push_back(c);
    t.corner_offsets.push_back(static_cast<std::int64_t>(t.corners.size()));
  }
  return t;
}

/// Files that do not say what scene they are of are taken on trust.
void check_scene(const std::string& path, const ElementTable& t, const SceneFingerprint& scene) {
  if (t.fingerprints.size() != 2) return;
  if (hash_of_text(t.fingerprints[0]) != scene.ways) {
    throw FileError(path, "", "is the solution of a scene with other surfaces or lights; bake this scene");
  }
  if (hash_of_text(t.fingerprints[1]) != scene.light) {
    throw FileError(path, "",
                    "is the solution of this scene with other colours or intensities; bake it again (--checkpoint and "
                    "--resume make that quick)");
  }
}

DiffuseSolution read_solution(const std::string& path, const Scene& scene) {
  const ElementTable t = read_element_table(path);
  check_scene(path, t, fingerprint(scene));
  if (!t.wavelength_edges.empty()) {
    throw FileError(path, "",
                    "was solved over bands of wavelength, whose light pictures of a solution cannot show; bake without "
                    "--spectral, or draw by --integrator path --spectral");
  }
  DiffuseSolution s;
  s.mesh.vertices = t.vertices;
  s.mesh.reflectance = t.reflectance;
  s.mesh.emission = t.emission;
  s.irradiance = t.irradiance;
  s.radiosity = t.radiosity;
  s.caustics = t.caustics;
  s.partial = t.partial;
  std::map<std::string, std::uint32_t> number_of;
  for (std::size_t i = 0; i < t.rows(); ++i) {
    const auto [object, fresh] = number_of.try_emplace(t.objects[i], static_cast<std::uint32_t>(number_of.size()));
    if (fresh) s.object_names.push_back(t.objects[i]);
    const auto first = static_cast<std::size_t>(t.corner_offsets[i]),
               last = static_cast<std::size_t>(t.corner_offsets[i + 1]);
    std::vector<std::uint32_t> corners;
    for (std::size_t k = first; k < last; ++k) corners.push_back(static_cast<std::uint32_t>(t.corners[k]));
    s.mesh.surfaces.push_back({.name = t.objects[i],
                               .face = static_cast<std::uint32_t>(t.surfaces[i]),
                               .object = object->second,
                               .back = t.backs[i],
                               .area = 0});
    add_patch(s.mesh, corners, static_cast<std::uint32_t>(i), static_cast<std::uint32_t>(t.surfaces[i]));
    if (!(s.mesh.areas[i] > 0)) throw FileError(path, fmt::format("row {}", i), "an element has no area");
  }
  s.mesh.radiating_count = t.rows();
  return s;
}

std::vector<std::string> write_solution(const std::string& path, const DiffuseSolution& solution, const Scene& scene,
                                        const ColourScale& scale) {
  const std::string extension = std::filesystem::path(path).extension().string();
  if (extension == ".glb") {
    const double to_colour = std::exp2(scale.exposure) / std::numbers::pi;
    const MadePatchMesh faces = make_element_faces(scene, PatchSides::both, MeshingOptions{}.shape_segments);
    const LampIrradiance lamps(scene, faces.mesh);
    Scene coloured = vertex_coloured_scene(solution.mesh, solution.irradiance, to_colour, scene, &lamps);
    coloured.cameras = scene.cameras;
    return write_glb(path, coloured,
                     {{"profile", "vertex"},
                      {"quantity", scale.photometric ? "radiance in W/(m^2 sr), from luminance in nit / 683 lm/W"
                                                     : "radiance in W/(m^2 sr)"},
                      {"colour", "linear Rec. 709: radiance x 2^exposure_ev, cut at 1"},
                      {"exposure_ev", fmt::format("{}", scale.exposure)},
                      {"partial", solution.partial ? "true" : "false"}});
  }
  if (extension == ".ply" || extension == ".vtu") {
    std::vector<std::uint8_t> colours;
    const PolygonCells cells = cells_of(solution, scale, colours);
    if (extension == ".vtu") {
      write_vtu(path, cells);
    } else {
      write_ply(path, cells, colours, solution.partial ? "partial: the computation was stopped, light is missing" : "");
    }
    return {};
  }
  write_element_table(path, element_table(solution));
  return {};
}

}  // namespace penumbra::cli
