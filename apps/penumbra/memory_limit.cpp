#include "memory_limit.h"

#include <sys/resource.h>
#include <unistd.h>

#include <algorithm>
#include <fstream>
#include <limits>
#include <string>

namespace penumbra::cli {
namespace {

// RLIMIT_DATA counts private memory that can be written, untouched or not (Linux 4.7 and later), and so do these pages.
double data_bytes() {
  std::ifstream statm("/proc/self/statm");
  double pages = 0;
  for (int field = 0; field < 6; ++field) statm >> pages;  // the sixth: data and stacks
  return pages * static_cast<double>(::sysconf(_SC_PAGESIZE));
}

double machine_bytes() {
  const double installed =
      static_cast<double>(::sysconf(_SC_PHYS_PAGES)) * static_cast<double>(::sysconf(_SC_PAGESIZE));
  double container = std::numeric_limits<double>::infinity();  // stays so when it reads "max"
  std::ifstream group("/sys/fs/cgroup/memory.max");
  if (double bytes = 0; group >> bytes) container = bytes;
  return std::min(installed, container);
}

double stack_bytes() {
  constexpr double usual = 8 << 20;
  rlimit limit{};
  ::getrlimit(RLIMIT_STACK, &limit);
  return limit.rlim_cur == RLIM_INFINITY ? usual : static_cast<double>(limit.rlim_cur);
}

void set_soft_limit(rlim_t bytes) {
  rlimit limit{};
  ::getrlimit(RLIMIT_DATA, &limit);
  limit.rlim_cur = std::min(bytes, limit.rlim_max);
  ::setrlimit(RLIMIT_DATA, &limit);
}

}  // namespace

MemoryLimit::MemoryLimit(std::optional<double> bytes, int threads) {
  constexpr double share = 0.8;
  rlimit limit{};
  ::getrlimit(RLIMIT_DATA, &limit);
  before_ = limit.rlim_cur;
  const double asked = std::max(least_memory, bytes.value_or(share * machine_bytes()));
  const double allowed = data_bytes() + asked + threads * stack_bytes();
  if (allowed < static_cast<double>(before_)) set_soft_limit(static_cast<rlim_t>(allowed));
}

MemoryLimit::~MemoryLimit() { set_soft_limit(before_); }

double memory_left() {
  rlimit limit{};
  ::getrlimit(RLIMIT_DATA, &limit);
  if (limit.rlim_cur == RLIM_INFINITY) return std::numeric_limits<double>::infinity();
  return std::max(0.0, static_cast<double>(limit.rlim_cur) - data_bytes());
}

}  // namespace penumbra::cli
