#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace penumbra {

/// The head of an array in NumPy's format 1.0: magic, version, length of a Python literal that describes the array,
/// padded to 64 bytes. @param type "<f8". @param shape "(3,)".
[[nodiscard]] std::string npy_header(std::string_view type, std::string_view shape);

// Whole arrays, little-endian.
[[nodiscard]] std::string npy_array(std::span<const double> values);
[[nodiscard]] std::string npy_array(std::span<const std::int64_t> values);
/// '<U': the same number of code points for each, padded with zeros; nothing is pickled.
[[nodiscard]] std::string npy_array(const std::vector<std::string>& texts);
/// A single truth value without dimensions.
[[nodiscard]] std::string npy_truth(bool value);

/// An array as read: what its head says, and its bytes.
struct NpyArray {
  std::string type;                ///< "<f8"
  std::vector<std::size_t> shape;  ///< empty for a single value
  std::string_view bytes;          ///< within what was read; as many as type and shape ask for

  [[nodiscard]] std::size_t size() const;
};

// Each throws std::runtime_error with half a sentence ("is no NumPy array", "holds <f4 where <f8 was expected").
[[nodiscard]] NpyArray read_npy(std::string_view file);
[[nodiscard]] std::vector<double> doubles_of(const NpyArray& array);
/// Of single or double precision.
[[nodiscard]] std::vector<double> reals_of(const NpyArray& array);
[[nodiscard]] std::vector<std::int64_t> integers_of(const NpyArray& array);
[[nodiscard]] std::vector<std::string> texts_of(const NpyArray& array);

}  // namespace penumbra
