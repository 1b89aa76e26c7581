#include "penumbra/tracing/shading/light_tree.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>

namespace penumbra {
namespace {

using std::numbers::pi;
using Emitter = LightTree::Emitter;

double angle_between(const Vec3d& a, const Vec3d& b) { return std::acos(std::clamp(dot(a, b), -1.0, 1.0)); }

struct Cone {
  Vec3d axis;
  double spread;
};

// The narrowest cone about two others.
Cone united(const Cone& a, const Cone& b) {
  const Cone& wide = a.spread >= b.spread ? a : b;
  const Cone& narrow = a.spread >= b.spread ? b : a;
  const double apart = angle_between(wide.axis, narrow.axis);
  if (apart + narrow.spread <= wide.spread) return wide;
  const double spread = (wide.spread + apart + narrow.spread) / 2;
  const Vec3d side = narrow.axis - dot(wide.axis, narrow.axis) * wide.axis;
  if (spread >= pi || length(side) < 1e-9) return {wide.axis, pi};
  const double turn = spread - wide.spread;
  return {normalize(std::cos(turn) * wide.axis + std::sin(turn) * normalize(side)), spread};
}

Emitter united(const Emitter& a, const Emitter& b) {
  if (a.power == 0) return b;
  if (b.power == 0) return a;
  Emitter both = a;
  both.bounds.grow(b.bounds);
  const Cone cone = united(Cone{a.axis, a.spread}, Cone{b.axis, b.spread});
  both.axis = cone.axis;
  both.spread = cone.spread;
  both.beam = std::max(a.beam, b.beam);
  both.both_sides = a.both_sides || b.both_sides;
  both.power = a.power + b.power;
  return both;
}

double surface_area(const Bounds& b) {
  const Vec3d e = b.extent();
  return 2 * (e.x * e.y + e.y * e.z + e.z * e.x);
}

// What a part of the tree costs: power times the area and the solid angle that its light may come from (eq. 1 there).
double orientation_cost(const Emitter& e) {
  const double widest = std::min(e.spread + e.beam, pi);
  const double solid_angle =
      2 * pi * (1 - std::cos(e.spread)) + pi / 2 *
                                              (2 * widest * std::sin(e.spread) - std::cos(e.spread - 2 * widest) -
                                               2 * e.spread * std::sin(e.spread) + std::cos(e.spread));
  return e.power * solid_angle * surface_area(e.bounds);
}

// A bound, in effect, on what the emitters may bring to a point, relative to that of others.
double importance(const Emitter& e, const Vec3d& point, const Vec3d& normal) {
  const Vec3d way = point - e.bounds.centre();
  const double radius = e.bounds.diagonal() / 2;
  const double distance2 = length_squared(way);
  const bool inside = distance2 <= radius * radius;
  // Half the angle that the bounds fill as seen from the point.
  const double filled = inside ? pi : std::asin(std::min(1.0, radius / std::sqrt(distance2)));
  const Vec3d direction = distance2 > 0 ? way / std::sqrt(distance2) : e.axis;
  double turned = angle_between(e.axis, direction);
  if (e.both_sides) turned = std::min(turned, pi - turned);
  const double from_normals = std::max(0.0, turned - e.spread - filled);
  if (from_normals >= e.beam) return 0;
  double value = e.power * std::cos(from_normals) / std::max({distance2, radius * radius, 1e-30});
  if (normal != Vec3d(0)) {
    const double incidence = std::acos(std::min(1.0, std::abs(dot(normal, direction))));
    value *= std::max(0.0, std::cos(std::max(0.0, incidence - filled)));
  }
  return value;
}

}  // namespace

LightTree::LightTree(std::span<const Emitter> emitters) : leaf_of_(emitters.size()) {
  if (emitters.empty()) return;
  std::vector<std::uint32_t> order(emitters.size());
  for (std::size_t i = 0; i < order.size(); ++i) order[i] = static_cast<std::uint32_t>(i);
  nodes_.reserve(2 * emitters.size() - 1);
  build(emitters, order, 0);
}

std::uint32_t LightTree::build(std::span<const Emitter> emitters, std::span<std::uint32_t> order,
                               std::uint32_t parent) {
  const auto number = static_cast<std::uint32_t>(nodes_.size());
  nodes_.push_back({.light = {}, .parent = parent});
  if (order.size() == 1) {
    nodes_[number].light = emitters[order[0]];
    nodes_[number].emitter = order[0];
    leaf_of_[order[0]] = number;
    return number;
  }
  Bounds centres;
  for (const std::uint32_t e : order) centres.grow(emitters[e].bounds.centre());
  // Twelve slices along each axis; the cut between two of them that costs least.
  constexpr std::size_t slices = 12;
  double best_cost = std::numeric_limits<double>::infinity();
  int best_axis = -1;
  std::size_t best_slice = 0;
  const auto slice_of = [&](std::uint32_t e, int axis) {
    const double along = (emitters[e].bounds.centre()[axis] - centres.lower[axis]) / centres.extent()[axis];
    return std::min(slices - 1, static_cast<std::size_t>(along * slices));
  };
  for (int axis = 0; axis < 3; ++axis) {
    if (!(centres.extent()[axis] > 0)) continue;
    std::array<Emitter, slices> slice{};
    for (const std::uint32_t e : order) {
      Emitter& s = slice[slice_of(e, axis)];
      s = united(s, emitters[e]);
    }
    std::array<Emitter, slices> above{};  // all from a slice on
    Emitter sum{};
    for (std::size_t i = slices; i-- > 0;) above[i] = sum = united(sum, slice[i]);
    Emitter below{};
    const double stretched = std::max({centres.extent().x, centres.extent().y, centres.extent().z}) /
                             centres.extent()[axis];  // long thin parts are cut across
    for (std::size_t i = 1; i < slices; ++i) {
      below = united(below, slice[i - 1]);
      if (below.power == 0 || above[i].power == 0) continue;
      const double cost = stretched * (orientation_cost(below) + orientation_cost(above[i]));
      if (cost < best_cost) {
        best_cost = cost;
        best_axis = axis;
        best_slice = i;
      }
    }
  }
  auto middle = order.begin() + static_cast<std::ptrdiff_t>(order.size() / 2);
  if (best_axis >= 0) {
    middle = std::stable_partition(order.begin(), order.end(),
                                   [&](std::uint32_t e) { return slice_of(e, best_axis) < best_slice; });
  }
  const auto left = static_cast<std::size_t>(middle - order.begin());
  const std::uint32_t first = build(emitters, order.first(left), number);
  const std::uint32_t second = build(emitters, order.subspan(left), number);
  nodes_[number].right = second;
  nodes_[number].light = united(nodes_[first].light, nodes_[second].light);
  return number;
}

std::optional<LightTree::Choice> LightTree::choose(const Vec3d& point, const Vec3d& normal, double u) const {
  if (nodes_.empty()) return std::nullopt;
  std::uint32_t number = 0;
  double chance = 1;
  if (nodes_[0].right == 0 && importance(nodes_[0].light, point, normal) == 0) return std::nullopt;
  while (nodes_[number].right != 0) {
    const std::uint32_t left = number + 1, right = nodes_[number].right;
    const double of_left = importance(nodes_[left].light, point, normal);
    const double of_right = importance(nodes_[right].light, point, normal);
    if (of_left + of_right == 0) return std::nullopt;
    const double share = of_left / (of_left + of_right);
    if (u < share) {
      number = left;
      u /= share;
      chance *= share;
    } else {
      number = right;
      u = (u - share) / (1 - share);
      chance *= 1 - share;
    }
  }
  return Choice{nodes_[number].emitter, chance, std::clamp(u, 0.0, 0x1.fffffffffffffp-1)};
}

double LightTree::chance(std::uint32_t emitter, const Vec3d& point, const Vec3d& normal) const {
  std::uint32_t number = leaf_of_[emitter];
  if (number == 0) return importance(nodes_[0].light, point, normal) > 0 ? 1 : 0;
  double chance = 1;
  while (number != 0) {
    const std::uint32_t parent = nodes_[number].parent;
    const std::uint32_t left = parent + 1, right = nodes_[parent].right;
    const double of_left = importance(nodes_[left].light, point, normal);
    const double of_right = importance(nodes_[right].light, point, normal);
    if (of_left + of_right == 0) return 0;
    const double share = of_left / (of_left + of_right);
    chance *= number == left ? share : 1 - share;
    number = parent;
  }
  return chance;
}

}  // namespace penumbra
