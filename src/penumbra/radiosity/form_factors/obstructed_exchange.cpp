#include "penumbra/radiosity/form_factors/obstructed_exchange.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace penumbra {
namespace {

constexpr int nodes = 4;
// Errors of the rule where the integrand has kinks, of degree 2 and 3's size: where the view opens or closes slowly,
// and where it does so between two nodes at once, as it may across two shadow lines.
constexpr double kink_share = 0.2, step_share = 1;
// What the nodes may overlook, of the open exchange: a strip up to the first node (0.069), where the view opens
// linearly; of a narrower strip's width: there it may open at once; between two lines all, up to the gap of two nodes.
constexpr double overlooked_share = 3e-3, overlooked_strip = 0.1, overlooked_step = 0.17, overlooked_step_strip = 1;
constexpr double first_node = 0.05;       // a line closer to the rim than about this is not seen by the nodes
constexpr double expected_share = 0.25;   // the mean error is at most this share of the estimate for slow views
constexpr double touching = 1e-6;         // of a cell's size
constexpr double many_edges = 12;         // more: a round outline, whose edges each have a small part in the error
constexpr double loose_tolerance = 0.01;  // relative
constexpr double open_share = 0.2;        // of the allowed error, that of the exchange without occluders
constexpr double rough_share = 0.5;       // error up to which it is a scale
constexpr double exact_share = 1e-12;     // error of the closed form as a share of the smaller area
// Of the exchange without blockers, and of what may be missed: next to nothing is nothing. Where a wall's corners meet
// those of its neighbours, moved by 1e-8 of their size, a closed room would let that through.
constexpr double seam_share = 1e-6, seam_tolerance = 0.1;
constexpr double first_cut_balance = 0.15;
constexpr double shortest_edge = 1e-10;  // of a polygon's longest: where it was cut at a corner; it has no direction
constexpr double least_balance = 1e-3;   // a shadow line closer than this share to a cell's rim does not split it

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

/// What 4 x 4 values at Gauss nodes say of the error of their sum, as a share of the piece's area, from their Legendre
/// coefficients c_m.
struct RuleError {
  double smooth = 0;     ///< if the integrand is smooth
  double irregular = 0;  ///< the size of degree 2 and 3: those of an integrand with a kink decay like m^-2 only
};

/// A smooth integrand's coefficients decay like r^m, and Gauss misses those from degree 8 on: c_0 r^8, of which r^6 is
/// taken to be safe.
RuleError rule_error(std::span<const double> values) {
  static const HighModes modes;
  double mean = 0, second = 0, third = 0;
  for (std::size_t i = 0; i < nodes; ++i)
    for (std::size_t j = 0; j < nodes; ++j) mean += modes.weight[i] * modes.weight[j] * values[i * nodes + j];
  for (int axis = 0; axis < 2; ++axis) {
    for (std::size_t mode = 0; mode < 2; ++mode) {  // across: constant, and a step that stands for all that is odd
      double c2 = 0, c3 = 0;
      for (std::size_t i = 0; i < nodes; ++i) {
        double line = 0;
        for (std::size_t j = 0; j < nodes; ++j) {
          const double f = axis == 0 ? values[i * nodes + j] : values[j * nodes + i];
          line += modes.weight[j] * (mode == 1 && j < nodes / 2 ? -f : f);
        }
        c2 += modes.weight[i] * line * modes.second[i];
        c3 += modes.weight[i] * line * modes.third[i];
      }
      second += c2 * c2;
      third += c3 * c3;
    }
  }
  second = std::sqrt(second);
  third = std::sqrt(third);
  if (!(mean > 0)) return {};
  const double rate = std::min(1.0, std::max(std::sqrt(second / mean), std::cbrt(third / mean)));
  const double rate2 = rate * rate;
  return {mean * rate2 * rate2 * rate2, std::sqrt(third * third + 0.25 * second * second)};
}

/// The part of `polygon` in front of a plane, without edges of no length.
void clip_cleanly(std::span<const Vec3d> polygon, const Plane3& plane, std::vector<Vec3d>& out) {
  clip_polygon(polygon, plane, 0, out);
  double longest = 0;
  for (std::size_t c = 0; c < out.size(); ++c)
    longest = std::max(longest, length_squared(out[c + 1 == out.size() ? 0 : c + 1] - out[c]));
  for (std::size_t c = out.size(); c-- > 0;) {
    const Vec3d& next = out[c + 1 >= out.size() ? 0 : c + 1];
    if (length_squared(next - out[c]) <= shortest_edge * shortest_edge * longest)
      out.erase(out.begin() + static_cast<std::ptrdiff_t>(c));
  }
}

}  // namespace

/// Whether something of both is left.
bool ObstructedExchange::clip_pair(std::span<const Vec3d> receiver, const Plane3& receiver_plane,
                                   std::span<const Vec3d> source, const Plane3& source_plane,
                                   const ExchangeEstimate& open) {
  receiver_plane_ = receiver_plane;
  open_ = open;
  clip_cleanly(receiver, source_plane, receiver_);
  clip_cleanly(source, receiver_plane, source_);
  lines_.clear();
  silhouette_.clear();
  if (receiver_.size() < 3 || source_.size() < 3) return false;
  fragments_.set_source(source_);
  return true;
}

void ObstructedExchange::set_pair(std::span<const Vec3d> receiver, const Plane3& receiver_plane,
                                  std::span<const Vec3d> source, const Plane3& source_plane,
                                  std::span<const std::uint32_t> blockers, const ExchangeEstimate& open) {
  if (clip_pair(receiver, receiver_plane, source, source_plane, open))
    silhouette_.build(occluders_, blockers, receiver_, receiver_plane, source_, source_plane);
}

void ObstructedExchange::set_pair(std::span<const Vec3d> receiver, const Plane3& receiver_plane,
                                  std::span<const Vec3d> source, const Plane3& source_plane,
                                  const Silhouette::Surface& surface, const ExchangeEstimate& open) {
  if (clip_pair(receiver, receiver_plane, source, source_plane, open))
    silhouette_.build(occluders_, surface, receiver_, receiver_plane, source_, source_plane);
}

/// Replaces what stands in the cell by the rule's sums over `points_`.
void ObstructedExchange::apply_rule(Cell& cell, const ShadowLines::Cut& kink_of_seen,
                                    const ShadowLines::Cut& kink_of_hidden) {
  const std::size_t count =
      (points_.size() + VisibleFragments::group - 1) / VisibleFragments::group * VisibleFragments::group;
  for (auto* v : {&x_, &y_, &z_, &seen_, &hidden_})
    if (v->size() < count) v->resize(count);
  for (std::size_t k = 0; k < count; ++k) {
    const Vec3d& p = points_[std::min(k, points_.size() - 1)].point;
    x_[k] = p.x;
    y_[k] = p.y;
    z_[k] = p.z;
  }
  fragments_.evaluate(silhouette_, x_.data(), y_.data(), z_.data(), count, receiver_plane_.normal, seen_.data(),
                      hidden_.data());
  for (std::size_t k = 0; k < count; ++k) hidden_[k] -= seen_[k];

  constexpr std::size_t tensor = nodes * nodes;
  const auto error_of = [&](const RuleError& e, const ShadowLines::Cut& kink) {
    double expected = kink.balance > first_node ? kink_share * e.irregular : e.smooth;
    double possible = kink.balance > first_node ? (kink.lines > 1 ? step_share : kink_share) * e.irregular : e.smooth;
    expected = std::max(expected, open_factor_ * std::min(overlooked_share, overlooked_strip * kink.balance));
    possible = std::max(possible,
                        open_factor_ * (kink.lines > 1 ? std::min(overlooked_step, overlooked_step_strip * kink.balance)
                                                       : std::min(overlooked_share, overlooked_strip * kink.balance)));
    return std::max(expected_share * expected, caution_ * possible);
  };
  const auto sum = [&](const std::vector<double>& values, const ShadowLines::Cut& kink) {
    ExchangeEstimate e;
    for (std::size_t first = 0; first + tensor <= points_.size(); first += tensor) {
      double area = 0;
      for (std::size_t k = first; k < first + tensor; ++k) {
        e.exchange += points_[k].weight * values[k];
        area += points_[k].weight;
      }
      e.error += std::abs(area) * error_of(rule_error(std::span(values).subspan(first, tensor)), kink);
    }
    return e;
  };
  cell.seen = sum(seen_, kink_of_seen);
  cell.hidden = sum(hidden_, kink_of_hidden);
}

void ObstructedExchange::evaluate(Cell& cell) {
  polygon_rule(cell.polygon, nodes, points_);
  constexpr ShadowLines::Cut everywhere{nullptr, 1, 2}, somewhere{nullptr, 1, 1};
  ShadowLines::Cut kink;
  if (!uniform() && touches(cell.polygon, poles_))
    kink = everywhere;
  else if (!uniform())
    kink = lines_.all_known() ? lines_.best_cut(cell.polygon) : somewhere;
  apply_rule(cell, touches(cell.polygon, contacts_) ? everywhere : kink, kink);
}

/// The exchange without occluders, to within `allowed`.
ExchangeEstimate ObstructedExchange::open_exchange(double allowed) {
  if (open_.error > allowed) {
    const double exact = exchange_area(receiver_, source_, scratch_);
    open_ = {exact, exact_share * std::min(polygon_area(receiver_), polygon_area(source_))};
  }
  return open_;
}

ExchangeEstimate ObstructedExchange::integrate(double allowed, double relative, std::size_t max_cells) {
  if (receiver_.size() < 3 || source_.size() < 3) return {};
  std::size_t count = 1;
  if (cells_.size() < 3) cells_.resize(3);
  cells_[0].polygon = receiver_;
  find_poles();
  const double averaged = std::min(1.0, many_edges / std::max(1.0, static_cast<double>(silhouette_.edges().size())));
  caution_ = caution_of_pair_ * std::pow(averaged, 4);
  if (!uniform()) open_factor_ = open_exchange(rough_share * open_.exchange).exchange / polygon_area(receiver_);
  // Across a shadow line the first values would not do: cut there at once when the tolerance is tight.
  if (!uniform()) lines_.find(receiver_, receiver_plane_, source_, silhouette_);
  if (!uniform() && relative < loose_tolerance && max_cells > 1) {
    if (lines_.best_cut(receiver_).balance > first_cut_balance && split(cells_[0], cells_[1], cells_[2])) {
      std::swap(cells_[0], cells_[1]);
      std::swap(cells_[1], cells_[2]);
      count = 2;
    }
  }
  Total seen, hidden;
  for (std::size_t k = 0; k < count; ++k) {
    evaluate(cells_[k]);
    seen.add(cells_[k].seen);
    hidden.add(cells_[k].hidden);
  }
  // What is hidden is integrated where that is smoother: of patches that touch the open exchange has a closed form.
  const bool from_open = hidden.error < seen.error;
  if (from_open) open_exchange(open_share * (allowed + relative * seen.exchange));
  const auto part = [from_open](Cell& cell) -> ExchangeEstimate& { return from_open ? cell.hidden : cell.seen; };
  Total sum = from_open ? hidden : seen;
  const auto total = [&] {
    const double error = sum.error_with(caution_);
    return from_open ? ExchangeEstimate{std::max(0.0, open_.exchange - sum.exchange), open_.error + error}
                     : ExchangeEstimate{sum.exchange, error};
  };
  const auto is_enough = [&] {
    const ExchangeEstimate e = total();
    return e.error <= allowed + relative * e.exchange;
  };
  // A heap with the worst cell on top.
  const auto better = [&](Cell& a, Cell& b) { return part(a).error < part(b).error; };
  std::make_heap(cells_.begin(), cells_.begin() + static_cast<std::ptrdiff_t>(count), better);
  while (!is_enough() && count < max_cells) {
    std::pop_heap(cells_.begin(), cells_.begin() + static_cast<std::ptrdiff_t>(count), better);
    if (cells_.size() < count + 2) cells_.resize(count + 2);
    Cell& worst = cells_[count - 1];
    Cell& left = cells_[count];
    Cell& right = cells_[count + 1];
    if (!split(worst, left, right)) break;
    evaluate(left);
    evaluate(right);
    sum.add(part(left));
    sum.add(part(right));
    sum.add(part(worst), -1);
    std::swap(worst, left);
    std::swap(left, right);
    std::push_heap(cells_.begin(), cells_.begin() + static_cast<std::ptrdiff_t>(count), better);
    ++count;
    std::push_heap(cells_.begin(), cells_.begin() + static_cast<std::ptrdiff_t>(count), better);
  }
  sum = {};
  for (std::size_t k = 0; k < count; ++k) sum.add(part(cells_[k]));
  ExchangeEstimate result = total();
  if (!uniform() && result.exchange <=
                        std::min(seam_share * open_.exchange, seam_tolerance * (allowed + relative * open_.exchange))) {
    result.error += result.exchange;
    result.exchange = 0;
  }
  return result;
}

/// Corners of the silhouette and of the source that stand on the receiver's plane: what is seen from beside one depends
/// on the side.
void ObstructedExchange::find_poles() {
  const double least = touching * polygon_size(receiver_);
  const auto find = [&](std::span<const Vec3d> corners, std::vector<Vec3d>& found) {
    found.clear();
    for (const Vec3d& v : corners)
      if (receiver_plane_.distance(v) <= least) found.push_back(v);
  };
  find(silhouette_.vertices(), poles_);
  find(source_, contacts_);
}

/// Whether one of some points in its plane is in a cell or on its outline.
bool ObstructedExchange::touches(std::span<const Vec3d> cell, std::span<const Vec3d> points) const {
  return std::any_of(points.begin(), points.end(), [&](const Vec3d& point) {
    for (std::size_t c = 0; c < cell.size(); ++c) {
      const Vec3d edge = cell[c + 1 == cell.size() ? 0 : c + 1] - cell[c];
      const double outside = dot(cross(edge, point - cell[c]), receiver_plane_.normal);
      if (outside < -touching * length_squared(edge)) return false;
    }
    return true;
  });
}

bool ObstructedExchange::split(const Cell& cell, Cell& left, Cell& right) {
  const ShadowLines::Cut best = lines_.best_cut(cell.polygon);
  Plane3 cut;
  if (best.balance > least_balance) {
    cut = *best.line;
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
