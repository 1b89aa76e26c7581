#pragma once

#include "penumbra/image/image.h"

namespace penumbra {

/// IEC 61966-2-1 transfer function, per value; linear 0..1 to encoded 0..1, extended beyond by the same formula.
[[nodiscard]] float srgb_encode(float linear);
/// Its inverse.
[[nodiscard]] float srgb_decode(float encoded);

enum class ToneCurve {
  none,    ///< exposure only
  srgb,    ///< exposure only; clamping and sRGB encoding happen where an 8-bit file is written
  filmic,  ///< a filmic shoulder (Hable 2010 or Narkowicz 2015), per channel
};

/// Scales the first three channels by 2^exposure and applies the curve; stays linear-light.
/// @param exposure stops (EV).
[[nodiscard]] Image tonemapped(const Image& image, double exposure, ToneCurve curve);

}  // namespace penumbra
