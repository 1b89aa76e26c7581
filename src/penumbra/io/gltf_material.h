#pragma once

#include "penumbra/io/gltf_document.h"
#include "penumbra/io/gltf_texture.h"
#include "penumbra/scene/material.h"

namespace penumbra {

/// Material `index` of the glTF with its extensions and `extras.penumbra` (see gltf_reader.h). Numbers outside their
/// range are clamped with a warning. Throws FileError.
[[nodiscard]] Material read_gltf_material(GltfDocument& document, GltfTextures& textures, std::uint64_t index);

/// What glTF draws a primitive without material with: white, metallic, rough (glTF 2.0, section 3.9.6 and 5.19).
[[nodiscard]] Material gltf_default_material();

}  // namespace penumbra
