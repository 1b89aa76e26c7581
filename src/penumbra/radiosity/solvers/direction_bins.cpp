#include "penumbra/radiosity/solvers/direction_bins.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>

namespace penumbra {

DirectionBins::DirectionBins(int polar, int azimuth)
    : polar_(static_cast<std::size_t>(std::max(polar, 1))), azimuth_(static_cast<std::size_t>(std::max(azimuth, 2))) {
  if (polar < 1 || polar > 4096) throw std::invalid_argument("the polar bins of a hemisphere should be 1 to 4096");
  if (azimuth < 2 || azimuth > 4096 || azimuth % 2 != 0) {
    throw std::invalid_argument("the azimuth bins of a hemisphere should be an even number from 2 to 4096");
  }
}

std::size_t DirectionBins::index(const Vec3d& local) const {
  const double sine2 = std::min(1.0, local.x * local.x + local.y * local.y);
  double turn = std::atan2(local.y, local.x) / (2 * std::numbers::pi);
  if (turn < 0) turn += 1;
  const auto ring = std::min(polar_ - 1, static_cast<std::size_t>(sine2 * static_cast<double>(polar_)));
  const auto sector = std::min(azimuth_ - 1, static_cast<std::size_t>(turn * static_cast<double>(azimuth_)));
  return ring * azimuth_ + sector;
}

Vec3d DirectionBins::direction(std::size_t bin, double u, double v) const {
  const double sine2 = (static_cast<double>(bin / azimuth_) + u) / static_cast<double>(polar_);
  const double angle = 2 * std::numbers::pi * (static_cast<double>(bin % azimuth_) + v) / static_cast<double>(azimuth_);
  const double sine = std::sqrt(sine2);
  return {sine * std::cos(angle), sine * std::sin(angle), std::sqrt(std::max(0.0, 1 - sine2))};
}

std::size_t DirectionBins::mirrored(std::size_t bin) const {
  const std::size_t ring = bin / azimuth_, sector = bin % azimuth_;
  return ring * azimuth_ + (sector + azimuth_ / 2) % azimuth_;
}

std::vector<double> glossy_lobe(const DirectionBins& bins, double exponent) {
  if (!(exponent >= 0)) throw std::invalid_argument("the exponent of a glossy lobe should not be negative");
  const std::size_t n = bins.size();
  std::vector<double> lobe(n * n), scale(n, 1.0);
  for (std::size_t arriving = 0; arriving < n; ++arriving) {
    const Vec3d axis = bins.direction(bins.mirrored(arriving), 0.5, 0.5);
    for (std::size_t leaving = 0; leaving < n; ++leaving) {
      const double cosine = std::clamp(dot(axis, bins.direction(leaving, 0.5, 0.5)), 0.0, 1.0);
      lobe[leaving * n + arriving] = std::pow(cosine, exponent);
    }
  }
  // Symmetric scaling to rows and columns of sum 1 (Sinkhorn & Knopp 1967).
  for (int step = 0; step < 1000; ++step) {
    double worst = 0;
    for (std::size_t i = 0; i < n; ++i) {
      double sum = 0;
      for (std::size_t j = 0; j < n; ++j) sum += lobe[i * n + j] * scale[j];
      worst = std::max(worst, std::abs(sum * scale[i] - 1));
      scale[i] = std::sqrt(scale[i] / sum);
    }
    if (worst < 1e-13) break;
  }
  for (std::size_t i = 0; i < n; ++i)
    for (std::size_t j = 0; j < n; ++j) lobe[i * n + j] *= scale[i] * scale[j];
  return lobe;
}

}  // namespace penumbra
