#pragma once

#include <optional>

#include "penumbra/image/image.h"

namespace penumbra {

/// How far two pictures lie apart, over the first three channels (one for grey), linear values.
struct ImageDifference {
  double rmse = 0;             ///< infinite when a value is NaN, or infinite in one picture only
  double relative_rmse = 0;    ///< rmse / mean_a; infinite when mean_a is 0 and rmse is not
  std::optional<double> psnr;  ///< dB against a peak of 1 (or the largest value of A when above 1); none when equal
  double ssim = 1;             ///< Wang et al. 2004, Gaussian window sigma 1.5, luminance; 1 when equal
  double max = 0;              ///< largest absolute difference
  double mean_a = 0;
  double mean_b = 0;
};

/// Throws std::invalid_argument when the sizes differ.
[[nodiscard]] ImageDifference compare(const Image& a, const Image& b);

}  // namespace penumbra
