#include "penumbra/radiosity/form_factors/bsp_tree.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "penumbra/math/rng.h"

namespace penumbra {
namespace {

constexpr int candidates = 8;        // planes tried for a node
constexpr double cost_of_a_cut = 4;  // against one patch of imbalance
constexpr double on_plane = 1e-9;    // of the mesh's size

enum class Side { on, front, back, both };

Side side_of(std::span<const Vec3d> polygon, const Plane3& plane, double tolerance) {
  bool front = false, back = false;
  for (const Vec3d& v : polygon) {
    const double d = plane.distance(v);
    front = front || d > tolerance;
    back = back || d < -tolerance;
  }
  if (front && back) return Side::both;
  return front ? Side::front : (back ? Side::back : Side::on);
}

}  // namespace

struct BspTree::Piece {
  std::uint32_t patch = 0;
  std::vector<Vec3d> polygon;
};

// Grows the tree with a list of tasks instead of recursion: a convex body's tree is as deep as it has faces.
struct BspTree::Builder {
  struct Task {
    std::vector<Piece> pieces;
    std::uint32_t parent = no_node;
    bool in_front = false;
    int depth = 1;
  };

  BspTree& tree;
  const PatchMesh& mesh;
  double tolerance;
  CounterRng random;

  void grow(std::vector<Piece> pieces) {
    std::vector<Task> tasks;
    tasks.push_back({std::move(pieces)});
    while (!tasks.empty()) {
      Task task = std::move(tasks.back());
      tasks.pop_back();
      if (task.pieces.empty()) continue;
      const auto node = static_cast<std::uint32_t>(tree.nodes_.size());
      tree.nodes_.emplace_back();
      if (task.parent == no_node) {
        tree.root_ = node;
      } else {
        (task.in_front ? tree.nodes_[task.parent].front : tree.nodes_[task.parent].back) = node;
      }
      tree.depth_ = std::max(tree.depth_, task.depth);
      auto [front, back] = divide(task.pieces, tree.nodes_[node]);
      tasks.push_back({std::move(front), node, true, task.depth + 1});
      tasks.push_back({std::move(back), node, false, task.depth + 1});
    }
  }

  [[nodiscard]] Plane3 plane_of(const Piece& piece) const {
    const Vec3d& n = mesh.normals[piece.patch];
    return {n, dot(n, mesh.centroids[piece.patch])};
  }

  Plane3 choose(const std::vector<Piece>& pieces) {
    Plane3 best = plane_of(pieces[0]);
    double least = -1;
    // A sample of the pieces judges a candidate, so that building stays near n log n.
    const std::size_t stride = std::max<std::size_t>(1, pieces.size() / 256);
    for (int c = 0; c < candidates && static_cast<std::size_t>(c) < pieces.size(); ++c) {
      const Plane3 plane = plane_of(pieces[random.next_bits() % pieces.size()]);
      double cuts = 0, front = 0, back = 0;
      for (std::size_t k = 0; k < pieces.size(); k += stride) {
        const Side side = side_of(pieces[k].polygon, plane, tolerance);
        cuts += side == Side::both ? 1 : 0;
        front += side == Side::front ? 1 : 0;
        back += side == Side::back ? 1 : 0;
      }
      const double cost = cost_of_a_cut * cuts + std::abs(front - back);
      if (least < 0 || cost < least) {
        least = cost;
        best = plane;
      }
    }
    return best;
  }

  std::pair<std::vector<Piece>, std::vector<Piece>> divide(std::vector<Piece>& pieces, Node& node) {
    node.plane = choose(pieces);
    const Plane3 reversed{-node.plane.normal, -node.plane.offset};
    std::vector<Piece> front, back, same, opposite;
    for (Piece& piece : pieces) {
      for (const Vec3d& v : piece.polygon) node.bounds.grow(v);
      switch (side_of(piece.polygon, node.plane, tolerance)) {
        case Side::on:
          (dot(mesh.normals[piece.patch], node.plane.normal) > 0 ? same : opposite).push_back(std::move(piece));
          break;
        case Side::front:
          front.push_back(std::move(piece));
          break;
        case Side::back:
          back.push_back(std::move(piece));
          break;
        case Side::both: {
          std::vector<Vec3d> part;
          clip_polygon(piece.polygon, node.plane, tolerance, part);
          if (part.size() >= 3) front.push_back({piece.patch, part});
          clip_polygon(piece.polygon, reversed, tolerance, part);
          if (part.size() >= 3) back.push_back({piece.patch, part});
          break;
        }
      }
    }
    node.first = static_cast<std::uint32_t>(tree.patch_of_.size());
    store(same);
    node.middle = static_cast<std::uint32_t>(tree.patch_of_.size());
    store(opposite);
    node.last = static_cast<std::uint32_t>(tree.patch_of_.size());
    return {std::move(front), std::move(back)};
  }

  void store(const std::vector<Piece>& pieces) {
    for (const Piece& piece : pieces) {
      tree.patch_of_.push_back(piece.patch);
      tree.corners_.insert(tree.corners_.end(), piece.polygon.begin(), piece.polygon.end());
      tree.offsets_.push_back(static_cast<std::uint32_t>(tree.corners_.size()));
    }
  }
};

BspTree::BspTree(const PatchMesh& mesh, std::uint64_t seed) {
  std::vector<Piece> pieces;
  Bounds all;
  for (std::uint32_t p = 0; p < mesh.patch_count(); ++p) {
    const auto polygon = mesh.polygon(p);
    pieces.push_back({p, {polygon.begin(), polygon.end()}});
    for (const Vec3d& v : polygon) all.grow(v);
  }
  const double size = pieces.empty() ? 0.0 : length(all.upper - all.lower);
  Builder builder{*this, mesh, on_plane * size, CounterRng(hash_key(seed, 0xB59))};
  builder.grow(std::move(pieces));
}

void BspTree::front_to_back(const Vec3d& eye, const std::function<void(const Fragment&)>& visitor) const {
  // The half-space that holds everything.
  front_to_back(eye, Plane3{Vec3d(0), -1}, visitor);
}

void BspTree::front_to_back(const Vec3d& eye, const Plane3& horizon,
                            const std::function<void(const Fragment&)>& visitor) const {
  // The box's corner that lies farthest along the horizon's normal decides.
  const auto below = [&](const Bounds& b) {
    const Vec3d corner(horizon.normal.x > 0 ? b.upper.x : b.lower.x, horizon.normal.y > 0 ? b.upper.y : b.lower.y,
                       horizon.normal.z > 0 ? b.upper.z : b.lower.z);
    return horizon.distance(corner) <= 0;
  };
  const auto show = [&](std::uint32_t first, std::uint32_t last) {
    for (std::uint32_t f = first; f < last; ++f) visitor({patch_of_[f], polygon(f)});
  };
  struct Step {
    std::uint32_t node;
    bool opened;  // its near side is done
  };
  std::vector<Step> steps;
  if (root_ != no_node) steps.push_back({root_, false});
  while (!steps.empty()) {
    const Step step = steps.back();
    steps.pop_back();
    const Node& node = nodes_[step.node];
    const bool in_front = node.plane.distance(eye) >= 0;
    if (step.opened) {
      show(in_front ? node.first : node.middle, in_front ? node.middle : node.last);
      show(in_front ? node.middle : node.first, in_front ? node.last : node.middle);
      const std::uint32_t far = in_front ? node.back : node.front;
      if (far != no_node) steps.push_back({far, false});
      continue;
    }
    if (below(node.bounds)) continue;
    steps.push_back({step.node, true});
    const std::uint32_t near = in_front ? node.front : node.back;
    if (near != no_node) steps.push_back({near, false});
  }
}

}  // namespace penumbra
