#include "penumbra/radiosity/specular/specular_paths.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>

#include "penumbra/math/frame.h"
#include "penumbra/math/polygon.h"
#include "penumbra/math/rng.h"
#include "penumbra/math/sampling.h"
#include "penumbra/math/sobol.h"

namespace penumbra {
namespace {

using std::numbers::pi;

/// Specular elements that fill more of an element's view than this are met by rays spread over the hemisphere; fewer
/// are aimed at.
constexpr double large_share = 0.05;
constexpr int most_rays_a_hit = 4;  // spread rays for each that is wanted to meet a specular element
/// Branches of less weight are followed by chance, with this weight.
constexpr float roulette_weight = 0.1F;
constexpr int deepest = 256;
/// Of the scene's size: how far above a surface its element is looked for.
constexpr double landing_height = 1e-4;
/// Of a round shape's radius: how far its polygons lie inside it at most.
constexpr double roundness = 0.05;

Vec3d point_of(std::span<const Vec3d> polygon, Vec2d u) {
  double area = 0;
  const auto part = [&](std::size_t k) { return length(cross(polygon[k - 1] - polygon[0], polygon[k] - polygon[0])); };
  for (std::size_t k = 2; k < polygon.size(); ++k) area += part(k);
  double below = 0;
  std::size_t k = 2;
  while (k + 1 < polygon.size() && u.x * area >= below + part(k)) below += part(k++);
  u.x = std::clamp((u.x * area - below) / part(k), 0.0, 1.0);
  const Vec2d b = sample_triangle(u);
  return polygon[0] + b.x * (polygon[k - 1] - polygon[0]) + b.y * (polygon[k] - polygon[0]);
}

}  // namespace

/// The visitor of the trees that start at one element or light.
class SpecularPaths::Walker final : public SpecularTree::Visitor {
 public:
  Walker(const SpecularPaths& owner, std::uint64_t key, SpecularLandings::Half& found)
      : owner_(owner), random_(key), found_(found) {}

  [[nodiscard]] std::uint64_t rays() const { return rays_; }

  /// Sends a ray. @param object the ray must meet first, if given, at `distance` (m) when that is finite. False when it
  /// meets no specular surface first; then nothing was noted.
  bool send(const Ray& ray, std::optional<std::uint32_t> object, double distance, double weight) {
    object_ = object;
    distance_ = distance;
    weight_ = static_cast<float>(weight);
    started_ = false;
    ++rays_;
    owner_.tree_.trace(ray, {.start = ray.origin}, *this);
    return started_;
  }

  Rgb surface(const SpecularTree::Node& node) override {
    const Material& material = owner_.scene_.materials[node.point.material];
    if (node.branch.depth == 0) {
      started_ = is_specular(material) && (!object_ || *object_ == node.point.object) && near(node);
      if (!started_) return Rgb(0);
    } else {
      note(node, material);
    }
    follow_gloss(node);
    return Rgb(0);
  }

  Rgb sky(const Ray& ray, const SpecularTree::Branch& branch) override {
    if (branch.depth == 0) return Rgb(0);
    const Vec3d share(weight_ * branch.weight);
    found_.left += share;
    const EnvironmentMap& environment = owner_.lights_.environment();
    if (environment.lights_surfaces()) found_.sky += pi * share * Vec3d(environment.radiance(ray.direction));
    return Rgb(0);
  }

  float followed(const Rgb& weight, int depth) override {
    if (!started_ || depth >= deepest) return 0;
    const float largest = max_component(weight);
    if (largest >= roulette_weight) return 1;
    const float chance = largest / roulette_weight;
    return random_.next() < chance ? 1 / chance : 0;
  }

  void count(bool, int) override { ++rays_; }

 private:
  [[nodiscard]] bool near(const SpecularTree::Node& node) const {
    if (!std::isfinite(distance_)) return true;
    return std::abs(length(node.point.position - node.ray.origin) - distance_) <= 2 * landing_height * owner_.size_;
  }

  void note(const SpecularTree::Node& node, const Material& material) {
    if (is_specular(material) && is_black(node.bsdf.diffuse_reflectance()) && !material.emits()) return;
    const std::uint32_t element = owner_.landing(node.point, node.wo);
    if (element == PatchTracer::no_patch) return;
    found_.landings.push_back({element, weight_ * node.branch.weight});
  }

  /// Metals and glass too rough for the tree: one ray by chance.
  void follow_gloss(const SpecularTree::Node& node) {
    const SurfaceMaterial& s = node.surface;
    if (s.roughness <= static_cast<float>(followed_roughness) || !(s.metallic > 0 || s.transmission > 0)) return;
    const double u_lobe = random_.next(), u = random_.next();
    const auto gloss = node.bsdf.without_base().sample(node.wo, u_lobe, {u, random_.next()});
    if (!gloss || gloss->ideal) return;  // ideal lobes are the tree's
    owner_.tree_.follow(node.point, node.branch, gloss->direction, gloss->weight, gloss->transmitted, *this);
  }

  const SpecularPaths& owner_;
  CounterRng random_;
  SpecularLandings::Half& found_;
  std::optional<std::uint32_t> object_;
  double distance_ = 0;
  float weight_ = 1;
  std::uint64_t rays_ = 0;
  bool started_ = false;
};

SpecularPaths::SpecularPaths(const Scene& scene, const PatchMesh& elements, bool front_sides_only, std::uint64_t seed)
    : scene_(scene),
      elements_(elements),
      tracer_(scene),
      tree_(tracer_, front_sides_only),
      patches_(elements),
      lights_(scene),
      seed_(seed) {
  Bounds all;
  for (const Vec3d& v : elements.vertices) all.grow(v);
  size_ = length(all.upper - all.lower);
}

/// The point of a round shape that a point of its polygons stands for.
Vec3d SpecularPaths::on_surface(std::uint32_t element, const Vec3d& point) const {
  const std::uint32_t object = elements_.surfaces[element].object;
  if (object < scene_.instances.size()) return point;
  const Shape& shape = scene_.shapes[object - scene_.instances.size()].shape;
  if (const auto* sphere = std::get_if<Sphere>(&shape)) {
    return sphere->centre + sphere->radius * normalize(point - sphere->centre);
  }
  if (const auto* cylinder = std::get_if<Cylinder>(&shape)) {
    const Vec3d axis = normalize(cylinder->top - cylinder->base);
    const Vec3d foot = cylinder->base + dot(point - cylinder->base, axis) * axis;
    return foot + cylinder->radius * normalize(point - foot);
  }
  return point;
}

std::uint32_t SpecularPaths::landing(const SurfacePoint& point, const Vec3d& wo) const {
  const bool front = dot(point.geometric_normal, wo) > 0;
  const Vec3d side = front ? point.geometric_normal : -point.geometric_normal;
  const double height = landing_height * size_;
  double above = height, below = height;
  if (point.object >= scene_.instances.size()) {
    // A round shape's polygons lie on its inner side.
    const Shape& shape = scene_.shapes[point.object - scene_.instances.size()].shape;
    const auto* sphere = std::get_if<Sphere>(&shape);
    const auto* cylinder = std::get_if<Cylinder>(&shape);
    const double inside = roundness * (sphere != nullptr ? sphere->radius : cylinder != nullptr ? cylinder->radius : 0);
    (front ? below : above) += inside;
  }
  return patches_.first_front({.origin = point.position + above * side, .direction = -side, .t_max = above + below});
}

/// An element that sends rays, and the specular elements that it sees.
struct SpecularPaths::Sender {
  std::uint32_t element;
  std::span<const SpecularSight> seen;
  std::vector<double> up_to;  // sum of the form factors
  Frame frame;
  SurfacePoint point;
};

/// One ray to a specular element chosen by its form factor; adds its weight to `met` when it gets there.
bool SpecularPaths::aim(const Sender& from, std::uint32_t index, std::uint64_t key, Walker& walker, double& met) const {
  const double choice = owen_sobol_1d(index, key + 3) * from.up_to.back();
  const auto found = std::upper_bound(from.up_to.begin(), from.up_to.end(), choice) - from.up_to.begin();
  const SpecularSight& sight = from.seen[std::min<std::size_t>(static_cast<std::size_t>(found), from.seen.size() - 1)];
  const Vec3d way = point_of(elements_.polygon(sight.element), owen_sobol_2d(index, key + 2)) - from.point.position;
  const double r2 = length_squared(way), r = std::sqrt(r2);
  const double kernel = std::max(0.0, dot(way, from.frame.normal)) *
                        std::max(0.0, -dot(way, elements_.normals[sight.element])) * elements_.areas[sight.element] /
                        (pi * r2 * r2);
  if (!(kernel > 0)) return false;
  const std::uint32_t object = elements_.surfaces[sight.element].object;
  const double weight = kernel / sight.factor;
  const bool met_it =
      walker.send(leave(from.point, way / r), object, object < scene_.instances.size() ? r : INFINITY, weight);
  if (met_it) met += weight;
  return met_it;
}

SpecularLandings SpecularPaths::cast(std::uint32_t element, std::span<const SpecularSight> seen, int rays) const {
  SpecularLandings found;
  Sender from{element, seen, {}, Frame(elements_.normals[element]), {}};
  double all = 0;
  for (const SpecularSight& s : seen) from.up_to.push_back(all += s.factor);
  if (!(all > 0)) return found;
  from.point.error = rounding_error(size_ + largest_component(elements_.centroids[element]));
  from.point.geometric_normal = from.point.shading_normal = from.frame.normal;
  const bool spread = all > large_share;
  const int wanted = (rays + 1) / 2;
  const int count = spread ? static_cast<int>(wanted * std::min<double>(most_rays_a_hit, 1 / all)) : wanted;
  for (std::size_t half = 0; half < 2; ++half) {
    const std::uint64_t key = hash_key(seed_, element, half);
    SpecularLandings::Half& into = found.halves[half];
    Walker walker(*this, key, into);
    double met = 0;
    for (std::uint32_t k = 0; k < static_cast<std::uint32_t>(count); ++k) {
      from.point.position = on_surface(element, point_of(elements_.polygon(element), owen_sobol_2d(k, key + 1)));
      if (!spread) {
        aim(from, k, key, walker, met);
        continue;
      }
      const Vec3d direction = from.frame.to_world(sample_cosine_hemisphere(owen_sobol_2d(k, key + 2)));
      if (walker.send(leave(from.point, direction), std::nullopt, INFINITY, 1)) met += 1;
    }
    // The rays of a half share the form factors among them.
    const double share = met > 0 ? all / met : 0;
    for (auto& landing : into.landings) landing.weight *= static_cast<float>(share);
    into.left *= share;
    into.sky *= share;
    found.rays += walker.rays();
  }
  return found;
}

SpecularLandings SpecularPaths::shoot(std::size_t light, std::span<const std::uint32_t> targets, int rays) const {
  SpecularLandings found;
  const auto& kind = scene_.lights[lights_.light(light).index].kind;
  const auto* far = std::get_if<DirectionalLight>(&kind);
  const auto* lamp = std::get_if<PointLight>(&kind);
  const auto* spot = std::get_if<SpotLight>(&kind);
  const double strength = static_cast<double>(max_component(far != nullptr    ? far->irradiance
                                                            : lamp != nullptr ? lamp->intensity
                                                                              : spot->intensity));
  // Power that a point of an element stands for.
  const auto power = [&](std::uint32_t element, const Vec3d& at) {
    SurfacePoint to;
    to.position = at;
    to.geometric_normal = to.shading_normal = elements_.normals[element];
    const auto sample = lights_.sample_light(light, to, Vec2d(0));
    const double cosine = sample ? dot(sample->direction, elements_.normals[element]) : 0;
    return cosine > 0 ? cosine * elements_.areas[element] * static_cast<double>(max_component(sample->radiance)) : 0;
  };
  std::vector<double> up_to;
  double all = 0;
  for (const std::uint32_t t : targets) up_to.push_back(all += power(t, elements_.centroids[t]));
  if (!(all > 0) || !(strength > 0)) return found;
  const int count = (rays + 1) / 2;
  for (std::size_t half = 0; half < 2; ++half) {
    const std::uint64_t key = hash_key(seed_, ~std::uint64_t{0}, light, half);
    Walker walker(*this, key, found.halves[half]);
    for (std::uint32_t k = 0; k < static_cast<std::uint32_t>(count); ++k) {
      const double choice = owen_sobol_1d(k, key + 3) * all;
      const auto n = std::min<std::size_t>(
          static_cast<std::size_t>(std::upper_bound(up_to.begin(), up_to.end(), choice) - up_to.begin()),
          targets.size() - 1);
      const std::uint32_t target = targets[n];
      const double chance = (up_to[n] - (n > 0 ? up_to[n - 1] : 0)) / all;
      const Vec3d at = point_of(elements_.polygon(target), owen_sobol_2d(k, key + 2));
      const Vec3d origin = far != nullptr    ? at - 4 * size_ * far->direction
                           : lamp != nullptr ? lamp->position
                                             : spot->position;
      const double brought = power(target, at);
      if (!(chance > 0) || !(brought > 0)) continue;
      const std::uint32_t object = elements_.surfaces[target].object;
      const double distance = object < scene_.instances.size() ? length(at - origin) : INFINITY;
      walker.send({.origin = origin, .direction = normalize(at - origin)}, object, distance,
                  brought / (chance * strength * count));
    }
    found.rays += walker.rays();
  }
  return found;
}

}  // namespace penumbra
