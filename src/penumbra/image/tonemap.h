#pragma once

#include <cstdint>

#include "penumbra/image/image.h"

namespace penumbra {

/// IEC 61966-2-1 transfer function, per value; linear 0..1 to encoded 0..1, extended beyond by the same formula.
[[nodiscard]] float srgb_encode(float linear);
/// Its inverse.
[[nodiscard]] float srgb_decode(float encoded);
/// The 8-bit sRGB code nearest to a linear value, clamped to 0..1; NaN is 0. Exact, and a few times faster than a
/// power.
[[nodiscard]] std::uint8_t srgb_encode8(float linear);

enum class ToneCurve {
  none,    ///< exposure only
  srgb,    ///< exposure only; clamping and sRGB encoding happen where an 8-bit file is written
  filmic,  ///< the filmic shoulder of Narkowicz 2015, per channel, clamped to 0..1
};

/// Scales the first three channels (the first of a grey picture) by 2^exposure and applies the curve; stays
/// linear-light.
/// @param exposure stops (EV).
[[nodiscard]] Image tonemapped(const Image& image, double exposure, ToneCurve curve);

}  // namespace penumbra
