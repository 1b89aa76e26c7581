#pragma once

#include "penumbra/io/json_place.h"
#include "penumbra/math/transform.h"
#include "penumbra/scene/light.h"

namespace penumbra {

/// Photometric values of a file are divided by this to get radiometric ones: the most that a watt can be seen (lm/W).
inline constexpr double gltf_lumens_per_watt = 683;

/// A light of KHR_lights_punctual, placed by the world matrix of its node: it stands in the node's origin and shines
/// along its -z. Throws FileError.
[[nodiscard]] Light read_gltf_light(const JsonPlace& place, const Mat4d& to_world);

}  // namespace penumbra
