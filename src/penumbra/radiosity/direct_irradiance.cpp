#include "penumbra/radiosity/direct_irradiance.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <optional>
#include <stdexcept>

#include "penumbra/math/frame.h"
#include "penumbra/math/polygon.h"
#include "penumbra/math/rng.h"
#include "penumbra/math/sampling.h"
#include "penumbra/math/sobol.h"
#include "penumbra/parallel/parallel_for.h"
#include "penumbra/tracing/ray_tracer.h"
#include "penumbra/tracing/shading/light_sampling.h"
#include "penumbra/tracing/shading/media.h"

namespace penumbra {
namespace {

using std::numbers::pi;

/// Points per shadow ray where the light is seen in part.
constexpr int refinement = 16;
/// A light that varies by more than this over an element ends on it: the edge of a cone, the end of a range.
constexpr double uneven = 0.5;
constexpr std::size_t elements_a_block = 64;

/// The faces of a scene as triangles, for shadow rays.
Scene occluder_scene(const PatchMesh& faces) {
  Scene scene;
  Mesh& mesh = scene.meshes.emplace_back();
  mesh.positions = faces.vertices;
  for (std::size_t p = 0; p < faces.patch_count(); ++p) {
    // The back of a face stands where its front does.
    if (faces.surfaces[faces.surface_of[p]].back) continue;
    const auto corners = faces.patch_corners(p);
    for (std::size_t c = 2; c < corners.size(); ++c) {
      mesh.triangles.push_back({corners[0], corners[c - 1], corners[c]});
    }
  }
  scene.materials.emplace_back();
  scene.instances.push_back({"faces", 0, Mat4d(1)});
  return scene;
}

/// Solid angle of a polygon seen from a point, sr (van Oosterom & Strackee 1983, triangle by triangle).
double solid_angle(std::span<const Vec3d> polygon, const Vec3d& from) {
  double sum = 0;
  const Vec3d a = polygon[0] - from;
  for (std::size_t k = 2; k < polygon.size(); ++k) {
    const Vec3d b = polygon[k - 1] - from, c = polygon[k] - from;
    const double la = length(a), lb = length(b), lc = length(c);
    sum += 2 * std::atan2(dot(a, cross(b, c)), la * lb * lc + dot(a, b) * lc + dot(b, c) * la + dot(c, a) * lb);
  }
  return std::abs(sum);
}

void set_lane(RayPacket& packet, int lane, const Ray& ray) {
  const Vec3f o(ray.origin), d(ray.direction);
  packet.origin_x[lane] = o.x, packet.origin_y[lane] = o.y, packet.origin_z[lane] = o.z;
  packet.direction_x[lane] = d.x, packet.direction_y[lane] = d.y, packet.direction_z[lane] = d.z;
  packet.t_min[lane] = static_cast<float>(ray.t_min);
  packet.t_max[lane] = static_cast<float>(ray.t_max);
  packet.active[lane] = -1;
}

/// One side of an element as a place where light arrives.
class Receiver {
 public:
  Receiver(const PatchMesh& mesh, std::size_t element, double error, std::uint64_t seed)
      : polygon_(mesh.polygon(element)), normal_(mesh.normals[element]), key_(hash_key(seed, element)) {
    area_ = mesh.areas[element];
    shares_.push_back(0);
    for (std::size_t k = 2; k < polygon_.size(); ++k) {
      const double part = 0.5 * length(cross(polygon_[k - 1] - polygon_[0], polygon_[k] - polygon_[0]));
      shares_.push_back(shares_.back() + part / area_);
    }
    point_.error = Vec3d(error);
    point_.geometric_normal = point_.shading_normal = normal_;
  }

  [[nodiscard]] std::span<const Vec3d> polygon() const { return polygon_; }
  [[nodiscard]] const Vec3d& normal() const { return normal_; }
  [[nodiscard]] double area() const { return area_; }
  /// Sobol points for purpose `use`, independent of other uses.
  [[nodiscard]] Vec2d random(std::uint32_t index, std::uint64_t use) const {
    return owen_sobol_2d(index, hash_key(key_, use));
  }
  /// The surface at the `index`-th of a sequence of points spread evenly over the element.
  [[nodiscard]] const SurfacePoint& point(std::uint32_t index) {
    Vec2d u = random(index, 0);
    std::size_t k = 1;
    while (k + 1 < shares_.size() && u.x >= shares_[k]) ++k;
    u.x = std::clamp((u.x - shares_[k - 1]) / (shares_[k] - shares_[k - 1]), 0.0, 1.0);
    const Vec2d b = sample_triangle(u);
    point_.position = polygon_[0] + b.x * (polygon_[k] - polygon_[0]) + b.y * (polygon_[k + 1] - polygon_[0]);
    return point_;
  }

 private:
  std::span<const Vec3d> polygon_;
  Vec3d normal_;
  std::uint64_t key_;
  double area_;
  std::vector<double> shares_;  // of the area, up to each triangle of the fan
  SurfacePoint point_;
};

class Gatherer {
 public:
  Gatherer(const Scene& scene, const PatchMesh& faces, const DirectIrradianceOptions& options)
      : scene_(scene),
        options_(options),
        occluders_(occluder_scene(faces)),
        tracer_(occluders_),
        lights_(scene),
        media_(scene) {
    double size = 0;
    for (const Vec3d& v : faces.vertices) size = std::max(size, largest_component(v));
    error_ = float_error * size;
    for (std::size_t i = 0; i < lights_.light_count(); ++i) {
      const auto kind = lights_.light(i).kind;
      if (kind == LightSampler::Kind::punctual || kind == LightSampler::Kind::environment) used_.push_back(i);
    }
  }

  [[nodiscard]] std::size_t light_count() const { return used_.size(); }
  /// Number in Scene::lights, or the environment.
  [[nodiscard]] std::size_t scene_light(std::size_t number) const {
    const auto& source = lights_.light(used_[number]);
    return source.kind == LightSampler::Kind::environment ? LightIrradiance::environment : source.index;
  }
  [[nodiscard]] bool has_colours_of_its_own(std::size_t number) const {
    return lights_.light(used_[number]).kind == LightSampler::Kind::environment && lights_.environment().has_picture();
  }
  [[nodiscard]] std::optional<Vec3d> flux(std::size_t number) const {
    const auto& source = lights_.light(used_[number]);
    return source.kind == LightSampler::Kind::punctual ? light_flux(scene_, scene_.lights[source.index]) : std::nullopt;
  }

  [[nodiscard]] Vec3d irradiance(const PatchMesh& elements, std::size_t element, std::size_t number) const {
    Receiver receiver(elements, element, error_, hash_key(options_.seed, number));
    const std::size_t light = used_[number];
    if (lights_.light(light).kind == LightSampler::Kind::environment) return from_sky(receiver);
    return from_punctual(receiver, light);
  }

 private:
  /// Sums over shadow rays: what arrives, what would arrive unhindered, and how even that is.
  struct Sums {
    Vec3d arrived{0};
    double seen = 0;  // of the unhindered part, by the largest band
    double all = 0;
    double least = 1e300;
    double most = 0;
    int count = 0;
    [[nodiscard]] bool is_even() const { return (seen == 0 || seen == all) && least >= uneven * most; }
  };

  [[nodiscard]] Vec3d from_punctual(Receiver& receiver, std::size_t light) const {
    const auto& kind = scene_.lights[lights_.light(light).index].kind;
    if (const auto* far = std::get_if<DirectionalLight>(&kind)) {
      if (dot(far->direction, receiver.normal()) >= 0) return Vec3d(0);
    } else {
      const auto* point = std::get_if<PointLight>(&kind);
      const Vec3d position = point != nullptr ? point->position : std::get<SpotLight>(kind).position;
      if (!(dot(position - receiver.polygon()[0], receiver.normal()) > 0)) return Vec3d(0);
    }
    Sums sums;
    add_shadow_rays(receiver, light, 0, options_.samples, sums);
    if (!sums.is_even()) add_shadow_rays(receiver, light, options_.samples, refinement * options_.samples, sums);
    if (!(sums.seen > 0)) return Vec3d(0);
    const auto whole = media_.none() ? unhindered(receiver, kind) : std::nullopt;
    return whole ? (sums.seen / sums.all) * *whole : sums.arrived / static_cast<double>(sums.count);
  }

  /// What the light would bring on average with nothing in the way, where that has a closed form.
  [[nodiscard]] static std::optional<Vec3d> unhindered(const Receiver& receiver, const decltype(Light::kind)& kind) {
    if (const auto* far = std::get_if<DirectionalLight>(&kind)) {
      return -dot(far->direction, receiver.normal()) * Vec3d(far->irradiance);
    }
    const auto* point = std::get_if<PointLight>(&kind);
    if (point == nullptr || point->web || !point->inverse_square || std::isfinite(point->range)) return std::nullopt;
    return (solid_angle(receiver.polygon(), point->position) / receiver.area()) * Vec3d(point->intensity);
  }

  void add_shadow_rays(Receiver& receiver, std::size_t light, int first, int last, Sums& sums) const {
    for (int start = first; start < last; start += RayPacket::size) {
      RayPacket packet{};
      std::array<Vec3d, RayPacket::size> brought{};
      const int lanes = std::min(RayPacket::size, last - start);
      for (int i = 0; i < lanes; ++i) {
        const SurfacePoint& from = receiver.point(static_cast<std::uint32_t>(start + i));
        const auto sample = lights_.sample_light(light, from, Vec2d(0));
        if (!sample) continue;
        brought[i] = std::max(0.0, dot(sample->direction, receiver.normal())) * Vec3d(sample->radiance) *
                     left_by_air(sample->shadow_ray);
        set_lane(packet, i, sample->shadow_ray);
      }
      tracer_.occluded(packet, true);
      for (int i = 0; i < lanes; ++i) {
        const double strength = std::max({brought[i].x, brought[i].y, brought[i].z});
        sums.least = std::min(sums.least, strength);
        sums.most = std::max(sums.most, strength);
        sums.all += strength;
        if (packet.active[i] != 0) {
          sums.seen += strength;
          sums.arrived += brought[i];
        }
      }
      sums.count += lanes;
    }
  }

  /// Directions half by the cosine, half by the picture's brightness, weighed together by the balance heuristic (Veach
  /// & Guibas 1995); all by the cosine without a picture.
  [[nodiscard]] Vec3d from_sky(Receiver& receiver) const {
    const EnvironmentMap& sky = lights_.environment();
    const Frame frame(receiver.normal());
    Vec3d sum(0);
    for (int start = 0; start < options_.sky_samples; start += RayPacket::size) {
      RayPacket packet{};
      std::array<Vec3d, RayPacket::size> brought{};
      const int lanes = std::min(RayPacket::size, options_.sky_samples - start);
      for (int i = 0; i < lanes; ++i) {
        const auto index = static_cast<std::uint32_t>(start + i);
        const bool by_picture = sky.has_picture() && index % 2 == 1;
        const Vec2d u = receiver.random(sky.has_picture() ? index / 2 : index, by_picture ? 1 : 2);
        const Vec3d direction = by_picture ? sky.sample(u).direction : frame.to_world(sample_cosine_hemisphere(u));
        const double cosine = dot(direction, receiver.normal());
        if (!(cosine > 0)) continue;
        const double density = sky.has_picture() ? 0.5 * (cosine / pi + sky.pdf(direction)) : cosine / pi;
        const Ray ray = leave(receiver.point(index), direction);
        brought[i] = (cosine / density) * Vec3d(sky.radiance(direction)) * left_by_air(ray);
        set_lane(packet, i, ray);
      }
      tracer_.occluded(packet, false);
      for (int i = 0; i < lanes; ++i) {
        if (packet.active[i] != 0) sum += brought[i];
      }
    }
    return sum / static_cast<double>(options_.sky_samples);
  }

  [[nodiscard]] Vec3d left_by_air(const Ray& ray) const {
    return media_.none() ? Vec3d(1) : Vec3d(media_.transmittance(std::nullopt, ray));
  }

  const Scene& scene_;
  const DirectIrradianceOptions& options_;
  Scene occluders_;
  RayTracer tracer_;
  LightSampler lights_;
  Media media_;
  std::vector<std::size_t> used_;  // lights of the sampler that are no elements
  double error_ = 0;
};

/// Divides by the light's strength. A band in which it is dark takes the value of its brightest, unless it has colours
/// of its own (a picture).
Vec3d at_unit_strength(const Vec3d& value, const Vec3d& strength, bool coloured) {
  const int brightest = strength.x >= strength.y && strength.x >= strength.z ? 0 : strength.y >= strength.z ? 1 : 2;
  if (!(strength[brightest] > 0)) return Vec3d(0);
  Vec3d unit(0);
  for (int b = 0; b < 3; ++b) {
    const int from = strength[b] > 0 || coloured ? b : brightest;
    if (strength[from] > 0) unit[b] = value[from] / strength[from];
  }
  return unit;
}

void check(const DirectIrradianceOptions& options) {
  if (options.samples < 1 || options.sky_samples < 1) {
    throw std::invalid_argument("Direct irradiance needs at least one ray from an element to each light.");
  }
}

}  // namespace

DirectIrradiance direct_irradiance(const Scene& scene, const PatchMesh& elements,
                                   const DirectIrradianceOptions& options) {
  check(options);
  PatchMeshOptions whole_faces;
  whole_faces.degenerate = DegenerateFaces::drop;
  whole_faces.duplicates = DuplicateFaces::drop;
  whole_faces.shape_segments = options.shape_segments;
  const MadePatchMesh faces = make_patch_mesh(scene, whole_faces);
  const Gatherer gatherer(scene, faces.mesh, options);
  DirectIrradiance result;
  result.light_power.assign(3, 0);
  const std::size_t lights = gatherer.light_count(), count = elements.surface_count();
  if (lights == 0) return result;

  result.irradiance.assign(3 * count, 0);
  std::vector<Vec3d> by_light(count);
  for (std::size_t light = 0; light < lights; ++light) {
    std::fill(by_light.begin(), by_light.end(), Vec3d(0));
    // Blocks of blocks, so that the caller hears of progress and can stop.
    const std::size_t stride =
        std::max<std::size_t>(elements_a_block, count / 32 / elements_a_block * elements_a_block);
    for (std::size_t start = 0; start < count; start += stride) {
      if (options.progress.stop_requested()) {
        result.partial = true;
        break;
      }
      parallel_for(std::min(stride, count - start), elements_a_block, [&](std::size_t first, std::size_t last) {
        for (std::size_t e = start + first; e < start + last; ++e) {
          by_light[e] = gatherer.irradiance(elements, e, light);
        }
      });
      options.progress.tell("direct light",
                            (static_cast<double>(light) +
                             static_cast<double>(std::min(count, start + stride)) / static_cast<double>(count)) /
                                static_cast<double>(lights));
    }
    LightIrradiance alone;
    alone.light = gatherer.scene_light(light);
    alone.unit.resize(3 * count);
    const Vec3d strength = light_strength(scene, alone.light);
    const bool coloured = gatherer.has_colours_of_its_own(light);
    Vec3d reached(0);
    for (std::size_t e = 0; e < count; ++e) {
      const Vec3d unit = at_unit_strength(by_light[e], strength, coloured);
      for (int b = 0; b < 3; ++b) {
        result.irradiance[3 * e + b] += by_light[e][b];
        alone.unit[3 * e + b] = unit[b];
      }
      reached += elements.areas[e] * by_light[e];
    }
    const Vec3d power = gatherer.flux(light).value_or(reached);
    for (int b = 0; b < 3; ++b) result.light_power[b] += power[b];
    alone.power = at_unit_strength(power, strength, coloured);
    result.lights.push_back(std::move(alone));
  }
  return result;
}

}  // namespace penumbra
