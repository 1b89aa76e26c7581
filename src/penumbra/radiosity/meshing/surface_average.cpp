#include "penumbra/radiosity/meshing/surface_average.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <optional>

#include "penumbra/math/polygon.h"
#include "penumbra/math/rng.h"
#include "penumbra/math/transform.h"
#include "penumbra/scene/texture_lookup.h"

namespace penumbra {
namespace {

/// Sample points along the edge of each triangle of a polygon's fan: few for vertex colours, more for texels.
constexpr double fewest_along_edge = 3;
constexpr double most_along_edge = 24;

/// What a material reads at a sample.
struct Sample {
  Vec3d position{0};
  Vec2f uv[2]{};
  Vec4f colour{1};
};

bool on_second_colour(const Vec3d& position, const Vec3d& normal, double size) {
  const Vec3d n = glm::abs(normal);
  const int across = n.x > n.y && n.x > n.z ? 0 : (n.y >= n.z ? 1 : 2);
  const double a = std::floor(position[(across + 1) % 3] / size), b = std::floor(position[(across + 2) % 3] / size);
  return std::fmod(std::abs(a + b), 2.0) == 1.0;
}

/// The averaged factors of a material at one sample, as surface_material reads them.
SurfacePaint paint_at(const Scene& scene, const Material& material, const Vec3d& normal, const Sample& sample) {
  if (material.unlit) return {};
  const auto read = [&](std::optional<TextureRef> ref, TexelEncoding encoding) {
    return ref ? texture_value(scene, *ref, sample.uv, encoding) : Vec4f(1);
  };
  const bool second =
      material.checker_colour && on_second_colour(sample.position, normal, double{material.checker_size});
  const Rgb base = second ? *material.checker_colour : material.base_colour;
  const Vec3d colour = glm::clamp(
      Vec3d(base * Rgb(sample.colour) * Rgb(read(material.base_colour_texture, TexelEncoding::srgb))), 0.0, 1.0);
  const double metallic =
      material.metallic *
      read(material.metallic > 0 ? material.metallic_roughness_texture : std::nullopt, TexelEncoding::linear).z;
  const double transmission =
      material.transmission *
      read(material.transmission > 0 ? material.transmission_texture : std::nullopt, TexelEncoding::linear).x;
  SurfacePaint paint;
  paint.reflectance = colour * (1 - metallic) * (1 - transmission);
  if (material.emits()) {
    paint.emission =
        std::numbers::pi * Vec3d(material.emission * Rgb(read(material.emission_texture, TexelEncoding::srgb)));
  }
  return paint;
}

double twice_uv_area(const Vec2f& a, const Vec2f& b, const Vec2f& c) {
  return std::abs(double{b.x - a.x} * double{c.y - a.y} - double{b.y - a.y} * double{c.x - a.x});
}

std::vector<TextureRef> averaged_textures(const Material& material) {
  std::vector<TextureRef> refs;
  const auto add = [&](const std::optional<TextureRef>& ref, bool counts) {
    if (ref && counts) refs.push_back(*ref);
  };
  add(material.base_colour_texture, true);
  add(material.metallic_roughness_texture, material.metallic > 0);
  add(material.transmission_texture, material.transmission > 0);
  add(material.emission_texture, material.emits());
  return refs;
}

template <class T>
T mix(const std::vector<T>& values, const Mesh::Triangle& t, const Vec2d& b) {
  return static_cast<float>(1 - b.x - b.y) * values[t[0]] + static_cast<float>(b.x) * values[t[1]] +
         static_cast<float>(b.y) * values[t[2]];
}

}  // namespace

/// The triangles of one face: finds texture coordinates and colours at a place in space.
struct SurfaceAverage::FaceSurface {
  const Mesh* mesh = nullptr;
  struct Triangle {
    std::uint32_t number;
    Vec3d origin, to_b, to_c;  // dot(to_b, p - origin) is the weight of vertex 1
  };
  std::vector<Triangle> triangles;

  void add(std::uint32_t number, const Vec3d& a, const Vec3d& b, const Vec3d& c) {
    const Vec3d n = cross(b - a, c - a);
    const double scale = length_squared(n);
    if (!(scale > 0)) return;
    triangles.push_back({number, a, cross(c - a, n) / scale, cross(n, b - a) / scale});
  }

  [[nodiscard]] Sample at(const Vec3d& p) const {
    Sample sample;
    sample.position = p;
    if (triangles.empty()) return sample;
    // The triangle in which the point lies deepest, for points on the lines between them are outside by rounding.
    std::size_t best = 0;
    Vec2d weights(0);
    double deepest = -std::numeric_limits<double>::infinity();
    for (std::size_t k = 0; k < triangles.size(); ++k) {
      const Triangle& t = triangles[k];
      const Vec2d w(dot(t.to_b, p - t.origin), dot(t.to_c, p - t.origin));
      const double depth = std::min({w.x, w.y, 1 - w.x - w.y});
      if (depth <= deepest) continue;
      deepest = depth;
      best = k;
      weights = w;
    }
    const Mesh::Triangle& corners = mesh->triangles[triangles[best].number];
    for (int set = 0; set < 2; ++set) {
      if (!mesh->uv[set].empty()) sample.uv[set] = mix(mesh->uv[set], corners, weights);
    }
    if (!mesh->colours.empty()) sample.colour = mix(mesh->colours, corners, weights);
    return sample;
  }
};

SurfaceAverage::SurfaceAverage(const Scene& scene, const FaceTable& faces) : scene_(&scene), faces_(&faces) {}

bool SurfaceAverage::is_even(const Material& material, std::size_t object) const {
  if (material.checker_colour || !averaged_textures(material).empty()) return false;
  return object >= scene_->instances.size() || scene_->meshes[scene_->instances[object].mesh].colours.empty();
}

/// Samples a square metre that see every texel.
double SurfaceAverage::detail(std::uint32_t face, std::size_t object, const Material& material) const {
  double finest = material.checker_colour ? 64 / (double{material.checker_size} * material.checker_size) : 0;
  if (object >= scene_->instances.size()) return finest;
  const Instance& instance = scene_->instances[object];
  const Mesh& mesh = scene_->meshes[instance.mesh];
  for (const TextureRef& ref : averaged_textures(material)) {
    const TextureImage& image = scene_->images[scene_->textures[ref.texture].image];
    const double stretch =
        std::abs(double{ref.transform[0][0]} * ref.transform[1][1] - double{ref.transform[1][0]} * ref.transform[0][1]);
    const auto& uv = mesh.uv[ref.uv_set == 1 ? 1 : 0];
    if (uv.empty()) continue;
    for (const std::uint32_t t : faces_->triangles(face)) {
      const Mesh::Triangle& c = mesh.triangles[t];
      const Vec3d a = transform_point(instance.to_world, mesh.positions[c[0]]);
      const double area = length(cross(transform_point(instance.to_world, mesh.positions[c[1]]) - a,
                                       transform_point(instance.to_world, mesh.positions[c[2]]) - a));
      const double texels =
          twice_uv_area(uv[c[0]], uv[c[1]], uv[c[2]]) * stretch * double(image.width) * double(image.height);
      if (area > 0) finest = std::max(finest, texels / area);
    }
  }
  return finest;
}

SurfaceAverage::FaceSurface SurfaceAverage::surface_of(std::uint32_t face, std::size_t object) const {
  FaceSurface surface;
  if (object >= scene_->instances.size()) return surface;
  const Instance& instance = scene_->instances[object];
  surface.mesh = &scene_->meshes[instance.mesh];
  for (const std::uint32_t t : faces_->triangles(face)) {
    const Mesh::Triangle& c = surface.mesh->triangles[t];
    const auto corner = [&](int k) { return transform_point(instance.to_world, surface.mesh->positions[c[k]]); };
    surface.add(t, corner(0), corner(1), corner(2));
  }
  return surface;
}

SurfacePaint SurfaceAverage::over(std::uint32_t face, std::span<const Vec3d> polygon) const {
  const std::size_t object = faces_->object_of(face);
  const Material& material = scene_->materials[faces_->material(face)];
  SurfacePaint mean = is_even(material, object)
                          ? paint_at(*scene_, material, polygon_normal(polygon), {})
                          : sampled(surface_of(face, object), material, detail(face, object, material), polygon);
  mean.reflectance = glm::clamp(mean.reflectance, 0.0, 1.0);
  if (material.double_sided) mean.back_emission = mean.emission;
  return mean;
}

SurfacePaint SurfaceAverage::sampled(const FaceSurface& surface, const Material& material, double samples_per_area,
                                     std::span<const Vec3d> polygon) const {
  const Vec3d normal = polygon_normal(polygon);
  SurfacePaint sum;
  double weight = 0;
  for (std::size_t k = 2; k < polygon.size(); ++k) {
    const Vec3d e1 = polygon[k - 1] - polygon[0], e2 = polygon[k] - polygon[0];
    const double area = 0.5 * length(cross(e1, e2));
    if (!(area > 0)) continue;
    const double wanted = std::sqrt(area * samples_per_area);
    const auto n = static_cast<int>(std::ceil(std::clamp(wanted, fewest_along_edge, most_along_edge)));
    // Where samples are farther apart than texels they are scattered, lest they keep step with a pattern.
    const double scatter = wanted > most_along_edge ? 1.0 / 3 : 0;
    CounterRng random(k);
    const double share = area / (double(n) * n);
    // The centres of n^2 similar triangles, upright ones and those between.
    for (int j = 0; j < n; ++j) {
      for (int i = 0; i + j < n; ++i) {
        for (int between = 0; between < (i + j + 1 < n ? 2 : 1); ++between) {
          const double third = between == 0 ? 1.0 / 3 : 2.0 / 3;
          const double u = third + scatter * (random.next() - 0.5), v = third + scatter * (random.next() - 0.5);
          const SurfacePaint here =
              paint_at(*scene_, material, normal, surface.at(polygon[0] + ((i + u) / n) * e1 + ((j + v) / n) * e2));
          sum.reflectance += share * here.reflectance;
          sum.emission += share * here.emission;
        }
      }
    }
    weight += area;
  }
  sum.reflectance /= weight;
  sum.emission /= weight;
  return sum;
}

}  // namespace penumbra
