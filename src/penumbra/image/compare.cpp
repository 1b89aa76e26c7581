#include "penumbra/image/compare.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <stdexcept>
#include <vector>

namespace penumbra {
namespace {

/// The channels that are judged, as a picture of one or three planes.
struct Planes {
  int width;
  int height;
  std::size_t stride;
  std::size_t colours;
  const float* data;

  explicit Planes(const Image& image)
      : width(image.width),
        height(image.height),
        stride(image.channels.size()),
        colours(stride >= 3 ? 3 : 1),
        data(image.data.data()) {}

  [[nodiscard]] std::size_t pixels() const {
    return static_cast<std::size_t>(width) * static_cast<std::size_t>(height);
  }
  /// Grey pictures answer the same for every channel.
  [[nodiscard]] double value(std::size_t pixel, std::size_t channel) const {
    return data[pixel * stride + (colours == 1 ? 0 : channel)];
  }
  [[nodiscard]] std::vector<double> luminances() const {
    std::vector<double> y(pixels());
    for (std::size_t p = 0; p < y.size(); ++p) {
      y[p] = 0.2126 * value(p, 0) + 0.7152 * value(p, 1) + 0.0722 * value(p, 2);
    }
    return y;
  }
};

constexpr int window_radius = 5;  // 11 x 11, as in the paper

std::array<double, 2 * window_radius + 1> gaussian_window() {
  std::array<double, 2 * window_radius + 1> w{};
  double sum = 0;
  for (int i = -window_radius; i <= window_radius; ++i) {
    sum += w[static_cast<std::size_t>(i + window_radius)] = std::exp(-i * i / (2 * 1.5 * 1.5));
  }
  for (double& x : w) x /= sum;
  return w;
}

/// A picture of one channel.
struct Plane {
  std::size_t width;
  std::size_t height;
  std::vector<double> values;
};

// Where the window lies whole within the picture; along a side shorter than the window, the plain mean.
Plane rows_blurred(const Plane& in) {
  static const auto window = gaussian_window();
  const std::size_t taps = window.size();
  Plane out{in.width >= taps ? in.width - taps + 1 : 1, in.height, {}};
  out.values.resize(out.width * out.height);
  for (std::size_t y = 0; y < in.height; ++y) {
    const double* row = in.values.data() + y * in.width;
    for (std::size_t x = 0; x < out.width; ++x) {
      double sum = 0;
      if (in.width >= taps) {
        for (std::size_t i = 0; i < taps; ++i) sum += window[i] * row[x + i];
      } else {
        for (std::size_t i = 0; i < in.width; ++i) sum += row[i] / static_cast<double>(in.width);
      }
      out.values[y * out.width + x] = sum;
    }
  }
  return out;
}

Plane transposed(const Plane& in) {
  Plane out{in.height, in.width, std::vector<double>(in.values.size())};
  for (std::size_t y = 0; y < in.height; ++y) {
    for (std::size_t x = 0; x < in.width; ++x) out.values[x * in.height + y] = in.values[y * in.width + x];
  }
  return out;
}

std::vector<double> blurred(const Planes& shape, std::vector<double> values) {
  const Plane plane{static_cast<std::size_t>(shape.width), static_cast<std::size_t>(shape.height), std::move(values)};
  return rows_blurred(transposed(rows_blurred(plane))).values;
}

std::vector<double> products(const std::vector<double>& a, const std::vector<double>& b) {
  std::vector<double> out(a.size());
  for (std::size_t i = 0; i < a.size(); ++i) out[i] = a[i] * b[i];
  return out;
}

// Wang, Bovik, Sheikh, Simoncelli 2004, equation 13 with K1 = 0.01, K2 = 0.03, averaged over the picture.
double mean_ssim(const Planes& a, const Planes& b, double peak) {
  const auto ya = a.luminances();
  const auto yb = b.luminances();
  const auto mean_a = blurred(a, ya);
  const auto mean_b = blurred(b, yb);
  const auto square_a = blurred(a, products(ya, ya));
  const auto square_b = blurred(b, products(yb, yb));
  const auto product = blurred(a, products(ya, yb));
  const double c1 = 0.01 * peak * 0.01 * peak;
  const double c2 = 0.03 * peak * 0.03 * peak;
  double sum = 0;
  for (std::size_t i = 0; i < mean_a.size(); ++i) {
    const double variance_a = square_a[i] - mean_a[i] * mean_a[i];
    const double variance_b = square_b[i] - mean_b[i] * mean_b[i];
    const double covariance = product[i] - mean_a[i] * mean_b[i];
    sum += (2 * mean_a[i] * mean_b[i] + c1) * (2 * covariance + c2) /
           ((mean_a[i] * mean_a[i] + mean_b[i] * mean_b[i] + c1) * (variance_a + variance_b + c2));
  }
  return sum / static_cast<double>(mean_a.size());
}

// Infinite where only one of them is a number, or neither: such a picture is never within a limit.
double distance(double a, double b) {
  if (a == b) return 0;
  const double d = std::abs(a - b);
  return std::isnan(d) ? std::numeric_limits<double>::infinity() : d;
}

}  // namespace

ImageDifference compare(const Image& a, const Image& b) {
  if (a.width != b.width || a.height != b.height) {
    throw std::invalid_argument(
        fmt::format("pictures of {} x {} and {} x {} pixels cannot be compared; render both at one size", a.width,
                    a.height, b.width, b.height));
  }
  if (a.data.empty() || b.data.empty()) throw std::invalid_argument("pictures without pixels cannot be compared");
  const Planes pa(a);
  const Planes pb(b);
  const std::size_t colours = std::max(pa.colours, pb.colours);
  ImageDifference out;
  double squares = 0;
  double sum_a = 0;
  double sum_b = 0;
  double peak = 1;
  for (std::size_t p = 0; p < pa.pixels(); ++p) {
    for (std::size_t c = 0; c < colours; ++c) {
      const double va = pa.value(p, c);
      const double vb = pb.value(p, c);
      const double d = distance(va, vb);
      squares += d * d;
      sum_a += va;
      sum_b += vb;
      out.max = std::max(out.max, d);
      if (std::isfinite(va)) peak = std::max(peak, va);
    }
  }
  const auto count = static_cast<double>(pa.pixels() * colours);
  out.rmse = std::sqrt(squares / count);
  out.mean_a = sum_a / count;
  out.mean_b = sum_b / count;
  if (out.rmse == 0) return out;
  out.relative_rmse = out.mean_a == 0 ? std::numeric_limits<double>::infinity() : out.rmse / std::abs(out.mean_a);
  out.psnr = 20 * std::log10(peak / out.rmse);
  out.ssim = mean_ssim(pa, pb, peak);
  // Values that are no numbers have no structure to compare.
  if (!std::isfinite(out.ssim)) out.ssim = 0;
  return out;
}

}  // namespace penumbra
