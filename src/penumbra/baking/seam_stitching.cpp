#include "penumbra/baking/seam_stitching.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

namespace penumbra {
namespace {

constexpr double points_a_texel = 2;
constexpr double inertia = 1e-5;         // of covered texels, beside the differences along seams
constexpr double inertia_beside = 1e-6;  // of the others

/// A point on a seam: the lookup on one side less that on the other.
struct Row {
  std::array<std::uint32_t, 8> texels{};  // pixels; then numbers among the unknowns
  std::array<double, 8> weights{};
};

void add_lookup(const Vec2d& at, int width, int height, double sign, Row& row, std::size_t first) {
  const double x = std::clamp(at.x - 0.5, 0.0, width - 1.0), y = std::clamp(at.y - 0.5, 0.0, height - 1.0);
  const int x0 = static_cast<int>(x), y0 = static_cast<int>(y);
  const double u = x - x0, v = y - y0;
  for (int k = 0; k < 4; ++k) {
    const int px = std::min(x0 + k % 2, width - 1), py = std::min(y0 + k / 2, height - 1);
    const std::size_t slot = first + static_cast<std::size_t>(k);
    row.texels[slot] =
        static_cast<std::uint32_t>(py) * static_cast<std::uint32_t>(width) + static_cast<std::uint32_t>(px);
    row.weights[slot] = sign * (k % 2 == 1 ? u : 1 - u) * (k / 2 == 1 ? v : 1 - v);
  }
}

std::vector<Row> rows_along(std::span<const ChartSeam> seams, int width, int height) {
  std::vector<Row> rows;
  for (const ChartSeam& seam : seams) {
    const double size = std::max(glm::length(seam.one[1] - seam.one[0]), glm::length(seam.other[1] - seam.other[0]));
    const int steps = std::max(1, static_cast<int>(std::ceil(points_a_texel * size)));
    for (int i = 0; i <= steps; ++i) {
      const double s = static_cast<double>(i) / steps;
      Row row;
      add_lookup(glm::mix(seam.one[0], seam.one[1], s), width, height, 1, row, 0);
      add_lookup(glm::mix(seam.other[0], seam.other[1], s), width, height, -1, row, 4);
      rows.push_back(row);
    }
  }
  return rows;
}

/// The pixels that rows read, ascending; the rows then name them by their place in it.
std::vector<std::uint32_t> number_unknowns(std::vector<Row>& rows) {
  std::vector<std::uint32_t> pixels;
  pixels.reserve(8 * rows.size());
  for (const Row& row : rows) {
    for (std::size_t k = 0; k < 8; ++k) {
      if (row.weights[k] != 0) pixels.push_back(row.texels[k]);
    }
  }
  std::ranges::sort(pixels);
  pixels.erase(std::unique(pixels.begin(), pixels.end()), pixels.end());
  for (Row& row : rows) {
    for (std::size_t k = 0; k < 8; ++k) {
      const auto found = std::ranges::lower_bound(pixels, row.texels[k]);
      row.texels[k] = row.weights[k] != 0 ? static_cast<std::uint32_t>(found - pixels.begin()) : 0;
    }
  }
  return pixels;
}

/// (R^T R + D) x = D x0 for the change of x: conjugate gradients with the diagonal as preconditioner.
class Stitching {
 public:
  Stitching(std::span<const Row> rows, std::vector<double> inertias)
      : rows_(rows), inertias_(std::move(inertias)), diagonal_(inertias_) {
    for (const Row& row : rows_) {
      for (std::size_t k = 0; k < 8; ++k) diagonal_[row.texels[k]] += row.weights[k] * row.weights[k];
    }
  }

  void solve(std::vector<double>& x) const {
    constexpr int most_steps = 400;
    constexpr double enough = 1e-16;  // of the squared first residual
    std::vector<double> change(x.size(), 0), residual = times_rows(x), direction(x.size()), image;
    for (double& r : residual) r = -r;
    double size = 0;
    for (std::size_t i = 0; i < x.size(); ++i) {
      direction[i] = residual[i] / diagonal_[i];
      size += residual[i] * direction[i];
    }
    const double first = size;
    for (int step = 0; step < most_steps && size > enough * first; ++step) {
      image = times_rows(direction);
      double along = 0;
      for (std::size_t i = 0; i < x.size(); ++i) {
        image[i] += inertias_[i] * direction[i];
        along += image[i] * direction[i];
      }
      const double far = size / along, before = size;
      size = 0;
      for (std::size_t i = 0; i < x.size(); ++i) {
        change[i] += far * direction[i];
        residual[i] -= far * image[i];
        size += residual[i] * residual[i] / diagonal_[i];
      }
      for (std::size_t i = 0; i < x.size(); ++i) {
        direction[i] = residual[i] / diagonal_[i] + size / before * direction[i];
      }
    }
    for (std::size_t i = 0; i < x.size(); ++i) x[i] += change[i];
  }

 private:
  /// R^T R x
  [[nodiscard]] std::vector<double> times_rows(const std::vector<double>& x) const {
    std::vector<double> product(x.size(), 0);
    for (const Row& row : rows_) {
      double difference = 0;
      for (std::size_t k = 0; k < 8; ++k) difference += row.weights[k] * x[row.texels[k]];
      for (std::size_t k = 0; k < 8; ++k) product[row.texels[k]] += row.weights[k] * difference;
    }
    return product;
  }

  std::span<const Row> rows_;
  std::vector<double> inertias_, diagonal_;
};

}  // namespace

void stitch_seams(std::span<const ChartSeam> seams, int width, int height, std::span<const std::uint8_t> covered,
                  std::span<float> values, std::size_t channels, float lowest) {
  std::vector<Row> rows = rows_along(seams, width, height);
  const std::vector<std::uint32_t> pixels = number_unknowns(rows);
  std::vector<double> inertias;
  inertias.reserve(pixels.size());
  for (const std::uint32_t p : pixels) inertias.push_back(covered[p] != 0 ? inertia : inertia_beside);
  const Stitching stitching(rows, std::move(inertias));
  std::vector<double> x(pixels.size());
  for (std::size_t c = 0; c < channels; ++c) {
    for (std::size_t i = 0; i < x.size(); ++i) x[i] = values[pixels[i] * channels + c];
    stitching.solve(x);
    for (std::size_t i = 0; i < x.size(); ++i) {
      values[pixels[i] * channels + c] = std::max(lowest, static_cast<float>(x[i]));
    }
  }
}

}  // namespace penumbra
