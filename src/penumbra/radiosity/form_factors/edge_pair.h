#pragma once

#include "penumbra/math/vec.h"

namespace penumbra {

/// A straight edge with what its integrals need.
struct Edge {
  Vec3d start{0};
  Vec3d end{0};
  Vec3d direction{0};  ///< unit; zero when the edge has no length
  double length = 0;

  Edge() = default;
  Edge(const Vec3d& from, const Vec3d& to) : start(from), end(to), length(glm::length(to - from)) {
    if (length > 0) direction = (to - from) / length;
  }
};

/// Integral of ln|p - q| over the points q of an edge (arc length). Closed form; finite also where p lies on the edge.
[[nodiscard]] double log_distance_integral(const Vec3d& p, const Edge& edge);

/// Double integral of ln|p - q| over the points p of one edge and q of the other (arc lengths), to about 1e-15 of the
/// product of lengths (times 1 + |ln distance|) wherever they lie: touching, crossing, overlapping or far.
///
/// The inner integral is closed. Where the outer integrand is smooth, a Gauss rule takes it, its size chosen from the
/// Bernstein ellipse that the nearest singularity leaves (Trefethen 2008). Otherwise parallel edges have an elementary
/// closed form; lines at an angle are taken from their nearest points s = t = 0, where ln r is nearly homogeneous:
/// s d/ds ln r + t d/dt ln r = 1 - h^2 / r^2 with their distance h, so that the divergence theorem leaves four single
/// integrals, closed, and h^2 times the integral of 1 / r^2 (Schroeder & Hanrahan's dilogarithms), which the
/// substitution s sin(angle) = h sinh(theta) makes smooth. Nearly parallel lines are integrated on panels graded
/// towards the singularities.
[[nodiscard]] double log_distance_integral(const Edge& first, const Edge& second);

}  // namespace penumbra
