#include "penumbra/render/radiosity_view.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include "penumbra/radiosity/meshing/sharp_irradiance.h"

namespace penumbra {
namespace {

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
      media_(scene),
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
  sight_ = std::make_unique<ElementSight>(shading_, normals_);
}

void RadiosityView::relight(std::span<const double> irradiance) {
  if (options_.smooth) {
    light_ = shading_.at_vertices(irradiance, 3);
  } else {
    light_.assign(irradiance.begin(), irradiance.end());
  }
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
  Sight sight = look_through_clear_air(ray);
  if (media_.none()) return sight;
  Ray way = ray;
  if (sight.hit) way.t_max = sight.distance;
  const Rgb left = media_.transmittance(std::nullopt, way);
  sight.radiance *= left;
  sight.emission *= left;
  return sight;
}

RadiosityView::Sight RadiosityView::look_through_clear_air(const Ray& ray) const {
  const std::optional<ElementSight::Place> seen = sight_->nearest(ray);
  Sight sight;
  if (!seen) {
    sight.radiance = environment_.radiance(ray.direction);
    return sight;
  }
  sight.hit = true;
  sight.distance = seen->distance;
  sight.position = ray.at(seen->distance);
  sight.normal = normals_[seen->element];
  sight.object = objects_[seen->element];
  if (!seen->faces) return sight;

  const double shade = outline(seen->element, sight.position, seen->distance) / std::numbers::pi;
  for (std::size_t b = 0; b < 3; ++b) {
    double light = 0;
    if (options_.smooth) {
      for (std::size_t k = 0; k < 3; ++k)
        light += seen->weights[k] * light_[3 * shading_.triangles[seen->triangle][k] + b];
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
