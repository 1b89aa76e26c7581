#pragma once

#include <span>
#include <vector>

#include "penumbra/math/vec.h"

namespace penumbra {

/// A node and its weight on [0, 1]; the weights of a rule sum to 1.
struct GaussNode {
  double x = 0;
  double weight = 0;
};

/// The largest rule that `gauss_legendre` keeps.
inline constexpr int max_tabled_gauss = 64;

/// Gauss-Legendre rule with n nodes on [0, 1], ascending: exact for polynomials of degree 2 n - 1. Made once for every
/// n on first use (thread-safe), so this is a table look-up.
/// @pre 1 <= n <= max_tabled_gauss.
[[nodiscard]] std::span<const GaussNode> gauss_legendre(int n);

/// The same for any n >= 1: Newton's iteration on the three-term recurrence (Golub & Welsch 1969 describe the rule;
/// starting values after Tricomi). Throws std::invalid_argument for n < 1.
[[nodiscard]] std::vector<GaussNode> make_gauss_legendre(int n);

/// A point on a surface and the area (m^2) it stands for.
struct WeightedPoint {
  Vec3d point{0};
  double weight = 0;
};

/// Appends n x n points of the conical product rule on a triangle (Duffy 1982); their weights sum to its area. Exact
/// for polynomials of degree 2 n - 2.
void append_triangle_rule(const Vec3d& a, const Vec3d& b, const Vec3d& c, int n, std::vector<WeightedPoint>& out);

/// Appends n x n points of the tensor rule on a planar convex quadrilateral under the bilinear map; their weights sum
/// to its area. Exact for polynomials of degree 2 n - 1 on a parallelogram, 2 n - 2 otherwise.
void append_quad_rule(const Vec3d& a, const Vec3d& b, const Vec3d& c, const Vec3d& d, int n,
                      std::vector<WeightedPoint>& out);

/// Replaces `out` by a rule on a planar polygon: a fan around the first corner, of quadrilaterals (and one triangle
/// where the count is odd) when it is convex, else of triangles with signed weights. Weights sum to its area.
void polygon_rule(std::span<const Vec3d> polygon, int n, std::vector<WeightedPoint>& out);

}  // namespace penumbra
