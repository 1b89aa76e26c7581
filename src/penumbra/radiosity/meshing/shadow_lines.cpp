#include "penumbra/radiosity/meshing/shadow_lines.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <optional>
#include <set>

#include "penumbra/math/bounds.h"
#include "penumbra/parallel/parallel_for.h"

namespace penumbra {
namespace {

/// How far beside an edge a ray passes it, in parts of the edge's length.
constexpr double beside = 1e-4;
constexpr double on_plane = 1e-7;  // of the scene's size
constexpr int most_surfaces_passed = 4;

/// An edge of the faces and the patches that have it; backs are left out.
struct OccluderEdge {
  Vec3d a, b;
  std::vector<std::uint32_t> patches;
};

std::vector<OccluderEdge> occluder_edges(const PatchMesh& faces, std::size_t most) {
  std::map<std::pair<std::uint32_t, std::uint32_t>, std::vector<std::uint32_t>> patches_of;
  for (std::uint32_t p = 0; p < faces.patch_count(); ++p) {
    if (faces.surfaces[faces.surface_of[p]].back) continue;
    const auto corners = faces.patch_corners(p);
    for (std::size_t k = 0; k < corners.size(); ++k) {
      const std::uint32_t v = corners[k], w = corners[(k + 1) % corners.size()];
      patches_of[{std::min(v, w), std::max(v, w)}].push_back(p);
    }
  }
  std::vector<OccluderEdge> edges;
  for (const auto& [ends, patches] : patches_of) {
    edges.push_back({faces.vertices[ends.first], faces.vertices[ends.second], patches});
  }
  std::stable_sort(edges.begin(), edges.end(), [](const OccluderEdge& a, const OccluderEdge& b) {
    return length_squared(a.b - a.a) > length_squared(b.b - b.a);
  });
  if (edges.size() > most) edges.resize(most);
  return edges;
}

/// Where light comes from, as one point sees it: a place, or a direction from far away.
struct Eye {
  Vec3d position;
  bool far = false;  // then `position` is the way light goes

  [[nodiscard]] Vec3d towards(const Vec3d& p) const { return far ? position : p - position; }
};

class LineSeeker {
 public:
  LineSeeker(const LampIrradiance& light, const ShadowLineOptions& options)
      : light_(light), faces_(light.faces()), options_(options), edges_(occluder_edges(faces_, options.most_edges)) {
    Bounds all;
    for (const Vec3d& v : faces_.vertices) all.grow(v);
    size_ = faces_.vertices.empty() ? 1 : length(all.upper - all.lower);
  }

  std::vector<ShadowLine> seek() {
    std::vector<std::vector<ShadowLine>> found(edges_.size());
    parallel_for(edges_.size(), 8, [&](std::size_t first, std::size_t last) {
      for (std::size_t k = first; k < last; ++k) {
        for (const Lamp& lamp : light_.lamps()) {
          add_edge_shadows(edges_[k], lamp, found[k]);
          add_corner_shadows(edges_[k], lamp, found[k]);
        }
      }
    });
    std::vector<ShadowLine> lines = contacts();
    for (const auto& some : found) lines.insert(lines.end(), some.begin(), some.end());
    return lines;
  }

 private:
  /// Whether the outline of what the eye sees may run along an edge.
  [[nodiscard]] bool is_silhouette(const OccluderEdge& edge, const Eye& eye) const {
    if (edge.patches.size() != 2) return true;
    const Vec3d way = eye.towards(0.5 * (edge.a + edge.b));
    const auto side = [&](std::uint32_t p) { return dot(faces_.normals[p], way); };
    const double one = side(edge.patches[0]), other = side(edge.patches[1]);
    const double tiny = on_plane * length(way);
    if (std::abs(one) <= tiny || std::abs(other) <= tiny) return true;
    // Neighbours may be turned either way round; the edge's direction in each says whether they agree.
    const bool agree = runs(edge.patches[0], edge) != runs(edge.patches[1], edge);
    return ((one > 0) == (other > 0)) != agree;
  }
  [[nodiscard]] bool runs(std::uint32_t patch, const OccluderEdge& edge) const {
    const auto polygon = faces_.polygon(patch);
    for (std::size_t k = 0; k < polygon.size(); ++k) {
      if (polygon[k] == edge.a) return polygon[(k + 1) % polygon.size()] == edge.b;
    }
    return false;
  }

  /// The middle of the patches that an edge belongs to: the side on which rays are stopped.
  [[nodiscard]] Vec3d outward(const OccluderEdge& edge, const Vec3d& at, const Vec3d& way) const {
    const Vec3d along = normalize(edge.b - edge.a);
    Vec3d inward = faces_.centroids[edge.patches[0]] - at;
    const Vec3d across = cross(along, way);
    const double size = length(across);
    if (!(size > 0)) return Vec3d(0);
    const Vec3d unit = across / size;
    return dot(unit, inward) > 0 ? -unit : unit;
  }

  /// The patches that rays from `from` towards `at` meet beyond it, unless something stands before it.
  void add_met(const Vec3d& from, const Vec3d& at, bool far, std::set<std::uint32_t>& met) const {
    const Vec3d way = at - from;
    const double distance = length(way);
    if (!(distance > 0)) return;
    Ray ray{.origin = from, .direction = way / distance};
    ray.t_min = far ? 0 : 1e-5 * distance;
    double t = 0;
    for (int passed = 0; passed < most_surfaces_passed; ++passed) {
      const auto hit = light_.tracer().nearest(ray);
      if (!hit) return;
      t = hit->t;
      if (t >= distance * (1 - 1e-4)) {
        met.insert(light_.patch_of_triangle(hit->primitive));
        return;
      }
      // The lamp itself, or its other side, may stand at its own corner.
      if (t > 1e-4 * distance) return;
      ray.t_min = t + 1e-4 * distance;
    }
  }

  /// Lamp corner and occluder edge.
  void add_edge_shadows(const OccluderEdge& edge, const Lamp& lamp, std::vector<ShadowLine>& found) const {
    const int degree = lamp.kind == Lamp::Kind::patch ? 1 : 0;
    std::vector<Eye> eyes;
    if (lamp.kind == Lamp::Kind::far) eyes.push_back({lamp.direction, true});
    for (const Vec3d& corner : lamp.corners) eyes.push_back({corner, false});
    const double edge_length = length(edge.b - edge.a);
    for (const Eye& eye : eyes) {
      if (!is_silhouette(edge, eye)) continue;
      std::set<std::uint32_t> met;
      for (int k = 0; k < options_.rays_along_edge; ++k) {
        const double share = (k + 0.5) / options_.rays_along_edge;
        const Vec3d on_edge = edge.a + share * (edge.b - edge.a);
        const Vec3d way = eye.towards(on_edge);
        const Vec3d at = on_edge + beside * edge_length * outward(edge, on_edge, way);
        const Vec3d from = eye.far ? at - 2 * size_ * eye.position : eye.position;
        if (lamp.kind == Lamp::Kind::patch && !shines(lamp, at)) continue;
        add_met(from, at, eye.far, met);
      }
      for (const std::uint32_t patch : met) {
        const Plane3 plane = polygon_plane(faces_.polygon(patch));
        const auto a = cast(eye, edge.a, plane), b = cast(eye, edge.b, plane);
        if (a && b) found.push_back({patch, {*a, *b}, degree});
      }
    }
  }

  /// Lamp edge and occluder corner: each edge brings its first corner; the corners of an open edge come with its
  /// neighbours.
  void add_corner_shadows(const OccluderEdge& edge, const Lamp& lamp, std::vector<ShadowLine>& found) const {
    if (lamp.kind != Lamp::Kind::patch) return;
    const double edge_length = length(edge.b - edge.a);
    for (const Vec3d& corner : {edge.a, edge.b}) {
      for (std::size_t k = 0; k < lamp.corners.size(); ++k) {
        const Vec3d &c = lamp.corners[k], &d = lamp.corners[(k + 1) % lamp.corners.size()];
        if (!is_silhouette(edge, {0.5 * (c + d), false})) continue;
        std::set<std::uint32_t> met;
        for (int r = 0; r < options_.rays_along_edge; ++r) {
          const Vec3d from = c + ((r + 0.5) / options_.rays_along_edge) * (d - c);
          const Vec3d at = corner + beside * edge_length *
                                        (outward(edge, corner, corner - from) +
                                         (corner == edge.a ? 1.0 : -1.0) * normalize(edge.a - edge.b));
          if (shines(lamp, at)) add_met(from, at, false, met);
        }
        for (const std::uint32_t patch : met) {
          const Plane3 plane = polygon_plane(faces_.polygon(patch));
          const auto a = cast({c, false}, corner, plane), b = cast({d, false}, corner, plane);
          if (a && b) found.push_back({patch, {*a, *b}, 1});
        }
      }
    }
  }

  [[nodiscard]] bool shines(const Lamp& lamp, const Vec3d& at) const {
    return polygon_plane(lamp.corners).distance(at) > on_plane * size_;
  }

  /// The shadow of a point on a plane; none when it falls elsewhere.
  [[nodiscard]] std::optional<Vec3d> cast(const Eye& eye, const Vec3d& p, const Plane3& plane) const {
    const Vec3d way = eye.towards(p);
    const double slope = dot(plane.normal, way);
    if (std::abs(slope) <= 1e-9 * length(way)) return std::nullopt;
    const double t = -plane.distance(p) / slope;
    if (t < -on_plane || !std::isfinite(t)) return std::nullopt;
    const Vec3d shadow = p + t * way;
    return length(shadow - p) < 100 * size_ ? std::optional(shadow) : std::nullopt;
  }

  /// Where other faces touch a patch or pass through it.
  [[nodiscard]] std::vector<ShadowLine> contacts() const {
    struct Boxed {
      std::uint32_t patch;
      Bounds box;
    };
    std::vector<Boxed> boxes;
    const double tolerance = on_plane * size_;
    for (std::uint32_t p = 0; p < faces_.patch_count(); ++p) {
      if (faces_.surfaces[faces_.surface_of[p]].back) continue;
      Bounds box;
      for (const Vec3d& v : faces_.polygon(p)) box.grow(v);
      box.lower -= Vec3d(tolerance);
      box.upper += Vec3d(tolerance);
      boxes.push_back({p, box});
    }
    std::stable_sort(boxes.begin(), boxes.end(),
                     [](const Boxed& a, const Boxed& b) { return a.box.lower.x < b.box.lower.x; });
    std::vector<ShadowLine> lines;
    for (std::size_t i = 0; i < boxes.size(); ++i) {
      for (std::size_t k = i + 1; k < boxes.size() && boxes[k].box.lower.x <= boxes[i].box.upper.x; ++k) {
        const Bounds &a = boxes[i].box, &b = boxes[k].box;
        if (a.lower.y > b.upper.y || b.lower.y > a.upper.y || a.lower.z > b.upper.z || b.lower.z > a.upper.z) continue;
        add_contact(boxes[i].patch, boxes[k].patch, tolerance, lines);
        add_contact(boxes[k].patch, boxes[i].patch, tolerance, lines);
      }
    }
    return lines;
  }

  /// The line in which `other` meets the plane of `patch`.
  void add_contact(std::uint32_t patch, std::uint32_t other, double tolerance, std::vector<ShadowLine>& lines) const {
    const Plane3 plane = polygon_plane(faces_.polygon(patch));
    const auto polygon = faces_.polygon(other);
    if (std::all_of(polygon.begin(), polygon.end(),
                    [&](const Vec3d& p) { return std::abs(plane.distance(p)) <= tolerance; })) {
      return;
    }
    std::vector<Vec3d> meets;
    for (std::size_t k = 0; k < polygon.size(); ++k) {
      const Vec3d &p = polygon[k], &q = polygon[(k + 1) % polygon.size()];
      const double dp = plane.distance(p), dq = plane.distance(q);
      if (std::abs(dp) <= tolerance) {
        meets.push_back(p);
      } else if (std::abs(dq) > tolerance && (dp > 0) != (dq > 0)) {
        meets.push_back(p + (dp / (dp - dq)) * (q - p));
      }
    }
    if (meets.size() < 2) return;
    // Of several in a row the farthest two.
    std::array<Vec3d, 2> ends{meets[0], meets[1]};
    for (const Vec3d& p : meets) {
      for (const Vec3d& q : meets) {
        if (length_squared(p - q) > length_squared(ends[0] - ends[1])) ends = {p, q};
      }
    }
    lines.push_back({patch, ends, 0});
  }

  const LampIrradiance& light_;
  const PatchMesh& faces_;
  const ShadowLineOptions& options_;
  std::vector<OccluderEdge> edges_;
  double size_ = 1;
};

}  // namespace

std::vector<ShadowLine> find_shadow_lines(const LampIrradiance& light, const ShadowLineOptions& options) {
  return LineSeeker(light, options).seek();
}

std::vector<ShadowLine> by_importance(std::vector<ShadowLine> lines) {
  std::stable_sort(lines.begin(), lines.end(), [](const ShadowLine& a, const ShadowLine& b) {
    if (a.degree != b.degree) return a.degree < b.degree;
    return length_squared(a.ends[1] - a.ends[0]) > length_squared(b.ends[1] - b.ends[0]);
  });
  return lines;
}

}  // namespace penumbra
