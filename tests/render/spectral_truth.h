#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <string>

#include "penumbra/math/bands.h"
#include "render/probe.h"

namespace penumbra::testing {

/// Linear Rec. 709 of light that is known by wavelength: the mean over many samples of three.
/// @param light of some Bands, in them.
template <class Light>
Vec3d over_wavelengths(const Light& light) {
  constexpr int samples = 20000;
  Vec3d sum(0);
  for (int i = 0; i < samples; ++i) {
    const Bands bands = Bands::sample((i + 0.5) / samples);
    sum += Vec3d(bands.to_rgb(light(bands)));
  }
  return sum / double{samples};
}

/// Each band within three of its standard errors, or 1e-4 of the largest band.
/// @param error_at_most how large a standard error may be for the comparison to mean something, as a share of the
/// largest band.
inline void expect_colour(const Seen& seen, const Vec3d& truth, double error_at_most, const std::string& what = "") {
  const double scale = std::max({truth.x, truth.y, truth.z});
  for (int k = 0; k < 3; ++k) {
    const auto error = static_cast<double>(seen.errors[k]);
    EXPECT_NEAR(seen.radiance[k], truth[k], 3 * error + 1e-4 * scale) << what << " band " << k;
    EXPECT_LT(error, error_at_most * scale) << what << " band " << k;
  }
}

inline RenderOptions spectral(RenderOptions options) {
  options.spectral = true;
  return options;
}

}  // namespace penumbra::testing
