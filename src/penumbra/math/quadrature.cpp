#include "penumbra/math/quadrature.h"

#include <array>
#include <cassert>
#include <cmath>
#include <cstddef>
#include <numbers>
#include <stdexcept>

namespace penumbra {

std::vector<GaussNode> make_gauss_legendre(int n) {
  if (n < 1) throw std::invalid_argument("A Gauss-Legendre rule needs 1 node or more.");
  std::vector<GaussNode> rule(static_cast<std::size_t>(n));
  using Real = long double;  // so that nodes and weights are right to the last digit of a double
  for (int i = 0; i < (n + 1) / 2; ++i) {
    Real x = std::cos(std::numbers::pi_v<Real> * (i + Real{0.75}) / (n + Real{0.5}));
    Real derivative = 1;
    for (int step = 0; step < 100; ++step) {
      Real p = 1, before = 0;
      for (int k = 1; k <= n; ++k) {
        const Real next = ((2 * k - 1) * x * p - (k - 1) * before) / k;
        before = p;
        p = next;
      }
      derivative = n * (x * p - before) / (x * x - 1);
      const Real dx = p / derivative;
      x -= dx;
      if (std::abs(dx) < Real{1e-18}) break;
    }
    if (2 * i + 1 == n) x = 0;
    const auto weight = static_cast<double>(1 / ((1 - x * x) * derivative * derivative));
    rule[static_cast<std::size_t>(i)] = {static_cast<double>((1 - x) / 2), weight};
    rule[static_cast<std::size_t>(n - 1 - i)] = {static_cast<double>((1 + x) / 2), weight};
  }
  return rule;
}

std::span<const GaussNode> gauss_legendre(int n) {
  assert(n >= 1 && n <= max_tabled_gauss);
  static const auto table = [] {
    std::array<std::vector<GaussNode>, max_tabled_gauss> rules;
    for (int k = 1; k <= max_tabled_gauss; ++k) rules[static_cast<std::size_t>(k - 1)] = make_gauss_legendre(k);
    return rules;
  }();
  return table[static_cast<std::size_t>(n - 1)];
}

void append_triangle_rule(const Vec3d& a, const Vec3d& b, const Vec3d& c, int n, std::vector<WeightedPoint>& out) {
  const double twice_area = length(cross(b - a, c - a));
  for (const GaussNode& u : gauss_legendre(n)) {
    for (const GaussNode& v : gauss_legendre(n)) {
      out.push_back({a + u.x * ((1 - v.x) * (b - a) + v.x * (c - a)), twice_area * u.weight * v.weight * u.x});
    }
  }
}

void append_quad_rule(const Vec3d& a, const Vec3d& b, const Vec3d& c, const Vec3d& d, int n,
                      std::vector<WeightedPoint>& out) {
  const Vec3d along = b - a, up = d - a, twist = (a - b) + (c - d);
  for (const GaussNode& u : gauss_legendre(n)) {
    for (const GaussNode& v : gauss_legendre(n)) {
      const double jacobian = length(cross(along + v.x * twist, up + u.x * twist));
      out.push_back({a + u.x * along + v.x * up + u.x * v.x * twist, jacobian * u.weight * v.weight});
    }
  }
}

void polygon_rule(std::span<const Vec3d> polygon, int n, std::vector<WeightedPoint>& out) {
  out.clear();
  if (polygon.size() < 3) return;
  Vec3d twice_area(0);
  for (std::size_t i = 2; i < polygon.size(); ++i) {
    twice_area += cross(polygon[i - 1] - polygon[0], polygon[i] - polygon[0]);
  }
  bool convex = true;
  for (std::size_t i = 0; i < polygon.size(); ++i) {
    const Vec3d &p = polygon[i], &after = polygon[(i + 1) % polygon.size()];
    const Vec3d& before = polygon[(i + polygon.size() - 1) % polygon.size()];
    convex = convex && dot(cross(after - p, before - p), twice_area) >= 0;
  }
  std::size_t i = 2;
  for (; convex && i + 1 < polygon.size(); i += 2) {
    append_quad_rule(polygon[0], polygon[i - 1], polygon[i], polygon[i + 1], n, out);
  }
  for (; i < polygon.size(); ++i) {
    const std::size_t first = out.size();
    append_triangle_rule(polygon[0], polygon[i - 1], polygon[i], n, out);
    if (dot(cross(polygon[i - 1] - polygon[0], polygon[i] - polygon[0]), twice_area) < 0) {
      for (std::size_t k = first; k < out.size(); ++k) out[k].weight = -out[k].weight;
    }
  }
}

}  // namespace penumbra
