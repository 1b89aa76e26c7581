#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "option_parser.h"

namespace penumbra::cli {

enum class ProgressMode { automatic, bar, json, off };

/// The options that every command has.
struct CommonOptions {
  int threads = 0;                   ///< 0: every core
  std::optional<double> max_memory;  ///< bytes; none: 80 % of what the machine has
  std::uint64_t seed = 0;
  bool quiet = false;
  bool json = false;  ///< the report on standard output, and nothing else there
  std::optional<std::string> stats;
  ProgressMode progress = ProgressMode::automatic;
};

/// Adds them under a headline of their own. `options` must outlive `parser`'s last parse.
void add_common_options(OptionParser& parser, CommonOptions& options);

}  // namespace penumbra::cli
