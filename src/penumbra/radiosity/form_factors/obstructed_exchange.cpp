#include "penumbra/radiosity/form_factors/obstructed_exchange.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace penumbra {
namespace {

constexpr int nodes = 4;
constexpr double least_balance = 0.02;  // a shadow line closer than this share to a cell's rim does not split it

/// Legendre polynomials of degree 2 and 3 at the Gauss nodes, orthonormal on [0, 1].
struct HighModes {
  std::array<double, nodes> weight, second, third;
  HighModes() {
    const auto rule = gauss_legendre(nodes);
    for (std::size_t k = 0; k < nodes; ++k) {
      const double t = 2 * rule[k].x - 1;
      weight[k] = rule[k].weight;
      second[k] = std::sqrt(5.0) * 0.5 * (3 * t * t - 1);
      third[k] = std::sqrt(7.0) * 0.5 * (5 * t * t * t - 3 * t);
    }
  }
};

/// How rough 4 x 4 values are: the error of their Gauss sum as a share of the piece's area. The Legendre coefficients
/// of degree 3 and their decay from degree 2 are extrapolated to what Gauss misses; a kink keeps them from decaying.
double roughness(std::span<const double> values) {
  static const HighModes modes;
  double second = 0, third = 0;
  for (int axis = 0; axis < 2; ++axis) {
    for (std::size_t mode = 0; mode < 2; ++mode) {  // across: constant and linear-like
      double c2 = 0, c3 = 0;
      for (std::size_t i = 0; i < nodes; ++i) {
        for (std::size_t j = 0; j < nodes; ++j) {
          const double f = axis == 0 ? values[i * nodes + j] : values[j * nodes + i];
          const double across = mode == 0 ? 1.0 : (j < nodes / 2 ? -1.0 : 1.0);
          const double w = modes.weight[i] * modes.weight[j] * across * f;
          c2 += w * modes.second[i];
          c3 += w * modes.third[i];
        }
      }
      second += c2 * c2;
      third += c3 * c3;
    }
  }
  second = std::sqrt(second);
  third = std::sqrt(third);
  if (third == 0) return 0;
  const double decay = std::min(1.0, third / std::max(second, 1e-300));
  return 0.25 * third * decay;
}

}  // namespace

void ObstructedExchange::set_pair(std::span<const Vec3d> receiver, const Plane3& receiver_plane,
                                  std::span<const Vec3d> source, const Plane3& source_plane,
                                  std::span<const std::uint32_t> blockers) {
  receiver_plane_ = receiver_plane;
  clip_polygon(receiver, source_plane, 0, receiver_);
  clip_polygon(source, receiver_plane, 0, source_);
  lines_.clear();
  lines_found_ = false;
  blocker_count_ = 0;
  if (receiver_.size() < 3 || source_.size() < 3) return;
  fragments_.set_source(source_);
  for (std::uint32_t k : blockers) {
    const double slack = occluders_.slack[k];
    double over_receiver = 0, over_source = 0;
    for (const Vec3d& v : occluders_.polygon(k)) {
      over_receiver = std::max(over_receiver, receiver_plane.distance(v));
      over_source = std::max(over_source, source_plane.distance(v));
    }
    if (over_receiver <= slack || over_source <= slack) continue;
    clip_polygon(occluders_.polygon(k), receiver_plane, 0, clipped_);
    if (clipped_.size() < 3) continue;
    if (blockers_.size() == blocker_count_) blockers_.emplace_back();
    auto& blocker = blockers_[blocker_count_];
    clip_polygon(clipped_, source_plane, 0, blocker);
    if (blocker.size() < 3) continue;
    ++blocker_count_;
    fragments_.add_occluder(blocker, occluders_.planes[k]);
  }
}

ExchangeEstimate ObstructedExchange::rule_on(std::span<const WeightedPoint> points) {
  const std::size_t count =
      (points.size() + VisibleFragments::group - 1) / VisibleFragments::group * VisibleFragments::group;
  for (auto* v : {&x_, &y_, &z_, &factors_})
    if (v->size() < count) v->resize(count);
  for (std::size_t k = 0; k < count; ++k) {
    const Vec3d& p = points[std::min(k, points.size() - 1)].point;
    x_[k] = p.x;
    y_[k] = p.y;
    z_[k] = p.z;
  }
  fragments_.evaluate(x_.data(), y_.data(), z_.data(), count, receiver_plane_.normal, factors_.data());

  ExchangeEstimate e;
  constexpr std::size_t tensor = nodes * nodes;
  for (std::size_t first = 0; first + tensor <= points.size(); first += tensor) {
    double area = 0;
    for (std::size_t k = first; k < first + tensor; ++k) {
      e.exchange += points[k].weight * factors_[k];
      area += points[k].weight;
    }
    e.error += std::abs(area) * roughness(std::span(factors_).subspan(first, tensor));
  }
  return e;
}

void ObstructedExchange::evaluate(Cell& cell) {
  polygon_rule(cell.polygon, nodes, points_);
  const ExchangeEstimate e = rule_on(points_);
  cell.exchange = e.exchange;
  cell.error = e.error;
}

ExchangeEstimate ObstructedExchange::integrate(double allowed, double relative, std::size_t max_cells) {
  if (receiver_.size() < 3 || source_.size() < 3) return {};
  std::size_t count = 1;
  if (cells_.empty()) cells_.emplace_back();
  cells_[0].polygon = receiver_;
  evaluate(cells_[0]);
  double error = cells_[0].error, exchange = cells_[0].exchange;
  // A heap with the worst cell on top.
  const auto better = [](const Cell& a, const Cell& b) { return a.error < b.error; };
  while (error > allowed + relative * exchange && count < max_cells) {
    std::pop_heap(cells_.begin(), cells_.begin() + static_cast<std::ptrdiff_t>(count), better);
    if (cells_.size() < count + 2) cells_.resize(count + 2);
    Cell& worst = cells_[count - 1];
    Cell& left = cells_[count];
    Cell& right = cells_[count + 1];
    if (!split(worst, left, right)) break;
    evaluate(left);
    evaluate(right);
    error += left.error + right.error - worst.error;
    exchange += left.exchange + right.exchange - worst.exchange;
    std::swap(worst, left);
    std::swap(left, right);
    std::push_heap(cells_.begin(), cells_.begin() + static_cast<std::ptrdiff_t>(count), better);
    ++count;
    std::push_heap(cells_.begin(), cells_.begin() + static_cast<std::ptrdiff_t>(count), better);
  }
  ExchangeEstimate sum;
  for (std::size_t k = 0; k < count; ++k) {
    sum.exchange += cells_[k].exchange;
    sum.error += cells_[k].error;
  }
  return sum;
}

void ObstructedExchange::find_shadow_lines() {
  lines_found_ = true;
  const auto add = [&](const Vec3d& pole, const Vec3d& from, const Vec3d& to, bool corner_on_source) {
    const Vec3d across = cross(from - pole, to - pole);
    const double size = length(across);
    if (!(size > 1e-14 * length(from - pole) * length(to - pole))) return;
    ShadowLine line{{across / size, dot(across / size, pole)}, pole, from, to, corner_on_source};
    bool front = false, back = false;
    for (const Vec3d& v : receiver_) {
      const double d = line.plane.distance(v);
      front |= d > 0;
      back |= d < 0;
    }
    if (front && back) lines_.push_back(line);
  };
  for (std::size_t k = 0; k < blocker_count_; ++k) {
    const auto& blocker = blockers_[k];
    for (std::size_t a = 0; a < source_.size(); ++a)
      for (std::size_t b = 0; b < blocker.size(); ++b) {
        add(source_[a], blocker[b], blocker[(b + 1) % blocker.size()], true);
        add(blocker[b], source_[a], source_[(a + 1) % source_.size()], false);
      }
  }
}

/// Whether, somewhere along the line's chord through the cell, the corner covers a point of the edge itself and not
/// only of its extension.
bool ObstructedExchange::matters(const ShadowLine& line, std::span<const Vec3d> cell) const {
  double least = 1e300, most = -1e300;
  for (std::size_t c = 0; c < cell.size(); ++c) {
    const Vec3d& p = cell[c];
    const Vec3d& q = cell[(c + 1) % cell.size()];
    const double dp = line.plane.distance(p), dq = line.plane.distance(q);
    if ((dp < 0) == (dq < 0)) continue;
    const Vec3d x = p + dp / (dp - dq) * (q - p);
    const Vec3d ray = line.pole - x, edge = line.to - line.from;
    const double scale = dot(cross(edge, ray), line.plane.normal);
    if (std::abs(scale) <= 1e-9 * length(edge) * length(ray)) return true;
    const double u = dot(cross(x - line.from, ray), line.plane.normal) / scale;
    least = std::min(least, u);
    most = std::max(most, u);
  }
  return least <= 1 && most >= 0;
}

bool ObstructedExchange::split(const Cell& cell, Cell& left, Cell& right) {
  if (!lines_found_) find_shadow_lines();
  const ShadowLine* best = nullptr;
  double best_balance = least_balance;
  for (const ShadowLine& line : lines_) {
    double front = 0, back = 0;
    for (const Vec3d& v : cell.polygon) {
      const double d = line.plane.distance(v);
      front = std::max(front, d);
      back = std::max(back, -d);
    }
    const double balance = std::min(front, back) / (front + back);
    if (balance > best_balance && matters(line, cell.polygon)) {
      best_balance = balance;
      best = &line;
    }
  }
  Plane3 cut;
  if (best) {
    cut = best->plane;
  } else {  // across the longest edge, through the middle
    std::size_t longest = 0;
    double most = -1;
    for (std::size_t c = 0; c < cell.polygon.size(); ++c) {
      const double l = length_squared(cell.polygon[(c + 1) % cell.polygon.size()] - cell.polygon[c]);
      if (l > most * (1 + 1e-9)) {
        most = l;
        longest = c;
      }
    }
    const Vec3d along = normalize(cell.polygon[(longest + 1) % cell.polygon.size()] - cell.polygon[longest]);
    cut = {along, dot(along, polygon_centroid(cell.polygon))};
  }
  clip_polygon(cell.polygon, cut, 0, left.polygon);
  clip_polygon(cell.polygon, {-cut.normal, -cut.offset}, 0, right.polygon);
  return left.polygon.size() >= 3 && right.polygon.size() >= 3;
}

}  // namespace penumbra
