#include "penumbra/tracing/shading/environment_map.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "penumbra/math/sampling.h"

namespace penumbra {
namespace {

using std::numbers::pi;

// Which cell of a cumulative distribution holds u, and where in it (0..1).
std::pair<std::size_t, double> find_cell(const double* cdf, std::size_t cells, double u) {
  const double* above = std::upper_bound(cdf, cdf + cells + 1, u);
  const auto cell =
      static_cast<std::size_t>(std::clamp<std::ptrdiff_t>(above - cdf - 1, 0, static_cast<std::ptrdiff_t>(cells) - 1));
  const double width = cdf[cell + 1] - cdf[cell];
  return {cell, width > 0 ? std::min((u - cdf[cell]) / width, 1 - 1e-12) : 0.5};
}

void accumulate(double* cdf, std::size_t cells) {
  for (std::size_t i = 0; i < cells; ++i) cdf[i + 1] += cdf[i];
  const double total = cdf[cells];
  for (std::size_t i = 1; i <= cells; ++i) {
    cdf[i] = total > 0 ? cdf[i] / total : static_cast<double>(i) / static_cast<double>(cells);
  }
}

// Picture coordinates (0..1)^2 of a direction.
Vec2d to_picture(const Vec3d& d) {
  double u = 0.5 + std::atan2(d.x, -d.z) / (2 * pi);
  u -= std::floor(u);
  return {u, std::acos(std::clamp(d.y, -1.0, 1.0)) / pi};
}

}  // namespace

EnvironmentMap::EnvironmentMap(const Scene& scene) {
  if (!scene.environment) return;
  factor_ = mean_ = scene.environment->radiance;
  lights_ = !scene.environment->backdrop_only && !is_black(factor_);
  if (!scene.environment->image) return;

  image_ = &scene.images[*scene.environment->image];
  const auto w = static_cast<std::size_t>(image_->width);
  const auto h = static_cast<std::size_t>(image_->height);
  row_cdf_.assign(h + 1, 0);
  column_cdf_.assign(h * (w + 1), 0);
  Vec3d sum(0);
  double solid_angle = 0;
  for (std::size_t y = 0; y < h; ++y) {
    const double ring = std::sin(pi * (static_cast<double>(y) + 0.5) / static_cast<double>(h));
    double* columns = column_cdf_.data() + y * (w + 1);
    for (std::size_t x = 0; x < w; ++x) {
      const Rgb c = texel(static_cast<int>(x), static_cast<int>(y));
      columns[x + 1] = std::max(0.0F, luminance(c));
      row_cdf_[y + 1] += ring * columns[x + 1];
      sum += ring * Vec3d(c);
      solid_angle += ring;
    }
    accumulate(columns, w);
  }
  accumulate(row_cdf_.data(), h);
  mean_ = Rgb(sum / solid_angle) * factor_;
}

Rgb EnvironmentMap::texel(int x, int y) const {
  const auto at =
      (static_cast<std::size_t>(y) * static_cast<std::size_t>(image_->width) + static_cast<std::size_t>(x)) *
      static_cast<std::size_t>(image_->channels);
  const auto channel = [&](int c) { return at + static_cast<std::size_t>(image_->channels >= 3 ? c : 0); };
  if (const auto* values = std::get_if<std::vector<float>>(&image_->texels)) {
    return {(*values)[channel(0)], (*values)[channel(1)], (*values)[channel(2)]};
  }
  const auto& bytes = std::get<std::vector<std::uint8_t>>(image_->texels);
  return Rgb(bytes[channel(0)], bytes[channel(1)], bytes[channel(2)]) / 255.0F;
}

// Texels are looked up without interpolation, so that the density of `sample` is exactly proportional to what is seen.
Rgb EnvironmentMap::radiance(const Vec3d& direction) const {
  if (image_ == nullptr) return factor_;
  const Vec2d p = to_picture(direction);
  const int x = std::min(static_cast<int>(p.x * image_->width), image_->width - 1);
  const int y = std::min(static_cast<int>(p.y * image_->height), image_->height - 1);
  return factor_ * texel(x, y);
}

EnvironmentMap::Sample EnvironmentMap::sample(const Vec2d& u) const {
  if (image_ == nullptr) return {sample_sphere(u), 1 / (4 * pi)};
  const auto w = static_cast<std::size_t>(image_->width);
  const auto h = static_cast<std::size_t>(image_->height);
  const auto [row, v_part] = find_cell(row_cdf_.data(), h, u.y);
  const auto [column, u_part] = find_cell(column_cdf_.data() + row * (w + 1), w, u.x);
  const double theta = pi * (static_cast<double>(row) + v_part) / static_cast<double>(h);
  const double phi = 2 * pi * ((static_cast<double>(column) + u_part) / static_cast<double>(w) - 0.5);
  const Vec3d direction(std::sin(theta) * std::sin(phi), std::cos(theta), -std::sin(theta) * std::cos(phi));
  return {direction, pdf(direction)};
}

double EnvironmentMap::pdf(const Vec3d& direction) const {
  if (image_ == nullptr) return 1 / (4 * pi);
  const auto w = static_cast<std::size_t>(image_->width);
  const auto h = static_cast<std::size_t>(image_->height);
  const Vec2d p = to_picture(direction);
  const auto x = std::min(static_cast<std::size_t>(p.x * static_cast<double>(w)), w - 1);
  const auto y = std::min(static_cast<std::size_t>(p.y * static_cast<double>(h)), h - 1);
  const double* columns = column_cdf_.data() + y * (w + 1);
  const double in_square = (row_cdf_[y + 1] - row_cdf_[y]) * (columns[x + 1] - columns[x]) * static_cast<double>(w * h);
  const double sine = std::sqrt(std::max(1e-30, 1 - direction.y * direction.y));
  return in_square / (2 * pi * pi * sine);
}

}  // namespace penumbra
