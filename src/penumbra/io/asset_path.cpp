#include "penumbra/io/asset_path.h"

#include <algorithm>
#include <string>

namespace penumbra {

std::optional<std::filesystem::path> asset_path(std::string_view name) {
  std::string text(name);
  std::ranges::replace(text, '\\', '/');
  const bool has_drive = text.size() > 1 && text[1] == ':';
  if (text.empty() || text.front() == '/' || has_drive || text.find('\0') != std::string::npos) return std::nullopt;
  auto path = std::filesystem::path(text).lexically_normal();
  if (path.begin() != path.end() && *path.begin() == "..") return std::nullopt;
  return path;
}

}  // namespace penumbra
