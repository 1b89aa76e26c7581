#include "penumbra/image/tonemap.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace penumbra {
namespace {

// Narkowicz 2015, "ACES filmic tone mapping curve": a fit that rises to 1.
float filmic(float x) {
  x = std::max(x, 0.0F);
  // Both polynomials overflow far above where the curve is flat.
  if (x > 1e4F) return 1.0F;
  return std::min(x * (2.51F * x + 0.03F) / (x * (2.43F * x + 0.59F) + 0.14F), 1.0F);
}

/// For each code the smallest linear value that rounds to it, and a first guess for each slice of 0..1.
struct SrgbCodes {
  static constexpr int slices = 4096;
  std::array<float, 257> lower{};
  std::array<std::uint8_t, slices + 1> guess{};

  SrgbCodes() {
    lower[0] = 0;
    for (std::size_t code = 1; code < 256; ++code) lower[code] = first_value_of(code);
    lower[256] = INFINITY;
    std::size_t code = 0;
    for (std::size_t i = 0; i <= slices; ++i) {
      while (code < 255 && lower[code + 1] <= static_cast<float>(i) / slices) ++code;
      guess[i] = static_cast<std::uint8_t>(code);
    }
  }

  static float first_value_of(std::size_t code) {
    const double encoded = (static_cast<double>(code) - 0.5) / 255.0;
    const double linear = encoded <= 0.04045 ? encoded / 12.92 : std::pow((encoded + 0.055) / 1.055, 2.4);
    return static_cast<float>(linear);
  }
};

}  // namespace

float srgb_encode(float linear) {
  return linear <= 0.0031308F ? 12.92F * linear : 1.055F * std::pow(linear, 1.0F / 2.4F) - 0.055F;
}

float srgb_decode(float encoded) {
  return encoded <= 0.04045F ? encoded / 12.92F : std::pow((encoded + 0.055F) / 1.055F, 2.4F);
}

std::uint8_t srgb_encode8(float linear) {
  static const SrgbCodes codes;
  if (!(linear > 0)) return 0;  // NaN too
  if (linear >= 1) return 255;
  auto code = static_cast<std::size_t>(codes.guess[static_cast<std::size_t>(linear * SrgbCodes::slices)]);
  while (linear >= codes.lower[code + 1]) ++code;
  return static_cast<std::uint8_t>(code);
}

Image tonemapped(const Image& image, double exposure, ToneCurve curve) {
  Image out = image;
  const auto scale = static_cast<float>(std::exp2(exposure));
  const std::size_t stride = image.channels.size();
  const std::size_t colours = stride >= 3 ? 3 : std::min<std::size_t>(stride, 1);
  for (std::size_t p = 0; p < out.data.size(); p += stride) {
    for (std::size_t c = 0; c < colours; ++c) {
      float& value = out.data[p + c];
      value *= scale;
      if (curve == ToneCurve::filmic) value = filmic(value);
    }
  }
  return out;
}

}  // namespace penumbra
