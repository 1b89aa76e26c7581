#pragma once

#include <cstdint>
#include <map>
#include <optional>

#include "penumbra/io/gltf_document.h"
#include "penumbra/scene/scene.h"

namespace penumbra {

/// Textures of a glTF, put into the scene when a material first names them; images that nothing uses are not decoded.
class GltfTextures {
 public:
  GltfTextures(GltfDocument& document, Scene& scene) : document_(&document), scene_(&scene) {}

  /// The texture that member `key` of `user` names (a textureInfo), with KHR_texture_transform, or nothing when the
  /// member is not there. An image that cannot be decoded is a warning, and `unreadable` is set.
  /// Throws FileError when an index points nowhere.
  [[nodiscard]] std::optional<TextureRef> read(const JsonPlace& user, std::string_view key, bool& unreadable);

 private:
  [[nodiscard]] std::optional<std::uint32_t> texture(std::uint64_t index, const JsonPlace& user);
  [[nodiscard]] std::optional<std::uint32_t> image(std::uint64_t index, const JsonPlace& user);

  GltfDocument* document_;
  Scene* scene_;
  std::map<std::uint64_t, std::optional<std::uint32_t>> texture_of_;  // nothing: its image is unreadable
  std::map<std::uint64_t, std::optional<std::uint32_t>> image_of_;
};

}  // namespace penumbra
