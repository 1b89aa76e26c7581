#include "penumbra/radiosity/leaks/openings.h"

#include <algorithm>
#include <cmath>
#include <unordered_map>

#include "penumbra/math/polygon.h"

namespace penumbra {
namespace {

constexpr double goes_on = 0.5;        // cosine between a face and the loop's plane, from which the surface continues
constexpr double share_of_hole = 0.1;  // of a loop's length along which surfaces go on

/// A walk along border edges, in order.
struct Chain {
  std::vector<std::size_t> edges;
  std::vector<std::uint32_t> corners;  ///< corners[k] begins edges[k]
};

class Chainer {
 public:
  explicit Chainer(const std::vector<BorderEdge>& border) : border_(border), used_(border.size(), 0) {
    for (std::size_t k = 0; k < border.size(); ++k) {
      if (border[k].kind != BorderKind::open) continue;
      at_[border[k].from].push_back(k);
      at_[border[k].to].push_back(k);
    }
  }

  std::vector<Chain> chains() {
    std::vector<Chain> all;
    for (std::size_t k = 0; k < border_.size(); ++k) {
      if (border_[k].kind == BorderKind::open && used_[k] == 0) all.push_back(walk_from(k));
    }
    return all;
  }

 private:
  // Forwards to a dead end or back to the start, then from the start backwards.
  Chain walk_from(std::size_t start) {
    Chain chain;
    extend(chain, start, border_[start].from);
    if (border_[chain.edges.back()].to != border_[start].from &&
        border_[chain.edges.back()].from != border_[start].from) {
      Chain back;
      if (const auto next = unused_at(border_[start].from)) extend(back, *next, border_[start].from);
      std::reverse(back.edges.begin(), back.edges.end());
      Chain whole;
      for (const std::size_t e : back.edges) whole.edges.push_back(e);
      // The corners of the part before the start, seen from its far end.
      for (std::size_t k = back.corners.size(); k-- > 0;) {
        const BorderEdge& e = border_[back.edges[back.corners.size() - 1 - k]];
        whole.corners.push_back(e.from == back.corners[k] ? e.to : e.from);
      }
      whole.edges.insert(whole.edges.end(), chain.edges.begin(), chain.edges.end());
      whole.corners.insert(whole.corners.end(), chain.corners.begin(), chain.corners.end());
      return whole;
    }
    return chain;
  }

  void extend(Chain& chain, std::size_t edge, std::uint32_t corner) {
    for (;;) {
      used_[edge] = 1;
      chain.edges.push_back(edge);
      chain.corners.push_back(corner);
      corner = border_[edge].from == corner ? border_[edge].to : border_[edge].from;
      if (corner == chain.corners.front()) return;
      const auto next = unused_at(corner);
      if (!next) return;
      edge = *next;
    }
  }

  [[nodiscard]] std::optional<std::size_t> unused_at(std::uint32_t corner) const {
    for (const std::size_t k : at_.at(corner)) {
      if (used_[k] == 0) return k;
    }
    return std::nullopt;
  }

  const std::vector<BorderEdge>& border_;
  std::vector<char> used_;
  std::unordered_map<std::uint32_t, std::vector<std::size_t>> at_;
};

Opening judge(const FaceNet& net, const std::vector<BorderEdge>& border, const Chain& chain) {
  Opening o;
  std::vector<Vec3d> loop;
  for (const std::uint32_t v : chain.corners) loop.push_back(net.vertices[v]);
  const BorderEdge& last = border[chain.edges.back()];
  const std::uint32_t end = last.from == chain.corners.back() ? last.to : last.from;
  if (end != chain.corners.front()) loop.push_back(net.vertices[end]);

  o.face = border[chain.edges.front()].face;
  o.normal = polygon_normal(loop);
  o.area = polygon_area(loop);
  o.size = polygon_size(loop);
  double whole = 0, beyond = 0, within = 0;
  for (std::size_t k = 0; k < chain.edges.size(); ++k) {
    const BorderEdge& e = border[chain.edges[k]];
    const Vec3d a = loop[k], b = loop[(k + 1) % loop.size()];
    const double edge_length = length(b - a);
    o.centre += 0.5 * edge_length * (a + b);
    whole += edge_length;
    const Vec3d outward = edge_length > 0 ? cross(b - a, o.normal) / edge_length : Vec3d(0);
    const double side = dot(inward(net, e), outward);
    if (side > goes_on) beyond += edge_length;
    if (side < -goes_on) within += edge_length;
  }
  o.centre = whole > 0 ? o.centre / whole : loop.front();
  // A single edge, or several in one line, enclose nothing to judge by: the surface stops.
  if (o.area <= 1e-9 * o.size * o.size || within > beyond) {
    o.kind = Opening::Kind::outline;
  } else {
    o.kind = beyond > share_of_hole * whole ? Opening::Kind::hole : Opening::Kind::side;
  }
  return o;
}

}  // namespace

std::vector<Opening> find_openings(const FaceNet& net, const std::vector<BorderEdge>& border) {
  std::vector<Opening> openings;
  for (const Chain& chain : Chainer(border).chains()) openings.push_back(judge(net, border, chain));
  return openings;
}

}  // namespace penumbra
