#include "penumbra/render/radiosity_view.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include "penumbra/radiosity/meshing/sharp_irradiance.h"

namespace penumbra {
namespace {

// No surface of a man-made scene lies along it.
const Vec3d dividing_direction = normalize(Vec3d(0.5741, 0.7213, 0.3873));
constexpr double same_place = 1e-5;  // two hits of coincident sides, relative to their distance
constexpr double outline_strength = 0.75;

double distance_to_segment(const Vec3d& p, const Vec3d& a, const Vec3d& b) {
  const Vec3d along = b - a;
  const double t = std::clamp(dot(p - a, along) / std::max(length_squared(along), 1e-300), 0.0, 1.0);
  return length(p - (a + t * along));
}

}  // namespace

RadiosityView::RadiosityView(const PatchMesh& elements, std::span<const double> irradiance, const Scene& scene,
                             const RadiosityViewOptions& options)
    : shading_(make_shading_mesh(elements)),
      options_(options),
      environment_(scene),
      reflectance_(elements.reflectance),
      emission_(elements.emission) {
  for (std::size_t i = 0; i < elements.radiating_count; ++i) {
    normals_.push_back(elements.normals[i]);
    objects_.push_back(elements.surfaces[i].object);
    if (options.outlines == ElementOutlines::none) continue;
    const auto corners = elements.polygon(i);
    outlines_.emplace_back(corners.begin(), corners.end());
  }
  if (options.smooth && options.lamps != nullptr) {
    SharpIrradiance sharp = sharp_irradiance(*options.lamps, elements, shading_, irradiance);
    shading_ = std::move(sharp.mesh);
    light_ = std::move(sharp.at_vertices);
  } else {
    relight(irradiance);
  }
  halves_[0] = make_half(true);
  halves_[1] = make_half(false);
}

void RadiosityView::relight(std::span<const double> irradiance) {
  if (options_.smooth) {
    light_ = shading_.at_vertices(irradiance, 3);
  } else {
    light_.assign(irradiance.begin(), irradiance.end());
  }
}

RadiosityView::Half RadiosityView::make_half(bool positive) const {
  Half half;
  half.scene = std::make_unique<Scene>();
  half.scene->materials.emplace_back();
  Mesh& mesh = half.scene->meshes.emplace_back();
  mesh.positions = shading_.positions;
  for (std::uint32_t t = 0; t < shading_.triangles.size(); ++t) {
    const Vec3d& n = normals_[shading_.element_of_triangle[t]];
    if ((dot(n, dividing_direction) >= 0) != positive) continue;
    mesh.triangles.push_back(shading_.triangles[t]);
    half.triangles.push_back(t);
  }
  half.scene->instances.push_back({"elements", 0, Mat4d(1.0)});
  half.tracer = std::make_unique<RayTracer>(*half.scene);
  return half;
}

double RadiosityView::outline(std::uint32_t element, const Vec3d& position, double distance) const {
  if (options_.outlines == ElementOutlines::none) return 1;
  const std::vector<Vec3d>& ring = outlines_[element];
  const double width = 0.5 * options_.outline_width * distance;
  for (std::size_t k = 0; k < ring.size(); ++k) {
    if (distance_to_segment(position, ring[k], ring[(k + 1) % ring.size()]) < width) return 1 - outline_strength;
  }
  return 1;
}

RadiosityView::Sight RadiosityView::look(const Ray& ray) const {
  struct Met {
    double t;
    std::uint32_t triangle, element;
    Vec2d weights;
    bool faces;
  };
  std::optional<Met> seen;
  for (const Half& half : halves_) {
    const std::optional<Hit> hit = half.tracer->nearest(ray);
    if (!hit) continue;
    const std::uint32_t triangle = half.triangles[hit->primitive];
    const std::uint32_t element = shading_.element_of_triangle[triangle];
    const Met met{hit->t, triangle, element, hit->barycentric, dot(normals_[element], ray.direction) < 0};
    // Of two sides in one place, the one that faces the ray.
    const bool same = seen && std::abs(met.t - seen->t) <= same_place * met.t;
    if (!seen || (same ? met.faces && !seen->faces : met.t < seen->t)) seen = met;
  }
  Sight sight;
  if (!seen) {
    sight.radiance = environment_.radiance(ray.direction);
    return sight;
  }
  sight.hit = true;
  sight.distance = seen->t;
  sight.position = ray.at(seen->t);
  sight.normal = normals_[seen->element];
  sight.object = objects_[seen->element];
  if (!seen->faces) return sight;

  const double weights[] = {1 - seen->weights.x - seen->weights.y, seen->weights.x, seen->weights.y};
  const double shade = outline(seen->element, sight.position, seen->t) / std::numbers::pi;
  for (std::size_t b = 0; b < 3; ++b) {
    double light = 0;
    if (options_.smooth) {
      for (std::size_t k = 0; k < 3; ++k) light += weights[k] * light_[3 * shading_.triangles[seen->triangle][k] + b];
    } else {
      light = light_[3 * seen->element + b];
    }
    const double rho = reflectance_[3 * seen->element + b], emission = emission_[3 * seen->element + b];
    const int band = static_cast<int>(b);
    sight.albedo[band] = static_cast<float>(rho);
    sight.emission[band] = static_cast<float>(shade * emission);
    sight.radiance[band] = static_cast<float>(shade * (emission + rho * std::max(0.0, light)));
  }
  return sight;
}

}  // namespace penumbra
