#include "penumbra/radiosity/specular_transport.h"

#include <cmath>

namespace penumbra {

Vec3d SpecularTransport::row_sum(std::size_t i) const {
  Vec3d sum(0);
  for (std::uint64_t k = offsets[i]; k < offsets[i + 1]; ++k) {
    for (int b = 0; b < 3; ++b) sum[b] += static_cast<double>(values[bands * k + static_cast<std::size_t>(b)]);
  }
  return sum;
}

void SpecularTransport::gather(std::size_t first, std::size_t last, std::span<const double> radiosity,
                               std::span<double> irradiance) const {
  for (std::size_t i = first; i < last; ++i) {
    double* const sum = &irradiance[bands * (i - first)];
    for (std::uint64_t k = offsets[i]; k < offsets[i + 1]; ++k) {
      const double* const sent = &radiosity[bands * columns[k]];
      for (std::size_t b = 0; b < bands; ++b) sum[b] += static_cast<double>(values[bands * k + b]) * sent[b];
    }
  }
}

std::vector<double> SpecularTransport::standard_errors(std::span<const double> radiosity) const {
  std::vector<double> errors(bands * rows(), 0.0);
  for (std::size_t i = 0; i < rows(); ++i) {
    for (std::uint64_t k = offsets[i]; k < offsets[i + 1]; ++k) {
      for (std::size_t b = 0; b < bands; ++b) {
        errors[bands * i + b] += static_cast<double>(deviations[bands * k + b]) * radiosity[bands * columns[k] + b];
      }
    }
    for (std::size_t b = 0; b < bands; ++b) errors[bands * i + b] = std::abs(errors[bands * i + b]);
  }
  return errors;
}

SpecularTransport transposed(const SpecularTransport& t) {
  SpecularTransport sent;
  sent.offsets.assign(t.rows() + 1, 0);
  for (const std::uint32_t column : t.columns) ++sent.offsets[column + 1];
  for (std::size_t j = 0; j < t.rows(); ++j) sent.offsets[j + 1] += sent.offsets[j];
  sent.columns.resize(t.columns.size());
  sent.values.resize(t.values.size());
  sent.deviations.resize(t.deviations.size());
  sent.leaving = t.leaving;
  std::vector<std::uint64_t> next(sent.offsets.begin(), sent.offsets.end() - 1);
  for (std::size_t i = 0; i < t.rows(); ++i) {
    for (std::uint64_t k = t.offsets[i]; k < t.offsets[i + 1]; ++k) {
      const std::uint64_t to = next[t.columns[k]]++;
      sent.columns[to] = static_cast<std::uint32_t>(i);
      for (std::size_t b = 0; b < SpecularTransport::bands; ++b) {
        sent.values[3 * to + b] = t.values[3 * k + b];
        sent.deviations[3 * to + b] = t.deviations[3 * k + b];
      }
    }
  }
  return sent;
}

}  // namespace penumbra
