#pragma once

#include <filesystem>
#include <string_view>

namespace penumbra {

/// Where the files lie that another file names: its own folder and those below. A scene from anywhere may then not read
/// what it pleases; who trusts it can allow all.
class AssetFolder {
 public:
  /// @param file the file that names others.
  /// @param allow_outside whether absolute paths, `..` and links may lead out of its folder.
  explicit AssetFolder(const std::filesystem::path& file, bool allow_outside = false);

  /// The file that `name` means, there or not; backslashes part folders too.
  /// Throws std::invalid_argument with what is wrong ("leaves the folder ...") when the name is empty, when it
  /// means a folder, a pipe or a device, or, unless allowed, when it is absolute or leaves the folder, by `..` or by a
  /// symbolic link.
  [[nodiscard]] std::filesystem::path resolve(std::string_view name) const;

 private:
  std::filesystem::path folder_;
  bool allow_outside_;
};

}  // namespace penumbra
