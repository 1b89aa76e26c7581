#pragma once

#include <exception>

namespace penumbra::cli {

/// How the program ends; scripts rely on these.
enum ExitCode : int {
  exit_done = 0,
  exit_failed = 1,        ///< for a cause outside the input: disk full, no memory
  exit_bad_input = 2,     ///< bad usage, bad input, or an output that cannot be created
  exit_finding = 3,       ///< `check` found something, or `compare` is over its limit
  exit_interrupted = 130  ///< Ctrl-C
};

/// Says on standard error what went wrong, in one sentence, and returns the exit code for it.
[[nodiscard]] int report_failure(const std::exception_ptr& failure);

}  // namespace penumbra::cli
