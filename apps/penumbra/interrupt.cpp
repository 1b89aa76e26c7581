#include "interrupt.h"

#include <fmt/core.h>
#include <unistd.h>

#include <ctime>

#include "exit_code.h"

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
  for (;;) {
    int signal = 0;
    sigwait(&signals_, &signal);
    if (ending_) return;
    if (source_.stop_requested() || !keeps_) {
      fmt::print(stderr, "\npenumbra: interrupted; nothing was written\n");
      ::_exit(exit_interrupted);
    }
    fmt::print(stderr, "\npenumbra: interrupted; keeping what is done (Ctrl-C again quits at once)\n");
    source_.request_stop();
  }
}

}  // namespace penumbra::cli
