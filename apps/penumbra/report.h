#pragma once

#include <chrono>
#include <nlohmann/json.hpp>

#include "common_options.h"

namespace penumbra::cli {

using Report = nlohmann::ordered_json;

/// Fails early when `--stats` names a file that cannot be created. Throws FileError.
void check_report(const CommonOptions& options);

/// Writes the report where `--stats` and `--json` say. Throws FileError, std::system_error.
void write_report(const CommonOptions& options, const Report& report);

/// The most memory that this process has held, bytes.
[[nodiscard]] long long peak_memory();

/// Seconds since it was made.
class Stopwatch {
 public:
  [[nodiscard]] double seconds() const {
    return std::chrono::duration<double>(std::chrono::steady_clock::now() - began_).count();
  }

 private:
  std::chrono::steady_clock::time_point began_ = std::chrono::steady_clock::now();
};

}  // namespace penumbra::cli
