#pragma once

#include <string_view>

#include "penumbra/image/image.h"

namespace penumbra {

/// A layer of a picture as a picture of its own, for the eye: colours as they are; normals from -1..1 to 0..1;
/// positions within their bounds; a layer of one value (depth, object, rays) in grey from 0 to its largest finite
/// value, with what is infinite or below 0 black.
/// @param layer "rays": the channels "rays.*". Throws std::invalid_argument when the picture has no such layer.
[[nodiscard]] Image layer_picture(const Image& image, std::string_view layer);

}  // namespace penumbra
