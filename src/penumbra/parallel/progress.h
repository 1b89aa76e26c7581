#pragma once

#include <functional>
#include <stop_token>
#include <string_view>

namespace penumbra {

/// What a long computation tells its caller, and how the caller ends it early.
///
/// `report` is called from one thread at a time with the stage's name and the share done, 0..1,
/// never falling within a stage. When `stop` is requested the computation returns soon with what it
/// has and marks the result partial.
struct Progress {
  std::function<void(std::string_view stage, double fraction)> report;
  std::stop_token stop;

  void tell(std::string_view stage, double fraction) const {
    if (report) report(stage, fraction);
  }
  [[nodiscard]] bool stop_requested() const { return stop.stop_requested(); }
};

}  // namespace penumbra
