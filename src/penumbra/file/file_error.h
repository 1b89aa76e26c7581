#pragma once

#include <stdexcept>
#include <string>
#include <string_view>

namespace penumbra {

/// Bad input, or an output that cannot be created: one sentence that names the file, the place in it
/// and, where there is one, the remedy. The command line ends with exit code 2 on it.
class FileError : public std::runtime_error {
 public:
  /// @param path the file as the user named it.
  /// @param place where in the file ("line 12", "accessor 3", "byte 40"); may be empty.
  /// @param sentence what is wrong and what to do about it.
  FileError(std::string_view path, std::string_view place, std::string_view sentence);

  [[nodiscard]] const std::string& path() const { return path_; }
  [[nodiscard]] const std::string& place() const { return place_; }

 private:
  std::string path_;
  std::string place_;
};

}  // namespace penumbra
