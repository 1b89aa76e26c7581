#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <vector>

#include "penumbra/radiosity/form_factors/form_factor_method.h"
#include "penumbra/radiosity/patch_mesh.h"
#include "penumbra/radiosity/patch_tracer.h"

namespace penumbra {

struct RayCastOptions {
  /// Rays a patch, 16 or more, rounded up to 16 times a power of two; 0 doubles from 1024 until the row's tolerance is
  /// met or `most_rays` are spent.
  int rays = 0;
  int most_rays = 1 << 16;
  double tolerance = 1e-4;  ///< for each row, of the sum of 3 standard errors; only for rays = 0
  std::uint64_t seed = 0;
};

/// One factor of a row, estimated.
struct RayCastFactor {
  std::uint32_t patch = 0;
  double factor = 0;          ///< the share of rays that arrived
  double standard_error = 0;  ///< from the scatter of the scrambles; see RayCaster
};

/// Form factors by following rays: points spread evenly over a patch, directions with density cos / pi, and the share
/// of rays that meets a patch is its form factor (Malley 1988).
///
/// Points and directions are one four-dimensional Sobol sequence, Owen-scrambled `scrambles` times independently; the
/// scatter of the scrambles' means is an honest standard error (Owen 1997). It is mixed with a little of the variance
/// of random rays, since 16 scrambles estimate a variance badly and few hits tell little: 99 % of factors lie within
/// three of the result, which is 10 to 25 % above the root mean square error. The error falls faster than 1 /
/// sqrt(rays), about as rays^-0.6 where outlines cut the sample space. A factor whose patch no ray met is absent; it is
/// below 3 / rays with 95 % confidence. All member functions are thread-safe.
class RayCaster {
 public:
  static constexpr int scrambles = 16;

  explicit RayCaster(const PatchMesh& mesh) : mesh_(mesh), tracer_(mesh) {}

  /// The factors of one row, by ascending patch. @param rays as in RayCastOptions, not 0.
  [[nodiscard]] std::vector<RayCastFactor> row(std::uint32_t patch, int rays, std::uint64_t seed) const;
  /// The same with as many rays as the options ask for.
  [[nodiscard]] std::vector<RayCastFactor> row(std::uint32_t patch, const RayCastOptions& options) const;

 private:
  class Tally;
  void cast(std::uint32_t patch, int scramble, std::uint32_t first, std::uint32_t last, std::uint64_t seed,
            Tally& tally) const;

  const PatchMesh& mesh_;
  PatchTracer tracer_;
};

/// Ray casting as a method: each row gives its pairs a share of the exchange in inverse proportion to its variance,
/// A_j / (A_i + A_j). The error of a pair is 3 standard errors. Throws std::invalid_argument for options out of range.
[[nodiscard]] std::unique_ptr<FormFactorMethod> make_ray_cast(const PatchMesh& mesh, const RayCastOptions& options);

}  // namespace penumbra
