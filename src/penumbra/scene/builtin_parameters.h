#pragma once

#include <map>
#include <span>
#include <string>
#include <string_view>

namespace penumbra {

/// A number that a built-in scene takes.
struct BuiltinParameter {
  std::string_view key;
  double fallback = 0;         ///< its value when the user gives none
  double lower = 0;            ///< inclusive
  double upper = 1;            ///< inclusive
  bool whole = false;          ///< only integers
  std::string_view unit = {};  ///< for the list, may be empty
};

/// The parameters of one built-in scene with their values, each within its range.
class BuiltinParameters {
 public:
  /// Reads "key=value&key=value".
  /// @param scene its name, for the errors.
  /// Throws std::invalid_argument for an unknown key (listing the known ones), a value that is no number, or one out
  /// of range (stating the range).
  BuiltinParameters(std::string_view scene, std::span<const BuiltinParameter> known, std::string_view text);

  /// @pre `key` is one of the scene's.
  [[nodiscard]] double operator[](std::string_view key) const;

 private:
  std::map<std::string, double, std::less<>> values_;
};

/// "triangles=N (default 10000, 100 to 10000000)", several joined by "; ".
[[nodiscard]] std::string describe(std::span<const BuiltinParameter> parameters);

}  // namespace penumbra
