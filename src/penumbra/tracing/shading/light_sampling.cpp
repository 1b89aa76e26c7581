#include "penumbra/tracing/shading/light_sampling.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "penumbra/math/sampling.h"
#include "penumbra/tracing/shading/surface_material.h"
#include "penumbra/tracing/shape_intersection.h"

namespace penumbra {
namespace {

using std::numbers::pi;

// Up to how many triangles a mesh can be one flat lamp with a middle.
constexpr std::size_t few_triangles = 4;

constexpr std::uint32_t no_light = 0xFFFFFFFFU;

// Rounding of a point on a light: its shadow ray ends before it.
Vec3d rounding(const Vec3d& p, double size) { return rounding_error(largest_component(p) + size); }

std::size_t find_cell(const std::vector<double>& cdf, double u) {
  const auto above = std::upper_bound(cdf.begin(), cdf.end(), u);
  const auto cell = above - cdf.begin() - 1;
  return static_cast<std::size_t>(std::clamp<std::ptrdiff_t>(cell, 0, static_cast<std::ptrdiff_t>(cdf.size()) - 2));
}

bool is_lamp(const Material& m) { return m.emits() && !m.unlit; }

const EmissionSpectrum* spectrum_of(const Material& m) { return m.emission_spectrum ? &*m.emission_spectrum : nullptr; }

double sides(const Material& m) { return m.double_sided ? 2.0 : 1.0; }

}  // namespace

double range_window(double distance, double range) {
  if (!std::isfinite(range)) return 1;
  const double q = distance / range;
  return std::clamp(1 - q * q * q * q, 0.0, 1.0);
}

double spot_window(const SpotLight& spot, const Vec3d& from_light) {
  const double outer = std::cos(spot.outer_angle);
  const double scale = 1 / std::max(0.001, std::cos(spot.inner_angle) - outer);
  const double a = std::clamp((dot(spot.direction, from_light) - outer) * scale, 0.0, 1.0);
  return a * a;
}

Rgb LightSample::weight(const Bands& bands) const {
  if (!spectrum || !bands.spectral()) return bands.emission(weight());
  return spectrum_in(*spectrum, bands) / static_cast<float>(pdf);
}

bool emits_towards(const Material& material, const Vec3d& geometric_normal, const Vec3d& direction) {
  return material.double_sided || dot(geometric_normal, direction) > 0;
}

LightSampler::LightSampler(const Scene& scene)
    : scene_(&scene), environment_(scene), scene_radius_(std::max(1e-3, scene.bounds().diagonal() / 2)) {
  light_of_object_.assign(scene.object_count(), no_light);
  add_punctual();
  for (std::uint32_t object = 0; object < scene.object_count(); ++object) {
    object < scene.instances.size() ? add_mesh(object) : add_shape(object);
  }
  add_environment();
  make_choice();
}

void LightSampler::add_punctual() {
  for (std::uint32_t i = 0; i < scene_->lights.size(); ++i) {
    const auto& kind = scene_->lights[i].kind;
    double power = 0;
    if (const auto* point = std::get_if<PointLight>(&kind)) {
      power = luminance(point->intensity) * (point->inverse_square ? 1 : scene_radius_ * scene_radius_) *
              (point->web ? luminous_flux(scene_->webs[point->web->web]) : 4 * pi);
    } else if (const auto* spot = std::get_if<SpotLight>(&kind)) {
      power = 2 * pi * (1 - std::cos(0.5 * (spot->inner_angle + spot->outer_angle))) * luminance(spot->intensity);
    } else if (const auto* far = std::get_if<DirectionalLight>(&kind)) {
      power = pi * scene_radius_ * scene_radius_ * luminance(far->irradiance);
    } else {
      ambient_ += std::get<AmbientLight>(kind).radiance;
      continue;
    }
    if (power > 0) lights_.push_back({Kind::punctual, i, power, {}, {}, {}});
  }
}

void LightSampler::add_mesh(std::uint32_t object) {
  const Instance& instance = scene_->instances[object];
  const Mesh& mesh = scene_->meshes[instance.mesh];
  const bool shines = std::any_of(mesh.materials.begin(), mesh.materials.end(),
                                  [&](std::uint32_t m) { return is_lamp(scene_->materials[m]); });
  if (!shines) return;
  Source source{Kind::mesh, object, 0, {}, {0.0}, {}};
  for (std::uint32_t t = 0; t < mesh.triangles.size(); ++t) {
    const Material& m = scene_->materials[mesh.material_of(t)];
    if (!is_lamp(m)) continue;
    const double power =
        pi * sides(m) * luminance(m.emission) * length(world_triangle(instance, mesh, t).area_normal());
    if (!(power > 0)) continue;
    source.power += power;
    source.triangles.push_back(t);
    source.cdf.push_back(source.power);
  }
  if (source.triangles.empty()) return;
  for (double& c : source.cdf) c /= source.power;
  source.middle = flat_middle(source);
  light_of_object_[object] = static_cast<std::uint32_t>(lights_.size());
  lights_.push_back(std::move(source));
}

std::optional<LightSampler::Middle> LightSampler::flat_middle(const Source& source) const {
  if (source.triangles.size() > few_triangles) return std::nullopt;
  const Instance& instance = scene_->instances[source.index];
  const Mesh& mesh = scene_->meshes[instance.mesh];
  const Material& material = scene_->materials[mesh.material_of(source.triangles.front())];
  const double mirror = is_mirroring(instance.to_world) ? -1.0 : 1.0;
  Middle middle{.radiance = material.emission, .both_sides = material.double_sided};
  Vec3d normal_sum(0);
  for (const std::uint32_t t : source.triangles) {
    const Material& m = scene_->materials[mesh.material_of(t)];
    if (m.emission != material.emission || m.double_sided != material.double_sided || m.emission_texture ||
        m.alpha_mode != AlphaMode::opaque) {
      return std::nullopt;
    }
    const WorldTriangle triangle = world_triangle(instance, mesh, t);
    const double area = length(triangle.area_normal());
    middle.area += area;
    middle.position += area * (triangle.v0 + (triangle.e1 + triangle.e2) / 3.0);
    normal_sum += mirror * triangle.area_normal();
  }
  // Bent lamps face several ways and have no middle.
  if (length(normal_sum) < (1 - 1e-6) * middle.area) return std::nullopt;
  middle.position /= middle.area;
  middle.normal = normalize(normal_sum);
  return middle;
}

void LightSampler::add_shape(std::uint32_t object) {
  const ShapeObject& o = scene_->shapes[object - scene_->instances.size()];
  const Material& m = scene_->materials[o.material];
  const double power = pi * sides(m) * luminance(m.emission) * shape_area(o.shape);
  if (!is_lamp(m) || !(power > 0)) return;
  light_of_object_[object] = static_cast<std::uint32_t>(lights_.size());
  lights_.push_back({Kind::shape, object, power, {}, {}, {}});
  if (const auto* disk = std::get_if<Disk>(&o.shape); disk != nullptr && !m.emission_texture) {
    lights_.back().middle = Middle{disk->centre, disk->normal, shape_area(o.shape), m.emission, m.double_sided};
  }
}

void LightSampler::add_environment() {
  if (!environment_.lights_surfaces()) return;
  const double power = pi * scene_radius_ * scene_radius_ * pi * luminance(environment_.mean_radiance());
  if (power > 0) lights_.push_back({Kind::environment, 0, power, {}, {}, {}});
}

// Bounds of a triangle of a mesh, of a shape, or of a punctual light at a place.
LightTree::Emitter LightSampler::emitter(const Source& source, std::size_t part) const {
  LightTree::Emitter e{.bounds = {}, .axis = {0, 0, 1}, .spread = pi, .beam = pi / 2, .power = source.power};
  if (source.kind == Kind::mesh) {
    const Instance& instance = scene_->instances[source.index];
    const Mesh& mesh = scene_->meshes[instance.mesh];
    const WorldTriangle t = world_triangle(instance, mesh, source.triangles[part]);
    for (const Vec3d& corner : {t.v0, t.v0 + t.e1, t.v0 + t.e2}) e.bounds.grow(corner);
    e.axis = normalize(t.area_normal()) * (is_mirroring(instance.to_world) ? -1.0 : 1.0);
    e.spread = 0;
    e.both_sides = scene_->materials[mesh.material_of(source.triangles[part])].double_sided;
    e.power = source.power * (source.cdf[part + 1] - source.cdf[part]);
    return e;
  }
  if (source.kind == Kind::shape) {
    const ShapeObject& object = scene_->shapes[source.index - scene_->instances.size()];
    e.both_sides = scene_->materials[object.material].double_sided;
    if (const auto* sphere = std::get_if<Sphere>(&object.shape)) {
      e.bounds.grow(sphere->centre - sphere->radius);
      e.bounds.grow(sphere->centre + sphere->radius);
    } else if (const auto* disk = std::get_if<Disk>(&object.shape)) {
      e.bounds.grow(disk->centre - disk->radius);
      e.bounds.grow(disk->centre + disk->radius);
      e.axis = disk->normal;
      e.spread = 0;
    } else {
      const auto& cylinder = std::get<Cylinder>(object.shape);
      for (const Vec3d& end : {cylinder.base, cylinder.top}) {
        e.bounds.grow(end - cylinder.radius);
        e.bounds.grow(end + cylinder.radius);
      }
    }
    return e;
  }
  const auto& kind = scene_->lights[source.index].kind;
  if (const auto* spot = std::get_if<SpotLight>(&kind)) {
    e.bounds.grow(spot->position);
    e.axis = spot->direction;
    e.spread = spot->outer_angle;  // even within its cone
  } else {
    e.bounds.grow(std::get<PointLight>(kind).position);
  }
  return e;
}

void LightSampler::make_choice() {
  constexpr std::uint32_t none = 0xFFFFFFFFU;
  part_of_light_.assign(lights_.size(), none);
  part_of_triangle_.resize(lights_.size());
  places_.resize(lights_.size());
  std::vector<LightTree::Emitter> emitters;
  double far_power = 0, all_power = 0;
  for (std::uint32_t i = 0; i < lights_.size(); ++i) {
    const Source& source = lights_[i];
    all_power += source.power;
    const bool placeless =
        source.kind == Kind::environment ||
        (source.kind == Kind::punctual && std::holds_alternative<DirectionalLight>(scene_->lights[source.index].kind));
    if (placeless) {
      far_.push_back(i);
      far_power += source.power;
      far_cdf_.push_back(far_power);
      continue;
    }
    part_of_light_[i] = static_cast<std::uint32_t>(parts_.size());
    if (source.kind == Kind::mesh) {
      part_of_triangle_[i].assign(scene_->meshes[scene_->instances[source.index].mesh].triangles.size(), none);
    }
    Bounds bounds;
    for (std::uint32_t t = 0; t < std::max<std::size_t>(1, source.triangles.size()); ++t) {
      if (source.kind == Kind::mesh) {
        part_of_triangle_[i][source.triangles[t]] = static_cast<std::uint32_t>(parts_.size());
      }
      parts_.push_back({i, t});
      emitters.push_back(emitter(source, t));
      bounds.grow(emitters.back().bounds);
    }
    places_[i] = bounds.centre();
  }
  tree_ = LightTree(emitters);
  far_chance_ = all_power > 0 ? far_power / all_power : 0;
  for (double& c : far_cdf_) c /= all_power;
}

const EmissionSpectrum* LightSampler::spectrum(std::size_t light) const {
  const Source& source = lights_[light];
  if (source.kind == Kind::shape) {
    return spectrum_of(scene_->materials[scene_->shapes[source.index - scene_->instances.size()].material]);
  }
  if (source.kind != Kind::mesh) return nullptr;
  const Mesh& mesh = scene_->meshes[scene_->instances[source.index].mesh];
  return spectrum_of(scene_->materials[mesh.material_of(source.triangles.front())]);
}

std::optional<LightSample> LightSampler::sample_light(std::size_t light, const SurfacePoint& from, const Vec2d& u,
                                                      const Vec3d& facing) const {
  const Source& source = lights_[light];
  switch (source.kind) {
    case Kind::punctual:
      return sample_punctual(source, from, u);
    case Kind::mesh:
      return sample_lamp(light, from, u);
    case Kind::shape:
      return sample_shape(source, from, u);
    case Kind::environment:
      return sample_environment(from, u, facing);
  }
  return std::nullopt;
}

bool LightSampler::has_middle(std::size_t light) const {
  const Source& source = lights_[light];
  if (source.kind == Kind::punctual || source.middle) return true;
  if (source.kind != Kind::shape) return false;
  return std::holds_alternative<Sphere>(scene_->shapes[source.index - scene_->instances.size()].shape);
}

std::optional<LightSample> LightSampler::sample_middle(std::size_t light, const SurfacePoint& from) const {
  const Source& source = lights_[light];
  if (source.kind == Kind::punctual) return sample_punctual(source, from, Vec2d(0));
  // On the axis of the cone that a sphere fills.
  if (!source.middle) return has_middle(light) ? sample_shape(source, from, Vec2d(0)) : std::nullopt;
  const Middle& middle = *source.middle;
  SurfacePoint point;
  point.position = middle.position;
  point.geometric_normal = point.shading_normal = middle.normal;
  point.error = rounding(middle.position, std::sqrt(middle.area));
  point.object = source.index;
  point.material = source.kind == Kind::mesh
                       ? scene_->meshes[scene_->instances[source.index].mesh].material_of(source.triangles.front())
                       : scene_->shapes[source.index - scene_->instances.size()].material;
  return towards(from, point, 1 / middle.area);
}

std::optional<LampPoint> LightSampler::sample_point(std::size_t light, Vec2d u) const {
  const Source& source = lights_[light];
  if (source.kind == Kind::shape) return point_on_shape(*scene_, source.index, u);
  if (source.kind != Kind::mesh) return std::nullopt;
  const std::size_t cell = find_cell(source.cdf, u.x);
  const double chance = source.cdf[cell + 1] - source.cdf[cell];
  u.x = std::clamp((u.x - source.cdf[cell]) / chance, 0.0, 1.0);  // the part of u left over is uniform again
  LampPoint at = point_on_triangle(*scene_, source.index, source.triangles[cell], u);
  at.density *= chance;
  return at;
}

std::optional<LightSample> LightSampler::sample(const SurfacePoint& from, double u_light, const Vec2d& u,
                                                const Vec3d& facing) const {
  std::optional<LightSample> s;
  double chance = 0;
  if (u_light < far_chance_) {
    const auto at = static_cast<std::size_t>(
        std::min(std::upper_bound(far_cdf_.begin(), far_cdf_.end(), u_light), far_cdf_.end() - 1) - far_cdf_.begin());
    chance = far_cdf_[at] - (at > 0 ? far_cdf_[at - 1] : 0);
    s = sample_light(far_[at], from, u, facing);
  } else {
    const auto choice = tree_.choose(from.position, facing, (u_light - far_chance_) / (1 - far_chance_));
    if (!choice) return std::nullopt;
    chance = (1 - far_chance_) * choice->chance;
    const Part& part = parts_[choice->emitter];
    const Source& source = lights_[part.light];
    s = source.kind == Kind::mesh ? sample_triangle_of(source, part.number, 1, from, u)
                                  : sample_light(part.light, from, u, facing);
  }
  if (!s) return s;
  if (s->pdf > 0) {
    s->pdf *= chance;
  } else {
    s->radiance /= static_cast<float>(chance);
  }
  return s;
}

std::optional<LightSample> LightSampler::sample_punctual(const Source& source, const SurfacePoint& from,
                                                         const Vec2d& u) const {
  const auto& kind = scene_->lights[source.index].kind;
  LightSample s;
  if (const auto* far = std::get_if<DirectionalLight>(&kind)) {
    s.direction = -far->direction;
    s.radiance = far->irradiance;
    if (far->angular_radius > 0) {
      // A disk of even radiance E / (pi sin^2), drawn by its solid angle 2 pi (1 - cos).
      const double cosine = std::cos(far->angular_radius);
      s.direction = Frame(s.direction).to_world(sample_cone(u, cosine));
      s.radiance *= static_cast<float>(2 / (1 + cosine));
    }
    s.shadow_ray = leave(from, s.direction);
    return s;
  }
  const auto* point = std::get_if<PointLight>(&kind);
  const auto* spot = std::get_if<SpotLight>(&kind);
  const Vec3d position = point ? point->position : spot->position;
  const Vec3d way = position - from.position;
  const double distance = length(way);
  if (!(distance > 0)) return std::nullopt;
  s.direction = way / distance;
  s.shadow_ray = segment(from, position);
  if (point && !point->inverse_square) {
    s.radiance = point->intensity * static_cast<float>(pi);
    return s;
  }
  double window =
      range_window(distance, point ? point->range : spot->range) * (spot ? spot_window(*spot, -s.direction) : 1);
  if (point && point->web) window *= candela_towards(scene_->webs[point->web->web], *point->web, -s.direction);
  if (window <= 0) return std::nullopt;
  s.radiance = (point ? point->intensity : spot->intensity) * static_cast<float>(window / (distance * distance));
  return s;
}

// Turns a point of a light, chosen with a density over area, into a direction with a density over solid angle.
std::optional<LightSample> LightSampler::towards(const SurfacePoint& from, const SurfacePoint& light,
                                                 double area_pdf) const {
  const Vec3d way = light.position - from.position;
  const double distance2 = length_squared(way);
  if (!(distance2 > 0)) return std::nullopt;
  LightSample s;
  s.direction = way / std::sqrt(distance2);
  const double cosine = std::abs(dot(light.geometric_normal, s.direction));
  const Material& material = scene_->materials[light.material];
  if (cosine <= 0 || !emits_towards(material, light.geometric_normal, -s.direction)) return std::nullopt;
  s.pdf = area_pdf * distance2 / cosine;
  s.radiance = emission_at(*scene_, light);
  s.spectrum = spectrum_of(material);
  if (!(s.pdf > 0) || !std::isfinite(s.pdf) || is_black(s.radiance)) return std::nullopt;
  s.shadow_ray = segment(from, light);
  return s;
}

std::optional<LightSample> LightSampler::sample_lamp(std::size_t light, const SurfacePoint& from,
                                                     const Vec2d& u) const {
  const auto at = sample_point(light, u);
  return at ? towards(from, at->point, at->density) : std::nullopt;
}

std::optional<LightSample> LightSampler::sample_triangle_of(const Source& source, std::size_t part, double chance,
                                                            const SurfacePoint& from, const Vec2d& u) const {
  const LampPoint at = point_on_triangle(*scene_, source.index, source.triangles[part], u);
  return towards(from, at.point, chance * at.density);
}

std::optional<LightSample> LightSampler::sample_shape(const Source& source, const SurfacePoint& from,
                                                      const Vec2d& u) const {
  const ShapeObject& object = scene_->shapes[source.index - scene_->instances.size()];
  SurfacePoint light;
  light.object = source.index;
  light.material = object.material;
  if (const auto* sphere = std::get_if<Sphere>(&object.shape)) {
    const Vec3d to_centre = sphere->centre - from.position;
    const double distance2 = length_squared(to_centre);
    const double r2 = sphere->radius * sphere->radius;
    if (distance2 > r2 * (1 + 1e-9)) {
      // 1 - cos of the cone's half-angle without cancellation for small spheres.
      const double sin2 = r2 / distance2;
      const double one_minus_cos = sin2 / (1 + std::sqrt(1 - sin2));
      const Vec3d local = sample_cone(u, 1 - one_minus_cos);
      const Vec3d direction = Frame(to_centre / std::sqrt(distance2)).to_world(local);
      const double along = dot(to_centre, direction);
      const double off2 = std::max(0.0, distance2 - along * along);
      const double t = along - std::sqrt(std::max(0.0, r2 - off2));
      light.geometric_normal = normalize(from.position + t * direction - sphere->centre);
      light.position = sphere->centre + sphere->radius * light.geometric_normal;
      light.error = rounding(light.position, sphere->radius);
      LightSample s;
      s.direction = direction;
      s.pdf = 1 / (2 * pi * one_minus_cos);
      light.uv[0] = light.uv[1] = shape_point(object.shape, light.position).uv;
      s.radiance = emission_at(*scene_, light);
      s.spectrum = spectrum_of(scene_->materials[object.material]);
      s.shadow_ray = segment(from, light);
      return s;
    }
  }
  const auto at = point_on_shape(*scene_, source.index, u);
  return at ? towards(from, at->point, at->density) : std::nullopt;
}

// Of an environment of one colour, only the surface's own cosine says which directions matter.
bool LightSampler::by_cosine(const Vec3d& facing) const { return !environment_.has_picture() && facing != Vec3d(0); }

std::optional<LightSample> LightSampler::sample_environment(const SurfacePoint& from, const Vec2d& u,
                                                            const Vec3d& facing) const {
  LightSample s;
  if (by_cosine(facing)) {
    const Vec3d local = sample_cosine_hemisphere(u);
    s.direction = Frame(facing).to_world(local);
    s.pdf = local.z / pi;
  } else {
    const EnvironmentMap::Sample e = environment_.sample(u);
    s.direction = e.direction;
    s.pdf = e.pdf;
  }
  if (!(s.pdf > 0)) return std::nullopt;
  s.radiance = environment_.radiance(s.direction);
  s.shadow_ray = leave(from, s.direction);
  return s;
}

Rgb LightSampler::seen_in_sky(const Vec3d& direction) const {
  Rgb radiance = environment_.radiance(direction);
  for (const std::uint32_t light : far_) {
    if (lights_[light].kind != Kind::punctual) continue;
    const auto& far = std::get<DirectionalLight>(scene_->lights[lights_[light].index].kind);
    const double sine = std::sin(far.angular_radius);
    const bool seen = sine > 0 && length(cross(direction, far.direction)) < sine && dot(direction, far.direction) < 0;
    if (seen) radiance += far.irradiance / static_cast<float>(pi * sine * sine);
  }
  return radiance;
}

double LightSampler::pdf(const Vec3d& from, const SurfacePoint& light, const Vec3d& facing) const {
  const std::uint32_t number = light_of_object_[light.object];
  if (number == no_light) return 0;
  const Source& source = lights_[number];
  const std::uint32_t part =
      source.kind == Kind::mesh ? part_of_triangle_[number][light.primitive] : part_of_light_[number];
  if (part >= parts_.size()) return 0;  // a triangle that does not shine
  const double chance = (1 - far_chance_) * tree_.chance(part, from, facing);
  if (source.kind == Kind::shape) {
    return chance * shape_pdf(scene_->shapes[light.object - scene_->instances.size()], from, light);
  }
  const Instance& instance = scene_->instances[light.object];
  const double area = length(world_triangle(instance, scene_->meshes[instance.mesh], light.primitive).area_normal());
  const Vec3d way = light.position - from;
  const double distance2 = length_squared(way);
  const double cosine = std::abs(dot(light.geometric_normal, way)) / std::sqrt(distance2);
  if (!(area > 0) || !(cosine > 0)) return 0;
  return chance / area * distance2 / cosine;
}

double LightSampler::shape_pdf(const ShapeObject& object, const Vec3d& from, const SurfacePoint& light) const {
  if (const auto* sphere = std::get_if<Sphere>(&object.shape)) {
    const double distance2 = length_squared(sphere->centre - from);
    const double r2 = sphere->radius * sphere->radius;
    if (distance2 > r2 * (1 + 1e-9)) {
      const double sin2 = r2 / distance2;
      return (1 + std::sqrt(1 - sin2)) / (2 * pi * sin2);
    }
  }
  const Vec3d way = light.position - from;
  const double distance2 = length_squared(way);
  const double cosine = std::abs(dot(light.geometric_normal, way)) / std::sqrt(distance2);
  return cosine > 0 ? distance2 / (cosine * shape_area(object.shape)) : 0;
}

double LightSampler::environment_pdf(const Vec3d& direction, const Vec3d& facing) const {
  if (far_.empty() || lights_[far_.back()].kind != Kind::environment) return 0;
  const double density = by_cosine(facing) ? std::max(0.0, dot(facing, direction)) / pi : environment_.pdf(direction);
  const double chance = far_cdf_.back() - (far_cdf_.size() > 1 ? far_cdf_[far_cdf_.size() - 2] : 0);
  return chance * density;
}

}  // namespace penumbra
