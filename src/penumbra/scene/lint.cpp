#include "penumbra/scene/lint.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <optional>

#include "penumbra/math/transform.h"
#include "penumbra/scene/energy.h"
#include "penumbra/scene/lit.h"

namespace penumbra {
namespace {

constexpr double flat = 1e-9;             // twice the area over the longest edge squared
constexpr double least_size = 0.01;       // m
constexpr double greatest_size = 20'000;  // m

std::string label(std::string_view kind, std::size_t index, const std::string& name) {
  return name.empty() ? fmt::format("{} {}", kind, index + 1) : fmt::format("{} \"{}\"", kind, name);
}

void judge_materials(const Scene& scene, std::vector<Finding>& found) {
  for (const std::uint32_t i : materials_beyond_energy(scene)) {
    found.push_back({.kind = FindingKind::reflectance,
                     .sentence = fmt::format("{} reflects and transmits {:.3g} times the light that it receives; "
                                             "reflectance and transmittance together are at most 1 in each band",
                                             material_label(scene, i), sent_on(scene.materials[i]).sum()),
                     .position = scene.bounds().empty() ? Vec3d(0) : scene.bounds().centre(),
                     .object = scene.materials[i].name});
  }
}

struct FlatFaces {
  std::size_t count = 0;
  Vec3d first{0};
};

FlatFaces flat_faces(const Scene& scene, const Instance& instance) {
  const Mesh& mesh = scene.meshes[instance.mesh];
  FlatFaces result;
  for (const Mesh::Triangle& t : mesh.triangles) {
    Vec3d p[3];
    for (std::size_t k = 0; k < 3; ++k) p[k] = transform_point(instance.to_world, mesh.positions[t[k]]);
    const double longest =
        std::max({length_squared(p[1] - p[0]), length_squared(p[2] - p[1]), length_squared(p[0] - p[2])});
    if (length(cross(p[1] - p[0], p[2] - p[0])) > flat * longest) continue;
    if (result.count++ == 0) result.first = p[0];
  }
  return result;
}

void judge_triangles(const Scene& scene, std::vector<Finding>& found) {
  for (std::size_t i = 0; i < scene.instances.size(); ++i) {
    const FlatFaces flats = flat_faces(scene, scene.instances[i]);
    if (flats.count == 0) continue;
    const std::string& name = scene.instances[i].name;
    found.push_back(
        {.kind = FindingKind::degenerate,
         .sentence = fmt::format("{} has {} degenerate triangle{} without area, the first at ({:.6g}, "
                                 "{:.6g}, {:.6g}) m: {} no light; remove {}",
                                 label("object", i, name), flats.count, flats.count == 1 ? "" : "s", flats.first.x,
                                 flats.first.y, flats.first.z, flats.count == 1 ? "it receives" : "they receive",
                                 flats.count == 1 ? "it" : "them"),
         .position = flats.first,
         .object = name,
         .count = flats.count});
  }
}

void judge_scale(const Scene& scene, std::vector<Finding>& found) {
  const Bounds bounds = scene.bounds();
  const double size = bounds.diagonal();
  if (bounds.empty() || (size >= least_size && size <= greatest_size)) return;
  found.push_back({.kind = FindingKind::scale,
                   .sentence = fmt::format("the whole scene is {:.3g} m across, which is {}; is it in another unit? "
                                           "(--unit mm|cm|m|in for OBJ files; glTF is in metres)",
                                           size, size < least_size ? "tiny" : "huge"),
                   .position = bounds.centre(),
                   .object = ""});
}

}  // namespace

std::vector<Finding> lint(const Scene& scene) {
  std::vector<Finding> found;
  judge_materials(scene, found);
  if (!is_lit(scene)) {
    const Bounds bounds = scene.bounds();
    found.push_back({.kind = FindingKind::no_light,
                     .sentence = "the scene has no light: no surface emits, and there is no lamp and no environment; "
                                 "it will be lit by a uniform white environment of radiance 1",
                     .position = bounds.empty() ? Vec3d(0) : bounds.centre(),
                     .object = ""});
  }
  judge_triangles(scene, found);
  judge_scale(scene, found);
  return found;
}

}  // namespace penumbra
