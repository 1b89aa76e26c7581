#pragma once

#include "common_options.h"
#include "memory_limit.h"
#include "penumbra/parallel/parallel_for.h"

namespace penumbra::cli {

/// What --threads and --max-memory allow, while it lives.
class RunLimits {
 public:
  explicit RunLimits(const CommonOptions& options)
      : threads_(options.threads), memory_(options.max_memory, thread_count()) {}

 private:
  ThreadLimit threads_;
  MemoryLimit memory_;
};

}  // namespace penumbra::cli
