#pragma once

#include "penumbra/io/gltf_document.h"
#include "penumbra/scene/medium.h"

namespace penumbra {

/// A participating medium of `extras.penumbra` (see gltf_reader.h for its keys). Throws FileError.
[[nodiscard]] Medium read_gltf_medium(GltfDocument& document, const JsonPlace& place);

}  // namespace penumbra
