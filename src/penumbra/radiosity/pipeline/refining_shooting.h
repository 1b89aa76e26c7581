#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "penumbra/parallel/progress.h"
#include "penumbra/radiosity/form_factors/form_factor_method.h"
#include "penumbra/radiosity/patch_mesh.h"
#include "penumbra/radiosity/solvers/radiosity_problem.h"
#include "penumbra/radiosity/solvers/radiosity_solution.h"
#include "penumbra/scene/scene.h"

namespace penumbra {

struct RefiningShootingOptions {
  std::size_t element_count = 5000;  ///< at most about this many, both sides counted; an eighth of them are patches
  double element_size = 0;           ///< longest edge of a patch, m; 0: from the count
  double contrast = 1e-3;            ///< as AdaptiveMeshingOptions
  bool front_sides_only = false;     ///< backs are black and opaque
  FormFactorOptions factors;
  std::size_t at_once = 16;  ///< patches that shoot at once; the result depends on it, on threads it does not
  /// Up to this many elements gather from each other once; 0: none. With more the time would grow as their square, and
  /// patches are small enough.
  std::size_t most_gathering = 30000;
  std::uint64_t seed = 0;
};

/// Shooting that refines elements as light arrives: patches shoot, elements receive (Cohen, Greenberg, Immel & Brock
/// 1986; Cohen, Chen, Wallace & Greenberg 1988).
///
/// Patches are coarse and even; elements are pieces of them, cut along the lamps' shadow lines to begin with. The
/// patches p of most unshot energy send their mean unshot radiosity to all elements e,
///
///     H_e += F_ep dB_p,    B_e = E_e + rho_e H_e,    dB_p = mean of B_e over p - S_p,    S_p: what p has sent until
///     now.
///
/// After each batch the elements that received most are looked at: where the shooters' light (exact at points) departs
/// from what an element's corners interpolate to, it is split, worst first, as many as befits the share of the light
/// that has been sent by then. The pieces share out what the whole had received as all patches' light (sum_p F_ep S_p)
/// falls on them: cuts change no power. So whatever shines, a lamp or a bright ceiling, gets elements along its
/// shadows. Lights that are no elements (points, far lights) are looked at before the first shot; the sky asks for no
/// elements. What is left of the elements when nearly all light was sent is spent on the largest.
///
/// Near a corner a patch's mean says little of what its parts send. So, when the elements are as they will be and
/// nearly all light was sent, elements gather once from each other,
///
///     H_e = sum_c F_ec S_c,    S_c = B_c S_p / (mean of B over p),    c a piece of p,
///
/// and patches send the rest. Against the same elements solved by Gauss-Seidel radiosities differ by 0.2 to 0.7 %
/// (root mean square, Cornell box), by 1.5 to 3 % without.
///
/// Memory is O(elements + patches): rows are computed when they are asked for (a fixed number is kept). The same bits
/// on any number of threads.
class RefiningShooting {
 public:
  /// The scene must outlive this. Throws std::invalid_argument as make_adaptive_elements does.
  RefiningShooting(const Scene& scene, const RefiningShootingOptions& options, const Progress& progress = {});
  ~RefiningShooting();

  /// The elements of now, each a patch and a surface of the mesh, and their problem.
  [[nodiscard]] const PatchMesh& mesh() const;
  [[nodiscard]] const RadiosityProblem& problem() const;
  [[nodiscard]] const std::vector<std::string>& warnings() const;
  /// Shoots until a criterion holds. Iterations, residuals, escaped energy and ends are those of solve_shooting();
  /// residuals and unshot energy are of the patches. Stages show the elements of their time, see mesh(). The unshot
  /// energy (sum over patches of A_p |dB_p|) falls from stage to stage: where finer elements find light that coarser
  /// ones missed, the stage goes on until less is unshot than before it. Call it once.
  [[nodiscard]] RadiositySolution solve(const SolverOptions& options);

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace penumbra
