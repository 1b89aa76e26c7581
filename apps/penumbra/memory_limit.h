#pragma once

#include <optional>

namespace penumbra::cli {

/// What the program itself needs, bytes: less cannot be asked for.
inline constexpr double least_memory = 128e6;

/// Keeps this process from taking more memory than it may, while it lives: what asks for more fails with
/// std::bad_alloc, where without a limit the system would begin to swap, or end some program of its choice.
class MemoryLimit {
 public:
  /// @param bytes how much more than now may be taken, at least `least_memory`; nothing: 80 % of what the machine has,
  /// or of what the control group of a container leaves of it.
  /// @param threads how many are to come; the room for their stacks is not counted.
  MemoryLimit(std::optional<double> bytes, int threads);
  ~MemoryLimit();
  MemoryLimit(const MemoryLimit&) = delete;
  MemoryLimit& operator=(const MemoryLimit&) = delete;

 private:
  unsigned long long before_;  // the limit that was
};

/// How many more bytes this process may take; infinite without a limit.
[[nodiscard]] double memory_left();

}  // namespace penumbra::cli
