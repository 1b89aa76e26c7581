#pragma once

#include "penumbra/render/render.h"

namespace penumbra {

/// The notes' thought experiment made to work: particles of light leave the lamps and are followed as they are
/// reflected, refracted and absorbed (Arvo, "Backward Ray Tracing", 1986; Dutre, Lafortune & Willems 1993). So few meet
/// the eye by themselves that each surface they meet, and the lamp that they leave, is joined to the eye by a shadow
/// ray instead, and what it sends there is added to the pixel where the eye sees it. Unbiased for all that the eye sees
/// without mirrors and glass; caustics are found quickly, while mirrors, smooth glass and what is seen in or through
/// them stay black, as is a sky that is only a backdrop. Samples are particles, `samples_per_pixel` for each pixel of
/// the whole picture. Pixels are boxes: of the options filter, noise and layers are not read.
///
/// Bit-identical for any number of threads: particles go in batches whose marks are added in their order.
/// Throws std::invalid_argument for a camera that is no pinhole, for participating media, and for lights that send out
/// no countable power, see LightEmission.
[[nodiscard]] RenderResult trace_light(const RayTracer& tracer, const Camera& camera, const RenderOptions& options,
                                       const Progress& progress = {});

}  // namespace penumbra
