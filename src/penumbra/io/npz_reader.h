#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "penumbra/io/npy_array.h"
#include "penumbra/io/zip_reader.h"

namespace penumbra {

/// The arrays of an .npz file by name, as NumPy and this program write them.
class NpzReader {
 public:
  /// Throws FileError when the file cannot be read or is no archive.
  explicit NpzReader(const std::filesystem::path& path) : zip_(path) {}

  [[nodiscard]] bool has(const std::string& name) const { return zip_.has(name + ".npy"); }
  /// How long the array is with its head, as the archive says. Throws FileError when it is missing.
  [[nodiscard]] std::size_t bytes_of(const std::string& name) const { return zip_.size_of(name + ".npy"); }
  // Each throws FileError when the array is missing, damaged or of another type.
  [[nodiscard]] std::vector<double> doubles(const std::string& name) const;
  [[nodiscard]] std::vector<std::int64_t> integers(const std::string& name) const;
  [[nodiscard]] std::vector<std::string> texts(const std::string& name) const;
  /// Real numbers of single or double precision and the shape that they have.
  struct Reals {
    std::vector<std::size_t> shape;
    std::vector<double> values;
  };
  [[nodiscard]] Reals reals(const std::string& name) const;
  /// A single truth value.
  [[nodiscard]] bool truth(const std::string& name) const;

 private:
  template <class Values>
  [[nodiscard]] Values take(const std::string& name, Values (*convert)(const NpyArray&)) const;

  ZipReader zip_;
};

}  // namespace penumbra
