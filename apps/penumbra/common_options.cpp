#include "common_options.h"

#include <limits>

namespace penumbra::cli {
namespace {

constexpr int most_threads = 1024;

const std::vector<std::pair<std::string, ProgressMode>> progress_modes{{"auto", ProgressMode::automatic},
                                                                       {"bar", ProgressMode::bar},
                                                                       {"json", ProgressMode::json},
                                                                       {"off", ProgressMode::off}};

}  // namespace

void add_common_options(OptionParser& parser, CommonOptions& options) {
  parser.group("Running");
  parser.value(
      "--threads", "N", "how many threads work (default: one for every core); the result does not depend on it",
      [&](const OptionValue& v) { options.threads = static_cast<int>(whole_number(v, 1, most_threads, "threads")); });
  parser.value(
      "--max-memory", "BYTES",
      "the most memory to take, such as 4e9, at least 128e6 (default: 80 % of what the machine has); what would need "
      "more ends "
      "with a sentence",
      [&](const OptionValue& v) { options.max_memory = number_above_zero(v, "a number of bytes, such as 4e9"); });
  parser.value("--seed", "N",
               "start of the random numbers, 0 or more (default: 0); the same seed gives the same result",
               [&](const OptionValue& v) {
                 constexpr long long highest = std::numeric_limits<long long>::max();
                 options.seed = static_cast<std::uint64_t>(whole_number(v, 0, highest, "any size"));
               });
  parser.value(
      "--progress", "MODE",
      "on standard error: auto, bar, json (an object a line) or off (default: auto, which is a bar on a terminal "
      "and a line every 10 s elsewhere)",
      [&](const OptionValue& v) { options.progress = choice<ProgressMode>(v, progress_modes); });
  parser.flag("-q,--quiet", "no progress, no warnings, no closing line", options.quiet);
  parser.flag("--json", "print the report as JSON on standard output, and nothing else there", options.json);
  parser.value("--stats", "FILE.json", "write the same report to a file",
               [&](const OptionValue& v) { options.stats = v.text; });
}

}  // namespace penumbra::cli
