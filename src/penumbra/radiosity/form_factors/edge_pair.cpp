#include "penumbra/radiosity/form_factors/edge_pair.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <numbers>
#include <span>

#include "penumbra/math/quadrature.h"

namespace penumbra {
namespace {

/// The most nodes a panel may have; a panel that would need more is halved.
constexpr int max_nodes = 14;
/// Panels shorter than this share of the edge end the grading: what a rule does wrong there is its square.
constexpr double shortest_panel = 1e-8;
/// Below this sine lines at an angle are no longer taken from their nearest points, which lie too far away.
constexpr double least_sine = 0.25;

/// u ln|(u, h)| without 0 * infinity.
double u_log_distance(double u, double h) {
  const double r2 = u * u + h * h;
  return r2 > 0 ? 0.5 * u * std::log(r2) : 0;
}

/// Integral of ln sqrt(u^2 + h^2) over [u0, u1], h >= 0. The last term is h times the angle that the piece subtends.
double log_integral(double u0, double u1, double h) {
  return u_log_distance(u1, h) - u_log_distance(u0, h) - (u1 - u0) + h * std::atan2(h * (u1 - u0), h * h + u0 * u1);
}

/// A place in the complex plane of the outer variable s where the inner integral is singular: s +- i distance.
struct Singularity {
  double s = 0;
  double distance = 0;
};

/// The outer variable runs along `outer`; the inner integral over `inner` is closed.
struct EdgePair {
  const Edge& outer;
  const Edge& inner;
  double cosine;
  Vec3d moment0, moment_rate;  // (p - inner.start) x inner.direction at s = 0 and its change with s: its length is h(s)
  double foot0;                // of p on the inner line at s = 0; changes with s by `cosine`
  std::array<Singularity, 3> singularities;
  std::size_t singularity_count = 2;
  double crossing_s = 0, crossing_t = 0, gap = 0;  // nearest points of the two lines and their distance; sine > 0 only
  double sine;

  EdgePair(const Edge& along, const Edge& across)
      : outer(along),
        inner(across),
        cosine(dot(along.direction, across.direction)),
        moment0(cross(along.start - across.start, across.direction)),
        moment_rate(cross(along.direction, across.direction)),
        foot0(dot(along.start - across.start, across.direction)),
        sine(glm::length(moment_rate)) {
    for (std::size_t k = 0; k < 2; ++k) {
      const Vec3d to_end = (k == 0 ? across.start : across.end) - along.start;
      singularities[k] = {dot(to_end, along.direction), glm::length(cross(to_end, along.direction))};
    }
    if (sine > 1e-14) locate_crossing();
  }

  /// The inner lines' |h| is singular where h^2 = 0, but only if the foot of p lies within the inner edge there.
  void locate_crossing() {
    crossing_s = -dot(moment0, moment_rate) / (sine * sine);
    crossing_t = foot0 + crossing_s * cosine;
    gap = std::abs(dot(outer.start - inner.start, moment_rate)) / sine;
    if (crossing_t > 0 && crossing_t < inner.length) singularities[singularity_count++] = {crossing_s, gap / sine};
  }

  [[nodiscard]] double inner_integral(double s) const {
    const double foot = foot0 + s * cosine;
    return log_integral(-foot, inner.length - foot, glm::length(moment0 + s * moment_rate));
  }

  [[nodiscard]] double panel(double s0, double s1, int nodes) const {
    double sum = 0;
    for (const GaussNode& node : gauss_legendre(nodes)) sum += node.weight * inner_integral(s0 + node.x * (s1 - s0));
    return (s1 - s0) * sum;
  }
};

/// How many Gauss nodes leave an error of about 1e-15 when (rho + 1/rho) / 2 = `semi_axis` is the ellipse around the
/// panel on which the integrand is still analytic; max_nodes + 1 when that many are not enough.
int nodes_for(double semi_axis) {
  static const auto least_axis = [] {
    std::array<double, max_nodes + 1> table{};
    for (int n = 1; n <= max_nodes; ++n) table[static_cast<std::size_t>(n)] = std::cosh(0.5 * std::log(1e15) / n);
    return table;
  }();
  for (int n = 2; n <= max_nodes; ++n) {
    if (semi_axis >= least_axis[static_cast<std::size_t>(n)]) return n;
  }
  return max_nodes + 1;
}

int nodes_for_panel(const EdgePair& pair, double s0, double s1) {
  double semi_axis = 1e300;
  for (const Singularity& at : std::span(pair.singularities).first(pair.singularity_count)) {
    const double sum = std::hypot(at.s - s0, at.distance) + std::hypot(at.s - s1, at.distance);
    semi_axis = std::min(semi_axis, sum / (s1 - s0));
  }
  return nodes_for(semi_axis);
}

/// Panels graded towards the singularities by halving, cut at the singularities themselves.
double graded(const EdgePair& pair, double s0, double s1) {
  const int nodes = nodes_for_panel(pair, s0, s1);
  const double length = s1 - s0;
  if (nodes <= max_nodes || length <= shortest_panel * pair.outer.length) {
    return pair.panel(s0, s1, std::min(nodes, max_nodes));
  }
  double cut = 0.5 * (s0 + s1);
  for (const Singularity& at : std::span(pair.singularities).first(pair.singularity_count)) {
    const bool inside = at.s > s0 + 1e-3 * length && at.s < s1 - 1e-3 * length;
    if (inside && at.distance < 0.25 * length) {
      cut = at.s;
      break;
    }
  }
  return graded(pair, s0, cut) + graded(pair, cut, s1);
}

/// Second antiderivative of ln sqrt(v^2 + h^2).
double parallel_antiderivative(double v, double h) {
  const double r2 = v * v + h * h;
  if (r2 == 0) return 0;
  return 0.25 * (v * v - h * h) * std::log(r2) + (h > 0 ? h * v * std::atan(v / h) : 0) - 0.75 * v * v;
}

/// Edges that are parallel to rounding: the integrand depends on s - t alone.
double parallel_closed_form(const EdgePair& pair) {
  const double h = 0.5 * (glm::length(pair.moment0) + glm::length(pair.moment0 + pair.outer.length * pair.moment_rate));
  // Along the outer direction; an antiparallel inner edge is run backwards.
  const double t0 = pair.cosine > 0 ? pair.singularities[0].s : pair.singularities[1].s;
  const double t1 = pair.cosine > 0 ? pair.singularities[1].s : pair.singularities[0].s;
  const double length = pair.outer.length;
  return parallel_antiderivative(length - t0, h) - parallel_antiderivative(-t0, h) -
         parallel_antiderivative(length - t1, h) + parallel_antiderivative(-t1, h);
}

/// gap^2 times the integral of 1 / r^2 over both edges, by s sine = gap sinh(theta): the integrand is the angle that
/// the inner edge subtends, analytic in the strip |Im theta| < angle between the lines.
double gap_integral(const EdgePair& pair) {
  const double gap = pair.gap, sine = pair.sine;
  const double s0 = -pair.crossing_s, s1 = pair.outer.length - pair.crossing_s;
  const double t0 = -pair.crossing_t, t1 = pair.inner.length - pair.crossing_t;
  if (gap * gap < 1e-20 * pair.outer.length * pair.inner.length) return 0;
  const double theta0 = std::asinh(s0 * sine / gap), theta1 = std::asinh(s1 * sine / gap);
  const double strip = std::asin(std::min(sine, 1.0));
  const int panels = std::max(1, static_cast<int>(std::ceil((theta1 - theta0) / (1.5 * strip))));
  const double step = (theta1 - theta0) / panels;
  double sum = 0;
  for (int k = 0; k < panels; ++k) {
    for (const GaussNode& node : gauss_legendre(16)) {
      const double theta = theta0 + step * (k + node.x);
      const double foot = gap * std::sinh(theta) / sine * pair.cosine, h = gap * std::cosh(theta);
      sum += node.weight * std::atan2(h * (t1 - t0), h * h + (t0 - foot) * (t1 - foot));
    }
  }
  return gap * gap / sine * step * sum;
}

/// Lines at an angle, by the divergence theorem from their nearest points.
double crossing_closed_form(const EdgePair& pair) {
  const Edge &e = pair.outer, &f = pair.inner;
  const double s0 = -pair.crossing_s, s1 = e.length - pair.crossing_s;
  const double t0 = -pair.crossing_t, t1 = f.length - pair.crossing_t;
  const double boundary = s1 * log_distance_integral(e.end, f) - s0 * log_distance_integral(e.start, f) +
                          t1 * log_distance_integral(f.end, e) - t0 * log_distance_integral(f.start, e);
  return 0.5 * (boundary - e.length * f.length + gap_integral(pair));
}

/// `outer` is not much shorter than `inner`, or `inner` is not near.
double integrate(const Edge& outer, const Edge& inner) {
  const EdgePair pair(outer, inner);
  const int nodes = nodes_for_panel(pair, 0, outer.length);
  if (nodes <= max_nodes) return pair.panel(0, outer.length, nodes);
  if (pair.sine < 1e-14) return parallel_closed_form(pair);
  if (pair.sine > least_sine) return crossing_closed_form(pair);
  return graded(pair, 0, outer.length);
}

}  // namespace

double log_distance_integral(const Vec3d& p, const Edge& edge) {
  const double foot = dot(p - edge.start, edge.direction);
  return log_integral(-foot, edge.length - foot, glm::length(cross(p - edge.start, edge.direction)));
}

double log_distance_integral(const Edge& first, const Edge& second) {
  if (first.length == 0 || second.length == 0) return 0;
  const bool first_is_shorter = first.length <= second.length;
  const Edge& outer = first_is_shorter ? first : second;
  const Edge& inner = first_is_shorter ? second : first;
  if (inner.length <= 6 * outer.length) return integrate(outer, inner);
  // The closed forms lose digits on lengths unlike: keep them to the part of the long edge that is near.
  const double foot0 = dot(outer.start - inner.start, inner.direction);
  const double foot1 = dot(outer.end - inner.start, inner.direction);
  const double near0 = std::clamp(std::min(foot0, foot1) - 2 * outer.length, 0.0, inner.length);
  const double near1 = std::clamp(std::max(foot0, foot1) + 2 * outer.length, 0.0, inner.length);
  const Vec3d cut0 = near0 > 0 ? inner.start + near0 * inner.direction : inner.start;
  const Vec3d cut1 = near1 < inner.length ? inner.start + near1 * inner.direction : inner.end;
  double sum = 0;
  if (near0 > 0) sum += integrate(outer, Edge(inner.start, cut0));
  if (near1 > near0) sum += integrate(outer, Edge(cut0, cut1));
  if (near1 < inner.length) sum += integrate(outer, Edge(cut1, inner.end));
  return sum;
}

}  // namespace penumbra
