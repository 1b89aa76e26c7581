#include "penumbra/radiosity/pipeline/weakened_factors.h"

#include "penumbra/parallel/parallel_for.h"

namespace penumbra {

std::vector<double> weaken_factors(const PatchMesh& mesh, const AbsorbingAir& air, FactorMatrix& factors) {
  std::vector<double> taken(factors.rows(), 0.0);
  parallel_for(factors.rows(), 16, [&](std::size_t first, std::size_t last) {
    for (std::size_t i = first; i < last; ++i) {
      for (std::size_t k = factors.offsets[i]; k < factors.offsets[i + 1]; ++k) {
        const double left = air.between(mesh.polygon(i), mesh.polygon(factors.columns[k]));
        taken[i] += factors.values[k] * (1 - left);
        factors.values[k] *= left;
      }
    }
  });
  return taken;
}

}  // namespace penumbra
