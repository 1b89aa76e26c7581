#pragma once

#include <vector>

#include "penumbra/scene/finding.h"
#include "penumbra/scene/scene.h"

namespace penumbra {

/// What is odd about a scene's numbers, one finding a material or object: materials that reflect and transmit more than
/// all light, nothing that shines, faces without area, and a size below a centimetre or above 20 km.
[[nodiscard]] std::vector<Finding> lint(const Scene& scene);

}  // namespace penumbra
