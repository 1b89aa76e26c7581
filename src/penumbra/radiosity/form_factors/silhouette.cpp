#include "penumbra/radiosity/form_factors/silhouette.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace penumbra {
namespace {

// Squared sine of an angle; vertices are moved by 1e-8 of their polygons' size.
constexpr double straight = 1e-13;

bool is_rim(const Silhouette::Edge& e) { return e.step != 0 || e.first != e.last; }

/// On which side of the line from a to b the line from `eye` to `to` passes: antisymmetric in a and b, so that
/// polygons that share an edge agree.
double side_of(const Vec3d& a, const Vec3d& b, const Vec3d& eye, const Vec3d& to) {
  return dot(cross(b - eye, a - eye), to - eye);
}

/// On which side of a plane the receiver is.
struct Range {
  double low = std::numeric_limits<double>::infinity(), high = -low;
  Range(const Plane3& plane, std::span<const Vec3d> receiver) {
    for (const Vec3d& p : receiver) {
      const double d = plane.distance(p);
      low = std::min(low, d);
      high = std::max(high, d);
    }
  }
  [[nodiscard]] bool turns() const { return low < 0 && high > 0; }
  [[nodiscard]] double sign() const { return low >= 0 ? 1 : -1; }
};

/// A point inside a polygon whose place repeats no regular pattern.
Vec3d odd_point(std::span<const Vec3d> polygon) {
  Vec3d sum(0);
  double weights = 0;
  for (std::size_t c = 0; c < polygon.size(); ++c) {
    const double weight = 1 + 0.37 * std::sin(1.9 * static_cast<double>(c) + 0.7);
    sum += weight * polygon[c];
    weights += weight;
  }
  return sum / weights;
}

}  // namespace

void Silhouette::Memory::forget(std::size_t size) {
  if (value.size() < size) {
    value.resize(size);
    age.resize(size, now);
  }
  if (++now == std::numeric_limits<std::uint32_t>::max()) {
    std::fill(age.begin(), age.end(), 0U);
    now = 1;
  }
}

std::uint32_t& Silhouette::Memory::at(std::uint32_t key, std::uint32_t otherwise) {
  if (age[key] != now) {
    age[key] = now;
    value[key] = otherwise;
  }
  return value[key];
}

void Silhouette::clear() {
  polygon_count_ = 0;
  has_reference_ = false;
  vertices_.clear();
  edges_.clear();
  turning_.clear();
  planes_.clear();
  heights_.clear();
  pending_.clear();
}

/// What stands on one of the planes is not cut by it: such a vertex moves into the horizon, or stays.
std::uint32_t Silhouette::vertex(const OccluderPolygons& occluders, std::uint32_t v, const Plane3& horizon,
                                 const Plane3& source, double slack) {
  std::uint32_t& known = vertex_of_.at(v, none);
  if (known == none) {
    known = static_cast<std::uint32_t>(vertices_.size());
    Vec3d p = occluders.vertices[v];
    std::array<double, 2> heights{horizon.distance(p), source.distance(p)};
    if (std::abs(heights[0]) <= 2 * slack) {
      p -= heights[0] * horizon.normal;
      heights[0] = 0;
    }
    if (std::abs(heights[1]) <= slack) heights[1] = 0;
    vertices_.push_back(p);
    heights_.push_back(heights);
  }
  return known;
}

/// Where the edge a-b meets a plane: the same vertex for all polygons that share the edge.
std::uint32_t Silhouette::cut(int plane, std::uint32_t edge, std::uint32_t a, std::uint32_t b) {
  const auto which = static_cast<std::size_t>(plane);
  const auto fresh = static_cast<std::uint32_t>(vertices_.size());
  if (edge != none) {
    const std::uint32_t known = cut_of_[which].at(edge, fresh);
    if (known != fresh) return known;
  }
  const double t = heights_[a][which] / (heights_[a][which] - heights_[b][which]);
  vertices_.push_back(vertices_[a] + t * (vertices_[b] - vertices_[a]));
  std::array<double, 2> heights;
  for (std::size_t k = 0; k < 2; ++k) heights[k] = heights_[a][k] + t * (heights_[b][k] - heights_[a][k]);
  heights[which] = 0;
  heights_.push_back(heights);
  return fresh;
}

/// Keeps the part of `ring_` on which the height over a plane is not negative. A corner on the plane is cut off as it
/// is: two vertices in one place would seem to be apart.
void Silhouette::clip(int plane) {
  const auto which = static_cast<std::size_t>(plane);
  clipped_.clear();
  for (std::size_t c = 0; c < ring_.size(); ++c) {
    const Corner& here = ring_[c];
    const std::uint32_t next = ring_[c + 1 == ring_.size() ? 0 : c + 1].vertex;
    const double height = heights_[here.vertex][which], next_height = heights_[next][which];
    const bool in = height >= 0, next_in = next_height >= 0;
    if (in) clipped_.push_back({here.vertex, height == 0 && !next_in ? none : here.edge});
    if (in == next_in || height == 0 || next_height == 0) continue;
    const std::uint32_t at = cut(plane, here.edge, here.vertex, next);
    clipped_.push_back({at, in ? none : here.edge});
  }
  ring_.swap(clipped_);
}

/// The number of a plane; neighbours that lie in one plane turn as one.
std::uint32_t Silhouette::turning_plane(const Plane3& plane, double slack) {
  const auto same = std::find_if(planes_.begin(), planes_.end(), [&](const Plane3& p) {
    return std::abs(p.offset - plane.offset) <= slack && length_squared(p.normal - plane.normal) <= 1e-18;
  });
  const auto number = static_cast<std::uint32_t>(same - planes_.begin());
  if (same == planes_.end()) planes_.push_back(plane);
  return number;
}

/// One polygon's side of an edge.
void Silhouette::add_side(std::uint32_t edge, double direction, const Plane3& plane, double sign, bool turns,
                          double slack) {
  Edge& e = edges_[edge];
  if (!turns) {
    e.step += direction * sign;
    e.reference_step += direction * sign;
    return;
  }
  pending_.push_back({edge, {turning_plane(plane, slack), direction}});
  // When the reference line passes the edge its ends are on either side of the polygon.
  if (has_reference_) e.reference_step += plane.distance(reference_.to) < 0 ? direction : -direction;
}

void Silhouette::add_sides(const Plane3& plane, double slack, std::span<const Vec3d> receiver) {
  const Range side(plane, receiver);
  for (std::size_t c = 0; c < ring_.size(); ++c) {
    const std::uint32_t from = ring_[c].vertex, to = ring_[c + 1 == ring_.size() ? 0 : c + 1].vertex;
    const auto fresh = static_cast<std::uint32_t>(edges_.size());
    const std::uint32_t e = ring_[c].edge == none ? fresh : edge_of_.at(ring_[c].edge, fresh);
    if (e == fresh) edges_.push_back({from, to, 0, 0, 0, false, 0});
    add_side(e, edges_[e].from == from ? 1 : -1, plane, side.sign(), side.turns(), slack);
  }
}

/// Adds an edge of the surface.
void Silhouette::add_rim(const OccluderPolygons& occluders, const Rim& rim, std::span<const Vec3d> receiver,
                         const Plane3& horizon, const Plane3& source) {
  const std::uint32_t first = occluders.corner_offsets[rim.occluder], last = occluders.corner_offsets[rim.occluder + 1];
  const std::uint32_t here = first + rim.corner, next = here + 1 == last ? first : here + 1;
  const std::uint32_t from = vertex(occluders, occluders.corner_vertices[here], horizon, source, slack_);
  const std::uint32_t to = vertex(occluders, occluders.corner_vertices[next], horizon, source, slack_);
  const auto fresh = static_cast<std::uint32_t>(edges_.size());
  const std::uint32_t e = edge_of_.at(occluders.corner_edges[here], fresh);
  if (e == fresh) edges_.push_back({from, to, 0, 0, 0, false, 0});
  const Range side(occluders.planes[rim.occluder], receiver);
  add_side(e, edges_[e].from == from ? 1 : -1, occluders.planes[rim.occluder], side.sign(), side.turns(),
           occluders.slack[rim.occluder]);
}

/// Sorts the turning polygons to their edges; two of one plane on either side of an edge are none.
void Silhouette::assign_turning_polygons() {
  if (pending_.empty()) return;
  std::stable_sort(pending_.begin(), pending_.end(), [](const auto& a, const auto& b) { return a.first < b.first; });
  for (std::size_t k = 0; k < pending_.size();) {
    Edge& edge = edges_[pending_[k].first];
    edge.first = static_cast<std::uint32_t>(turning_.size());
    const std::uint32_t e = pending_[k].first;
    for (; k < pending_.size() && pending_[k].first == e; ++k) {
      const Turning& t = pending_[k].second;
      const auto opposite = std::find_if(turning_.begin() + edge.first, turning_.end(), [&](const Turning& u) {
        return u.plane == t.plane && u.direction == -t.direction;
      });
      if (opposite == turning_.end()) {
        turning_.push_back(t);
      } else {
        turning_.erase(opposite);
      }
    }
    edge.last = static_cast<std::uint32_t>(turning_.size());
  }
}

/// Makes one edge of two that go straight on, where nothing else meets them: rims of walls that were cut into pieces.
void Silhouette::join_straight_edges() {
  bool joined = false;
  meeting_.assign(vertices_.size(), {});
  for (std::uint32_t e = 0; e < edges_.size(); ++e) {
    if (!is_rim(edges_[e])) continue;
    for (std::uint32_t v : {edges_[e].from, edges_[e].to}) {
      Meeting& at = meeting_[v];
      if (at.count < 2) at.edges[at.count] = e;
      ++at.count;
    }
  }
  for (std::uint32_t v = 0; v < vertices_.size(); ++v) {
    const Meeting& at = meeting_[v];
    if (at.count != 2 || at.edges[0] == at.edges[1]) continue;
    Edge& into = edges_[at.edges[0]];
    Edge& out = edges_[at.edges[1]];
    if (into.first != into.last || out.first != out.last) continue;
    if (into.from == v) into = {into.to, into.from, -into.step, 0, 0, false, -into.reference_step};
    if (out.to == v) out = {out.to, out.from, -out.step, 0, 0, false, -out.reference_step};
    if (into.step != out.step || into.from == out.to) continue;
    const Vec3d a = vertices_[v] - vertices_[into.from], b = vertices_[out.to] - vertices_[v];
    if (!(dot(a, b) > 0) || length_squared(cross(a, b)) > straight * length_squared(a) * length_squared(b)) continue;
    into.to = out.to;
    out.step = 0;
    for (std::uint32_t& e : meeting_[into.to].edges)
      if (e == at.edges[1]) e = at.edges[0];
    joined = true;
  }
  if (joined) join_coinciding_edges();
}

/// Slivers whose rim was straightened leave edges that coincide: one is left, with the sum of their steps.
void Silhouette::join_coinciding_edges() {
  by_ends_.clear();
  for (std::uint32_t e = 0; e < edges_.size(); ++e)
    if (is_rim(edges_[e])) by_ends_.push_back({std::minmax(edges_[e].from, edges_[e].to), e});
  std::sort(by_ends_.begin(), by_ends_.end());
  for (std::size_t k = 0; k + 1 < by_ends_.size(); ++k) {
    if (by_ends_[k].first != by_ends_[k + 1].first) continue;
    Edge* gone = &edges_[by_ends_[k].second];
    Edge* kept = &edges_[by_ends_[k + 1].second];
    if (gone->first != gone->last) {  // what turns stays
      if (kept->first != kept->last) continue;
      std::swap(gone, kept);
      std::swap(by_ends_[k].second, by_ends_[k + 1].second);
    }
    kept->step += gone->from == kept->from ? gone->step : -gone->step;
    kept->reference_step += gone->from == kept->from ? gone->reference_step : -gone->reference_step;
    gone->step = 0;
  }
}

/// Forgets edges without a step and vertices without an edge.
void Silhouette::drop_inner_edges() {
  used_.assign(vertices_.size(), none);
  std::size_t kept = 0, vertex_count = 0;
  for (Edge edge : edges_) {
    if (!is_rim(edge)) continue;
    for (std::uint32_t* v : {&edge.from, &edge.to}) {
      if (used_[*v] == none) used_[*v] = static_cast<std::uint32_t>(vertex_count++);
      *v = used_[*v];
    }
    edges_[kept++] = edge;
  }
  edges_.resize(kept);
  // In the order of their first use, so they move through a second vector.
  moved_.resize(vertex_count);
  for (std::size_t v = 0; v < vertices_.size(); ++v)
    if (used_[v] != none) moved_[used_[v]] = vertices_[v];
  vertices_.swap(moved_);
}

void Silhouette::add_blockers(const OccluderPolygons& occluders, std::span<const std::uint32_t> blockers,
                              std::span<const Vec3d> receiver, const Plane3& horizon, const Plane3& source) {
  for (std::uint32_t k : blockers) {
    ring_.clear();
    double over_receiver = 0, over_source = 0;
    for (std::uint32_t c = occluders.corner_offsets[k]; c < occluders.corner_offsets[k + 1]; ++c) {
      const std::uint32_t v = vertex(occluders, occluders.corner_vertices[c], horizon, source, slack_);
      ring_.push_back({v, occluders.corner_edges[c]});
      over_receiver = std::max(over_receiver, heights_[v][0]);
      over_source = std::max(over_source, heights_[v][1]);
    }
    if (over_receiver <= 0 || over_source <= occluders.slack[k]) continue;
    for (int plane = 0; plane < 2 && ring_.size() >= 3; ++plane) clip(plane);
    if (ring_.size() < 3) continue;
    ++polygon_count_;
    add_sides(occluders.planes[k], occluders.slack[k], receiver);
  }
}

/// Counts occluder k if it covers the reference line.
void Silhouette::count_covering(const OccluderPolygons& occluders, std::uint32_t k) {
  const Plane3& plane = occluders.planes[k];
  const double from = plane.distance(reference_.from), to = plane.distance(reference_.to);
  if ((from < 0) == (to < 0)) return;
  const double sign = from < 0 ? -1 : 1;
  const auto polygon = occluders.polygon(k);
  for (std::size_t c = 0; c < polygon.size(); ++c) {
    const Vec3d& next = polygon[c + 1 == polygon.size() ? 0 : c + 1];
    if (!(sign * side_of(polygon[c], next, reference_.from, reference_.to) > 0)) return;
  }
  reference_.covering += 1;
}

void Silhouette::finish() {
  assign_turning_polygons();
  join_straight_edges();
  drop_inner_edges();
}

void Silhouette::find_sides_of_reference() {
  for (Edge& e : edges_) e.left_of = side_of(vertices_[e.from], vertices_[e.to], reference_.from, reference_.to) > 0;
}

/// How many polygons cover the reference line when the contours close: the winding number of the steps about it, from
/// their crossings with the half-plane from `up` through it (Sunday 2001).
double Silhouette::winding_number(const Vec3d& up) const {
  const Vec3d across = cross(reference_.to - reference_.from, up);
  double covering = 0;
  for (const Edge& e : edges_) {
    const bool from = dot(across, vertices_[e.from] - reference_.from) > 0;
    const bool to = dot(across, vertices_[e.to] - reference_.from) > 0;
    if (from == to || e.left_of != to) continue;
    double step = e.step;
    for (std::uint32_t t = e.first; t < e.last; ++t)
      step += planes_[turning_[t].plane].distance(reference_.from) < 0 ? -turning_[t].direction : turning_[t].direction;
    covering += to ? step : -step;
  }
  return covering;
}

/// Drops the edges that no line from the receiver to the source passes: those that all points of one of the two see
/// outside the same side of the other. The test function is linear in the point, so that corners decide.
void Silhouette::drop_edges_aside(std::span<const Vec3d> receiver, std::span<const Vec3d> source) {
  if (edges_.empty()) return;
  aside_.assign(vertices_.size(), 0);
  std::uint64_t bit = 1;
  const auto look = [&](std::span<const Vec3d> from, std::span<const Vec3d> to, double least) {
    for (std::size_t c = 0; c < to.size() && bit != 0; ++c, bit <<= 1) {
      const Vec3d& corner = to[c];
      const Vec3d side = to[c + 1 == to.size() ? 0 : c + 1] - corner;
      for (std::size_t v = 0; v < vertices_.size(); ++v) {
        const Vec3d plane = cross(side, vertices_[v] - corner);
        if (std::all_of(from.begin(), from.end(), [&](const Vec3d& p) { return dot(plane, p - corner) < -least; }))
          aside_[v] |= bit;
      }
    }
  };
  look(receiver, source, 0);
  // Vertices that touch the source may be a hair behind it, where lines end that do pass their edges.
  const double reach = polygon_size(receiver) + polygon_size(source) + length(reference_.to - reference_.from);
  look(source, receiver, 8 * slack_ * reach * reach);
  bool dropped = false;
  for (Edge& e : edges_) {
    if ((aside_[e.from] & aside_[e.to]) == 0) continue;
    e.step = 0;
    e.first = e.last;
    dropped = true;
  }
  if (dropped) drop_inner_edges();
}

void Silhouette::build(const OccluderPolygons& occluders, std::span<const std::uint32_t> blockers,
                       std::span<const Vec3d> receiver, const Plane3& receiver_plane, std::span<const Vec3d> source,
                       const Plane3& source_plane) {
  start(occluders, blockers);
  has_reference_ = true;
  reference_ = {odd_point(receiver), odd_point(source), 0};
  add_blockers(occluders, blockers, receiver, {receiver_plane.normal, receiver_plane.offset + slack_}, source_plane);
  finish();
  find_sides_of_reference();
  reference_.covering = winding_number(receiver_plane.normal);
  drop_edges_aside(receiver, source);
}

void Silhouette::build(const OccluderPolygons& occluders, const Surface& surface, std::span<const Vec3d> receiver,
                       const Plane3& receiver_plane, std::span<const Vec3d> source, const Plane3& source_plane) {
  start(occluders, surface.polygons);
  has_reference_ = true;
  reference_ = {odd_point(receiver), odd_point(source), 0};
  const Plane3 horizon{receiver_plane.normal, receiver_plane.offset + slack_};
  for (std::uint32_t k : surface.polygons) count_covering(occluders, k);
  for (const Rim& rim : surface.rims) add_rim(occluders, rim, receiver, horizon, source_plane);
  finish();
  find_sides_of_reference();
  drop_edges_aside(receiver, source);
}

/// Forgets what was, and takes the slack from all that is to come. The horizon is a hair higher: no edge lies on one of
/// a source that reaches down to it, and none dips below, where signs can not tell a direction from its opposite. What
/// shines through underneath is the square of a hair.
void Silhouette::start(const OccluderPolygons& occluders, std::span<const std::uint32_t> polygons) {
  clear();
  vertex_of_.forget(occluders.vertices.size());
  edge_of_.forget(occluders.edges.size());
  for (Memory& memory : cut_of_) memory.forget(occluders.edges.size());
  slack_ = 0;
  for (std::uint32_t k : polygons) slack_ = std::max(slack_, occluders.slack[k]);
}

void Silhouette::add_polygon(std::span<const Vec3d> polygon, const Plane3& plane) {
  ++polygon_count_;
  const auto number = static_cast<std::uint32_t>(planes_.size());
  const auto first = static_cast<std::uint32_t>(vertices_.size());
  planes_.push_back(plane);
  for (std::uint32_t c = 0; c < polygon.size(); ++c) {
    vertices_.push_back(polygon[c]);
    const auto side = static_cast<std::uint32_t>(turning_.size());
    turning_.push_back({number, 1});
    edges_.push_back({first + c, first + (c + 1 == polygon.size() ? 0 : c + 1), 0, side, side + 1, false, 0});
  }
}

}  // namespace penumbra
