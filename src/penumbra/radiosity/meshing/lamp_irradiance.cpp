#include "penumbra/radiosity/meshing/lamp_irradiance.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "penumbra/math/sampling.h"
#include "penumbra/math/sobol.h"
#include "penumbra/radiosity/form_factors/nusselt.h"
#include "penumbra/radiosity/meshing/shadow_pyramid.h"

namespace penumbra {
namespace {

/// What lies within this share of the scene's size of a plane lies on it.
constexpr double on_plane = 1e-9;
constexpr std::uint32_t most_rays_to_a_lamp = 64;
constexpr std::uint32_t fewest_rays_to_a_lamp = 16;
constexpr std::uint32_t rays_to_all_lamps = 256;
constexpr std::uint32_t leaf_size = 4;
/// Lamps that bring the rest of the emitted power are left out.
constexpr double most_of_power = 0.99;

double largest(const Vec3d& v) { return std::max({v.x, v.y, v.z}); }

/// Half-spaces that hold the convex hull of two convex polygons: through each edge of one and a corner of the other.
std::vector<Plane3> hull_planes(std::span<const Vec3d> a, std::span<const Vec3d> b, double tolerance) {
  std::vector<Plane3> planes;
  const auto add_all = [&](std::span<const Vec3d> edges, std::span<const Vec3d> corners) {
    for (std::size_t k = 0; k < edges.size(); ++k) {
      for (const Vec3d& c : corners) {
        const Vec3d& from = edges[k];
        const Vec3d n = cross(edges[(k + 1) % edges.size()] - from, c - from);
        const double size = length(n);
        if (!(size > 0)) continue;
        Plane3 plane{n / size, dot(n, from) / size};
        double least = 0, most = 0;
        for (const auto& polygon : {edges, corners}) {
          for (const Vec3d& p : polygon) {
            least = std::min(least, plane.distance(p));
            most = std::max(most, plane.distance(p));
          }
        }
        if (least < -tolerance && most > tolerance) continue;
        if (most <= tolerance) plane = {-plane.normal, -plane.offset};
        planes.push_back(plane);
      }
    }
  };
  add_all(a, b);
  add_all(b, a);
  return planes;
}

bool is_beyond(const Plane3& plane, std::span<const Vec3d> polygon, double tolerance) {
  return std::all_of(polygon.begin(), polygon.end(), [&](const Vec3d& p) { return plane.distance(p) <= tolerance; });
}

/// Whether a box lies outside another, or outside one of the half-spaces.
bool misses(const Bounds& own, const Bounds& box, std::span<const Plane3> half_spaces, double tolerance) {
  if (glm::any(glm::lessThan(own.upper, box.lower)) || glm::any(glm::greaterThan(own.lower, box.upper))) return true;
  return is_outside(own, half_spaces, tolerance);
}

}  // namespace

LampIrradiance::LampIrradiance(const Scene& scene, const PatchMesh& faces, std::size_t most_lamps)
    : scene_(scene), faces_(faces), sampler_(scene), occluders_(std::make_unique<Scene>()) {
  Mesh& mesh = occluders_->meshes.emplace_back();
  mesh.positions = faces.vertices;
  std::vector<std::uint32_t> fronts;
  for (std::uint32_t p = 0; p < faces.patch_count(); ++p) {
    Bounds& box = bounds_.emplace_back();
    for (const Vec3d& v : faces.polygon(p)) box.grow(v);
    if (faces.surfaces[faces.surface_of[p]].back) continue;  // it stands where its front does
    fronts.push_back(p);
    const auto corners = faces.patch_corners(p);
    for (std::size_t c = 2; c < corners.size(); ++c) {
      mesh.triangles.push_back({corners[0], corners[c - 1], corners[c]});
      patch_of_triangle_.push_back(p);
    }
  }
  occluders_->materials.emplace_back();
  occluders_->instances.push_back({"faces", 0, Mat4d(1)});
  tracer_ = std::make_unique<RayTracer>(*occluders_);
  Bounds all;
  for (const Vec3d& v : faces.vertices) {
    all.grow(v);
    rounding_ = std::max(rounding_, float_error * largest_component(v));
  }
  size_ = faces.vertices.empty() ? 1 : length(all.upper - all.lower);
  tree_ = BoxTree(bounds_, std::move(fronts), leaf_size);
  add_patches(most_lamps);
  add_lights();
}

void LampIrradiance::add_patches(std::size_t most_lamps) {
  const auto emission = [&](std::uint32_t p) {
    const double* e = &faces_.emission[std::size_t{3} * faces_.surface_of[p]];
    return Vec3d(e[0], e[1], e[2]);
  };
  std::vector<std::uint32_t> emitting;
  for (std::uint32_t p = 0; p < faces_.radiating_count; ++p) {
    if (largest(emission(p)) > 0) emitting.push_back(p);
  }
  const auto power = [&](std::uint32_t p) { return faces_.areas[p] * largest(emission(p)); };
  std::stable_sort(emitting.begin(), emitting.end(),
                   [&](std::uint32_t a, std::uint32_t b) { return power(a) > power(b); });
  double all = 0, counted = 0;
  for (const std::uint32_t p : emitting) all += power(p);
  for (const std::uint32_t p : emitting) {
    if (lamps_.size() == most_lamps || counted >= most_of_power * all) break;
    counted += power(p);
    const auto polygon = faces_.polygon(p);
    lamps_.push_back({Lamp::Kind::patch, {polygon.begin(), polygon.end()}, Vec3d(0), emission(p), p});
  }
}

void LampIrradiance::add_lights() {
  for (std::uint32_t k = 0; k < sampler_.light_count(); ++k) {
    if (sampler_.light(k).kind != LightSampler::Kind::punctual) continue;
    Lamp lamp;
    lamp.light = k;
    const auto& kind = scene_.lights[sampler_.light(k).index].kind;
    if (const auto* far = std::get_if<DirectionalLight>(&kind)) {
      lamp.kind = Lamp::Kind::far;
      lamp.direction = far->direction;
      lamp.strength = Vec3d(far->irradiance);
    } else {
      const auto* point = std::get_if<PointLight>(&kind);
      const auto* spot = std::get_if<SpotLight>(&kind);
      lamp.kind = Lamp::Kind::point;
      lamp.corners = {point != nullptr ? point->position : spot->position};
      lamp.strength = Vec3d(point != nullptr ? point->intensity : spot->intensity);
    }
    lamps_.push_back(std::move(lamp));
  }
}

LampIrradiance::View LampIrradiance::view(std::span<const Vec3d> receiver) const {
  View view;
  view.owner_ = this;
  const Plane3 plane = polygon_plane(receiver);
  view.normal_ = plane.normal;
  const double tolerance = on_plane * size_;
  for (std::uint32_t k = 0; k < lamps_.size(); ++k) {
    const Lamp& lamp = lamps_[k];
    if (lamp.kind == Lamp::Kind::far) {
      if (dot(lamp.direction, plane.normal) < 0) view.seen_.push_back({k, {}, false});
      continue;
    }
    if (is_beyond(plane, lamp.corners, tolerance)) continue;
    View::Seen seen{k, {}, false};
    if (lamp.kind == Lamp::Kind::patch) {
      if (is_beyond(polygon_plane(lamp.corners), receiver, tolerance)) continue;
      list_occluders(receiver, plane, seen);
    }
    view.seen_.push_back(std::move(seen));
  }
  return view;
}

void LampIrradiance::list_occluders(std::span<const Vec3d> receiver, const Plane3& plane, View::Seen& seen) const {
  const Lamp& lamp = lamps_[seen.lamp];
  const Plane3 lamp_plane = polygon_plane(lamp.corners);
  const double tolerance = on_plane * size_;
  std::vector<Plane3> shaft = hull_planes(receiver, lamp.corners, tolerance);
  shaft.push_back(plane);
  shaft.push_back(lamp_plane);
  Bounds box;
  for (const auto& polygon : {receiver, std::span<const Vec3d>(lamp.corners)}) {
    for (const Vec3d& p : polygon) box.grow(p);
  }
  std::vector<Vec3d> above, between;
  bool too_many = false;
  tree_.search([&](const Bounds& of_node) { return too_many || misses(of_node, box, shaft, tolerance); },
               [&](std::uint32_t p) {
                 const auto polygon = faces_.polygon(p);
                 if (too_many || p == lamp.patch || misses(bounds_[p], box, shaft, tolerance)) return;
                 if (std::any_of(shaft.begin(), shaft.end(),
                                 [&](const Plane3& s) { return is_beyond(s, polygon, tolerance); })) {
                   return;
                 }
                 clip_polygon(polygon, plane, 0, above);
                 if (above.size() < 3) return;
                 clip_polygon(above, lamp_plane, 0, between);
                 if (between.size() < 3) return;
                 seen.is_round =
                     seen.is_round || faces_.surfaces[faces_.surface_of[p]].object >= scene_.instances.size();
                 too_many = seen.occluders.size() == most_occluders;
                 if (!too_many) seen.occluders.push_back(between);
               });
  if (too_many) {
    seen.by_rays = true;
    seen.occluders.clear();
    return;
  }
  // The nearest to the lamp's size first: large ones leave less for the rest to cut.
  std::stable_sort(seen.occluders.begin(), seen.occluders.end(),
                   [](const auto& a, const auto& b) { return polygon_area(a) > polygon_area(b); });
}

double LampIrradiance::visible_factor(const Vec3d& point, const Vec3d& normal, const View::Seen& seen) const {
  const Lamp& lamp = lamps_[seen.lamp];
  const double whole = point_to_polygon(point, normal, lamp.corners);
  if (whole == 0 || seen.occluders.empty()) return whole;
  std::vector<std::vector<Vec3d>> pieces{lamp.corners};
  for (const auto& occluder : seen.occluders) {
    cut_shadow(point, occluder, pieces);
    if (pieces.empty()) return 0;
  }
  double sum = 0;
  for (const auto& piece : pieces) sum += point_to_polygon(point, normal, piece);
  return std::min(sum, whole);
}

bool LampIrradiance::is_hidden(const Vec3d& point, const Vec3d& normal, const Vec3d& direction, double distance,
                               const ShadowRays& shadow) const {
  SurfacePoint from;
  from.position = point;
  from.error = Vec3d(rounding_);
  from.geometric_normal = from.shading_normal = normal;
  Ray ray = leave(from, direction);
  ray.t_max = distance * (1 - 1e-5);
  return (shadow.tracer != nullptr ? *shadow.tracer : *tracer_).occluded(ray);
}

double LampIrradiance::sampled_factor(const Vec3d& point, const Vec3d& geometric, const Vec3d& normal, const Lamp& lamp,
                                      const ShadowRays& shadow) const {
  const double whole = point_to_polygon(point, normal, lamp.corners);
  if (whole == 0) return 0;
  // The share of the lamp that is seen, each point weighed by what it brings.
  const Vec3d lamp_normal = polygon_normal(lamp.corners);
  double seen = 0, all = 0;
  const auto usual = std::clamp(rays_to_all_lamps / static_cast<std::uint32_t>(lamps_.size()), fewest_rays_to_a_lamp,
                                most_rays_to_a_lamp);
  const std::uint32_t rays = shadow.count > 0 ? shadow.count : usual;
  for (std::uint32_t k = 0; k < rays; ++k) {
    Vec2d u = owen_sobol_2d(k, shadow.key);
    const auto triangles = static_cast<double>(lamp.corners.size() - 2);
    const auto t = static_cast<std::size_t>(std::min(u.x * triangles, triangles - 1));
    u.x = u.x * triangles - static_cast<double>(t);
    const Vec2d b = sample_triangle(u);
    const Vec3d e1 = lamp.corners[t + 1] - lamp.corners[0], e2 = lamp.corners[t + 2] - lamp.corners[0];
    const Vec3d way = lamp.corners[0] + b.x * e1 + b.y * e2 - point;
    const double r2 = length_squared(way);
    const double weight =
        length(cross(e1, e2)) * std::max(0.0, dot(way, normal)) * std::max(0.0, -dot(way, lamp_normal)) / (r2 * r2);
    if (!(weight > 0)) continue;
    all += weight;
    if (!is_hidden(point, geometric, way / std::sqrt(r2), std::sqrt(r2), shadow)) seen += weight;
  }
  return all > 0 ? whole * seen / all : 0;
}

Vec3d LampIrradiance::without_body(const Vec3d& point, const Vec3d& geometric, const Vec3d& normal, const Lamp& lamp,
                                   const ShadowRays& shadow) const {
  SurfacePoint from;
  from.position = point;
  from.error = Vec3d(rounding_);
  from.geometric_normal = from.shading_normal = geometric;
  const RayTracer& tracer = shadow.tracer != nullptr ? *shadow.tracer : *tracer_;
  const auto sample = sampler_.sample_light(lamp.light, from, Vec2d(0));
  if (!sample || !(dot(sample->direction, geometric) > 0) || tracer.occluded(sample->shadow_ray)) return Vec3d(0);
  return std::max(0.0, dot(sample->direction, normal)) * Vec3d(sample->radiance);
}

Vec3d LampIrradiance::at(const Vec3d& point, const Vec3d& geometric, const Vec3d& normal,
                         const ShadowRays& rays) const {
  Vec3d sum(0);
  for (const Lamp& lamp : lamps_) {
    sum += lamp.kind == Lamp::Kind::patch ? lamp.strength * sampled_factor(point, geometric, normal, lamp, rays)
                                          : without_body(point, geometric, normal, lamp, rays);
  }
  return sum;
}

Vec3d LampIrradiance::View::at(const Vec3d& point, const ShadowRays& rays) const {
  Vec3d sum(0);
  for (const Seen& seen : seen_) {
    const Lamp& lamp = owner_->lamps_[seen.lamp];
    if (lamp.kind != Lamp::Kind::patch) {
      sum += owner_->without_body(point, normal_, normal_, lamp, rays);
    } else if (seen.by_rays || (seen.is_round && rays.tracer != nullptr)) {
      sum += lamp.strength * owner_->sampled_factor(point, normal_, normal_, lamp, rays);
    } else {
      sum += lamp.strength * owner_->visible_factor(point, normal_, seen);
    }
  }
  return sum;
}

}  // namespace penumbra
