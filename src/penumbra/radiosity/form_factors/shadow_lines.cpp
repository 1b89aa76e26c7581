#include "penumbra/radiosity/form_factors/shadow_lines.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace penumbra {
namespace {

constexpr double touching = 1e-6;              // of a size
constexpr double layer = 2, layer_growth = 4;  // where layers end, in an edge's heights over the receiver
constexpr double low_rim = 0.1;                // height of an edge of the source, of its and the receiver's size
constexpr std::size_t most_lined = 64;         // edges whose shadow lines are looked for
constexpr std::size_t most_meeting = 48;       // edges whose meetings are looked for
constexpr double negligible_balance = 1e-5;    // what such a rim can add is below notice

/// Whether a segment in the plane of a convex polygon passes through it.
bool meets_segment(std::span<const Vec3d> polygon, const Vec3d& normal, const Vec3d& p, const Vec3d& q) {
  double from = 0, to = 1;
  for (std::size_t c = 0; c < polygon.size(); ++c) {
    const Vec3d inwards = cross(normal, polygon[c + 1 == polygon.size() ? 0 : c + 1] - polygon[c]);
    const double dp = dot(inwards, p - polygon[c]), dq = dot(inwards, q - polygon[c]);
    if (dp < 0 && dq < 0) return false;
    if (dp < 0) from = std::max(from, dp / (dp - dq));
    if (dq < 0) to = std::min(to, dp / (dp - dq));
  }
  return from <= to;
}

/// Whether a polygon has corners on both sides of a plane.
bool is_cut(std::span<const Vec3d> polygon, const Plane3& plane) {
  bool front = false, back = false;
  for (const Vec3d& v : polygon) {
    const double d = plane.distance(v);
    front |= d > 0;
    back |= d < 0;
  }
  return front && back;
}

}  // namespace

void ShadowLines::clear() {
  lines_.clear();
  all_known_ = false;
}

void ShadowLines::find(std::span<const Vec3d> receiver, const Plane3& receiver_plane, std::span<const Vec3d> source,
                       const Silhouette& silhouette) {
  clear();
  receiver_ = receiver;
  receiver_plane_ = receiver_plane;
  source_ = source;
  silhouette_ = &silhouette;
  const auto add = [&](const Vec3d& pole, const Vec3d& from, const Vec3d& to) {
    const Vec3d across = cross(from - pole, to - pole);
    const double size = length(across);
    if (!(size > 1e-14 * length(from - pole) * length(to - pole))) return;
    const Line line{{across / size, dot(across, pole) / size}, pole, from, to};
    if (is_cut(receiver_, line.plane) && matters(line, receiver_)) lines_.push_back(line);
  };
  // An occluder's plane, from which it is seen edge on, across the source.
  turning_.assign(silhouette_->planes().size(), false);
  for (const Silhouette::Turning& t : silhouette_->turning()) turning_[t.plane] = true;
  for (std::size_t k = 0; k < turning_.size(); ++k) {
    const Plane3& plane = silhouette_->planes()[k];
    if (turning_[k] && is_cut(receiver_, plane) && is_cut(source_, plane))
      lines_.push_back({plane, {}, {}, {}, Line::Kind::edge_on});
  }
  all_known_ = silhouette_->edges().size() <= most_meeting;
  if (all_known_) find_meeting_lines();
  if (silhouette_->edges().size() > most_lined) return;
  const auto vertices = silhouette_->vertices();
  find_rims();
  for (const Silhouette::Edge& edge : silhouette_->edges()) find_layers(vertices[edge.from], vertices[edge.to]);
  for (std::size_t a = 0; a < source_.size(); ++a) {
    const Vec3d& corner = source_[a];
    const Vec3d& next = source_[a + 1 == source_.size() ? 0 : a + 1];
    for (const Silhouette::Edge& edge : silhouette_->edges()) add(corner, vertices[edge.from], vertices[edge.to]);
    for (const Vec3d& v : vertices) add(v, corner, next);
  }
}

/// Adds lines along an edge close above the receiver, before a source that is wide as seen from there: the view opens
/// within about the edge's height, and then ever more slowly, to where the edge leaves the source.
void ShadowLines::find_layers(const Vec3d& from, const Vec3d& to) {
  const Vec3d& up = receiver_plane_.normal;
  const double height = 0.5 * (receiver_plane_.distance(from) + receiver_plane_.distance(to));
  const Vec3d across = cross(up, to - from);
  const double size = length(across), slope = receiver_plane_.distance(to) - receiver_plane_.distance(from);
  if (!(size > 2 * std::abs(slope)) || !(height > touching * size)) return;
  const Vec3d normal = across / size;
  const double offset = dot(normal, 0.5 * (from + to));
  double least = 0, most = 0;  // where the edge covers the source's corners
  for (const Vec3d& corner : source_) {
    const double rise = std::max(receiver_plane_.distance(corner) - height, 1e-3 * height);
    const double at = (offset - dot(normal, corner)) * height / rise;
    least = std::min(least, at);
    most = std::max(most, at);
  }
  for (const double end : {least, most}) {
    for (double at = layer * height; at < std::abs(end); at *= layer_growth) {
      const Plane3 plane{normal, offset + (end < 0 ? -at : at)};
      if (!is_cut(receiver_, plane)) break;
      lines_.push_back({plane, {}, {}, {}, Line::Kind::layer});
    }
  }
}

/// Adds lines below the source's edges that are close above the receiver, and along them: within about its height such
/// an edge fills half the view or none of it.
void ShadowLines::find_rims() {
  const Vec3d& up = receiver_plane_.normal;
  const double receiver_size = polygon_size(receiver_);
  for (std::size_t a = 0; a < source_.size(); ++a) {
    const Vec3d& from = source_[a];
    const Vec3d& to = source_[a + 1 == source_.size() ? 0 : a + 1];
    const double height = 0.5 * (receiver_plane_.distance(from) + receiver_plane_.distance(to));
    const Vec3d across = cross(up, to - from);
    const double size = length(across);
    if (!(height > touching * size) || height > low_rim * std::min(size, receiver_size)) continue;
    const Vec3d normal = across / size;
    const double offset = dot(normal, 0.5 * (from + to));
    for (const double side : {-1.0, 1.0}) {
      for (double at = side > 0 ? 0 : layer * height;; at = at > 0 ? at * layer_growth : layer * height) {
        const Plane3 plane{normal, offset + side * at};
        if (!is_cut(receiver_, plane)) break;
        lines_.push_back({plane, {}, {}, {}, Line::Kind::layer});
      }
    }
  }
}

/// Adds the lines on which a corner of the silhouette covers one of its edges, both before the source: there a gap
/// between two occluders opens or closes.
void ShadowLines::find_meeting_lines() {
  const Plane3 target = polygon_plane(source_);
  // While the eye moves from x to y in the line's plane, the corner covers a segment on the source's plane.
  const auto passes_source = [&](const Vec3d& x, const Vec3d& y, const Vec3d& pole) {
    const double dx = target.distance(x), dy = target.distance(y), dp = target.distance(pole);
    if (dx <= dp || dy <= dp) return dx > dp || dy > dp;
    return meets_segment(source_, target.normal, x + dx / (dx - dp) * (pole - x), y + dy / (dy - dp) * (pole - y));
  };
  const auto add = [&](const Vec3d& pole, const Vec3d& from, const Vec3d& to) {
    const Vec3d across = cross(from - pole, to - pole);
    const double size = length(across);
    if (!(size > 1e-6 * length(from - pole) * length(to - pole))) return;
    const Line line{{across / size, dot(across, pole) / size}, pole, from, to};
    if (!is_cut(receiver_, line.plane) || !matters(line, receiver_)) return;
    std::array<Vec3d, 2> ends{};
    std::size_t found = 0;
    for (std::size_t c = 0; c < receiver_.size() && found < 2; ++c) {
      const Vec3d& p = receiver_[c];
      const Vec3d& q = receiver_[c + 1 == receiver_.size() ? 0 : c + 1];
      const double dp = line.plane.distance(p), dq = line.plane.distance(q);
      if ((dp < 0) != (dq < 0)) ends[found++] = p + dp / (dp - dq) * (q - p);
    }
    if (found == 2 && passes_source(ends[0], ends[1], pole)) lines_.push_back(line);
  };
  const auto vertices = silhouette_->vertices();
  for (std::uint32_t v = 0; v < vertices.size(); ++v)
    for (const Silhouette::Edge& edge : silhouette_->edges())
      if (edge.from != v && edge.to != v) add(vertices[v], vertices[edge.from], vertices[edge.to]);
}

/// Whether, somewhere along the line's chord through the piece, the corner covers a point of the edge itself and not
/// only of its extension.
bool ShadowLines::matters(const Line& line, std::span<const Vec3d> piece) const {
  if (line.kind != Line::Kind::shadow) return true;
  double least = 1e300, most = -1e300;
  bool ahead = false, astern = false;  // of the point from which the edge is seen end on: there u passes infinity
  for (std::size_t c = 0; c < piece.size(); ++c) {
    const Vec3d& p = piece[c];
    const Vec3d& q = piece[(c + 1) % piece.size()];
    const double dp = line.plane.distance(p), dq = line.plane.distance(q);
    if ((dp < 0) == (dq < 0)) continue;
    const Vec3d x = p + dp / (dp - dq) * (q - p);
    const Vec3d ray = line.pole - x, edge = line.to - line.from;
    const double scale = dot(cross(edge, ray), line.plane.normal);
    if (std::abs(scale) <= 1e-9 * length(edge) * length(ray)) return true;
    const double u = dot(cross(x - line.from, ray), line.plane.normal) / scale;
    least = std::min(least, u);
    most = std::max(most, u);
    ahead |= scale > 0;
    astern |= scale < 0;
  }
  return ahead && astern ? least >= 0 || most <= 1 : least <= 1 && most >= 0;
}

/// The shadow line that cuts the piece most evenly of those that matter in it, and the share of it on the smaller side.
ShadowLines::Cut ShadowLines::best_cut(std::span<const Vec3d> piece) const {
  Cut best;
  for (const Line& line : lines_) {
    double front = 0, back = 0;
    for (const Vec3d& v : piece) {
      const double d = line.plane.distance(v);
      front = std::max(front, d);
      back = std::max(back, -d);
    }
    const double balance = std::min(front, back) / (front + back);
    if (!(balance > best.balance || (best.lines < 2 && balance > negligible_balance)) || !matters(line, piece))
      continue;
    if (balance > negligible_balance) ++best.lines;
    if (balance > best.balance) {
      best.line = &line.plane;
      best.balance = balance;
    }
  }
  if (best.balance <= negligible_balance) return {};
  return best;
}

}  // namespace penumbra
