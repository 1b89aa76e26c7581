#include "penumbra/radiosity/form_factors/analytic.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <numbers>

#include "penumbra/math/frame.h"
#include "penumbra/math/polygon.h"
#include "penumbra/math/polygon_pieces.h"
#include "penumbra/radiosity/form_factors/edge_pair.h"
#include "penumbra/radiosity/form_factors/nusselt.h"
#include "penumbra/radiosity/form_factors/point.h"

namespace penumbra {
namespace {

/// What the rules cost, in ns measured for pairs of squares: the kernel at a pair of points, Lambert's term of an edge
/// at a point, the contour integral of an edge pair. The cheapest rule is taken,
constexpr double kernel_cost = 2.5;
constexpr double lambert_cost = 45;
constexpr double contour_cost = 450;
/// but beyond this distance, in radii of the larger polygon, the contour sum cancels too much.
constexpr double contour_reach = 10;
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

/// Nodes each way of polygon_rule over a polygon of `radius` whose points see the integrand's singularities at
/// `distance` or more, for a relative error of about 1e-13. The integrand is analytic in the ellipse through distance /
/// radius, which leaves rho^-2n (measured: at most 10 times that for ratios of 2 and more); the rule on triangles needs
/// one node more.
int nodes_for(std::span<const Vec3d> polygon, double radius, double distance) {
  const double axis = distance / radius;
  if (axis < 2) return max_tabled_gauss;
  const double rho = axis + std::hypot(axis, 1.0);
  const int nodes = static_cast<int>(std::ceil(0.5 * std::log(1e13) / std::log(rho)));
  return std::max(2, nodes) + (polygon.size() == 4 ? 0 : 1);
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

/// Points in arrays whose length is a multiple of 4; those that fill up weigh nothing.
void to_lanes(std::span<const WeightedPoint> rule, ExchangeAreaScratch::Points& out) {
  const std::size_t padded = (rule.size() + 3) / 4 * 4;
  for (std::vector<double>* lane : {&out.x, &out.y, &out.z, &out.weight}) lane->resize(padded);
  for (std::size_t k = 0; k < padded; ++k) {
    const WeightedPoint& p = rule[std::min(k, rule.size() - 1)];
    out.x[k] = p.point.x;
    out.y[k] = p.point.y;
    out.z[k] = p.point.z;
    out.weight[k] = k < rule.size() ? p.weight : 0;
  }
}

/// The kernel summed over Gauss points of both: no cancellation however far they are. Four partial sums in a fixed
/// order.
double kernel_sum(std::span<const WeightedPoint> first, const Vec3d& n, const ExchangeAreaScratch::Points& second,
                  const Vec3d& m) {
  double sum = 0;
  for (const WeightedPoint& p : first) {
    double row[4] = {0, 0, 0, 0};
    for (std::size_t k = 0; k < second.x.size(); k += 4) {
      for (std::size_t lane = 0; lane < 4; ++lane) {
        const double x = second.x[k + lane] - p.point.x;
        const double y = second.y[k + lane] - p.point.y;
        const double z = second.z[k + lane] - p.point.z;
        const double r2 = x * x + y * y + z * z;
        row[lane] +=
            second.weight[k + lane] * (n.x * x + n.y * y + n.z * z) * (m.x * x + m.y * y + m.z * z) / (r2 * r2);
      }
    }
    sum -= p.weight * ((row[0] + row[1]) + (row[2] + row[3]));
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
double unlike_pair(std::span<const Vec3d> small, const Vec3d& small_normal, const Ball& small_ball,
                   std::span<const Vec3d> large, const Vec3d& normal, ExchangeAreaScratch& scratch) {
  const Frame frame(normal);
  const Vec3d centre = small_ball.centre, x = frame.tangent, y = frame.bitangent;
  const double reach = near_reach * small_ball.radius;
  const Vec3d foot = centre - dot(normal, centre - large[0]) * normal;
  const Vec3d window[] = {foot - reach * x - reach * y, foot + reach * x - reach * y, foot + reach * x + reach * y,
                          foot - reach * x + reach * y};
  const int nodes = nodes_for(small, small_ball.radius, reach - small_ball.radius);
  polygon_rule(small, nodes, scratch.first_rule);
  if (dot(normal, centre - large[0]) >= reach) return lambert_sum(scratch.first_rule, small_normal, large);

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

/// The rule for two polygons in front of each other, about the origin, in units of their extent.
/// The normals are those of the whole polygons: what a plane leaves of one may be too narrow to tell.
double scaled_exchange_area(std::span<const Vec3d> first, const Vec3d& first_normal, std::span<const Vec3d> second,
                            const Vec3d& second_normal, ExchangeAreaScratch& scratch) {
  const Ball a = bounding_ball(first), b = bounding_ball(second);
  const double apart = length(b.centre - a.centre) - a.radius - b.radius;
  if (apart > 2 * std::max(a.radius, b.radius)) {
    polygon_rule(first, nodes_for(first, a.radius, apart), scratch.first_rule);
    polygon_rule(second, nodes_for(second, b.radius, apart), scratch.second_rule);
    const auto points = static_cast<double>(scratch.first_rule.size()), corners = static_cast<double>(second.size());
    const double by_kernel = kernel_cost * points * static_cast<double>(scratch.second_rule.size());
    const double by_lambert = is_convex(second) ? lambert_cost * points * corners : by_kernel;
    const double by_contour = apart > contour_reach * std::max(a.radius, b.radius)
                                  ? by_kernel
                                  : contour_cost * static_cast<double>(first.size()) * corners;
    if (by_kernel <= std::min(by_lambert, by_contour)) {
      to_lanes(scratch.second_rule, scratch.second_points);
      return kernel_sum(scratch.first_rule, first_normal, scratch.second_points, second_normal);
    }
    if (by_lambert <= by_contour) return lambert_sum(scratch.first_rule, first_normal, second);
  }
  if (a.radius < unlike_sizes * b.radius && is_convex(second)) {
    return unlike_pair(first, first_normal, a, second, second_normal, scratch);
  }
  if (b.radius < unlike_sizes * a.radius && is_convex(first)) {
    return unlike_pair(second, second_normal, b, first, first_normal, scratch);
  }
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
  return std::max(0.0, scaled_exchange_area(a, first_plane.normal, b, second_plane.normal, scratch)) * extent * extent;
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
