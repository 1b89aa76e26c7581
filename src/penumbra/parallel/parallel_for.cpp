#include "penumbra/parallel/parallel_for.h"

#include <tbb/global_control.h>
#include <tbb/parallel_for.h>
#include <tbb/task_arena.h>

#include <algorithm>
#include <atomic>
#include <cassert>
#include <optional>

namespace penumbra {

void parallel_for(std::size_t count, std::size_t grain,
                  const std::function<void(std::size_t first, std::size_t last)>& body) {
  assert(grain > 0);
  const std::size_t blocks = (count + grain - 1) / grain;
  // oneTBB orders the blocks after what came before this call, and what comes after it after the blocks. The atomic
  // says so once more, in a way that ThreadSanitizer sees though the library is not built for it.
  std::atomic<std::size_t> ordered{0};
  ordered.store(1, std::memory_order_release);
  const auto run = [&] {
    tbb::parallel_for(
        std::size_t{0}, blocks,
        [&](std::size_t b) {
          (void)ordered.load(std::memory_order_acquire);
          body(b * grain, std::min(count, (b + 1) * grain));
          ordered.fetch_add(1, std::memory_order_acq_rel);
        },
        tbb::simple_partitioner{});
  };
  // The implicit arena never has more slots than the machine has cores; an explicit one obeys ThreadLimit
  // also above that.
  if (tbb::this_task_arena::max_concurrency() == thread_count()) {
    run();
  } else {
    tbb::task_arena(thread_count()).execute(run);
  }
  (void)ordered.load(std::memory_order_acquire);
}

struct ThreadLimit::Impl {
  std::optional<tbb::global_control> control;
};

ThreadLimit::ThreadLimit(int threads) : impl_(std::make_unique<Impl>()) {
  assert(threads >= 0);
  const int count = threads > 0 ? threads : tbb::this_task_arena::max_concurrency();
  impl_->control.emplace(tbb::global_control::max_allowed_parallelism, static_cast<std::size_t>(count));
}

ThreadLimit::~ThreadLimit() = default;

int thread_count() {
  const auto allowed = tbb::global_control::active_value(tbb::global_control::max_allowed_parallelism);
  return static_cast<int>(allowed);
}

}  // namespace penumbra
