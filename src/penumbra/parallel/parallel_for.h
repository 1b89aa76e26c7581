#pragma once

#include <cstddef>
#include <functional>
#include <memory>

namespace penumbra {

/// Runs `body(first, last)` over disjoint ranges that cover [0, count), on every thread allowed, and
/// returns when all are done. Ranges hold at most `grain` indices and always start at a multiple of
/// `grain`, so work keyed by a range's start is the same on any number of threads. An exception of
/// `body` is rethrown here, after the rest stopped.
void parallel_for(std::size_t count, std::size_t grain,
                  const std::function<void(std::size_t first, std::size_t last)>& body);

/// Limits the threads of all parallel work in the process while it lives.
class ThreadLimit {
 public:
  /// @param threads 1 or more; 0 means every core this process may use.
  explicit ThreadLimit(int threads);
  ~ThreadLimit();
  ThreadLimit(const ThreadLimit&) = delete;
  ThreadLimit& operator=(const ThreadLimit&) = delete;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

/// The number of threads that parallel work may use now.
[[nodiscard]] int thread_count();

}  // namespace penumbra
