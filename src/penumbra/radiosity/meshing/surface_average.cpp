#include "penumbra/radiosity/meshing/surface_average.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <optional>

#include "penumbra/math/polygon.h"
#include "penumbra/tracing/shading/surface_material.h"

namespace penumbra {
namespace {

/// Sample points along the edge of each triangle of a polygon's fan: few for vertex colours, many for texels.
constexpr double fewest_along_edge = 3;
constexpr double most_along_edge = 128;

SurfacePaint paint_of(const SurfaceMaterial& surface, const Material& material) {
  if (material.unlit) return {};
  SurfacePaint paint;
  paint.reflectance = Vec3d(surface.base_colour) * (1 - double{surface.metallic}) * (1 - double{surface.transmission});
  paint.emission = std::numbers::pi * Vec3d(surface.emission);
  return paint;
}

/// Weights of corners 1 and 2 of a triangle for the point of its plane nearest to `p`.
Vec2d barycentric(const Vec3d& p, const Vec3d& a, const Vec3d& b, const Vec3d& c) {
  const Vec3d n = cross(b - a, c - a);
  const double scale = length_squared(n);
  if (!(scale > 0)) return Vec2d(1.0 / 3);
  return {dot(n, cross(p - a, c - a)) / scale, dot(n, cross(b - a, p - a)) / scale};
}

double twice_uv_area(const Vec2f& a, const Vec2f& b, const Vec2f& c) {
  return std::abs(double{b.x - a.x} * double{c.y - a.y} - double{b.y - a.y} * double{c.x - a.x});
}

std::vector<TextureRef> averaged_textures(const Material& material) {
  std::vector<TextureRef> refs;
  for (const auto& ref : {material.base_colour_texture, material.metallic_roughness_texture,
                          material.transmission_texture, material.emission_texture}) {
    if (ref) refs.push_back(*ref);
  }
  return refs;
}

}  // namespace

/// The surface of one face: finds its point nearest to a place in space.
struct SurfaceAverage::FaceSurface {
  const Scene& scene;
  const PlacedMesh* placed;
  std::uint32_t material;
  Vec3d normal;
  struct Triangle {
    std::uint32_t number;
    Vec3d a, b, c;
  };
  std::vector<Triangle> triangles;

  [[nodiscard]] SurfacePoint at(const Vec3d& p) const {
    if (triangles.empty()) {
      SurfacePoint point;
      point.position = p;
      point.geometric_normal = point.shading_normal = normal;
      point.material = material;
      return point;
    }
    // The triangle in which the point lies deepest, for points on the lines between them are outside by rounding.
    std::size_t best = 0;
    Vec2d best_weights(1.0 / 3);
    double deepest = -std::numeric_limits<double>::infinity();
    for (std::size_t k = 0; k < triangles.size(); ++k) {
      const Triangle& t = triangles[k];
      const Vec2d w = barycentric(p, t.a, t.b, t.c);
      const double depth = std::min({w.x, w.y, 1 - w.x - w.y});
      if (depth <= deepest) continue;
      deepest = depth;
      best = k;
      best_weights = w;
    }
    return placed->point(triangles[best].number, glm::clamp(best_weights, 0.0, 1.0));
  }
};

SurfaceAverage::SurfaceAverage(const Scene& scene, const FaceTable& faces) : scene_(&scene), faces_(&faces) {
  placed_.reserve(scene.instances.size());
  for (const Instance& instance : scene.instances) {
    placed_.emplace_back(scene.meshes[instance.mesh], instance.to_world, false);
  }
}

bool SurfaceAverage::is_even(const Material& material, std::size_t object) const {
  if (material.checker_colour || !averaged_textures(material).empty()) return false;
  return object >= scene_->instances.size() || scene_->meshes[scene_->instances[object].mesh].colours.empty();
}

/// Samples a square metre that see every texel.
double SurfaceAverage::detail(std::uint32_t face, const Material& material, const PlacedMesh& placed) const {
  double finest = material.checker_colour ? 64 / (double{material.checker_size} * material.checker_size) : 0;
  for (const TextureRef& ref : averaged_textures(material)) {
    const TextureImage& image = scene_->images[scene_->textures[ref.texture].image];
    const double stretch =
        std::abs(double{ref.transform[0][0]} * ref.transform[1][1] - double{ref.transform[1][0]} * ref.transform[0][1]);
    for (const std::uint32_t t : faces_->triangles(face)) {
      const SurfacePoint a = placed.point(t, {0, 0}), b = placed.point(t, {1, 0}), c = placed.point(t, {0, 1});
      const int set = ref.uv_set == 1 ? 1 : 0;
      const double texels =
          twice_uv_area(a.uv[set], b.uv[set], c.uv[set]) * stretch * double(image.width) * double(image.height);
      const double area = length(cross(b.position - a.position, c.position - a.position));
      if (area > 0) finest = std::max(finest, texels / area);
    }
  }
  return finest;
}

SurfacePaint SurfaceAverage::over(std::uint32_t face, std::span<const Vec3d> polygon) const {
  const std::size_t object = faces_->object_of(face);
  const std::uint32_t material_number = faces_->material(face);
  const Material& material = scene_->materials[material_number];
  const bool on_mesh = object < scene_->instances.size();
  FaceSurface surface{*scene_, on_mesh ? &placed_[object] : nullptr, material_number, polygon_normal(polygon), {}};
  SurfacePaint sum;
  if (is_even(material, object)) {
    SurfacePoint point;
    point.material = material_number;
    sum = paint_of(surface_material(*scene_, point), material);
  } else {
    for (const std::uint32_t t : faces_->triangles(face)) {
      surface.triangles.push_back({t, placed_[object].point(t, {0, 0}).position,
                                   placed_[object].point(t, {1, 0}).position,
                                   placed_[object].point(t, {0, 1}).position});
    }
    const double samples_per_area = on_mesh ? detail(face, material, placed_[object])
                                            : 64 / (double{material.checker_size} * material.checker_size);
    double weight = 0;
    for (std::size_t k = 2; k < polygon.size(); ++k) {
      const Vec3d e1 = polygon[k - 1] - polygon[0], e2 = polygon[k] - polygon[0];
      const double area = 0.5 * length(cross(e1, e2));
      if (!(area > 0)) continue;
      const auto n = static_cast<int>(
          std::ceil(std::clamp(std::sqrt(area * samples_per_area), fewest_along_edge, most_along_edge)));
      const double share = area / (double(n) * n);
      // The centres of n^2 similar triangles, upright ones and those between.
      for (int j = 0; j < n; ++j) {
        for (int i = 0; i + j < n; ++i) {
          for (int between = 0; between < (i + j + 1 < n ? 2 : 1); ++between) {
            const double third = between == 0 ? 1.0 / 3 : 2.0 / 3;
            const SurfacePoint point = surface.at(polygon[0] + ((i + third) / n) * e1 + ((j + third) / n) * e2);
            const SurfacePaint here = paint_of(surface_material(*scene_, point), scene_->materials[point.material]);
            sum.reflectance += share * here.reflectance;
            sum.emission += share * here.emission;
          }
        }
      }
      weight += area;
    }
    sum.reflectance /= weight;
    sum.emission /= weight;
  }
  sum.reflectance = glm::clamp(sum.reflectance, 0.0, 1.0);
  if (material.double_sided) sum.back_emission = sum.emission;
  return sum;
}

}  // namespace penumbra
