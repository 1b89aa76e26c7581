#include "penumbra/radiosity/leaks/border.h"

#include <algorithm>
#include <mutex>
#include <utility>

#include "penumbra/parallel/parallel_for.h"

namespace penumbra {
namespace {

constexpr int probes = 9;                   // points along an edge
constexpr double widest_for_length = 0.05;  // a gap wider than this share of its edge is an opening
constexpr double straight_ahead = 0.5;      // cosine between a gap and the prolonged face
constexpr double closing = 0.5;             // a gap this share of its widest near an end closes there
constexpr std::size_t edges_a_task = 256;

class Judge {
 public:
  Judge(const FaceNet& net, const TriangleTree& tree, const BorderOptions& options)
      : net_(net), tree_(tree), options_(options) {}

  void judge(BorderEdge& e) const {
    const Vec3d a = net_.vertices[e.from], b = net_.vertices[e.to];
    const double edge_length = length(b - a);
    const double reach = std::max(options_.touching, std::min(options_.widest_gap, widest_for_length * edge_length));
    const Vec3d ahead = -inward(net_, e);
    int open = 0, near = 0, straight = 0;
    double gaps[probes] = {};
    for (int k = 0; k < probes; ++k) {
      const Vec3d p = a + (k + 0.5) / probes * (b - a);
      const auto other = nearest_other(e.face, p, reach);
      if (other && other->distance <= options_.touching) continue;
      ++open;
      if (!other) continue;
      ++near;
      if (dot(other->point - p, ahead) >= straight_ahead * other->distance) ++straight;
      gaps[k] = other->distance;
      if (other->distance <= e.gap) continue;
      e.gap = other->distance;
      e.place = 0.5 * (p + other->point);
      e.neighbour = net_.face_of_triangle[other->triangle];
    }
    const int closed_ends = (gaps[0] < closing * e.gap ? 1 : 0) + (gaps[probes - 1] < closing * e.gap ? 1 : 0);
    e.shape = closed_ends == 2 ? GapShape::tent : closed_ends == 1 ? GapShape::wedge : GapShape::even;
    e.kind = open == 0              ? BorderKind::closed
             : 2 * straight >= open ? BorderKind::gap
             : 2 * near >= open     ? BorderKind::beside
                                    : BorderKind::open;
  }

 private:
  [[nodiscard]] std::optional<TriangleTree::Nearest> nearest_other(std::uint32_t face, const Vec3d& p,
                                                                   double within) const {
    return tree_.nearest(p, within, [&](std::uint32_t t) { return net_.face_of_triangle[t] == face; });
  }

  const FaceNet& net_;
  const TriangleTree& tree_;
  const BorderOptions& options_;
};

/// The corners of the border, sorted into a tree as triangles of one point.
class BorderCorners {
 public:
  BorderCorners(const FaceNet& net, const std::vector<BorderEdge>& border)
      : net_(net), numbers_(numbers(border)), tree_(points(net, numbers_)) {}

  /// The parts of an edge between the corners of others that lie on it.
  void split(const BorderEdge& e, double touching, std::vector<BorderEdge>& parts) const {
    const Vec3d a = net_.vertices[e.from], b = net_.vertices[e.to];
    const double edge_length = length(b - a);
    Bounds box;
    for (const Vec3d& p : {a, b}) {
      box.grow(p - Vec3d(touching));
      box.grow(p + Vec3d(touching));
    }
    std::vector<std::pair<double, std::uint32_t>> on;
    tree_.overlapping(box, [&](std::uint32_t k) {
      const Vec3d p = net_.vertices[numbers_[k]];
      const double t = dot(p - a, b - a) / (edge_length * edge_length);
      if (t * edge_length <= touching || (1 - t) * edge_length <= touching) return;
      if (length(a + t * (b - a) - p) <= touching) on.emplace_back(t, numbers_[k]);
    });
    std::sort(on.begin(), on.end());
    BorderEdge part = e;
    for (const auto& [t, vertex] : on) {
      part.to = vertex;
      parts.push_back(part);
      part.from = vertex;
    }
    part.to = e.to;
    parts.push_back(part);
  }

 private:
  static std::vector<std::uint32_t> numbers(const std::vector<BorderEdge>& border) {
    std::vector<std::uint32_t> all;
    for (const BorderEdge& e : border) {
      all.push_back(e.from);
      all.push_back(e.to);
    }
    std::sort(all.begin(), all.end());
    all.erase(std::unique(all.begin(), all.end()), all.end());
    return all;
  }
  static std::vector<TriangleTree::Triangle> points(const FaceNet& net, const std::vector<std::uint32_t>& numbers) {
    std::vector<TriangleTree::Triangle> all;
    for (const std::uint32_t v : numbers) all.push_back({net.vertices[v], net.vertices[v], net.vertices[v]});
    return all;
  }

  const FaceNet& net_;
  std::vector<std::uint32_t> numbers_;
  TriangleTree tree_;
};

std::vector<BorderEdge> border_of(const FaceNet& net, double touching) {
  std::vector<BorderEdge> whole, parts;
  for (const FaceNet::Edge& e : net.edges) {
    if (e.faces.size() == 1) whole.push_back({.from = e.from, .to = e.to, .face = e.faces[0]});
  }
  const BorderCorners corners(net, whole);
  for (const BorderEdge& e : whole) corners.split(e, touching, parts);
  return parts;
}

}  // namespace

Vec3d inward(const FaceNet& net, const BorderEdge& edge) {
  const Vec3d along = net.vertices[edge.to] - net.vertices[edge.from];
  const Vec3d in = cross(net.normals[edge.face], along);
  const double size = length(in);
  return size > 0 ? in / size : Vec3d(0);
}

std::vector<BorderEdge> find_border(const FaceNet& net, const TriangleTree& tree, const BorderOptions& options,
                                    const Progress& progress) {
  std::vector<BorderEdge> border = border_of(net, options.touching);
  const Judge judge(net, tree, options);
  std::mutex telling;
  std::size_t done = 0;
  parallel_for(border.size(), edges_a_task, [&](std::size_t first, std::size_t last) {
    if (progress.stop_requested()) return;
    for (std::size_t k = first; k < last; ++k) judge.judge(border[k]);
    const std::scoped_lock lock(telling);
    done += last - first;
    progress.tell("seams", static_cast<double>(done) / static_cast<double>(border.size()));
  });
  return border;
}

}  // namespace penumbra
