#include "penumbra/baking/straight_light.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "penumbra/math/frame.h"
#include "penumbra/math/rng.h"
#include "penumbra/math/sobol.h"
#include "penumbra/math/spherical_triangle.h"
#include "penumbra/radiosity/light_irradiance.h"
#include "penumbra/radiosity/meshing/element_builder.h"

namespace penumbra {
namespace {

constexpr std::size_t most_lamps = 64;
constexpr int shape_segments = 32;
constexpr std::uint32_t rays_through_holes = 64;  // to each lamp
/// Places belong to one plane when they lie within this share of their reach of it.
constexpr double flatness = 1e-4;
/// Of a shadow ray to a lamp, so that it does not meet the lamp itself.
constexpr double shortening = 1e-5;

/// The corners of a rectangle around coplanar places; nothing when they are not coplanar.
bool rectangle_around(std::span<const Place> places, double reach, std::array<Vec3d, 4>& corners) {
  const Place& first = places[0];
  const Frame frame(first.normal);
  Vec2d least(0), most(0);
  for (const Place& p : places) {
    const Vec3d local = frame.to_local(p.position - first.position);
    if (dot(p.normal, first.normal) < 1 - 1e-9 || std::abs(local.z) > flatness * reach) return false;
    least = glm::min(least, Vec2d(local));
    most = glm::max(most, Vec2d(local));
  }
  least -= reach, most += reach;
  const auto corner = [&](double x, double y) { return first.position + frame.to_world({x, y, 0}); };
  corners = {corner(least.x, least.y), corner(most.x, least.y), corner(most.x, most.y), corner(least.x, most.y)};
  return true;
}

}  // namespace

StraightLight::StraightLight(const LightmapAtlas& atlas, const RayTracer& tracer, const Options& options)
    : atlas_(atlas),
      tracer_(tracer),
      sampler_(atlas.scene),
      faces_(make_element_faces(atlas.scene, options.front_sides_only ? PatchSides::front : PatchSides::both,
                                shape_segments)
                 .mesh),
      shadow_(tracer, !options.opaque_shadows) {
  choose_lamps(options.front_sides_only);
  part_lamps();
  has_holes_ =
      std::ranges::any_of(atlas.scene.materials, [](const Material& m) { return m.alpha_mode == AlphaMode::mask; });
  const Bounds all = tracer.bounds();
  if (!all.empty()) rounding_ = float_error * std::max(largest_component(all.lower), largest_component(all.upper));
}

void StraightLight::part_lamps() {
  std::vector<Lamp> faces;
  for (const Lamp& lamp : light_->lamps()) (lamp.kind == Lamp::Kind::patch ? faces : bodiless_).push_back(lamp);
  light_->set_lamps(std::move(faces));
}

void StraightLight::choose_lamps(bool front_sides_only) {
  const Scene& scene = atlas_.scene;
  straight_.of_triangle.assign(atlas_.first_triangle.back(), 0);
  // The triangles of each input face.
  std::vector<std::uint32_t> first_face{0};
  for (const Instance& i : scene.instances) {
    first_face.push_back(first_face.back() + static_cast<std::uint32_t>(scene.meshes[i.mesh].face_count()));
  }
  std::vector<std::uint32_t> material_of_face(first_face.back(), 0);
  for (std::size_t i = 0; i < scene.instances.size(); ++i) {
    const Mesh& mesh = scene.meshes[scene.instances[i].mesh];
    for (std::uint32_t t = 0; t < mesh.triangles.size(); ++t) {
      const std::uint32_t face = mesh.face_of_triangle.empty() ? t : mesh.face_of_triangle[t];
      material_of_face[first_face[i] + face] = mesh.material_of(t);
    }
  }
  for (std::size_t s = 0; s < faces_.surface_count(); ++s) {
    const PatchSurface& surface = faces_.surfaces[s];
    const Material& m = scene.materials[material_of_face[surface.face]];
    const bool even = !m.emission_texture && !m.unlit && m.alpha_mode == AlphaMode::opaque;
    if (even && !(front_sides_only && surface.back)) continue;
    for (std::size_t b = 0; b < 3; ++b) faces_.emission[3 * s + b] = 0;
  }
  std::vector<std::size_t> patches(faces_.surface_count(), 0);
  for (std::size_t p = 0; p < faces_.radiating_count; ++p) ++patches[faces_.surface_of[p]];
  // A face counts with all of its patches or not at all.
  while (true) {
    light_ = std::make_unique<LampIrradiance>(scene, faces_, most_lamps);
    std::vector<std::size_t> chosen(faces_.surface_count(), 0);
    for (const Lamp& lamp : light_->lamps()) {
      if (lamp.kind == Lamp::Kind::patch) ++chosen[faces_.surface_of[lamp.patch]];
    }
    bool whole = true;
    for (std::size_t s = 0; s < chosen.size(); ++s) {
      if (chosen[s] == 0 || chosen[s] == patches[s]) continue;
      whole = false;
      for (std::size_t b = 0; b < 3; ++b) faces_.emission[3 * s + b] = 0;
    }
    if (!whole) continue;
    std::vector<std::uint8_t> of_face(first_face.back(), 0);
    for (std::size_t s = 0; s < chosen.size(); ++s) {
      if (chosen[s] > 0) of_face[faces_.surfaces[s].face] |= faces_.surfaces[s].back ? 2 : 1;
    }
    for (std::size_t i = 0; i < scene.instances.size(); ++i) {
      const Mesh& mesh = scene.meshes[scene.instances[i].mesh];
      for (std::uint32_t t = 0; t < mesh.triangles.size(); ++t) {
        const std::uint32_t face = mesh.face_of_triangle.empty() ? t : mesh.face_of_triangle[t];
        straight_.of_triangle[atlas_.first_triangle[i] + t] = of_face[first_face[i] + face];
      }
    }
    return;
  }
}

double StraightLight::power() const {
  double sum = 0;
  const auto add = [&](const Vec3d& power) { sum += power.x + power.y + power.z; };
  for (const Lamp& lamp : light_->lamps()) add(polygon_area(lamp.corners) * lamp.strength);
  for (const Lamp& lamp : bodiless_) {
    if (const auto flux = light_flux(atlas_.scene, atlas_.scene.lights[sampler_.light(lamp.light).index])) add(*flux);
  }
  return sum;
}

Vec3d StraightLight::far_irradiance(const Place& place) const { return from_bodiless(place, true); }

std::optional<StraightLight::Beam> StraightLight::beam_of(const Lamp& lamp, const Vec3d& point,
                                                          const Vec3d& normal) const {
  SurfacePoint from;
  from.position = point;
  from.geometric_normal = from.shading_normal = normal == Vec3d(0) ? from.geometric_normal : normal;
  const auto sample = sampler_.sample_light(lamp.light, from, Vec2d(0));
  if (!sample || (normal != Vec3d(0) && !(dot(sample->direction, normal) > 0))) return std::nullopt;
  const Rgb passed = shadow_.transmittance(sample->shadow_ray);
  if (is_black(passed)) return std::nullopt;
  return Beam{sample->direction, passed * sample->radiance};
}

void StraightLight::add_beams(const Lamp& lamp, const Vec3d& point, const Vec3d& normal, std::uint32_t samples,
                              std::uint64_t key, std::vector<Beam>& beams) const {
  // By solid angle: where a lamp meets the surface it shines on, its near points are no brighter than its far ones.
  const Vec3d facing = polygon_normal(lamp.corners);
  const double before = dot(facing, point - lamp.corners[0]);  // m in front of the lamp
  if (!(before > 0)) return;
  std::vector<Vec3d> corners = lamp.corners;
  if (normal != Vec3d(0)) clip_polygon(lamp.corners, {normal, dot(normal, point)}, 0, corners);
  if (corners.size() < 3) return;
  for (Vec3d& c : corners) c = normalize(c - point);
  std::vector<SphericalTriangle> triangles;
  std::vector<double> shares{0};
  for (std::size_t k = 2; k < corners.size(); ++k) {
    triangles.emplace_back(corners[0], corners[k - 1], corners[k]);
    shares.push_back(shares.back() + triangles.back().solid_angle());
  }
  const Rgb irradiance(lamp.strength * (shares.back() / (std::numbers::pi * samples)));
  for (std::uint32_t k = 0; k < samples; ++k) {
    Vec2d u = owen_sobol_2d(k, hash_key(key, lamp.patch));
    const double place = u.x * shares.back();
    std::size_t t = 0;
    while (t + 1 < triangles.size() && place >= shares[t + 1]) ++t;
    u.x = std::clamp((place - shares[t]) / (shares[t + 1] - shares[t]), 0.0, 1.0);
    const Vec3d direction = triangles[t].sample(u);
    const double cosine = -dot(direction, facing);
    if (!(cosine > 0) || (normal != Vec3d(0) && !(dot(direction, normal) > 0))) continue;
    const Ray ray{.origin = point, .direction = direction, .t_max = before / cosine * (1 - shortening)};
    if (!tracer_.occluded(ray)) beams.push_back({direction, irradiance});
  }
}

std::vector<StraightLight::Beam> StraightLight::beams(const Vec3d& point, const Vec3d& normal, std::uint32_t samples,
                                                      std::uint64_t key) const {
  std::vector<Beam> beams;
  for (const Lamp& lamp : light_->lamps()) add_beams(lamp, point, normal, samples, key, beams);
  for (const Lamp& lamp : bodiless_) {
    if (const auto beam = beam_of(lamp, point, normal)) beams.push_back(*beam);
  }
  return beams;
}

Vec3d StraightLight::lifted(const Place& place) const {
  const Vec3d& n = place.normal;
  return place.position + rounding_ * (std::abs(n.x) + std::abs(n.y) + std::abs(n.z)) * n;
}

Vec3d StraightLight::from_bodiless(const Place& place, bool far_only) const {
  Vec3d sum(0);
  for (const Lamp& lamp : bodiless_) {
    if (far_only && light_flux(atlas_.scene, atlas_.scene.lights[sampler_.light(lamp.light).index])) continue;
    const auto beam = beam_of(lamp, lifted(place), place.normal);
    if (beam) sum += std::max(0.0, dot(beam->direction, place.shading)) * Vec3d(beam->irradiance);
  }
  return sum;
}

Vec3d StraightLight::look(const LampIrradiance::View& view, const Place& place) const {
  const Vec3d bodiless = from_bodiless(place, false);
  if (!view.is_lit()) return bodiless;
  if (has_holes_) {
    std::vector<Beam> beams;
    for (const Lamp& lamp : light_->lamps()) {
      add_beams(lamp, lifted(place), place.normal, rays_through_holes, 0, beams);
    }
    Vec3d sum(0);
    for (const Beam& beam : beams) sum += std::max(0.0, dot(beam.direction, place.shading)) * Vec3d(beam.irradiance);
    return bodiless + sum;
  }
  if (dot(place.normal, place.shading) > 1 - 1e-6) return bodiless + view.at(place.position);
  return bodiless + light_->at(place.position, place.normal, place.shading, {});
}

void StraightLight::at(std::span<const Place> places, double reach, std::span<Vec3d> irradiance) const {
  std::array<Vec3d, 4> corners;
  if (rectangle_around(places, reach, corners)) {
    const LampIrradiance::View view = light_->view(corners);
    for (std::size_t k = 0; k < places.size(); ++k) irradiance[k] = look(view, places[k]);
    return;
  }
  for (std::size_t k = 0; k < places.size(); ++k) {
    rectangle_around(places.subspan(k, 1), reach, corners);
    irradiance[k] = look(light_->view(corners), places[k]);
  }
}

}  // namespace penumbra
