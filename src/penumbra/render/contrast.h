#pragma once

#include <cstdint>
#include <vector>

#include "penumbra/image/image.h"
#include "penumbra/render/render.h"

namespace penumbra {

/// Which pixels of a region differ from one of their eight neighbours in the picture by contrast, and so may hold an
/// edge between samples: where in some band
///   |a - b| > contrast max(a + b, floor)
/// (Mitchell, "Generating Antialiased Images at Low Sampling Densities", SIGGRAPH 1987, takes this measure to be near
/// the eye's). The floor keeps what is nearly black at rest: twice a hundredth of the region's mean. Both pixels of a
/// pair are noted. One entry a pixel of the region, row by row, 0 or 1.
/// @param contrast 0..1. @param picture radiance; the region's neighbours in it count, too.
[[nodiscard]] std::vector<std::uint8_t> contrasted_pixels(const Image& picture, const Region& region, double contrast);

/// Makes all pixels outside of the region black.
void leave_only(const Region& region, Image& picture);

/// How many samples a pixel gets before contrast is judged: one through its middle where each sample sees the same,
/// else a few, so that the noise of soft shadows, lenses and motion is not all that they show.
[[nodiscard]] int samples_to_judge(const RayTracer& tracer, const Camera& camera);
/// The same where light has no noise of its own.
[[nodiscard]] int samples_to_judge(const Camera& camera);

}  // namespace penumbra
