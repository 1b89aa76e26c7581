#include "penumbra/radiosity/form_factors/pair_methods.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <string>
#include <utility>
#include <vector>

#include "penumbra/math/polygon.h"
#include "penumbra/radiosity/form_factors/analytic.h"
#include "penumbra/radiosity/form_factors/nusselt.h"
#include "penumbra/radiosity/form_factors/obstructed_exchange.h"
#include "penumbra/radiosity/form_factors/occluder_index.h"
#include "penumbra/radiosity/form_factors/occluder_polygons.h"
#include "penumbra/radiosity/form_factors/point.h"
#include "penumbra/radiosity/form_factors/shaft.h"

namespace penumbra {
namespace {

/// Goes through the pairs row by row; what a method adds is the exchange of a pair that sees each other.
class PairwiseMethod : public FormFactorMethod {
 public:
  PairwiseMethod(std::string name, const PatchMesh& mesh)
      : mesh_(mesh), name_(std::move(name)), occluders_(make_occluder_polygons(mesh)), index_(occluders_) {
    for (std::uint32_t p = 0; p < mesh.patch_count(); ++p) {
      Bounds box;
      double r2 = 0;
      for (const Vec3d& v : mesh.polygon(p)) {
        box.grow(v);
        r2 = std::max(r2, length_squared(v - mesh.centroids[p]));
      }
      bounds_.push_back(box);
      radii_.push_back(std::sqrt(r2));
    }
  }

  [[nodiscard]] std::string_view name() const override { return name_; }
  [[nodiscard]] std::size_t block_count() const override { return mesh_.radiating_count; }
  [[nodiscard]] double block_cost(std::size_t index) const override {
    return static_cast<double>(mesh_.radiating_count - index);
  }
  [[nodiscard]] FactorBlock block(std::size_t index) const override {
    FactorBlock block;
    const auto i = static_cast<std::uint32_t>(index);
    for (std::uint32_t j = i + 1; j < mesh_.radiating_count; ++j) {
      const ExchangeEstimate e = exchange(i, j);
      if (e.exchange > 0) {
        block.pairs.push_back({i, j, e.exchange, static_cast<float>(e.error)});
      } else if (e.error > 0) {
        block.dropped.push_back({i, e.error});
        block.dropped.push_back({j, e.error});
      }
    }
    return block;
  }

  [[nodiscard]] bool computes_rows() const override { return true; }
  [[nodiscard]] PatchRow row(std::uint32_t patch) const override {
    PatchRow row;
    for (std::uint32_t j = 0; j < mesh_.radiating_count; ++j) {
      if (j == patch) continue;
      const double e = exchange(std::min(patch, j), std::max(patch, j)).exchange;
      if (!(e > 0)) continue;
      row.patches.push_back(j);
      row.exchanges.push_back(e);
    }
    return row;
  }

 protected:
  [[nodiscard]] virtual ExchangeEstimate exchange(std::uint32_t i, std::uint32_t j) const = 0;

  /// Whether the centres see each other, and all corners of the pair agree with that.
  struct Visibility {
    bool centres = true;
    bool undivided = true;
  };
  [[nodiscard]] Visibility visibility(std::uint32_t i, std::uint32_t j) const {
    Visibility v;
    const Shaft shaft(bounds_[i], bounds_[j]);
    const auto a = mesh_.polygon(i), b = mesh_.polygon(j);
    const Vec3d from = centre_before(i, j), to = centre_before(j, i);
    for (std::uint32_t k = 0; k < occluders_.size(); ++k) {
      if (shaft.misses(occluders_.bounds[k])) continue;
      const Sight sight = index_.sight(a, b, k);
      if (sight == Sight::hidden) return {false, true};
      if (sight == Sight::partial) {
        v.undivided = false;
        v.centres = v.centres && !crosses(from, to, k);
      }
    }
    return v;
  }

  [[nodiscard]] double radius(std::uint32_t p) const { return radii_[p]; }

  const PatchMesh& mesh_;

 private:
  // The centre of a patch or, when it reaches behind another, of what is in front of that.
  [[nodiscard]] Vec3d centre_before(std::uint32_t patch, std::uint32_t other) const {
    const Plane3 horizon{mesh_.normals[other], dot(mesh_.normals[other], mesh_.centroids[other])};
    const auto polygon = mesh_.polygon(patch);
    if (std::all_of(polygon.begin(), polygon.end(), [&](const Vec3d& v) { return horizon.distance(v) >= 0; })) {
      return mesh_.centroids[patch];
    }
    std::vector<Vec3d> above;
    clip_polygon(polygon, horizon, 0, above);
    return above.size() < 3 ? mesh_.centroids[patch] : polygon_centroid(above);
  }

  // Whether the segment between two points meets an occluder.
  [[nodiscard]] bool crosses(const Vec3d& from, const Vec3d& to, std::uint32_t k) const {
    const Plane3& plane = occluders_.planes[k];
    const double a = plane.distance(from), b = plane.distance(to), slack = occluders_.slack[k];
    if (std::abs(a) <= slack || std::abs(b) <= slack || (a > 0) == (b > 0)) return false;
    // What passes exactly along an edge is hidden: where two walls meet neither may leave it to the other.
    const Vec3d at = from + a / (a - b) * (to - from);
    const auto edges = index_.planes(k).subspan(1);
    return std::all_of(edges.begin(), edges.end(), [&](const Plane3& edge) { return edge.distance(at) >= -slack; });
  }

  std::string name_;
  OccluderPolygons occluders_;
  OccluderIndex index_;
  std::vector<Bounds> bounds_;
  std::vector<double> radii_;
};

class PointMethod final : public PairwiseMethod {
 public:
  explicit PointMethod(const PatchMesh& mesh) : PairwiseMethod("point", mesh) {}

 private:
  [[nodiscard]] ExchangeEstimate exchange(std::uint32_t i, std::uint32_t j) const override {
    const double kernel = point_kernel(mesh_.centroids[i], mesh_.normals[i], mesh_.centroids[j], mesh_.normals[j]);
    if (!(kernel > 0) || !visibility(i, j).centres) return {};
    const double whole = kernel * mesh_.areas[i] * mesh_.areas[j];
    const double sizes = radius(i) * radius(i) + radius(j) * radius(j);
    return {whole, whole * sizes / length_squared(mesh_.centroids[j] - mesh_.centroids[i])};
  }
};

class NusseltMethod final : public PairwiseMethod {
 public:
  explicit NusseltMethod(const PatchMesh& mesh) : PairwiseMethod("nusselt", mesh) {}

 private:
  [[nodiscard]] ExchangeEstimate exchange(std::uint32_t i, std::uint32_t j) const override {
    const double there = mesh_.areas[i] * point_to_polygon(mesh_.centroids[i], mesh_.normals[i], mesh_.polygon(j));
    const double back = mesh_.areas[j] * point_to_polygon(mesh_.centroids[j], mesh_.normals[j], mesh_.polygon(i));
    if (!(there + back > 0) || !visibility(i, j).centres) return {};
    const double mean = 0.5 * (there + back);
    const double least = std::min(radius(i), radius(j));
    const double one_centre = least * least / length_squared(mesh_.centroids[j] - mesh_.centroids[i]);
    return {mean, std::abs(there - back) + mean * std::min(1.0, one_centre)};
  }
};

class AnalyticMethod final : public PairwiseMethod {
 public:
  explicit AnalyticMethod(const PatchMesh& mesh) : PairwiseMethod("analytic", mesh) {}

 private:
  [[nodiscard]] ExchangeEstimate exchange(std::uint32_t i, std::uint32_t j) const override {
    if (!faces(i, j) || !faces(j, i)) return {};
    const Visibility seen = visibility(i, j);
    if (seen.undivided && !seen.centres) return {};
    const double whole = exchange_area(mesh_.polygon(i), mesh_.polygon(j));
    if (seen.undivided) return {whole, 1e-12 * std::min(mesh_.areas[i], mesh_.areas[j])};
    return {seen.centres ? whole : 0.0, whole};
  }

  [[nodiscard]] bool faces(std::uint32_t i, std::uint32_t j) const {
    const auto polygon = mesh_.polygon(j);
    return std::any_of(polygon.begin(), polygon.end(),
                       [&](const Vec3d& v) { return dot(mesh_.normals[i], v - mesh_.centroids[i]) > 0; });
  }
};

}  // namespace

std::unique_ptr<FormFactorMethod> make_point(const PatchMesh& mesh) { return std::make_unique<PointMethod>(mesh); }
std::unique_ptr<FormFactorMethod> make_nusselt(const PatchMesh& mesh) { return std::make_unique<NusseltMethod>(mesh); }
std::unique_ptr<FormFactorMethod> make_analytic(const PatchMesh& mesh) {
  return std::make_unique<AnalyticMethod>(mesh);
}

}  // namespace penumbra
