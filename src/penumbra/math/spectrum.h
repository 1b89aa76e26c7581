#pragma once

#include <algorithm>

#include "penumbra/math/vec.h"

namespace penumbra {

/// Linear Rec. 709 colour: radiance in W/(m^2 sr), irradiance in W/m^2, or a dimensionless
/// reflectance, as its name says.
using Rgb = glm::vec3;

/// Relative luminance Y of linear Rec. 709 (ITU-R BT.709-6, item 3.2).
[[nodiscard]] inline float luminance(const Rgb& c) { return 0.2126F * c.x + 0.7152F * c.y + 0.0722F * c.z; }

/// The largest of the three bands.
[[nodiscard]] inline float max_component(const Rgb& c) { return std::max({c.x, c.y, c.z}); }

[[nodiscard]] inline bool is_black(const Rgb& c) { return c.x == 0 && c.y == 0 && c.z == 0; }

}  // namespace penumbra
