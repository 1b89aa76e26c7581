#include "penumbra/radiosity/form_factors/ray_cast.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <limits>
#include <stdexcept>
#include <utility>

#include "penumbra/math/frame.h"
#include "penumbra/math/rng.h"
#include "penumbra/math/sampling.h"
#include "penumbra/math/sobol.h"

namespace penumbra {
namespace {

constexpr int fewest_rays = 1024;

// An even spread over a convex polygon: a parallelogram keeps the square's strata, another is a fan of triangles chosen
// by the first coordinate, which is stretched over the chosen one.
class PolygonSampler {
 public:
  explicit PolygonSampler(std::span<const Vec3d> polygon) : polygon_(polygon) {
    parallelogram_ = polygon.size() == 4 && length(polygon[0] - polygon[1] + polygon[2] - polygon[3]) <=
                                                1e-12 * length(polygon[2] - polygon[0]);
    double sum = 0;
    for (std::size_t c = 1; c + 1 < polygon.size(); ++c) {
      sum += length(cross(polygon[c] - polygon[0], polygon[c + 1] - polygon[0]));
      upto_.push_back(sum);
    }
  }

  [[nodiscard]] Vec3d point(Vec2d u) const {
    if (parallelogram_) return polygon_[0] + u.x * (polygon_[1] - polygon_[0]) + u.y * (polygon_[3] - polygon_[0]);
    const double place = u.x * upto_.back();
    const auto found = std::upper_bound(upto_.begin(), upto_.end() - 1, place);
    const auto k = static_cast<std::size_t>(found - upto_.begin());
    const double before = k > 0 ? upto_[k - 1] : 0.0;
    u.x = std::clamp((place - before) / (upto_[k] - before), 0.0, 1.0);
    const Vec2d b = sample_triangle(u);
    return polygon_[0] + b.x * (polygon_[k + 1] - polygon_[0]) + b.y * (polygon_[k + 2] - polygon_[0]);
  }

 private:
  std::span<const Vec3d> polygon_;
  std::vector<double> upto_;  // areas summed, doubled
  bool parallelogram_ = false;
};

struct SobolPoint {
  Vec2d place, direction;
};

SobolPoint sobol_point(std::uint32_t index, const std::array<std::uint32_t, 4>& seeds) {
  std::array<double, 4> x{};
  for (int d = 0; d < 4; ++d) {
    const auto k = static_cast<std::size_t>(d);
    x[k] = (owen_scramble(sobol_bits(index, d), seeds[k]) + 0.5) * 0x1p-32;
  }
  return {{x[0], x[1]}, {x[2], x[3]}};
}

}  // namespace

// Hits of each patch met, scramble by scramble.
class RayCaster::Tally {
 public:
  explicit Tally(std::size_t patches) : slot_of_(patches, no_slot) {}

  void add(std::uint32_t patch, int scramble) {
    std::uint32_t& slot = slot_of_[patch];
    if (slot == no_slot) {
      slot = static_cast<std::uint32_t>(counts_.size());
      counts_.push_back({patch, {}});
    }
    ++counts_[slot].hits[static_cast<std::size_t>(scramble)];
  }

  /// @param rays of one scramble.
  [[nodiscard]] std::vector<RayCastFactor> factors(std::uint32_t rays) const {
    std::vector<RayCastFactor> out;
    for (const Count& count : counts_) {
      double sum = 0;
      for (const std::uint32_t h : count.hits) sum += h;
      const double mean = sum / scrambles;
      out.push_back({count.patch, mean / rays, std::sqrt(variance(count, sum, rays)) / (double{scrambles} * rays)});
    }
    std::sort(out.begin(), out.end(), [](const auto& a, const auto& b) { return a.patch < b.patch; });
    return out;
  }

 private:
  // Of the sum of all hits. The scatter of the scrambles has few degrees of freedom, and with a handful of hits it
  // knows little: the binomial variance of random rays, which low-discrepancy ones hardly exceed, counts for
  // `prior_freedom` more (a moderated variance, Smyth 2004), and one hit is added for what a count near zero cannot
  // tell.
  template <class Hits>
  [[nodiscard]] static double variance(const Hits& count, double sum, std::uint32_t rays) {
    constexpr double freedom = scrambles - 1, prior_freedom = 2;
    double scatter = 0;
    for (const std::uint32_t h : count.hits) scatter += (h - sum / scrambles) * (h - sum / scrambles);
    const double binomial = sum * (1 - sum / (double{scrambles} * rays));
    return (scrambles * scatter + prior_freedom * binomial) / (freedom + prior_freedom) + 1;
  }

  static constexpr std::uint32_t no_slot = 0xFFFFFFFFU;
  struct Count {
    std::uint32_t patch;
    std::array<std::uint32_t, scrambles> hits;
  };
  std::vector<std::uint32_t> slot_of_;
  std::vector<Count> counts_;
};

void RayCaster::cast(std::uint32_t patch, int scramble, std::uint32_t first, std::uint32_t last, std::uint64_t seed,
                     Tally& tally) const {
  const PolygonSampler sampler(mesh_.polygon(patch));
  const Frame frame(mesh_.normals[patch]);
  std::array<std::uint32_t, 4> seeds{};
  for (std::size_t d = 0; d < 4; ++d) seeds[d] = static_cast<std::uint32_t>(hash_key(seed, patch, scramble, d));
  RayPacket rays{};
  std::fill(std::begin(rays.t_max), std::end(rays.t_max), std::numeric_limits<float>::infinity());
  std::uint32_t met[RayPacket::size];
  for (std::uint32_t at = first; at < last; at += RayPacket::size) {
    for (std::uint32_t lane = 0; lane < RayPacket::size; ++lane) {
      rays.active[lane] = at + lane < last ? -1 : 0;
      const SobolPoint sample = sobol_point(std::min(at + lane, last - 1), seeds);
      const Vec3d direction = frame.to_world(sample_cosine_hemisphere(sample.direction));
      const Ray ray = tracer_.leave_patch(patch, sampler.point(sample.place), direction);
      rays.origin_x[lane] = static_cast<float>(ray.origin.x);
      rays.origin_y[lane] = static_cast<float>(ray.origin.y);
      rays.origin_z[lane] = static_cast<float>(ray.origin.z);
      rays.direction_x[lane] = static_cast<float>(direction.x);
      rays.direction_y[lane] = static_cast<float>(direction.y);
      rays.direction_z[lane] = static_cast<float>(direction.z);
      rays.t_min[lane] = static_cast<float>(ray.t_min);
    }
    tracer_.first_front(rays, met);
    for (std::uint32_t lane = 0; lane < RayPacket::size && at + lane < last; ++lane) {
      if (met[lane] != PatchTracer::no_patch && met[lane] != patch) tally.add(met[lane], scramble);
    }
  }
}

std::vector<RayCastFactor> RayCaster::row(std::uint32_t patch, int rays, std::uint64_t seed) const {
  Tally tally(mesh_.radiating_count);
  const auto each = std::bit_ceil(static_cast<std::uint32_t>((std::max(rays, 1) + scrambles - 1) / scrambles));
  for (int s = 0; s < scrambles; ++s) cast(patch, s, 0, each, seed, tally);
  return tally.factors(each);
}

std::vector<RayCastFactor> RayCaster::row(std::uint32_t patch, const RayCastOptions& options) const {
  if (options.rays > 0) return row(patch, options.rays, options.seed);
  Tally tally(mesh_.radiating_count);
  std::uint32_t done = 0;
  for (std::uint32_t each = fewest_rays / scrambles;; each *= 2) {
    for (int s = 0; s < scrambles; ++s) cast(patch, s, done, each, options.seed, tally);
    done = each;
    const auto factors = tally.factors(each);
    double error = 0;
    for (const RayCastFactor& f : factors) error += 3 * f.standard_error;
    const bool spent = 2 * std::uint64_t{each} * scrambles > static_cast<std::uint64_t>(options.most_rays);
    if (error <= options.tolerance || spent) return factors;
  }
}

namespace {

class RayCastMethod final : public FormFactorMethod {
 public:
  RayCastMethod(const PatchMesh& mesh, const RayCastOptions& options) : mesh_(mesh), options_(options), caster_(mesh) {
    if (options.rays < 0 || (options.rays > 0 && options.rays < RayCaster::scrambles) || options.rays > 1 << 28) {
      throw std::invalid_argument("rays should be from 16 to 268435456, or 0 to let the tolerance decide");
    }
    if (!(options.tolerance > 0)) throw std::invalid_argument("the tolerance should be positive");
  }

  [[nodiscard]] std::string_view name() const override { return "ray-cast"; }
  [[nodiscard]] std::size_t block_count() const override { return mesh_.radiating_count; }
  [[nodiscard]] FactorBlock block(std::size_t index) const override {
    const auto i = static_cast<std::uint32_t>(index);
    FactorBlock block;
    for (const RayCastFactor& f : caster_.row(i, options_)) {
      const double a = mesh_.areas[i], b = mesh_.areas[f.patch];
      const double share = a * b / (a + b);
      block.pairs.push_back({std::min(i, f.patch), std::max(i, f.patch), share * f.factor,
                             static_cast<float>(3 * share * f.standard_error)});
    }
    return block;
  }
  [[nodiscard]] bool computes_rows() const override { return true; }
  [[nodiscard]] PatchRow row(std::uint32_t patch) const override {
    PatchRow row;
    for (const RayCastFactor& f : caster_.row(patch, options_)) {
      row.patches.push_back(f.patch);
      row.exchanges.push_back(mesh_.areas[patch] * f.factor);
    }
    return row;
  }

 private:
  const PatchMesh& mesh_;
  RayCastOptions options_;
  RayCaster caster_;
};

}  // namespace

std::unique_ptr<FormFactorMethod> make_ray_cast(const PatchMesh& mesh, const RayCastOptions& options) {
  return std::make_unique<RayCastMethod>(mesh, options);
}

}  // namespace penumbra
