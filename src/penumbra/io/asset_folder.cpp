#include "penumbra/io/asset_folder.h"

#include <algorithm>
#include <stdexcept>
#include <string>
#include <system_error>

namespace penumbra {
namespace {

bool is_below(const std::filesystem::path& path, const std::filesystem::path& folder) {
  return std::mismatch(folder.begin(), folder.end(), path.begin(), path.end()).first == folder.end();
}

/// Whether a symbolic link on the way to `path` leads out of `folder`. What is not there leads nowhere.
bool links_out(const std::filesystem::path& path, const std::filesystem::path& folder) {
  std::error_code unknown;
  const auto from = std::filesystem::weakly_canonical(folder.empty() ? "." : folder, unknown);
  if (unknown) return false;
  // A relative path of which nothing is there would stay relative.
  const auto to = std::filesystem::weakly_canonical(std::filesystem::absolute(path), unknown);
  return unknown || !is_below(to, from);
}

[[noreturn]] void refuse(std::string_view what, std::string_view remedy) {
  throw std::invalid_argument(std::string(what) + "; " + std::string(remedy) +
                              ", or allow files outside the folder (--allow-outside)");
}

/// A pipe or a device would never end.
std::filesystem::path ordinary(std::filesystem::path path) {
  std::error_code unknown;
  const auto status = std::filesystem::status(path, unknown);
  if (std::filesystem::exists(status) && !std::filesystem::is_regular_file(status)) {
    throw std::invalid_argument("is no ordinary file; name one that holds its bytes");
  }
  return path;
}

}  // namespace

AssetFolder::AssetFolder(const std::filesystem::path& file, bool allow_outside)
    : folder_(file.parent_path()), allow_outside_(allow_outside) {}

std::filesystem::path AssetFolder::resolve(std::string_view name) const {
  std::string text(name);
  std::ranges::replace(text, '\\', '/');
  if (text.empty() || text.find('\0') != std::string::npos) {
    throw std::invalid_argument("names no file; name one in the folder");
  }
  const auto path = std::filesystem::path(text).lexically_normal();
  if (allow_outside_) return ordinary(path.is_absolute() ? path : folder_ / path);

  const bool has_drive = text.size() > 1 && text[1] == ':';
  if (path.is_absolute() || has_drive) refuse("is an absolute path", "name it relative to the folder");
  if (path.begin() != path.end() && *path.begin() == "..") refuse("leaves the folder", "move the file into it");
  const auto whole = folder_ / path;
  if (links_out(whole, folder_)) refuse("leaves the folder by a symbolic link", "put the file itself there");
  return ordinary(whole);
}

}  // namespace penumbra
