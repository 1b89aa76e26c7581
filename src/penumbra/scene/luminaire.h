#pragma once

#include <cstddef>

#include "penumbra/scene/scene.h"

namespace penumbra {

/// Whether a light can take the intensity of a measured luminaire: point and spot lights.
[[nodiscard]] bool can_wear_web(const Light& light);

/// Gives a point or spot light the intensity of a measured luminaire, in cd divided by 683 lm/W; it becomes a point
/// light. Of what it was before its place, range and tint stay (the tint scaled to a luminance of 1). A spot light's
/// axis becomes the luminaire's nadir; a point light hangs upright, horizontal angle 0 towards -Z. The web's factor for
/// that tilt is applied.
/// @pre can_wear_web(scene.lights[light]).
void wear_web(Scene& scene, std::size_t light, PhotometricWeb web);

/// The same, turned: `nadir` and `zero` as in WebPlacement.
void wear_web(Scene& scene, std::size_t light, PhotometricWeb web, const Vec3d& nadir, const Vec3d& zero);

}  // namespace penumbra
