#pragma once

#include <span>
#include <vector>

#include "penumbra/math/quadrature.h"
#include "penumbra/math/vec.h"

namespace penumbra {

/// Vectors that `exchange_area` may reuse from call to call; one for each thread.
struct ExchangeAreaScratch {
  /// Points by coordinate, for vector arithmetic.
  struct Points {
    std::vector<double> x, y, z, weight;
  };
  std::vector<Vec3d> first, second, clipped_first, clipped_second;
  std::vector<WeightedPoint> first_rule, second_rule;
  Points second_points;
};

/// A_1 F_12 = A_2 F_21 (m^2; Hottel's direct exchange area) between two polygons with nothing in between.
///
/// The double contour integral 1/(2 pi) sum over edge pairs of cos * integral of ln r (Sparrow 1963; Schroeder &
/// Hanrahan 1993 give its closed form), each polygon first clipped to the front of the other's plane. Edge pairs are
/// integrated exactly where they touch or come close (see edge_pair.h), so shared edges and corners need no shift.
/// Pairs farther apart than twice the larger radius take the cheapest of it, of Lambert's sum at Gauss points and of
/// the kernel at pairs of Gauss points, the latter two with relative error 1e-13; polygons less than 1/1000 of the
/// other's size take Lambert's sum for what is not near. Symmetric in its arguments to rounding; 0 for coplanar
/// polygons. Error of F_12: about 1e-13 absolute for sizes within a factor 1000 (rounding times the ratio), touching or
/// not, and 1e-12 relative for far pairs; tests hold it to 1e-12 for sizes from 1 to 1e-11.
/// @pre both planar and simple, counter-clockwise seen from the side that radiates. Concave ones are allowed as long as
/// no part of either lies between parts of the two.
[[nodiscard]] double exchange_area(std::span<const Vec3d> first, std::span<const Vec3d> second);
[[nodiscard]] double exchange_area(std::span<const Vec3d> first, std::span<const Vec3d> second,
                                   ExchangeAreaScratch& scratch);

/// Form factor F_12 (dimensionless, 0..1): the share of what leaves `first` that arrives at `second`.
[[nodiscard]] double polygon_to_polygon(std::span<const Vec3d> first, std::span<const Vec3d> second);

}  // namespace penumbra
