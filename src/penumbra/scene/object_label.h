#pragma once

#include <cstddef>
#include <string>

#include "penumbra/scene/scene.h"

namespace penumbra {

/// What to call an object in a message: its name, that of its mesh, or its number counted from 1.
[[nodiscard]] std::string object_label(const Scene& scene, std::size_t object);

}  // namespace penumbra
