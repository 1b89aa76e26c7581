#include "penumbra/radiosity/form_factors/patch_clusters.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "penumbra/math/quadrature.h"

namespace penumbra {
namespace {

constexpr double normal_weight = 2;  // how much a right angle counts against a node's diagonal
constexpr double layer_gap = 0.05;   // of a node's diagonal: walls farther apart than it do not share a cluster

/// Where patches that face alike lie in layers one behind another, brings the lower ones to the front and returns how
/// many they are; 0 when there is but one layer. The cut is in the widest gap.
std::size_t split_layers(const PatchMesh& mesh, std::span<std::uint32_t> order, double diagonal) {
  Vec3d normal(0);
  for (std::uint32_t p : order) normal += mesh.normals[p];
  if (!(length(normal) > 0.5 * static_cast<double>(order.size()))) return 0;
  normal = normalize(normal);
  std::vector<double> depths;
  for (std::uint32_t p : order) depths.push_back(dot(normal, mesh.centroids[p]));
  std::sort(depths.begin(), depths.end());
  double widest = layer_gap * diagonal, cut = 0;
  for (std::size_t k = 0; k + 1 < depths.size(); ++k) {
    const double gap = depths[k + 1] - depths[k];
    if (gap <= widest * (1 + 1e-6)) continue;
    widest = gap;
    cut = 0.5 * (depths[k] + depths[k + 1]);
  }
  if (widest <= layer_gap * diagonal) return 0;
  const auto middle = std::stable_partition(order.begin(), order.end(),
                                            [&](std::uint32_t p) { return dot(normal, mesh.centroids[p]) < cut; });
  return static_cast<std::size_t>(middle - order.begin());
}

/// Splits [first, last) of `order` until at most PatchClusters::lanes are left: between normals that differ, else
/// between layers, else at the median of the longest side.
void split(const PatchMesh& mesh, std::vector<std::uint32_t>& order, std::size_t first, std::size_t last,
           std::vector<std::pair<std::size_t, std::size_t>>& groups) {
  Bounds places, directions;
  for (std::size_t k = first; k < last; ++k) {
    places.grow(mesh.centroids[order[k]]);
    directions.grow(mesh.normals[order[k]]);
  }
  const Vec3d side = places.extent();
  const Vec3d turn = normal_weight * places.diagonal() * directions.extent();
  int place_axis = 0, turn_axis = 0;
  for (int a = 1; a < 3; ++a) {
    if (side[a] > side[place_axis] * (1 + 1e-6)) place_axis = a;
    if (turn[a] > turn[turn_axis] * (1 + 1e-6)) turn_axis = a;
  }
  if (last - first <= PatchClusters::lanes) {
    groups.emplace_back(first, last);
    return;
  }
  const auto begin = order.begin() + static_cast<std::ptrdiff_t>(first);
  const auto end = order.begin() + static_cast<std::ptrdiff_t>(last);
  std::size_t middle = 0;
  if (turn[turn_axis] > side[place_axis]) {
    const double half = 0.5 * (directions.lower[turn_axis] + directions.upper[turn_axis]);
    const auto cut =
        std::stable_partition(begin, end, [&](std::uint32_t p) { return mesh.normals[p][turn_axis] < half; });
    middle = static_cast<std::size_t>(cut - order.begin());
  }
  if (middle <= first || middle >= last)
    middle = first + split_layers(mesh, std::span(order).subspan(first, last - first), places.diagonal());
  if (middle <= first || middle >= last) {
    // A multiple of the lanes on the left, so that clusters are full.
    const std::size_t half = (last - first) / 2;
    const std::size_t full = (half + PatchClusters::lanes - 1) / PatchClusters::lanes * PatchClusters::lanes;
    middle = first + (full < last - first ? full : half);
    std::nth_element(begin, order.begin() + static_cast<std::ptrdiff_t>(middle), end,
                     [&](std::uint32_t p, std::uint32_t q) {
                       const double a = mesh.centroids[p][place_axis], b = mesh.centroids[q][place_axis];
                       return a != b ? a < b : p < q;
                     });
  }
  split(mesh, order, first, middle, groups);
  split(mesh, order, middle, last, groups);
}

/// An orthonormal frame with z along `normal` and x along the patch's first edge.
std::array<Vec3d, 3> patch_frame(std::span<const Vec3d> polygon, const Vec3d& normal) {
  const Vec3d x = normalize(polygon[1] - polygon[0]);
  return {x, normalize(cross(normal, x)), normal};
}

void set_moment_rule(PatchClusters& c, std::size_t slot, std::span<const Vec3d> polygon, const Vec3d& centroid,
                     const std::array<Vec3d, 3>& frame, double area) {
  // Second moments about the centroid by a fan of triangles; a triangle's is the mean of its edges' midpoints' (exact).
  double xx = 0, xy = 0, yy = 0;
  for (std::size_t k = 0; k < polygon.size(); ++k) {
    const Vec3d a = polygon[k] - centroid, b = polygon[(k + 1) % polygon.size()] - centroid;
    const Vec2d p[3] = {0.5 * Vec2d(dot(a, frame[0]), dot(a, frame[1])),
                        0.5 * Vec2d(dot(b, frame[0]), dot(b, frame[1])),
                        0.5 * Vec2d(dot(a + b, frame[0]), dot(a + b, frame[1]))};
    const double w = dot(cross(a, b), frame[2]) / 6;
    for (const Vec2d& q : p) {
      xx += w * q.x * q.x;
      xy += w * q.x * q.y;
      yy += w * q.y * q.y;
    }
  }
  xx /= area;
  xy /= area;
  yy /= area;
  const double angle = 0.5 * std::atan2(2 * xy, xx - yy);
  const double mean = 0.5 * (xx + yy), spread = std::hypot(0.5 * (xx - yy), xy);
  const Vec3d u = std::cos(angle) * frame[0] + std::sin(angle) * frame[1];
  const Vec3d v = -std::sin(angle) * frame[0] + std::cos(angle) * frame[1];
  const double su = std::sqrt(2 * (mean + spread)), sv = std::sqrt(2 * std::max(0.0, mean - spread));
  const Vec3d points[PatchClusters::rule_points] = {centroid + su * u, centroid - su * u, centroid + sv * v,
                                                    centroid - sv * v};
  for (std::size_t k = 0; k < PatchClusters::rule_points; ++k)
    for (int a = 0; a < 3; ++a) c.rule[k][static_cast<std::size_t>(a)][slot] = points[k][a];
}

void set_fine_rule(PatchClusters& c, std::size_t slot, std::span<const Vec3d> polygon, double area) {
  std::vector<WeightedPoint> points;
  if (polygon.size() <= 4) polygon_rule(polygon, 3, points);
  points.resize(PatchClusters::fine_points, {polygon[0], 0.0});
  for (std::size_t k = 0; k < PatchClusters::fine_points; ++k) {
    for (int a = 0; a < 3; ++a) c.fine[k][static_cast<std::size_t>(a)][slot] = points[k].point[a];
    c.fine[k][3][slot] = points[k].weight / area;
  }
}

/// Whether each corner has a twin opposite the centroid.
bool centrally_symmetric(std::span<const Vec3d> polygon, const Vec3d& centroid, double radius) {
  if (polygon.size() % 2 != 0) return false;
  const std::size_t half = polygon.size() / 2;
  for (std::size_t k = 0; k < half; ++k)
    if (length(polygon[k] + polygon[k + half] - 2.0 * centroid) > 1e-6 * radius) return false;
  return true;
}

void fill_slot(PatchClusters& c, const PatchMesh& mesh, std::size_t slot, std::uint32_t p) {
  const auto polygon = mesh.polygon(p);
  const Vec3d& centroid = mesh.centroids[p];
  const Vec3d& normal = mesh.normals[p];
  c.patch[slot] = p;
  c.area[slot] = mesh.areas[p];
  double radius = 0;
  for (const Vec3d& v : polygon) radius = std::max(radius, length(v - centroid));
  c.radius[slot] = radius;
  c.skew[slot] = centrally_symmetric(polygon, centroid, radius) ? 0.0 : 0.1;
  for (int a = 0; a < 3; ++a) {
    c.centroid[static_cast<std::size_t>(a)][slot] = centroid[a];
    c.normal[static_cast<std::size_t>(a)][slot] = normal[a];
  }
  c.offset[slot] = dot(normal, centroid);
  set_moment_rule(c, slot, polygon, centroid, patch_frame(polygon, normal), mesh.areas[p]);
  set_fine_rule(c, slot, polygon, mesh.areas[p]);
}

void fill_corners(PatchClusters& c, const PatchMesh& mesh, std::size_t index) {
  PatchClusters::Cluster& cluster = c.clusters[index];
  const std::size_t first = index * PatchClusters::lanes;
  for (std::size_t l = 0; l < cluster.count; ++l)
    cluster.corner_count =
        std::max(cluster.corner_count, static_cast<std::uint32_t>(mesh.polygon(c.patch[first + l]).size()));
  cluster.first_corner = c.corners.size();
  c.corners.resize(c.corners.size() + 3 * PatchClusters::lanes * cluster.corner_count);
  const auto frame = patch_frame(mesh.polygon(c.patch[first]), mesh.normals[c.patch[first]]);
  Bounds box;
  for (std::size_t l = 0; l < PatchClusters::lanes; ++l) {
    const auto polygon = mesh.polygon(c.patch[first + l]);
    for (std::size_t k = 0; k < cluster.corner_count; ++k) {
      const Vec3d& v = polygon[std::min(k, polygon.size() - 1)];
      for (int a = 0; a < 3; ++a)
        c.corners[cluster.first_corner + (3 * k + static_cast<std::size_t>(a)) * PatchClusters::lanes + l] = v[a];
      cluster.bounds.grow(v);
      box.grow({dot(v, frame[0]), dot(v, frame[1]), dot(v, frame[2])});
    }
  }
  for (std::size_t k = 0; k < 8; ++k) {
    const Vec3d p{(k & 1) != 0 ? box.upper.x : box.lower.x, (k & 2) != 0 ? box.upper.y : box.lower.y,
                  (k & 4) != 0 ? box.upper.z : box.lower.z};
    cluster.box[k] = p.x * frame[0] + p.y * frame[1] + p.z * frame[2];
  }
  const std::uint32_t p = c.patch[first];
  cluster.plane = {mesh.normals[p], dot(mesh.normals[p], mesh.centroids[p])};
  cluster.flat = box.upper.z - box.lower.z <= 1e-9 * (box.diagonal() + std::abs(box.lower.z));
  for (std::size_t l = 1; l < cluster.count; ++l)
    cluster.flat = cluster.flat && dot(mesh.normals[c.patch[first + l]], cluster.plane.normal) > 0;
}

}  // namespace

PatchClusters make_patch_clusters(const PatchMesh& mesh) {
  std::vector<std::uint32_t> order(mesh.radiating_count);
  std::iota(order.begin(), order.end(), 0U);
  std::vector<std::pair<std::size_t, std::size_t>> groups;
  if (!order.empty()) split(mesh, order, 0, order.size(), groups);

  PatchClusters c;
  const std::size_t slots = groups.size() * PatchClusters::lanes;
  c.clusters.resize(groups.size());
  c.patch.resize(slots);
  for (auto* v : {&c.area, &c.radius, &c.skew, &c.offset}) v->resize(slots);
  for (std::size_t a = 0; a < 3; ++a) {
    c.centroid[a].resize(slots);
    c.normal[a].resize(slots);
    for (auto& point : c.rule) point[a].resize(slots);
  }
  for (std::size_t a = 0; a < 4; ++a) {
    for (auto& point : c.fine) point[a].resize(slots);
  }
  for (std::size_t g = 0; g < groups.size(); ++g) {
    const auto [first, last] = groups[g];
    c.clusters[g].count = static_cast<std::uint32_t>(last - first);
    for (std::size_t l = 0; l < PatchClusters::lanes; ++l)
      fill_slot(c, mesh, g * PatchClusters::lanes + l, order[std::min(first + l, last - 1)]);
    fill_corners(c, mesh, g);
  }
  return c;
}

}  // namespace penumbra
