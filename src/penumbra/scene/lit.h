#pragma once

#include "penumbra/scene/scene.h"

namespace penumbra {

/// Whether anything shines on the scene: an environment, a light that is not ambient, or a surface in the scene (an
/// instance or a shape) whose material emits.
///
/// An emission texture counts when the luminance of its mean colour (over all texels, linear) times the emission factor
/// is at least `least_lamp_luminance`: a helmet with a glowing display is not a lamp. Unlit materials are pictures of
/// light, not lamps.
[[nodiscard]] bool is_lit(const Scene& scene);

/// W/(m^2 sr), where the file's white is 1.
inline constexpr float least_lamp_luminance = 0.1F;

}  // namespace penumbra
