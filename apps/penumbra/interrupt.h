#pragma once

#include <atomic>
#include <csignal>
#include <stop_token>
#include <thread>

namespace penumbra::cli {

/// Ctrl-C (SIGINT) and SIGTERM while it lives: the first asks the work to stop and keep what it has, the second ends
/// the program at once (one within 0.3 s of the first counts as the same). While there is nothing to keep, the first
/// ends it too.
///
/// A thread of its own waits for the signals, so nothing runs inside a signal handler.
/// @pre made before any other thread, which then inherits the blocked signals.
class Interrupt {
 public:
  Interrupt();
  ~Interrupt();
  Interrupt(const Interrupt&) = delete;
  Interrupt& operator=(const Interrupt&) = delete;

  /// From now on there is something worth keeping.
  void something_to_keep() { keeps_ = true; }
  [[nodiscard]] std::stop_token token() const { return source_.get_token(); }
  [[nodiscard]] bool requested() const { return source_.stop_requested(); }

 private:
  void wait_for_signals();

  sigset_t signals_{};
  sigset_t before_{};
  std::atomic<bool> keeps_ = false;
  std::atomic<bool> ending_ = false;
  std::stop_source source_;
  std::thread waiter_;
};

}  // namespace penumbra::cli
