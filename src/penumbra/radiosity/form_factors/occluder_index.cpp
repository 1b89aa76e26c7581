#include "penumbra/radiosity/form_factors/occluder_index.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>

#include "penumbra/radiosity/form_factors/shaft.h"

namespace penumbra {
namespace {

constexpr std::size_t largest_polygon = 32;

struct Span {
  double low = 1e300, high = -1e300;
  void grow(double v) {
    low = std::min(low, v);
    high = std::max(high, v);
  }
};

/// Corners and their distances from an occluder's plane; fixed size, since this runs for each pair in doubt.
struct Heights {
  std::array<double, largest_polygon> value;
  Span range;
  Heights(std::span<const Vec3d> polygon, const Plane3& plane) {
    for (std::size_t c = 0; c < polygon.size(); ++c) {
      value[c] = plane.distance(polygon[c]);
      range.grow(value[c]);
    }
  }
};

/// Polygons on opposite sides of the occluder's plane. The distance from an edge at which a segment crosses the plane,
/// times the sum of its ends' heights, is bilinear in the ends: the corners decide.
Sight sight_across(std::span<const Vec3d> a, const Heights& ha, std::span<const Vec3d> b, const Heights& hb,
                   std::span<const Plane3> planes, double slack) {
  bool hidden = true;
  for (const Plane3& edge : planes.subspan(1)) {
    Span side;
    std::array<double, largest_polygon> eb;
    for (std::size_t j = 0; j < b.size(); ++j) eb[j] = edge.distance(b[j]);
    for (std::size_t i = 0; i < a.size(); ++i) {
      const double ea = edge.distance(a[i]), wa = std::abs(ha.value[i]);
      for (std::size_t j = 0; j < b.size(); ++j) {
        const double wb = std::abs(hb.value[j]), margin = slack * (wa + wb);
        const double s = wb * ea + wa * eb[j];
        side.low = std::min(side.low, s + margin);
        side.high = std::max(side.high, s - margin);
      }
    }
    if (side.high <= 0) return Sight::visible;
    hidden = hidden && side.low >= 0;
  }
  return hidden ? Sight::hidden : Sight::partial;
}

}  // namespace

OccluderIndex::OccluderIndex(const OccluderPolygons& occluders) : occluders_(occluders) {
  for (std::size_t k = 0; k < occluders.size(); ++k) {
    const auto polygon = occluders.polygon(k);
    planes_.push_back(occluders.planes[k]);
    for (std::size_t c = 0; c < polygon.size(); ++c) {
      const Vec3d inwards =
          normalize(cross(occluders.planes[k].normal, polygon[(c + 1) % polygon.size()] - polygon[c]));
      planes_.push_back({inwards, dot(inwards, polygon[c])});
    }
    plane_offsets_.push_back(static_cast<std::uint32_t>(planes_.size()));
  }
  body_slack_.resize(occluders.bodies.size(), 0.0);
  for (std::size_t k = 0; k < occluders.size(); ++k)
    if (const std::uint32_t body = occluders.body[k]; body != ConvexBodies::no_body)
      body_slack_[body] = std::max(body_slack_[body], occluders.slack[k]);
  order_.resize(occluders.size());
  std::iota(order_.begin(), order_.end(), 0U);
  if (!order_.empty()) {
    nodes_.reserve(2 * order_.size());
    nodes_.emplace_back();
    build(0, 0, static_cast<std::uint32_t>(order_.size()));
  }
}

void OccluderIndex::build(std::uint32_t node, std::uint32_t first, std::uint32_t last) {
  Bounds all, centres;
  for (std::uint32_t k = first; k < last; ++k) {
    all.grow(occluders_.bounds[order_[k]]);
    centres.grow(occluders_.bounds[order_[k]].centre());
  }
  nodes_[node].bounds = all;
  if (last - first <= 4) {
    nodes_[node].first = first;
    nodes_[node].count = last - first;
    return;
  }
  const Vec3d side = centres.extent();
  const int axis = side.x >= side.y && side.x >= side.z ? 0 : (side.y >= side.z ? 1 : 2);
  const std::uint32_t middle = (first + last) / 2;
  std::nth_element(order_.begin() + first, order_.begin() + middle, order_.begin() + last,
                   [&](std::uint32_t a, std::uint32_t b) {
                     const double ca = occluders_.bounds[a].centre()[axis], cb = occluders_.bounds[b].centre()[axis];
                     return ca != cb ? ca < cb : a < b;
                   });
  const auto children = static_cast<std::uint32_t>(nodes_.size());
  nodes_[node].first = children;
  nodes_.emplace_back();
  nodes_.emplace_back();
  build(children, first, middle);
  build(children + 1, middle, last);
}

signed char OccluderIndex::side(const PatchClusters::Cluster& a, std::size_t k) const {
  Span height;
  for (const Vec3d& v : a.box) height.grow(occluders_.planes[k].distance(v));
  const bool front = height.low >= -occluders_.slack[k], back = height.high <= occluders_.slack[k];
  return static_cast<signed char>(front == back ? 0 : (front ? 1 : -1));
}

std::uint64_t OccluderIndex::inside_edges(const PatchClusters::Cluster& a, const PatchClusters::Cluster& b,
                                          std::size_t k) const {
  const auto edges = planes(k);
  const double slack = occluders_.slack[k];
  const Heights ha(a.box, edges[0]), hb(b.box, edges[0]);
  std::uint64_t inside = 0;
  for (std::size_t e = 1; e < std::min<std::size_t>(edges.size(), 64); ++e) {
    std::array<double, 8> eb;
    for (std::size_t j = 0; j < 8; ++j) eb[j] = edges[e].distance(b.box[j]);
    bool all = true;
    for (std::size_t i = 0; i < 8 && all; ++i) {
      const double ea = edges[e].distance(a.box[i]), wa = std::abs(ha.value[i]);
      for (std::size_t j = 0; j < 8 && all; ++j) {
        const double wb = std::abs(hb.value[j]);
        all = wb * ea + wa * eb[j] + slack * (wa + wb) >= 0;
      }
    }
    if (all) inside |= std::uint64_t{1} << (e - 1);
  }
  return inside;
}

Sight OccluderIndex::sight(std::span<const Vec3d> a, std::span<const Vec3d> b, std::size_t k) const {
  if (a.size() > largest_polygon || b.size() > largest_polygon) return Sight::partial;
  const auto edges = planes(k);
  const double slack = occluders_.slack[k];
  const Heights ha(a, edges[0]), hb(b, edges[0]);
  const bool a_front = ha.range.low >= -slack, a_back = ha.range.high <= slack;
  const bool b_front = hb.range.low >= -slack, b_back = hb.range.high <= slack;
  if ((a_front && b_front) || (a_back && b_back)) return Sight::visible;
  if ((a_front && b_back) || (a_back && b_front)) return sight_across(a, ha, b, hb, edges, slack);

  // The plane cuts one of them: only parts on opposite sides can be hidden from each other.
  thread_local std::vector<Vec3d> part_a, part_b;
  const Plane3 back{-edges[0].normal, -edges[0].offset};
  for (int side = 0; side < 2; ++side) {
    clip_polygon(a, side == 0 ? edges[0] : back, 0, part_a);
    clip_polygon(b, side == 0 ? back : edges[0], 0, part_b);
    if (part_a.size() < 3 || part_b.size() < 3) continue;
    if (part_a.size() > largest_polygon || part_b.size() > largest_polygon) return Sight::partial;
    if (sight_across(part_a, Heights(part_a, edges[0]), part_b, Heights(part_b, edges[0]), edges, slack) !=
        Sight::visible)
      return Sight::partial;
  }
  return Sight::visible;
}

Sight OccluderIndex::examine(const PatchClusters::Cluster& a, const PatchClusters::Cluster& b, std::size_t k) const {
  const double slack = occluders_.slack[k];
  for (const auto* c : {&a, &b}) {
    if (!c->flat) continue;
    bool behind = true;
    for (const Vec3d& v : occluders_.polygon(k)) behind = behind && c->plane.distance(v) <= slack;
    if (behind) return Sight::visible;
  }
  // A flat cluster's box is a rectangle; a box that is cut by the occluder's plane stays undecided.
  const std::array<Vec3d, 4> rectangle_a{a.box[0], a.box[1], a.box[3], a.box[2]};
  const std::array<Vec3d, 4> rectangle_b{b.box[0], b.box[1], b.box[3], b.box[2]};
  if (a.flat && b.flat) return sight(rectangle_a, rectangle_b, k);
  const std::span<const Vec3d> corners_a = a.flat ? std::span<const Vec3d>(rectangle_a) : std::span<const Vec3d>(a.box);
  const std::span<const Vec3d> corners_b = b.flat ? std::span<const Vec3d>(rectangle_b) : std::span<const Vec3d>(b.box);
  const auto edges = planes(k);
  const Heights ha(corners_a, edges[0]), hb(corners_b, edges[0]);
  const bool a_front = ha.range.low >= -slack, a_back = ha.range.high <= slack;
  const bool b_front = hb.range.low >= -slack, b_back = hb.range.high <= slack;
  if ((a_front && b_front) || (a_back && b_back)) return Sight::visible;
  if (!(a_front && b_back) && !(a_back && b_front)) return Sight::partial;
  const Sight s = sight_across(corners_a, ha, corners_b, hb, edges, slack);
  // A box that touches the plane may hold patches that lie in it, before or behind the occluder.
  const auto touches = [&](const PatchClusters::Cluster& c, const Heights& h) {
    return !c.flat && h.range.low <= slack && h.range.high >= -slack;
  };
  return s == Sight::hidden && (touches(a, ha) || touches(b, hb)) ? Sight::partial : s;
}

Sight OccluderIndex::between(const PatchClusters::Cluster& a, const PatchClusters::Cluster& b,
                             std::vector<std::uint32_t>& found) const {
  found.clear();
  if (nodes_.empty()) return Sight::visible;
  const Shaft shaft(a.bounds, b.bounds);
  std::array<std::uint32_t, 64> stack;
  std::size_t depth = 0;
  stack[depth++] = 0;
  while (depth > 0) {
    const Node& node = nodes_[stack[--depth]];
    if (shaft.misses(node.bounds)) continue;
    if (node.count == 0) {
      stack[depth++] = node.first;
      stack[depth++] = node.first + 1;
      continue;
    }
    for (std::uint32_t n = node.first; n < node.first + node.count; ++n) {
      const std::uint32_t k = order_[n];
      if (shaft.misses(occluders_.bounds[k])) continue;
      const Sight s = examine(a, b, k);
      if (s == Sight::hidden) return Sight::hidden;
      if (s == Sight::partial) found.push_back(k);
    }
  }
  return found.empty() ? Sight::visible : Sight::partial;
}

OccluderIndex::Fronts OccluderIndex::fronts(const PatchClusters::Cluster& a, std::uint32_t body) const {
  Fronts found{true, 0, {}};
  const auto faces = occluders_.bodies.body_planes(body);
  const double slack = body_slack_[body];
  for (std::uint32_t f = 0; f < faces.size() && found.count < found.faces.size(); ++f) {
    if (std::all_of(a.box.begin(), a.box.end(), [&](const Vec3d& v) { return faces[f].distance(v) >= -slack; }))
      found.faces[found.count++] = f;
  }
  return found;
}

bool OccluderIndex::is_back(const PatchClusters::Cluster& a, std::size_t k, const Fronts& fronts) const {
  if (fronts.count == 0) return false;
  const Plane3& own = occluders_.planes[k];
  const double slack = occluders_.slack[k];
  if (!std::all_of(a.box.begin(), a.box.end(), [&](const Vec3d& v) { return own.distance(v) <= slack; })) return false;
  const auto faces = occluders_.bodies.body_planes(occluders_.body[k]);
  return std::any_of(fronts.faces.begin(), fronts.faces.begin() + fronts.count,
                     [&](std::uint32_t f) { return dot(faces[f].normal, own.normal) < 1 - 1e-9; });
}

}  // namespace penumbra
