#include "interrupt.h"

#include <unistd.h>

#include <chrono>
#include <ctime>

#include "exit_code.h"
#include "standard_error.h"

namespace penumbra::cli {

Interrupt::Interrupt() {
  sigemptyset(&signals_);
  sigaddset(&signals_, SIGINT);
  sigaddset(&signals_, SIGTERM);
  pthread_sigmask(SIG_BLOCK, &signals_, &before_);
  waiter_ = std::thread([this] { wait_for_signals(); });
}

Interrupt::~Interrupt() {
  ending_ = true;
  pthread_kill(waiter_.native_handle(), SIGTERM);
  waiter_.join();
  pthread_sigmask(SIG_SETMASK, &before_, nullptr);
}

void Interrupt::wait_for_signals() {
  // timeout(1) and some shells signal a process and then its group: one wish, told twice.
  constexpr auto same_wish = std::chrono::milliseconds(300);
  std::chrono::steady_clock::time_point first;
  for (;;) {
    int signal = 0;
    sigwait(&signals_, &signal);
    if (ending_) return;
    const auto now = std::chrono::steady_clock::now();
    if (source_.stop_requested() && now - first < same_wish) continue;
    first = now;
    if (source_.stop_requested() || !keeps_) {
      write_standard_error("\npenumbra: interrupted; nothing was written\n");
      ::_exit(exit_interrupted);
    }
    write_standard_error("\npenumbra: interrupted; keeping what is done (Ctrl-C again quits at once)\n");
    source_.request_stop();
  }
}

}  // namespace penumbra::cli
