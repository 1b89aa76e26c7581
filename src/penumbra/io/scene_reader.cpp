#include "penumbra/io/scene_reader.h"

#include <algorithm>
#include <cctype>
#include <filesystem>
#include <string>

#include "penumbra/file/file_error.h"
#include "penumbra/io/gltf_reader.h"
#include "penumbra/io/obj_reader.h"
#include "penumbra/scene/builtin_scenes.h"

namespace penumbra {
namespace {

constexpr std::string_view builtin_prefix = "builtin:";

std::string lower_case(std::string text) {
  std::ranges::transform(text, text.begin(), [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return text;
}

}  // namespace

LoadedScene read_scene(std::string_view source, const ReadOptions& options) {
  if (source.starts_with(builtin_prefix)) return {make_builtin_scene(source.substr(builtin_prefix.size())), {}};

  const std::filesystem::path path(source);
  const std::string extension = lower_case(path.extension().string());
  if (extension == ".obj") return read_obj(path, options);
  if (extension == ".glb" || extension == ".gltf") return read_gltf(path, options);

  constexpr std::string_view remedy =
      "name a .glb, .gltf or .obj file, or builtin:NAME (penumbra scene --list shows them)";
  std::error_code ignored;
  if (std::filesystem::is_directory(path, ignored))
    throw FileError(source, "", "is a directory; " + std::string(remedy));
  if (extension.empty()) {
    throw FileError(source, "", "has no extension to tell the format by; " + std::string(remedy));
  }
  throw FileError(source, "", "is not a scene format that is read (" + extension + "); " + std::string(remedy));
}

}  // namespace penumbra
