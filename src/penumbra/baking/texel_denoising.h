#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "penumbra/baking/sample_points.h"

namespace penumbra {

/// Smooths gathered light: each texel becomes a mean of those around it whose surroundings agree with its own within
/// their noise (non-local means with known variances, after Rousselle, Knaus & Zwicker, "Adaptive Rendering with
/// Non-Local Means Filtering", 2012, eq. 3 to 5).
///
/// Never mixed are texels of two charts, those whose normals differ by more than 10 degrees, and those that no run of
/// such texels joins: walls that stand on a surface part it. Where the noise is small against what differs, nothing
/// changes.
/// @param skipped 1: texels that are neither changed nor used, such as buried ones.
/// @param irradiance [texel * 3 + band], W/m^2. @param error standard error of its luminance, W/m^2; becomes that of
/// the mean.
void denoise_texels(const SamplePoints& points, std::span<const std::uint8_t> skipped, std::vector<float>& irradiance,
                    std::vector<float>& error);

}  // namespace penumbra
