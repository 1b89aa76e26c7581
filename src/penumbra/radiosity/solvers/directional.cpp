#include "penumbra/radiosity/solvers/directional.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>
#include <stdexcept>
#include <utility>

#include "penumbra/math/frame.h"
#include "penumbra/math/rng.h"
#include "penumbra/math/sampling.h"
#include "penumbra/math/sobol.h"
#include "penumbra/parallel/parallel_for.h"
#include "penumbra/radiosity/patch_tracer.h"
#include "penumbra/radiosity/solvers/direction_bins.h"

namespace penumbra {
namespace {

constexpr double pi = std::numbers::pi;
constexpr std::uint32_t nothing = 0xFFFFFFFFU;

void check(const PatchMesh& mesh, const DirectionalProblem& p, const DirectionalOptions& options) {
  const std::size_t values = mesh.surface_count() * p.bands;
  if (p.bands == 0 || p.diffuse.size() != values || p.specular.size() != values || p.emission.size() != values ||
      (!p.exponent.empty() && p.exponent.size() != mesh.surface_count())) {
    throw std::invalid_argument("the directional problem's arrays should hold a value for each element and band");
  }
  for (std::size_t k = 0; k < values; ++k) {
    if (!(p.diffuse[k] >= 0 && p.specular[k] >= 0 && p.diffuse[k] + p.specular[k] <= 1 + 1e-12)) {
      throw std::invalid_argument("reflectances should not be negative, and diffuse and specular together at most 1");
    }
    if (!(p.emission[k] >= 0 && std::isfinite(p.emission[k]))) {
      throw std::invalid_argument("emissions should be finite and not negative");
    }
  }
  if (mesh.radiating_count != mesh.surface_count()) {
    throw std::invalid_argument("directional radiosity takes surfaces of one patch each; split the others");
  }
  if (options.rays < 1 || options.rays > 1 << 16) throw std::invalid_argument("rays a bin should be 1 to 65536");
  if (!(options.tolerance >= 0)) throw std::invalid_argument("the tolerance should not be negative");
}

/// A point spread evenly over a convex polygon: a fan of triangles, chosen by area.
Vec3d point_on(std::span<const Vec3d> polygon, Vec2d u) {
  double whole = 0;
  for (std::size_t k = 1; k + 1 < polygon.size(); ++k) {
    whole += length(cross(polygon[k] - polygon[0], polygon[k + 1] - polygon[0]));
  }
  double place = u.x * whole;
  for (std::size_t k = 1; k + 1 < polygon.size(); ++k) {
    const double area = length(cross(polygon[k] - polygon[0], polygon[k + 1] - polygon[0]));
    if (place <= area || k + 2 == polygon.size()) {
      const Vec2d b = sample_triangle({std::clamp(place / area, 0.0, 1.0), u.y});
      return polygon[0] + b.x * (polygon[k] - polygon[0]) + b.y * (polygon[k + 1] - polygon[0]);
    }
    place -= area;
  }
  return polygon[0];
}

/// What each ray of each bin of each patch meets: the bin of the patch there that sends light back along it.
class BinRays {
 public:
  BinRays(const PatchMesh& mesh, const DirectionBins& bins, const DirectionalOptions& options)
      : rays_(static_cast<std::size_t>(options.rays)) {
    const std::size_t patches = mesh.radiating_count;
    if (patches * bins.size() >= nothing) throw std::invalid_argument("too many direction bins in all; take fewer");
    for (std::size_t p = 0; p < patches; ++p) frames_.emplace_back(mesh.normals[p]);
    met_.resize(patches * bins.size() * rays_);
    const PatchTracer tracer(mesh);
    parallel_for(patches, 1, [&](std::size_t p, std::size_t) { trace(mesh, tracer, bins, p, options.seed); });
  }

  [[nodiscard]] std::size_t count() const { return rays_; }
  /// The bins that the rays of one bin meet, or `nothing`. @param bin patch * bins + bin.
  [[nodiscard]] std::span<const std::uint32_t> met(std::size_t bin) const {
    return std::span(met_).subspan(bin * rays_, rays_);
  }

 private:
  void trace(const PatchMesh& mesh, const PatchTracer& tracer, const DirectionBins& bins, std::size_t p,
             std::uint64_t seed) {
    const auto patch = static_cast<std::uint32_t>(p);
    for (std::size_t bin = 0; bin < bins.size(); ++bin) {
      std::uint32_t scramble[4];
      for (std::uint64_t d = 0; d < 4; ++d) scramble[d] = static_cast<std::uint32_t>(hash_key(seed, p, bin, d));
      for (std::uint32_t r = 0; r < rays_; ++r) {
        double x[4];
        for (int d = 0; d < 4; ++d) x[d] = (owen_scramble(sobol_bits(r, d), scramble[d]) + 0.5) * 0x1p-32;
        const Vec3d direction = frames_[p].to_world(bins.direction(bin, x[2], x[3]));
        const Ray ray = tracer.leave_patch(patch, point_on(mesh.polygon(p), {x[0], x[1]}), direction);
        const std::uint32_t hit = tracer.first_front(ray);
        std::uint32_t& met = met_[(p * bins.size() + bin) * rays_ + r];
        met = nothing;
        if (hit == PatchTracer::no_patch || hit == patch) continue;
        met = static_cast<std::uint32_t>(hit * bins.size() + bins.index(frames_[hit].to_local(-direction)));
      }
    }
  }

  std::size_t rays_;
  std::vector<Frame> frames_;
  std::vector<std::uint32_t> met_;
};

/// One patch's reflection of what arrives, bin by bin.
class Reflection {
 public:
  Reflection(const DirectionalProblem& problem, const DirectionBins& bins) : problem_(problem), bins_(bins) {
    for (const double exponent : problem.exponent) {
      if (std::isfinite(exponent) && !lobes_.contains(exponent)) lobes_[exponent] = glossy_lobe(bins, exponent);
    }
  }

  /// @param arriving [bin * bands + band]. @param leaving the same shape.
  void reflect(std::size_t element, std::span<const double> arriving, std::span<double> leaving) const {
    const std::size_t bands = problem_.bands, n = bins_.size();
    for (std::size_t b = 0; b < bands; ++b) {
      const std::size_t k = element * bands + b;
      double irradiance = 0;
      for (std::size_t d = 0; d < n; ++d) irradiance += arriving[d * bands + b] * bins_.projected_solid_angle();
      const double diffuse = (problem_.emission[k] + problem_.diffuse[k] * irradiance) / pi;
      for (std::size_t d = 0; d < n; ++d) leaving[d * bands + b] = diffuse;
    }
    const double exponent =
        problem_.exponent.empty() ? std::numeric_limits<double>::infinity() : problem_.exponent[element];
    const std::vector<double>* lobe = std::isfinite(exponent) ? &lobes_.at(exponent) : nullptr;
    for (std::size_t b = 0; b < bands; ++b) {
      const double specular = problem_.specular[element * bands + b];
      if (specular == 0) continue;
      for (std::size_t d = 0; d < n; ++d) {
        double sum = 0;
        if (lobe == nullptr) {
          sum = arriving[bins_.mirrored(d) * bands + b];
        } else {
          for (std::size_t e = 0; e < n; ++e) sum += (*lobe)[d * n + e] * arriving[e * bands + b];
        }
        leaving[d * bands + b] += specular * sum;
      }
    }
  }

 private:
  const DirectionalProblem& problem_;
  const DirectionBins& bins_;
  std::map<double, std::vector<double>> lobes_;
};

/// The radiance that arrives in each bin of a patch; returns nothing that is not in `radiance`.
void gather(const BinRays& rays, std::size_t bins, std::size_t bands, std::size_t element,
            const std::vector<double>& radiance, std::span<double> arriving) {
  std::fill(arriving.begin(), arriving.end(), 0.0);
  const double share = 1 / static_cast<double>(rays.count());
  for (std::size_t d = 0; d < bins; ++d) {
    for (const std::uint32_t met : rays.met(element * bins + d)) {
      if (met == nothing) continue;
      for (std::size_t b = 0; b < bands; ++b) arriving[d * bands + b] += share * radiance[met * bands + b];
    }
  }
}

/// Radiosity, irradiance and the energy of the last state.
void describe(const PatchMesh& mesh, const DirectionalProblem& problem, const DirectionBins& bins, const BinRays& rays,
              const Reflection& reflection, DirectionalSolution& solution) {
  const std::size_t bands = problem.bands, n = bins.size();
  const double weight = bins.projected_solid_angle();
  std::vector<double> arriving(n * bands), leaving(n * bands);
  for (std::size_t i = 0; i < mesh.surface_count(); ++i) {
    gather(rays, n, bands, i, solution.radiance, arriving);
    reflection.reflect(i, arriving, leaving);
    for (std::size_t b = 0; b < bands; ++b) {
      double received = 0, sent = 0, lost = 0, reflected = 0;
      for (std::size_t d = 0; d < n; ++d) {
        const auto met = rays.met(i * n + d);
        const auto missed = static_cast<double>(std::count(met.begin(), met.end(), nothing));
        const double radiance = solution.radiance[(i * n + d) * bands + b];
        received += weight * arriving[d * bands + b];
        reflected += weight * leaving[d * bands + b];
        sent += weight * radiance;
        lost += weight * radiance * missed / static_cast<double>(rays.count());
      }
      const double emission = problem.emission[i * bands + b];
      solution.irradiance.push_back(received);
      solution.radiosity.push_back(sent);
      solution.energy.emitted += mesh.areas[i] * emission;
      solution.energy.absorbed += mesh.areas[i] * (received - (reflected - emission));
      solution.energy.escaped += mesh.areas[i] * lost;
    }
  }
}

}  // namespace

DirectionalSolution solve_directional(const PatchMesh& mesh, const DirectionalProblem& problem,
                                      const DirectionalOptions& options) {
  check(mesh, problem, options);
  const DirectionBins bins(options.polar_bins, options.azimuth_bins);
  options.progress.tell("directions", 0);
  const BinRays rays(mesh, bins, options);
  const Reflection reflection(problem, bins);
  const std::size_t elements = mesh.surface_count(), bands = problem.bands, values = bins.size() * bands;

  DirectionalSolution solution;
  solution.bins = bins.size();
  solution.radiance.resize(elements * values);
  double largest_emitted = 0;
  for (std::size_t k = 0; k < solution.radiance.size(); ++k) {
    solution.radiance[k] = problem.emission[k / values * bands + k % bands] / pi;
    largest_emitted = std::max(largest_emitted, solution.radiance[k]);
  }
  std::vector<double> next(solution.radiance.size()), changes(elements);
  const std::size_t limit = options.max_iterations > 0 ? options.max_iterations : 10000;
  while (!solution.converged && !solution.partial && solution.iterations < limit) {
    parallel_for(elements, 1, [&](std::size_t i, std::size_t) {
      std::vector<double> arriving(values);
      gather(rays, bins.size(), bands, i, solution.radiance, arriving);
      const auto leaving = std::span(next).subspan(i * values, values);
      reflection.reflect(i, arriving, leaving);
      changes[i] = 0;
      for (std::size_t k = 0; k < values; ++k) {
        changes[i] = std::max(changes[i], std::abs(leaving[k] - solution.radiance[i * values + k]));
      }
    });
    solution.radiance.swap(next);
    ++solution.iterations;
    const double change = elements == 0 ? 0 : *std::max_element(changes.begin(), changes.end());
    solution.residuals.push_back(largest_emitted > 0 ? change / largest_emitted : change);
    solution.converged = solution.residuals.back() <= options.tolerance;
    solution.partial = !solution.converged && options.progress.stop_requested();
  }
  options.progress.tell("directions", 1);
  describe(mesh, problem, bins, rays, reflection, solution);
  return solution;
}

}  // namespace penumbra
