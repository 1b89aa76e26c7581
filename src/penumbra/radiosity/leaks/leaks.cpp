#include "penumbra/radiosity/leaks/leaks.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <set>
#include <tuple>
#include <utility>

#include "penumbra/radiosity/leaks/border.h"
#include "penumbra/radiosity/leaks/doubled_faces.h"
#include "penumbra/radiosity/leaks/openings.h"
#include "penumbra/scene/object_label.h"

namespace penumbra {
namespace {

constexpr double share_of_an_enclosure = 0.5;  // of the scene's size, from which an open object is its room

std::string place(const Vec3d& p) {
  // Rounding leaves -0 and 1e-17 beside round numbers.
  const auto tidy = [](double x) { return std::abs(x) < 1e-12 ? 0.0 : x; };
  return fmt::format("({:.6g}, {:.6g}, {:.6g}) m", tidy(p.x), tidy(p.y), tidy(p.z));
}

/// A length as one reads it.
std::string span(double metres) {
  if (metres < 1e-5) return fmt::format("{:.3g} m", metres);
  if (metres < 1e-2) return fmt::format("{:.3g} mm", metres * 1e3);
  if (metres < 1) return fmt::format("{:.3g} cm", metres * 1e2);
  return fmt::format("{:.3g} m", metres);
}

class LeakSearch {
 public:
  LeakSearch(const Scene& scene, const LeakOptions& options)
      : scene_(scene),
        net_(make_face_net(scene)),
        tree_(world_triangles(net_)),
        size_(scene.bounds().diagonal()),
        options_{options.touching * size_, options.widest_crack * size_} {}

  std::vector<Finding> search(const Progress& progress) {
    if (net_.triangles.empty()) return {};
    const std::vector<BorderEdge> border = find_border(net_, tree_, options_, progress);
    add_openings(border);
    add_gaps(border);
    add_flipped();
    if (!progress.stop_requested()) add_doubled();
    return std::move(found_);
  }

 private:
  static std::vector<TriangleTree::Triangle> world_triangles(const FaceNet& net) {
    std::vector<TriangleTree::Triangle> triangles;
    triangles.reserve(net.triangles.size());
    for (const auto& t : net.triangles) {
      triangles.push_back({net.vertices[t[0]], net.vertices[t[1]], net.vertices[t[2]]});
    }
    return triangles;
  }

  [[nodiscard]] std::string label_of(std::uint32_t face) const { return object_label(scene_, net_.object_of[face]); }

  [[nodiscard]] std::string between(std::uint32_t a, std::uint32_t b) const {
    if (net_.object_of[a] == net_.object_of[b]) return fmt::format("within \"{}\"", label_of(a));
    return fmt::format("between \"{}\" and \"{}\"", label_of(a), label_of(b));
  }

  void add_openings(const std::vector<BorderEdge>& border) {
    for (const Opening& o : find_openings(net_, border)) {
      if (o.kind == Opening::Kind::outline) continue;
      const bool hole = o.kind == Opening::Kind::hole;
      if (!hole && o.size < share_of_an_enclosure * size_ / 2) continue;  // a cup, not the room
      Finding f{.kind = hole ? FindingKind::hole : FindingKind::open_side,
                .sentence = "",
                .position = o.centre,
                .object = label_of(o.face),
                .size = o.size,
                .deliberate = looked_through(o)};
      f.sentence = hole ? fmt::format("a hole of {} in \"{}\" at {}: light leaks there; close it or mean it",
                                      span(o.size), f.object, place(o.centre))
                        : fmt::format("the side at {} is open ({}, around it \"{}\" and others): light leaves there{}",
                                      place(o.centre), span(o.size), f.object,
                                      f.deliberate ? "; a camera looks in through it" : "; close it or mean it");
      found_.push_back(std::move(f));
    }
  }

  // Whether a camera stands off the opening's plane and its view goes through the opening.
  [[nodiscard]] bool looked_through(const Opening& o) const {
    return std::any_of(scene_.cameras.begin(), scene_.cameras.end(), [&](const Camera& camera) {
      const Ray view = camera.ray(0.5, 0.5, 1.0);
      const double slope = dot(view.direction, o.normal);
      if (slope == 0) return false;
      const double t = dot(o.centre - view.origin, o.normal) / slope;
      return t > 0 && length(view.at(t) - o.centre) < o.size / 2;
    });
  }

  void add_gaps(const std::vector<BorderEdge>& border) {
    using Objects = std::pair<std::uint32_t, std::uint32_t>;
    const auto objects_of = [&](const BorderEdge& e) {
      return Objects(std::minmax(net_.object_of[e.face], net_.object_of[e.neighbour]));
    };
    // The edges on the other side of a corner beside an edge see a wedge.
    std::set<Objects> with_corners;
    for (const BorderEdge& e : border) {
      const bool near = e.kind == BorderKind::gap || e.kind == BorderKind::beside;
      if (near && e.shape == GapShape::tent) with_corners.insert(objects_of(e));
    }
    std::map<std::pair<Objects, bool>, std::vector<const BorderEdge*>> groups;
    for (const BorderEdge& e : border) {
      if (e.kind != BorderKind::gap) continue;
      const bool corner = e.shape != GapShape::even && with_corners.contains(objects_of(e));
      groups[{objects_of(e), corner}].push_back(&e);
    }
    for (const auto& [key, edges] : groups) add_gap(edges, key.second);
  }

  void add_gap(const std::vector<const BorderEdge*>& edges, bool corner) {
    const BorderEdge& worst =
        **std::max_element(edges.begin(), edges.end(), [](auto* a, auto* b) { return a->gap < b->gap; });
    const std::string more = edges.size() > 1 ? fmt::format(", the widest of {} edges", edges.size()) : "";
    found_.push_back(
        {.kind = corner ? FindingKind::t_junction : FindingKind::crack,
         .sentence = fmt::format("{} of {} {} at {}{}: light leaks there; {}",
                                 corner ? "a corner lies beside an edge (T-junction), a gap" : "a crack",
                                 span(worst.gap), between(worst.face, worst.neighbour), place(worst.place), more,
                                 corner ? "put the corner onto the edge, or split the edge there"
                                        : "move the edges together, or let one surface reach past the "
                                          "other"),
         .position = worst.place,
         .object = label_of(worst.face),
         .count = edges.size(),
         .size = worst.gap});
  }

  // Where two faces meet, they should run through their edge in opposite directions. Of the two, the one that disagrees
  // with more of its neighbours is the flipped one.
  void add_flipped() {
    std::vector<double> agree(net_.rings.size(), 0), disagree(net_.rings.size(), 0);
    std::vector<const FaceNet::Edge*> wrong;
    for (const FaceNet::Edge& e : net_.edges) {
      if (e.faces.size() != 2 || e.faces[0] == e.faces[1]) continue;
      const bool flipped = e.along[0] == e.along[1];
      for (const std::uint32_t f : e.faces) ++(flipped ? disagree : agree)[f];
      if (flipped) wrong.push_back(&e);
    }
    const auto share = [&](std::uint32_t f) { return disagree[f] / (agree[f] + disagree[f]); };
    std::map<std::pair<std::uint32_t, std::uint32_t>, std::pair<std::size_t, const FaceNet::Edge*>> groups;
    for (const FaceNet::Edge* e : wrong) {
      const bool second = share(e->faces[1]) > share(e->faces[0]);
      const std::uint32_t culprit = net_.object_of[e->faces[second ? 1 : 0]];
      const std::uint32_t other = net_.object_of[e->faces[second ? 0 : 1]];
      auto& [count, longest] = groups[{culprit, other}];
      if (count++ == 0 || net_.edge_length(*e) > net_.edge_length(*longest)) longest = e;
    }
    for (const auto& [objects, group] : groups) {
      const auto& [count, edge] = group;
      const std::uint32_t face = edge->faces[share(edge->faces[1]) > share(edge->faces[0]) ? 1 : 0];
      const Vec3d middle = 0.5 * (net_.vertices[edge->from] + net_.vertices[edge->to]);
      const std::string neighbours = objects.first == objects.second
                                         ? "its neighbour"
                                         : fmt::format("\"{}\"", object_label(scene_, objects.second));
      found_.push_back(
          {.kind = FindingKind::flipped,
           .sentence = fmt::format("face {} of \"{}\" faces the other way than {} where they meet at {}{}; "
                                   "turn the order of its corners round",
                                   net_.number_in_object[face] + 1, label_of(face), neighbours, place(middle),
                                   count > 1 ? fmt::format(" (one of {} such edges)", count) : ""),
           .position = middle,
           .object = label_of(face),
           .count = count});
    }
  }

  void add_doubled() {
    std::map<std::tuple<bool, std::uint32_t, std::uint32_t>, std::pair<std::size_t, DoubledFaces>> groups;
    for (const DoubledFaces& d : find_doubled_faces(net_, tree_, options_.touching)) {
      const auto [a, b] = std::minmax(net_.object_of[d.first], net_.object_of[d.second]);
      auto& [count, largest] = groups[{!d.equal, a, b}];
      if (count++ == 0 || d.area > largest.area) largest = d;
    }
    for (const auto& [key, group] : groups) {
      const auto& [count, d] = group;
      const std::string more = count > 1 ? fmt::format(", the largest of {} such pairs", count) : "";
      found_.push_back(
          {.kind = d.equal ? FindingKind::duplicate : FindingKind::overlap,
           .sentence = fmt::format(
               "face {} of \"{}\" and face {} of \"{}\" {} ({:.3g} m^2 at {}{}); {}",
               net_.number_in_object[d.first] + 1, label_of(d.first), net_.number_in_object[d.second] + 1,
               label_of(d.second), d.equal ? "are the same face twice" : "lie over each other in one plane", d.area,
               place(d.place), more, d.equal ? "remove one" : "move one of them a little, or cut them apart"),
           .position = d.place,
           .object = label_of(d.first),
           .count = count});
    }
  }

  const Scene& scene_;
  FaceNet net_;
  TriangleTree tree_;
  double size_;
  BorderOptions options_;
  std::vector<Finding> found_;
};

}  // namespace

std::vector<Finding> find_leaks(const Scene& scene, const LeakOptions& options, const Progress& progress) {
  return LeakSearch(scene, options).search(progress);
}

}  // namespace penumbra
