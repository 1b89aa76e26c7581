#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "penumbra/math/polygon.h"
#include "penumbra/math/quadrature.h"
#include "penumbra/radiosity/form_factors/analytic.h"
#include "penumbra/radiosity/form_factors/occluder_polygons.h"
#include "penumbra/radiosity/form_factors/shadow_lines.h"
#include "penumbra/radiosity/form_factors/silhouette.h"
#include "penumbra/radiosity/form_factors/visible_fragments.h"

namespace penumbra {

/// A_i F_ij (m^2) and an estimate of its absolute error.
struct ExchangeEstimate {
  double exchange = 0;
  double error = 0;
};

/// The exchange of two polygons that see each other in part.
///
/// The exact form factor from a point to the visible fragments of one polygon is integrated over the other by 4 x 4
/// Gauss points, or that to its hidden part, which is taken from the exchange without occluders, where the estimate
/// says that this is the smoother of the two. Where the estimated error is too large the polygon is cut along a shadow
/// line (the trace of a plane through a corner of the source and an edge of the occluders' silhouette, or an edge of
/// the source and an end of one): between those lines the integrand is smooth and Gauss converges fast; it has kinks
/// across them. Where no shadow line is left it is halved. The worst piece goes first (Walton, NISTIR 6925, 2002,
/// halves without looking for the lines).
///
/// One object a thread.
class ObstructedExchange {
 public:
  explicit ObstructedExchange(const OccluderPolygons& occluders) : occluders_(occluders) {}

  /// Prepares a pair: each polygon is clipped to the front of the other's plane, the blockers to the front of both.
  /// @param receiver the polygon to integrate over; @param blockers numbers of occluders, others do not matter.
  /// @param open an estimate of the exchange without them: what is hidden is taken from it when its error is small
  /// enough (else from the closed form), and it is a scale for what Gauss points may overlook, and for what may come
  /// through a seam between blockers.
  void set_pair(std::span<const Vec3d> receiver, const Plane3& receiver_plane, std::span<const Vec3d> source,
                const Plane3& source_plane, std::span<const std::uint32_t> blockers, const ExchangeEstimate& open);

  /// The same with a surface in between.
  void set_pair(std::span<const Vec3d> receiver, const Plane3& receiver_plane, std::span<const Vec3d> source,
                const Plane3& source_plane, const Silhouette::Surface& surface, const ExchangeEstimate& open);

  /// How much of the largest error that is possible an estimate holds, 0..1: 1 for a pair alone, 1 / sqrt(n) for one of
  /// n whose errors are added up. It is no less than what is to be expected.
  void set_caution(double caution) { caution_of_pair_ = caution; }

  /// Whether what stands between hides the same from all points: nothing, or when covered() all.
  [[nodiscard]] bool uniform() const { return silhouette_.edges().empty(); }
  [[nodiscard]] bool covered() const { return silhouette_.reference() && silhouette_.reference()->covering > 0.5; }

  /// Blockers left after clipping; with 0 the pair is unobstructed.
  [[nodiscard]] std::size_t blocker_count() const { return silhouette_.polygon_count(); }

  /// Integrates until the estimated error is at most `allowed` (m^2) + `relative` * exchange, or `max_cells` pieces
  /// were made.
  [[nodiscard]] ExchangeEstimate integrate(double allowed, double relative, std::size_t max_cells);

 private:
  struct Cell {
    std::vector<Vec3d> polygon;
    ExchangeEstimate seen, hidden;
  };
  /// A sum over cells.
  struct Total {
    double exchange = 0, error = 0, variance = 0;
    void add(const ExchangeEstimate& e, double times = 1) {
      exchange += times * e.exchange;
      error += times * e.error;
      variance += times * e.error * e.error;
    }
    /// Errors have signs of their own, so that squares add up; with caution they need not.
    [[nodiscard]] double error_with(double caution) const {
      const double together = std::max(0.0, error), apart = std::sqrt(std::max(0.0, variance));
      return apart + caution * (together - apart);
    }
  };

  [[nodiscard]] bool clip_pair(std::span<const Vec3d> receiver, const Plane3& receiver_plane,
                               std::span<const Vec3d> source, const Plane3& source_plane, const ExchangeEstimate& open);
  void evaluate(Cell& cell);
  void apply_rule(Cell& cell, const ShadowLines::Cut& kink_of_seen, const ShadowLines::Cut& kink_of_hidden);
  ExchangeEstimate open_exchange(double allowed);
  void find_poles();
  [[nodiscard]] bool touches(std::span<const Vec3d> cell, std::span<const Vec3d> points) const;
  bool split(const Cell& cell, Cell& left, Cell& right);

  const OccluderPolygons& occluders_;
  VisibleFragments fragments_;
  Plane3 receiver_plane_;
  ExchangeEstimate open_;
  double open_factor_ = 0;
  ExchangeAreaScratch scratch_;
  std::vector<Vec3d> receiver_, source_;
  Silhouette silhouette_;
  ShadowLines lines_;
  std::vector<Vec3d> poles_, contacts_;       // corners of silhouette and source on the receiver's plane
  double caution_of_pair_ = 1, caution_ = 1;  // the second less where errors of many edges add up
  std::vector<WeightedPoint> points_;
  std::vector<double> x_, y_, z_, seen_, hidden_;
  std::vector<Cell> cells_;
};

}  // namespace penumbra
