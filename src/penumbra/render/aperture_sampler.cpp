#include "penumbra/render/aperture_sampler.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <span>
#include <stdexcept>

#include "penumbra/math/sampling.h"

namespace penumbra {
namespace {

double light_through(const TextureImage& picture, std::size_t texel) {
  const std::size_t at = texel * static_cast<std::size_t>(picture.channels);
  if (const auto* bytes = std::get_if<std::vector<std::uint8_t>>(&picture.texels)) return (*bytes)[at] / 255.0;
  return std::max(0.0F, std::get<std::vector<float>>(picture.texels)[at]);
}

// Makes shares of a sum out of running sums; false when the sum is 0.
bool normalise(std::span<double> running) {
  const double sum = running.back();
  if (!(sum > 0 && std::isfinite(sum))) return false;
  for (double& r : running) r /= sum;
  return true;
}

// The cell of a running sum in which u falls, and how far along it, as one number.
double invert(std::span<const double> running, double u) {
  const auto above = std::upper_bound(running.begin() + 1, running.end() - 1, u);
  const auto cell = static_cast<std::size_t>(above - running.begin()) - 1;
  const double share = running[cell + 1] - running[cell];
  const double along = share > 0 ? std::min(1.0, (u - running[cell]) / share) : 0.5;
  return static_cast<double>(cell) + along;
}

}  // namespace

ApertureSampler::ApertureSampler(const ThinLens& lens) : cat_eye_(lens.cat_eye) {
  if (!(lens.radius >= 0 && std::isfinite(lens.radius))) throw std::invalid_argument("a lens's radius is 0 or more");
  if (!(lens.focus > 0 && std::isfinite(lens.focus))) throw std::invalid_argument("a lens focuses in front of itself");
  if (!(cat_eye_ >= 0 && cat_eye_ <= 1)) throw std::invalid_argument("a cat's eye is a share from 0 to 1");
  if (const auto* polygon = std::get_if<BladeAperture>(&lens.aperture)) {
    if (polygon->blades < 3) throw std::invalid_argument("an iris has at least 3 blades");
    kind_ = Kind::blades;
    blades_ = polygon->blades;
    rotation_ = polygon->rotation;
    return;
  }
  const auto* image = std::get_if<ImageAperture>(&lens.aperture);
  if (!image) return;
  kind_ = Kind::image;
  width_ = image->picture.width;
  height_ = image->picture.height;
  const auto width = static_cast<std::size_t>(width_), height = static_cast<std::size_t>(height_);
  rows_.assign(height + 1, 0);
  columns_.assign(height * (width + 1), 0);
  for (std::size_t y = 0; y < height; ++y) {
    const auto row = std::span(columns_).subspan(y * (width + 1), width + 1);
    for (std::size_t x = 0; x < width; ++x) row[x + 1] = row[x] + light_through(image->picture, y * width + x);
    rows_[y + 1] = rows_[y] + row.back();
    normalise(row);
  }
  if (rows_.size() < 2 || !normalise(rows_))
    throw std::invalid_argument("no light passes through the aperture's picture");
}

std::optional<Vec2d> ApertureSampler::sample(const Vec2d& u, const Vec2d& at) const {
  const Vec2d point = kind_ == Kind::disk ? sample_disk(u) : kind_ == Kind::blades ? in_blades(u) : in_picture(u);
  if (cat_eye_ > 0 && length(point - cat_eye_ * at) > 1) return std::nullopt;
  return point;
}

// One of the triangles between the middle and two neighbouring corners, and a point of it.
Vec2d ApertureSampler::in_blades(const Vec2d& u) const {
  const double which = u.x * blades_;
  const double blade = std::min(std::floor(which), blades_ - 1.0);
  const auto corner = [&](double k) {
    const double angle = std::numbers::pi / 2 + rotation_ + 2 * std::numbers::pi * k / blades_;
    return Vec2d(std::cos(angle), std::sin(angle));
  };
  const Vec2d weights = sample_triangle({which - blade, u.y});
  return weights.x * corner(blade) + weights.y * corner(blade + 1);
}

Vec2d ApertureSampler::in_picture(const Vec2d& u) const {
  const double y = invert(rows_, u.y);
  const auto row = std::min(static_cast<std::size_t>(y), static_cast<std::size_t>(height_) - 1);
  const auto stride = static_cast<std::size_t>(width_) + 1;
  const double x = invert(std::span(columns_).subspan(row * stride, stride), u.x);
  return {2 * x / width_ - 1, 1 - 2 * y / height_};
}

}  // namespace penumbra
