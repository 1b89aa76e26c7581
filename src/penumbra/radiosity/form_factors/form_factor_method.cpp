#include "penumbra/radiosity/form_factors/form_factor_method.h"

#include <algorithm>
#include <stdexcept>
#include <string>

#include "penumbra/parallel/parallel_for.h"

namespace penumbra {

PatchRow FormFactorMethod::row(std::uint32_t /*patch*/) const {
  throw std::logic_error("the form factor method \"" + std::string(name()) + "\" computes no single rows");
}

bool visit_factors(const FormFactorMethod& method, const std::function<void(const FactorBlock&)>& visitor,
                   const Progress& progress) {
  const std::size_t count = method.block_count();
  double total_cost = 0;
  for (std::size_t b = 0; b < count; ++b) total_cost += method.block_cost(b);
  double done_cost = 0;
  progress.tell("form factors", 0);

  // A batch is computed in parallel and handed over in order: only a batch of blocks is ever in memory.
  const auto batch = std::max<std::size_t>(32, 8 * static_cast<std::size_t>(thread_count()));
  std::vector<FactorBlock> blocks(batch);
  for (std::size_t first = 0; first < count; first += batch) {
    const std::size_t size = std::min(batch, count - first);
    parallel_for(size, 1, [&](std::size_t b, std::size_t) {
      if (!progress.stop_requested()) blocks[b] = method.block(first + b);
    });
    if (progress.stop_requested()) return false;
    for (std::size_t b = 0; b < size; ++b) {
      visitor(blocks[b]);
      done_cost += method.block_cost(first + b);
    }
    progress.tell("form factors", total_cost > 0 ? std::min(1.0, done_cost / total_cost) : 1.0);
  }
  progress.tell("form factors", 1);
  return true;
}

}  // namespace penumbra
