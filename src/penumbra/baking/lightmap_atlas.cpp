#include "penumbra/baking/lightmap_atlas.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <map>
#include <numbers>
#include <optional>
#include <span>
#include <stdexcept>
#include <tuple>
#include <utility>

#include "penumbra/baking/chart_layout.h"
#include "penumbra/baking/lightmap_uv_check.h"
#include "penumbra/baking/unfolding.h"
#include "penumbra/math/transform.h"

namespace penumbra {
namespace {

constexpr int default_size = 1024;
constexpr int largest_size = 16384;

void check(const AtlasOptions& o) {
  if (o.size < 0 || o.size > largest_size || o.size % 4 != 0) {
    throw std::invalid_argument(
        fmt::format("an atlas of {} texels a side; take a multiple of 4 up to {}", o.size, largest_size));
  }
  if (!(o.texels_per_metre >= 0) || !std::isfinite(o.texels_per_metre)) {
    throw std::invalid_argument("the density of a lightmap is a positive number of texels a metre");
  }
  if (o.size > 0 && o.texels_per_metre > 0) {
    throw std::invalid_argument("a lightmap's size and its density follow from each other; give one of them");
  }
  if (!(o.chart_angle >= 0 && o.chart_angle <= std::numbers::pi / 2) ||
      !(o.widest_chart_angle <= std::numbers::pi / 2)) {
    throw std::invalid_argument("the angle within a chart is from 0 to pi / 2");
  }
  if (o.mip_levels < 0 || o.mip_levels > 8) {
    throw std::invalid_argument(fmt::format("{} mip levels; take 0 to 8", o.mip_levels));
  }
}

/// Gives every instance a mesh of its own.
Scene with_own_meshes(Scene scene) {
  std::vector<std::size_t> users(scene.meshes.size(), 0);
  for (const Instance& instance : scene.instances) ++users[instance.mesh];
  std::vector<Mesh> meshes;
  meshes.reserve(scene.instances.size());
  for (Instance& instance : scene.instances) {
    Mesh& mesh = scene.meshes[instance.mesh];
    if (--users[instance.mesh] == 0) {
      meshes.push_back(std::move(mesh));
    } else {
      meshes.push_back(mesh);
    }
    instance.mesh = static_cast<std::uint32_t>(meshes.size() - 1);
  }
  scene.meshes = std::move(meshes);
  return scene;
}

Vec3d corner(const Scene& scene, std::size_t instance, const Mesh::Triangle& t, std::size_t k) {
  const Instance& placed = scene.instances[instance];
  return transform_point(placed.to_world, scene.meshes[placed.mesh].positions[t[k]]);
}

/// Areas of all triangles in the world, m^2, and in uv[1].
std::pair<double, double> areas(const Scene& scene) {
  double world = 0, uv_area = 0;
  for (std::size_t i = 0; i < scene.instances.size(); ++i) {
    const Mesh& mesh = scene.meshes[scene.instances[i].mesh];
    for (const Mesh::Triangle& t : mesh.triangles) {
      const Vec3d a = corner(scene, i, t, 0), b = corner(scene, i, t, 1), c = corner(scene, i, t, 2);
      world += 0.5 * length(cross(b - a, c - a));
      const Vec2d p(mesh.uv[1][t[0]]), q = Vec2d(mesh.uv[1][t[1]]) - p, r = Vec2d(mesh.uv[1][t[2]]) - p;
      uv_area += 0.5 * std::abs(q.x * r.y - q.y * r.x);
    }
  }
  return {world, uv_area};
}

/// The islands of the input's uv[1]: triangles that share a vertex's position and coordinates.
void number_islands(LightmapAtlas& atlas) {
  using Corner = std::tuple<double, double, double, float, float>;
  atlas.chart_of_triangle.resize(atlas.first_triangle.back());
  for (std::size_t i = 0; i < atlas.scene.instances.size(); ++i) {
    const Mesh& mesh = atlas.scene.meshes[i];
    std::map<Corner, std::uint32_t> number;
    std::vector<std::uint32_t> parent(mesh.positions.size());
    const auto root = [&](std::uint32_t v) {
      while (parent[v] != v) v = parent[v] = parent[parent[v]];
      return v;
    };
    for (std::uint32_t v = 0; v < parent.size(); ++v) {
      const Vec3d& p = mesh.positions[v];
      const Vec2f& uv = mesh.uv[1][v];
      parent[v] = number.try_emplace({p.x, p.y, p.z, uv.x, uv.y}, v).first->second;
    }
    for (const Mesh::Triangle& t : mesh.triangles) {
      for (std::size_t k = 1; k < 3; ++k) {
        const std::uint32_t a = root(t[0]), b = root(t[k]);
        parent[std::max(a, b)] = std::min(a, b);
      }
    }
    std::map<std::uint32_t, std::uint32_t> island_of;
    for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
      const auto [island, fresh] =
          island_of.try_emplace(root(mesh.triangles[t][0]), static_cast<std::uint32_t>(atlas.charts.size()));
      if (fresh) atlas.charts.push_back({.object = static_cast<std::uint32_t>(i)});
      atlas.chart_of_triangle[atlas.first_triangle[i] + t] = island->second;
    }
  }
}

/// Sets each island's box.
void measure_islands(LightmapAtlas& atlas) {
  constexpr double infinity = std::numeric_limits<double>::infinity();
  std::vector<std::pair<Vec2d, Vec2d>> boxes(atlas.charts.size(), {Vec2d(infinity), Vec2d(-infinity)});
  for (std::size_t i = 0; i < atlas.scene.instances.size(); ++i) {
    const Mesh& mesh = atlas.scene.meshes[i];
    for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
      auto& [lower, upper] = boxes[atlas.chart_of_triangle[atlas.first_triangle[i] + t]];
      for (const std::uint32_t v : mesh.triangles[t]) {
        const Vec2d texel = Vec2d(mesh.uv[1][v]) * Vec2d(atlas.width, atlas.height);
        lower = glm::min(lower, texel);
        upper = glm::max(upper, texel);
      }
    }
  }
  for (std::size_t c = 0; c < boxes.size(); ++c) {
    Chart& chart = atlas.charts[c];
    chart.x = std::clamp(static_cast<int>(boxes[c].first.x + 1e-3), 0, atlas.width - 1);
    chart.y = std::clamp(static_cast<int>(boxes[c].first.y + 1e-3), 0, atlas.height - 1);
    chart.width = std::clamp(static_cast<int>(std::ceil(boxes[c].second.x - 1e-3)) - chart.x, 1, atlas.width - chart.x);
    chart.height =
        std::clamp(static_cast<int>(std::ceil(boxes[c].second.y - 1e-3)) - chart.y, 1, atlas.height - chart.y);
  }
}

LightmapAtlas atlas_of_input(Scene scene, const AtlasOptions& options) {
  LightmapAtlas atlas;
  atlas.from_input = true;
  atlas.scene = std::move(scene);
  const auto [world, uv_area] = areas(atlas.scene);
  const double per_side = std::sqrt(world / uv_area);  // m that the whole square is wide
  int size = options.size > 0 ? options.size : default_size;
  if (options.texels_per_metre > 0) {
    const double wanted = options.texels_per_metre * per_side;
    if (!(wanted <= largest_size)) {
      throw std::invalid_argument(
          fmt::format("at {} texels a metre the atlas would be larger than {} texels a side; "
                      "ask for fewer",
                      options.texels_per_metre, largest_size));
    }
    size = std::max(4, (static_cast<int>(std::ceil(wanted)) + 3) / 4 * 4);
  }
  atlas.width = atlas.height = size;
  atlas.texels_per_metre = size / per_side;
  atlas.first_triangle = number_triangles(atlas.scene);
  number_islands(atlas);
  measure_islands(atlas);
  return atlas;
}

/// Whether charts would be so small that an atlas of them were mostly padding.
bool mostly_padding(const Unfolding& unfolding, const AtlasOptions& options) {
  constexpr double fair_side = 8;  // texels
  const auto count = static_cast<double>(unfolding.planes.size());
  if (options.texels_per_metre > 0) {
    double area = 0;
    for (const ChartPlane& plane : unfolding.planes) area += plane.size.x * plane.size.y;
    return area * options.texels_per_metre * options.texels_per_metre < fair_side * fair_side * count;
  }
  const double side = options.size > 0 ? options.size : default_size;
  const double padded = fair_side + chart_padding(options);
  return side * side < padded * padded * count;
}

/// The copies of a mesh's vertices, one for each chart that they are in.
class VertexCopies {
 public:
  explicit VertexCopies(std::size_t vertices) : chart_(vertices, none), next_(vertices, none) {}

  /// The copy of `vertex` for a chart: the vertex itself for the first that asks.
  std::uint32_t of(std::uint32_t vertex, std::uint32_t chart) {
    std::uint32_t v = vertex;
    if (chart_[v] == none) chart_[v] = chart;
    while (chart_[v] != chart) {
      if (next_[v] == none) {
        next_[v] = static_cast<std::uint32_t>(chart_.size());
        chart_.push_back(chart);
        next_.push_back(none);
        source_.push_back(vertex);
      }
      v = next_[v];
    }
    return v;
  }

  /// Appends the copies' values to an array that is per vertex, or empty.
  template <class Value>
  void append(std::vector<Value>& values) const {
    if (values.empty()) return;
    values.reserve(chart_.size());
    for (const std::uint32_t v : source_) values.push_back(values[v]);
  }

  [[nodiscard]] std::size_t count() const { return chart_.size(); }
  /// `none` for a vertex that no triangle uses.
  [[nodiscard]] std::uint32_t chart(std::size_t v) const { return chart_[v]; }
  static constexpr std::uint32_t none = std::numeric_limits<std::uint32_t>::max();

 private:
  std::vector<std::uint32_t> chart_, next_, source_;
};

std::array<std::optional<TextureRef>*, 7> texture_refs(Material& m) {
  return {&m.base_colour_texture,  &m.metallic_roughness_texture, &m.normal_texture,         &m.emission_texture,
          &m.transmission_texture, &m.specular_texture,           &m.specular_colour_texture};
}

/// The atlas takes the second set of texture coordinates: materials that read it are told to read the first. Returns
/// by material whether it was one.
std::vector<std::uint8_t> free_second_set(Scene& scene) {
  std::vector<std::uint8_t> moved(scene.materials.size(), 0);
  for (std::size_t i = 0; i < moved.size(); ++i) {
    Material& m = scene.materials[i];
    bool first = false, second = false;
    for (std::optional<TextureRef>* ref : texture_refs(m)) {
      if (ref->has_value()) ((*ref)->uv_set == 0 ? first : second) = true;
    }
    if (first && second) {
      throw std::invalid_argument(
          fmt::format("material '{}' reads both TEXCOORD_0 and TEXCOORD_1, which leaves none for "
                      "a lightmap; let its textures share one set",
                      m.name));
    }
    if (!second) continue;
    moved[i] = 1;
    for (std::optional<TextureRef>* ref : texture_refs(m)) {
      if (ref->has_value()) (*ref)->uv_set = 0;
    }
  }
  return moved;
}

/// Vertices of one material each: those of materials that read the second set have it as their first.
void move_second_set(Mesh& mesh, const std::vector<std::uint8_t>& moved) {
  if (mesh.uv[1].empty() || std::ranges::none_of(mesh.materials, [&](std::uint32_t m) { return moved[m] != 0; }))
    return;
  mesh.uv[0].resize(mesh.positions.size(), Vec2f(0));
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    if (moved[mesh.material_of(t)] == 0) continue;
    for (const std::uint32_t v : mesh.triangles[t]) mesh.uv[0][v] = mesh.uv[1][v];
  }
}

/// Writes the places of the charts into uv[1]; vertices of several charts are doubled.
void place_corners(Mesh& mesh, const std::vector<std::uint8_t>& moved, const Mat4d& to_world,
                   std::span<const std::uint32_t> chart_of, const std::vector<ChartPlane>& planes,
                   const LightmapAtlas& atlas) {
  VertexCopies copies(mesh.positions.size());
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    for (std::uint32_t& v : mesh.triangles[t]) v = copies.of(v, chart_of[t]);
  }
  copies.append(mesh.positions);
  copies.append(mesh.normals);
  copies.append(mesh.tangents);
  copies.append(mesh.uv[0]);
  copies.append(mesh.uv[1]);
  copies.append(mesh.colours);
  move_second_set(mesh, moved);
  mesh.uv[1].assign(copies.count(), Vec2f(0));
  for (std::size_t v = 0; v < copies.count(); ++v) {
    if (copies.chart(v) == VertexCopies::none) continue;
    const ChartPlane& plane = planes[copies.chart(v)];
    const Chart& box = atlas.charts[copies.chart(v)];
    const Vec2d metres = plane.project(transform_point(to_world, mesh.positions[v]));
    const Vec2d texels(box.width, box.height);
    Vec2d at(box.x, box.y);
    for (int k = 0; k < 2; ++k) at[k] += texels[k] * (plane.size[k] > 0 ? metres[k] / plane.size[k] : 0.5);
    mesh.uv[1][v] = Vec2f(at / Vec2d(atlas.width, atlas.height));
  }
}

}  // namespace

LightmapAtlas make_lightmap_atlas(Scene scene, const AtlasOptions& options) {
  check(options);
  if (!scene.shapes.empty()) throw std::invalid_argument("exact shapes have no atlas; take tessellated() first");
  scene = with_own_meshes(std::move(scene));
  if (options.keep_input && !lightmap_uv_fault(scene)) return atlas_of_input(std::move(scene), options);

  const std::vector<std::uint8_t> moved = free_second_set(scene);
  double angle = options.chart_angle;
  Unfolding unfolding = unfold(scene, angle);
  while (2 * angle <= options.widest_chart_angle && angle > 0 && mostly_padding(unfolding, options)) {
    angle *= 2;
    unfolding = unfold(scene, angle);
  }
  std::vector<Vec2d> sizes;
  sizes.reserve(unfolding.planes.size());
  for (const ChartPlane& plane : unfolding.planes) sizes.push_back(plane.size);
  ChartLayout layout = lay_out_charts(sizes, options);

  LightmapAtlas atlas;
  atlas.scene = std::move(scene);
  atlas.width = std::max(4, layout.width);
  atlas.height = std::max(4, layout.height);
  atlas.texels_per_metre = layout.texels_per_metre;
  atlas.charts = std::move(layout.charts);
  for (std::size_t c = 0; c < atlas.charts.size(); ++c) atlas.charts[c].object = unfolding.objects[c];
  for (std::size_t i = 0; i < atlas.scene.instances.size(); ++i) {
    const auto chart_of =
        std::span<const std::uint32_t>(unfolding.chart_of_triangle)
            .subspan(unfolding.first_triangle[i], unfolding.first_triangle[i + 1] - unfolding.first_triangle[i]);
    place_corners(atlas.scene.meshes[i], moved, atlas.scene.instances[i].to_world, chart_of, unfolding.planes, atlas);
  }
  atlas.first_triangle = std::move(unfolding.first_triangle);
  atlas.chart_of_triangle = std::move(unfolding.chart_of_triangle);
  return atlas;
}

}  // namespace penumbra
