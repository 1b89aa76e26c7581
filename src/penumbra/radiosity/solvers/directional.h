#pragma once

#include <cstddef>
#include <cstdint>
#include <limits>
#include <vector>

#include "penumbra/parallel/progress.h"
#include "penumbra/radiosity/patch_mesh.h"
#include "penumbra/radiosity/solvers/radiosity_solution.h"

namespace penumbra {

/// Elements that reflect diffusely, glossily, as mirrors, or in part each. Arrays are [element * bands + band].
struct DirectionalProblem {
  std::size_t bands = 3;
  std::vector<double> diffuse;   ///< diffuse reflectance, 0..1
  std::vector<double> specular;  ///< reflectance of the lobe or mirror, 0..1; diffuse + specular <= 1
  std::vector<double> emission;  ///< E, diffuse, W/m^2, >= 0
  /// Per element: the lobe's exponent; infinite for a mirror. Empty: mirrors.
  std::vector<double> exponent;
};

struct DirectionalOptions {
  int polar_bins = 8;     ///< of a patch's hemisphere
  int azimuth_bins = 16;  ///< even
  int rays = 16;          ///< through each bin of each patch
  std::uint64_t seed = 0;
  double tolerance = 1e-5;         ///< largest change of a radiance in a sweep over the largest radiance emitted
  std::size_t max_iterations = 0;  ///< sweeps; 0: a safe limit
  Progress progress;
};

/// Radiance by patch and direction.
struct DirectionalSolution {
  std::size_t bins = 0;
  std::vector<double> radiance;    ///< leaving, W/(m^2 sr), [(element * bins + bin) * bands + band]
  std::vector<double> radiosity;   ///< B, W/m^2, [element * bands + band]
  std::vector<double> irradiance;  ///< H, W/m^2, [element * bands + band]
  std::vector<double> residuals;   ///< per sweep: largest change of a radiance over the largest emitted
  std::size_t iterations = 0;
  bool converged = false;
  bool partial = false;
  /// Each term from its own definition: what leaves through rays that meet nothing, what arrives and is not reflected.
  /// emitted - absorbed - escaped shows how well bins and rays keep the energy; unshot is 0.
  EnergyBalance energy;
};

/// Radiosity for surfaces that are not diffuse (Immel, Cohen & Greenberg 1986): each patch keeps a radiance for each
/// bin of its hemisphere, and each bin of each patch gathers from the patches it sees the radiance that they send back
/// into it:
///
///     Lin_i(d) = mean over rays of bin d of L_j(bin of the ray reversed, at the patch j that it meets),
///     L_i(d) = E_i / pi + rho_d / pi sum_d' Lin_i(d') w + rho_s sum_d' lobe(d, d') Lin_i(d'),    w = pi / bins.
///
/// The rays (Owen-scrambled Sobol points over patch and bin) are traced once; sweeps reuse what they met, on all
/// threads with the same bits. A radiance is constant over its patch and its bin, so that mirrors blur by a patch and
/// a bin with each reflection: that is the method's error, which falls as both are refined; diffuse surfaces do not
/// suffer. Memory: patches x bins x (4 rays + 8 bands) bytes: small scenes. Each surface should be one patch.
/// Throws std::invalid_argument for arrays of the wrong length, values or options out of range, surfaces of several
/// patches, or more than 2^32 - 2 bins in all.
[[nodiscard]] DirectionalSolution solve_directional(const PatchMesh& mesh, const DirectionalProblem& problem,
                                                    const DirectionalOptions& options = {});

}  // namespace penumbra
