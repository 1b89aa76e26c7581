#include "penumbra/render/element_sight.h"

#include <cmath>

namespace penumbra {
namespace {

// No surface of a man-made scene lies along it.
const Vec3d dividing_direction = normalize(Vec3d(0.5741, 0.7213, 0.3873));
constexpr double same_place = 1e-5;  // two hits of coincident sides, relative to their distance

}  // namespace

ElementSight::ElementSight(const ShadingMesh& shading, std::span<const Vec3d> normals)
    : normals_(normals.begin(), normals.end()), element_of_triangle_(shading.element_of_triangle) {
  halves_[0] = make_half(shading, true);
  halves_[1] = make_half(shading, false);
}

ElementSight::Half ElementSight::make_half(const ShadingMesh& shading, bool positive) const {
  Half half;
  half.scene = std::make_unique<Scene>();
  half.scene->materials.emplace_back();
  Mesh& mesh = half.scene->meshes.emplace_back();
  mesh.positions = shading.positions;
  for (std::uint32_t t = 0; t < shading.triangles.size(); ++t) {
    const Vec3d& n = normals_[element_of_triangle_[t]];
    if ((dot(n, dividing_direction) >= 0) != positive) continue;
    mesh.triangles.push_back(shading.triangles[t]);
    half.triangles.push_back(t);
  }
  half.scene->instances.push_back({"elements", 0, Mat4d(1.0)});
  half.tracer = std::make_unique<RayTracer>(*half.scene);
  return half;
}

std::optional<ElementSight::Place> ElementSight::meet(const Half& half, const Ray& ray) const {
  const std::optional<Hit> hit = half.tracer->nearest(ray);
  if (!hit) return std::nullopt;
  const std::uint32_t triangle = half.triangles[hit->primitive];
  const std::uint32_t element = element_of_triangle_[triangle];
  const Vec2d& b = hit->barycentric;
  return Place{hit->t, triangle, element, {1 - b.x - b.y, b.x, b.y}, dot(normals_[element], ray.direction) < 0};
}

std::optional<ElementSight::Place> ElementSight::nearest(const Ray& ray) const {
  std::optional<Place> seen;
  for (const Half& half : halves_) {
    const std::optional<Place> met = meet(half, ray);
    if (!met) continue;
    const bool same = seen && std::abs(met->distance - seen->distance) <= same_place * met->distance;
    if (!seen || (same ? met->faces && !seen->faces : met->distance < seen->distance)) seen = met;
  }
  return seen;
}

std::optional<ElementSight::Place> ElementSight::at(const Vec3d& point, const Vec3d& side, double reach) const {
  const Ray ray{.origin = point + reach * side, .direction = -side, .t_max = 2 * reach};
  std::optional<Place> closest;
  for (const Half& half : halves_) {
    const std::optional<Place> met = meet(half, ray);
    if (!met || !met->faces) continue;
    if (!closest || std::abs(met->distance - reach) < std::abs(closest->distance - reach)) closest = met;
  }
  return closest;
}

}  // namespace penumbra
