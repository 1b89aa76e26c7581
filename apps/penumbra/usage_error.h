#pragma once

#include <stdexcept>

namespace penumbra::cli {

/// Bad usage: one sentence that names the option and the remedy.
class UsageError : public std::invalid_argument {
 public:
  using std::invalid_argument::invalid_argument;
};

}  // namespace penumbra::cli
