#pragma once

#include <cstddef>
#include <filesystem>
#include <span>
#include <string_view>

namespace penumbra {

/// A file written beside its final name and renamed when whole, so that a crash or a full disk never
/// leaves half a file under the final name. Destroyed without `commit`, it leaves nothing. What exists and is no
/// regular file (a pipe, /dev/stdout, /dev/null) is written in place, never replaced.
class OutputFile {
 public:
  /// Throws FileError when the file cannot be created (no such folder, no permission, a directory).
  explicit OutputFile(const std::filesystem::path& path);
  ~OutputFile();
  OutputFile(const OutputFile&) = delete;
  OutputFile& operator=(const OutputFile&) = delete;

  /// Appends. Throws std::system_error when the device refuses (disk full).
  void write(std::span<const std::byte> bytes);
  void write(std::string_view text);

  /// Where the bytes stand until `commit`; for libraries that write to a path of their own.
  [[nodiscard]] const std::filesystem::path& partial_path() const { return partial_; }

  /// Flushes to the device and renames to the final name. Throws std::system_error.
  void commit();

 private:
  std::filesystem::path path_;
  std::filesystem::path partial_;
  int descriptor_ = -1;
  bool in_place_ = false;
};

/// Throws FileError when an OutputFile could not be made for `path` now. Leaves nothing behind and does not open pipes,
/// whose readers would take that for the whole message.
void check_creatable(const std::filesystem::path& path);

}  // namespace penumbra
