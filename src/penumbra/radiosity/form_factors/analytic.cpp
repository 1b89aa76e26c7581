#include "penumbra/radiosity/form_factors/analytic.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <numbers>

#include "penumbra/math/polygon.h"
#include "penumbra/math/polygon_pieces.h"
#include "penumbra/radiosity/form_factors/edge_pair.h"
#include "penumbra/radiosity/form_factors/nusselt.h"
#include "penumbra/radiosity/form_factors/point.h"

namespace penumbra {
namespace {

/// A far pair takes the kernel at Gauss points while that needs no more evaluations than this.
constexpr double most_kernel_evaluations = 700;
/// Below this ratio of sizes the contour sum, whose error is rounding times the larger size, gives way to Gauss points
/// on the smaller polygon.
constexpr double unlike_sizes = 1e-3;
/// How far the near part of the large polygon reaches around the small one, in radii of the small one.
constexpr double near_reach = 8;

struct Ball {
  Vec3d centre{0};
  double radius = 0;
};

Ball bounding_ball(std::span<const Vec3d> polygon) {
  Ball ball;
  for (const Vec3d& p : polygon) ball.centre += p / static_cast<double>(polygon.size());
  for (const Vec3d& p : polygon) ball.radius = std::max(ball.radius, length(p - ball.centre));
  return ball;
}

/// Nodes each way of a Gauss rule over a surface of `radius`, `distance` from whatever makes the integrand singular,
/// for a relative error of about 1e-13: the integrand is analytic in the ellipse through that place.
int nodes_for(double radius, double distance) {
  const double axis = distance / radius;
  if (axis < 1) return max_tabled_gauss;
  const double rho = axis + std::hypot(axis, 1.0);
  return std::min(max_tabled_gauss, 1 + static_cast<int>(std::ceil(0.5 * std::log(1e13) / std::log(rho))));
}

/// The part of a polygon in front of the other's plane; `clipped` holds it when that is not the whole.
std::span<const Vec3d> part_in_front(std::span<const Vec3d> polygon, const Plane3& plane, double tolerance,
                                     std::vector<Vec3d>& clipped) {
  double lowest = 0, highest = -1e300;
  for (const Vec3d& p : polygon) {
    const double distance = plane.distance(p);
    lowest = std::min(lowest, distance);
    highest = std::max(highest, distance);
  }
  if (highest <= tolerance) return {};
  if (lowest >= -tolerance) return polygon;
  clip_polygon(polygon, plane, tolerance, clipped);
  return clipped;
}

/// 1/(2 pi) times the sum over edge pairs: the double contour integral.
double contour_sum(std::span<const Vec3d> first, std::span<const Vec3d> second) {
  double sum = 0;
  Vec3d a = first.back();
  for (const Vec3d& b : first) {
    const Edge e(a, b);
    a = b;
    Vec3d c = second.back();
    for (const Vec3d& d : second) {
      const Edge f(c, d);
      c = d;
      const double cosine = dot(e.direction, f.direction);
      if (std::abs(cosine) > 1e-17) sum += cosine * log_distance_integral(e, f);
    }
  }
  return sum / (2 * std::numbers::pi);
}

/// The kernel summed over Gauss points of both: no cancellation however far they are.
double kernel_sum(std::span<const WeightedPoint> first, const Vec3d& first_normal,
                  std::span<const WeightedPoint> second, const Vec3d& second_normal) {
  double sum = 0;
  for (const WeightedPoint& p : first) {
    double row = 0;
    for (const WeightedPoint& q : second) {
      const Vec3d d = q.point - p.point;
      const double r2 = length_squared(d);
      row += q.weight * dot(first_normal, d) * dot(second_normal, d) / (r2 * r2);
    }
    sum -= p.weight * row;
  }
  return sum / std::numbers::pi;
}

/// Lambert's sum to `large` averaged over Gauss points of `small`, which is all in front of it.
double lambert_sum(std::span<const WeightedPoint> small, const Vec3d& small_normal, std::span<const Vec3d> large) {
  double sum = 0;
  for (const WeightedPoint& p : small) sum += p.weight * signed_point_to_polygon(p.point, small_normal, large);
  return sum;
}

/// One polygon far smaller than the other: what is near of the large one by contour, the rest from Gauss points.
double unlike_pair(std::span<const Vec3d> small, const Ball& small_ball, std::span<const Vec3d> large,
                   ExchangeAreaScratch& scratch) {
  const Vec3d normal = polygon_normal(large), small_normal = polygon_normal(small);
  const Vec3d centre = small_ball.centre, x = normalize(large[1] - large[0]), y = cross(normal, x);
  const double reach = near_reach * small_ball.radius;
  const Vec3d foot = centre - dot(normal, centre - large[0]) * normal;
  const Vec3d window[] = {foot - reach * x - reach * y, foot + reach * x - reach * y, foot + reach * x + reach * y,
                          foot - reach * x + reach * y};
  const int nodes = nodes_for(small_ball.radius, reach - small_ball.radius);
  polygon_rule(small, nodes, scratch.first_rule);
  const double all_distance = dot(normal, centre - large[0]);
  if (all_distance >= reach) return lambert_sum(scratch.first_rule, small_normal, large);

  double sum = 0;
  for (const std::vector<Vec3d>& piece : subtract_convex(large, window)) {
    sum += lambert_sum(scratch.first_rule, small_normal, piece);
  }
  std::vector<Vec3d> near(large.begin(), large.end()), rest;
  for (std::size_t k = 0; k < 4 && !near.empty(); ++k) {
    const Vec3d inwards = cross(normal, normalize(window[(k + 1) % 4] - window[k]));
    clip_polygon(near, {inwards, dot(inwards, window[k])}, 0, rest);
    near.swap(rest);
  }
  return near.empty() ? sum : sum + contour_sum(small, near);
}

/// Polygons in front of each other, about the origin, in units of their distance or size.
double scaled_exchange_area(std::span<const Vec3d> first, std::span<const Vec3d> second, ExchangeAreaScratch& scratch) {
  const Ball a = bounding_ball(first), b = bounding_ball(second);
  const double apart = length(b.centre - a.centre) - a.radius - b.radius;
  if (apart > 4 * std::max(a.radius, b.radius)) {
    const int n = nodes_for(a.radius, apart), m = nodes_for(b.radius, apart);
    if (static_cast<double>(n * n) * (m * m) <= most_kernel_evaluations) {
      polygon_rule(first, n, scratch.first_rule);
      polygon_rule(second, m, scratch.second_rule);
      return kernel_sum(scratch.first_rule, polygon_normal(first), scratch.second_rule, polygon_normal(second));
    }
  }
  if (a.radius < unlike_sizes * b.radius && is_convex(second)) return unlike_pair(first, a, second, scratch);
  if (b.radius < unlike_sizes * a.radius && is_convex(first)) return unlike_pair(second, b, first, scratch);
  return contour_sum(first, second);
}

}  // namespace

double exchange_area(std::span<const Vec3d> first, std::span<const Vec3d> second, ExchangeAreaScratch& scratch) {
  if (first.size() < 3 || second.size() < 3) return 0;
  // About a corner of the smaller one, and in units in which ln r is small: digits are lost otherwise.
  const Vec3d origin = polygon_size(first) <= polygon_size(second) ? first[0] : second[0];
  double extent = 0, farthest_coordinate = 0;
  for (const auto& polygon : {first, second}) {
    for (const Vec3d& p : polygon) {
      extent = std::max(extent, length(p - origin));
      farthest_coordinate = std::max({farthest_coordinate, std::abs(p.x), std::abs(p.y), std::abs(p.z)});
    }
  }
  if (!(extent > 0)) return 0;
  const auto to_unit = [&](std::span<const Vec3d> polygon, std::vector<Vec3d>& out) {
    out.clear();
    for (const Vec3d& p : polygon) out.push_back((p - origin) / extent);
  };
  to_unit(first, scratch.first);
  to_unit(second, scratch.second);

  const double size = std::min(polygon_size(scratch.first), polygon_size(scratch.second));
  const double tolerance = 4e-16 * (1 + farthest_coordinate / extent) + 1e-13 * size;
  const Plane3 first_plane = polygon_plane(scratch.first), second_plane = polygon_plane(scratch.second);
  const std::span<const Vec3d> a = part_in_front(scratch.first, second_plane, tolerance, scratch.clipped_first);
  const std::span<const Vec3d> b = part_in_front(scratch.second, first_plane, tolerance, scratch.clipped_second);
  if (a.empty() || b.empty()) return 0;
  return std::max(0.0, scaled_exchange_area(a, b, scratch)) * extent * extent;
}

double exchange_area(std::span<const Vec3d> first, std::span<const Vec3d> second) {
  ExchangeAreaScratch scratch;
  return exchange_area(first, second, scratch);
}

double polygon_to_polygon(std::span<const Vec3d> first, std::span<const Vec3d> second) {
  const double area = polygon_area(first);
  return area > 0 ? exchange_area(first, second) / area : 0;
}

}  // namespace penumbra
