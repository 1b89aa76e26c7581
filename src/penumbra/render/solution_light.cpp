#include "penumbra/render/solution_light.h"

#include <algorithm>
#include <cmath>
#include <map>

#include "penumbra/math/polygon.h"
#include "penumbra/parallel/parallel_for.h"
#include "penumbra/radiosity/meshing/sharp_irradiance.h"

namespace penumbra {
namespace {

/// Of the scene's size: how far from a point its element is looked for.
constexpr double nearness = 1e-4;
/// Of a round shape's radius: how far its polygons lie inside it at most.
constexpr double roundness = 0.02;
/// Where shading and geometric normals agree this well, a surface is flat.
constexpr double flat = 1 - 1e-7;

std::span<const Vec3d> normals_of(const PatchMesh& elements) {
  return std::span(elements.normals).first(elements.radiating_count);
}

}  // namespace

SolutionLight::SolutionLight(const RayTracer& tracer, const PatchMesh& elements, std::span<const double> irradiance,
                             std::span<const double> caustics, const LampIrradiance& lamps)
    : tracer_(tracer),
      scene_(tracer.scene()),
      lamps_(lamps),
      shading_(make_shading_mesh(elements)),
      sight_(shading_, normals_of(elements)) {
  indirect_ = shading_.at_vertices(without_lamps(lamps, elements, irradiance), 3);
  if (!caustics.empty()) caustics_ = shading_.at_vertices(caustics, 3);
  total_ = shading_.at_vertices(irradiance, 3);
  views_.resize(elements.radiating_count);
  for (std::size_t e = 0; e < elements.radiating_count; ++e) sizes_.push_back(std::sqrt(elements.areas[e]));
  parallel_for(views_.size(), 16, [&](std::size_t first, std::size_t last) {
    for (std::size_t e = first; e < last; ++e) views_[e] = lamps.view(elements.polygon(e));
  });
  Bounds all;
  for (const Vec3d& v : elements.vertices) all.grow(v);
  size_ = length(all.upper - all.lower);
  find_lamps(elements);
}

void SolutionLight::find_lamps(const PatchMesh& elements) {
  lamp_elements_.assign(elements.radiating_count, false);
  const PatchMesh& faces = lamps_.faces();
  std::multimap<std::uint32_t, std::uint32_t> patches;  // lamps by face
  for (const Lamp& lamp : lamps_.lamps()) {
    if (lamp.kind == Lamp::Kind::patch) patches.emplace(faces.face_of[lamp.patch], lamp.patch);
  }
  for (std::size_t e = 0; e < elements.radiating_count; ++e) {
    const auto [first, last] = patches.equal_range(elements.surfaces[e].face);
    lamp_elements_[e] = std::any_of(first, last, [&](const auto& entry) {
      return dot(faces.normals[entry.second], elements.normals[e]) > 0 &&
             convex_contains(faces.polygon(entry.second), elements.centroids[e]);
    });
  }
}

std::optional<ElementSight::Place> SolutionLight::find(const Place& place) const {
  double reach = nearness * size_;
  if (place.point.object >= scene_.instances.size()) {
    const Shape& shape = scene_.shapes[place.point.object - scene_.instances.size()].shape;
    if (const auto* sphere = std::get_if<Sphere>(&shape)) reach += roundness * sphere->radius;
    if (const auto* cylinder = std::get_if<Cylinder>(&shape)) reach += roundness * cylinder->radius;
  }
  return sight_.at(place.point.position, place.side, reach);
}

Rgb SolutionLight::blend(const std::vector<double>& at_vertices, const ElementSight::Place& at) const {
  Vec3d light(0);
  for (std::size_t k = 0; k < 3; ++k) {
    const double* const value = &at_vertices[std::size_t{3} * shading_.triangles[at.triangle][k]];
    light += at.weights[k] * Vec3d(value[0], value[1], value[2]);
  }
  return Rgb(light);
}

Rgb SolutionLight::direct(const Place& place, std::uint64_t key, std::uint32_t rays) const {
  const LampIrradiance::ShadowRays shadow{key, rays, scene_.shapes.empty() ? nullptr : &tracer_};
  if (dot(place.side, place.normal) > flat && place.point.object < scene_.instances.size()) {
    if (const auto at = find(place)) return Rgb(views_[at->element].at(place.point.position, shadow));
  }
  return Rgb(lamps_.at(place.point.position, place.side, place.normal, shadow));
}

Rgb SolutionLight::indirect(const Place& place) const {
  const auto at = find(place);
  return at ? glm::max(Rgb(0), blend(indirect_, *at)) : Rgb(0);
}

Rgb SolutionLight::caustics(const Place& place) const {
  const auto at = find(place);
  return at ? glm::max(Rgb(0), blend(caustics_, *at)) : Rgb(0);
}

Rgb SolutionLight::total(const Place& place) const {
  const auto at = find(place);
  return at ? glm::max(Rgb(0), blend(total_, *at)) : Rgb(0);
}

double SolutionLight::fineness(const Place& place) const {
  const auto at = find(place);
  return at ? sizes_[at->element] : 0;
}

bool SolutionLight::is_lamp(const Place& place) const {
  const auto at = find(place);
  return at && lamp_elements_[at->element];
}

}  // namespace penumbra
