#include "penumbra/baking/unfolding.h"

#include <algorithm>
#include <cmath>
#include <span>

#include "penumbra/baking/chart_growth.h"
#include "penumbra/baking/lightmap_uv_check.h"

namespace penumbra {
namespace {

/// Members of groups that lie one after the other.
struct Groups {
  std::vector<std::uint32_t> first, members;

  [[nodiscard]] std::size_t count() const { return first.size() - 1; }
  [[nodiscard]] std::span<const std::uint32_t> group(std::size_t g) const {
    return std::span(members).subspan(first[g], first[g + 1] - first[g]);
  }
};

Groups grouped(const std::vector<std::uint32_t>& group_of) {
  Groups groups;
  const std::uint32_t count = group_of.empty() ? 0 : *std::ranges::max_element(group_of) + 1;
  groups.first.assign(count + 1, 0);
  for (const std::uint32_t g : group_of) ++groups.first[g + 1];
  for (std::size_t g = 0; g < count; ++g) groups.first[g + 1] += groups.first[g];
  groups.members.resize(group_of.size());
  std::vector<std::uint32_t> next(groups.first.begin(), groups.first.end() - 1);
  for (std::size_t t = 0; t < group_of.size(); ++t) groups.members[next[group_of[t]]++] = static_cast<std::uint32_t>(t);
  return groups;
}

ChartPlane plane_of(const Mesh& mesh, const PlacedTriangles& surface, std::span<const std::uint32_t> triangles) {
  std::vector<Vec3d> points;
  points.reserve(3 * triangles.size());
  Vec3d normal(0);
  for (const std::uint32_t t : triangles) {
    for (const std::uint32_t v : mesh.triangles[t]) points.push_back(surface.positions[v]);
    normal += surface.area_vectors[t];
  }
  return chart_plane(points, normal);
}

bool folds_over(const Mesh& mesh, const PlacedTriangles& surface, std::span<const std::uint32_t> triangles) {
  if (triangles.size() < 2) return false;
  const ChartPlane plane = plane_of(mesh, surface, triangles);
  std::vector<UvTriangle> flat;
  flat.reserve(triangles.size());
  for (const std::uint32_t t : triangles) {
    UvTriangle corners;
    for (std::size_t k = 0; k < 3; ++k) corners[k] = plane.project(surface.positions[mesh.triangles[t][k]]);
    flat.push_back(corners);
  }
  return find_overlap(flat, 1e-4 * std::sqrt(plane.size.x * plane.size.y)).has_value();
}

/// Renumbered in order of their first triangles.
void put_in_order(std::vector<std::uint32_t>& chart_of) {
  if (chart_of.empty()) return;
  std::vector<std::uint32_t> renamed(*std::ranges::max_element(chart_of) + 1, ungrown);
  std::uint32_t count = 0;
  for (std::uint32_t& chart : chart_of) {
    if (renamed[chart] == ungrown) renamed[chart] = count++;
    chart = renamed[chart];
  }
}

/// Charts of one mesh, none folding over itself.
std::vector<std::uint32_t> flat_charts(const Mesh& mesh, const PlacedTriangles& surface, double angle) {
  constexpr double flat = 1e-3;  // rad; what overlaps there lies twice in one place, and may share its texels
  std::vector<std::uint32_t> chart_of = grow_charts(surface, angle);
  Groups charts = grouped(chart_of);
  std::vector<std::uint32_t> numbers(charts.count());
  for (std::size_t c = 0; c < numbers.size(); ++c) numbers[c] = static_cast<std::uint32_t>(c);
  for (double finer = angle; finer > flat && !numbers.empty();) {
    finer /= 2;
    auto end = static_cast<std::uint32_t>(charts.count());
    const std::uint32_t first_new = end;
    for (const std::uint32_t c : numbers) {
      const auto triangles = charts.group(c);
      if (!folds_over(mesh, surface, triangles)) continue;
      for (const std::uint32_t t : triangles) chart_of[t] = ungrown;
      end = grow_charts(surface, triangles, finer, end, chart_of);
    }
    numbers.clear();
    for (std::uint32_t c = first_new; c < end; ++c) numbers.push_back(c);
    if (!numbers.empty()) charts = grouped(chart_of);
  }
  put_in_order(chart_of);
  return chart_of;
}

}  // namespace

std::vector<std::uint32_t> number_triangles(const Scene& scene) {
  std::vector<std::uint32_t> first{0};
  for (const Instance& instance : scene.instances) {
    first.push_back(first.back() + static_cast<std::uint32_t>(scene.meshes[instance.mesh].triangles.size()));
  }
  return first;
}

Unfolding unfold(const Scene& scene, double chart_angle) {
  Unfolding all;
  all.first_triangle = number_triangles(scene);
  all.chart_of_triangle.reserve(all.first_triangle.back());
  for (std::size_t i = 0; i < scene.instances.size(); ++i) {
    const Mesh& mesh = scene.meshes[scene.instances[i].mesh];
    const PlacedTriangles surface = place_triangles(mesh, scene.instances[i].to_world);
    const std::vector<std::uint32_t> chart_of = flat_charts(mesh, surface, chart_angle);
    const auto first_chart = static_cast<std::uint32_t>(all.planes.size());
    for (const std::uint32_t chart : chart_of) all.chart_of_triangle.push_back(first_chart + chart);
    const Groups charts = grouped(chart_of);
    for (std::size_t c = 0; c < charts.count(); ++c) {
      all.planes.push_back(plane_of(mesh, surface, charts.group(c)));
      all.objects.push_back(static_cast<std::uint32_t>(i));
    }
  }
  return all;
}

}  // namespace penumbra
