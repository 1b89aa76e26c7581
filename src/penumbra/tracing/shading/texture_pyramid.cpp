#include "penumbra/tracing/shading/texture_pyramid.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "penumbra/parallel/parallel_for.h"
#include "penumbra/scene/texel_address.h"
#include "penumbra/tracing/shading/footprint_axes.h"

namespace penumbra {
namespace {

constexpr double most_probes = 16;

/// How a texel of the next level gathers along one axis: up to three texels from `first`, and their shares.
struct Gathering {
  int first = 0;
  float shares[3]{};
};

// A level of n texels becomes one of max(1, n / 2): each covers n / m texels, whose ends may cut one.
std::vector<Gathering> gatherings(int from, int to) {
  std::vector<Gathering> all(static_cast<std::size_t>(to));
  const double covered = static_cast<double>(from) / to;
  for (int i = 0; i < to; ++i) {
    Gathering& g = all[static_cast<std::size_t>(i)];
    const double begin = i * covered;
    const double end = begin + covered;
    g.first = std::min(static_cast<int>(begin), from - 1);
    for (int k = 0; k < 3; ++k) {
      const double inside = std::min(end, g.first + k + 1.0) - std::max(begin, static_cast<double>(g.first + k));
      g.shares[k] = static_cast<float>(std::max(0.0, inside) / covered);
    }
  }
  return all;
}

Vec4f between(const Vec4f& a, const Vec4f& b, float share) { return a * (1 - share) + b * share; }

}  // namespace

TexturePyramid::TexturePyramid(const TextureImage& image, TexelEncoding encoding)
    : image_(&image), encoding_(encoding) {
  int width = image.width;
  int height = image.height;
  while (width > 1 || height > 1) {
    Level next{std::max(1, width / 2), std::max(1, height / 2), {}};
    next.texels.resize(static_cast<std::size_t>(next.width) * static_cast<std::size_t>(next.height));
    const auto columns = gatherings(width, next.width);
    const auto rows = gatherings(height, next.height);
    const Level* below = levels_.empty() ? nullptr : &levels_.back();
    const auto source = [&](int x, int y) {
      return below != nullptr ? below->texels[static_cast<std::size_t>(y) * static_cast<std::size_t>(width) +
                                              static_cast<std::size_t>(x)]
                              : texel(image, x, y, encoding);
    };
    parallel_for(rows.size(), 16, [&](std::size_t first, std::size_t last) {
      for (std::size_t j = first; j < last; ++j) {
        for (std::size_t i = 0; i < columns.size(); ++i) {
          Vec4f sum(0);
          for (int dy = 0; dy < 3; ++dy) {
            for (int dx = 0; dx < 3; ++dx) {
              const float share = rows[j].shares[dy] * columns[i].shares[dx];
              if (share > 0) sum += share * source(columns[i].first + dx, rows[j].first + dy);
            }
          }
          next.texels[j * columns.size() + i] = sum;
        }
      }
    });
    width = next.width;
    height = next.height;
    levels_.push_back(std::move(next));
  }
}

Vec4f TexturePyramid::bilinear(int level, const Texture& texture, const Vec2d& uv) const {
  if (level == 0) return texture_value(texture, *image_, Vec2f(uv), encoding_);
  const Level& at = levels_[static_cast<std::size_t>(level - 1)];
  const TexelPair x = texels_around(wrapped(uv.x, texture.wrap_u), at.width, texture.wrap_u);
  const TexelPair y = texels_around(wrapped(uv.y, texture.wrap_v), at.height, texture.wrap_v);
  const auto row = [&](int j) {
    const Vec4f* texels = at.texels.data() + static_cast<std::size_t>(j) * static_cast<std::size_t>(at.width);
    return between(texels[x.first], texels[x.second], x.share);
  };
  return between(row(y.first), row(y.second), y.share);
}

// Two levels, mixed so that the spread is that of texels of the width asked: spreads go with the width's square.
Vec4f TexturePyramid::trilinear(double width, const Texture& texture, const Vec2d& uv) const {
  if (!(width > 1)) return bilinear(0, texture, uv);
  const int finer = std::ilogb(width);
  if (finer >= level_count()) return bilinear(level_count(), texture, uv);
  const double stretch = std::ldexp(width, -finer);
  const double share = (stretch * stretch - 1) / 3;
  return between(bilinear(finer, texture, uv), bilinear(finer + 1, texture, uv), static_cast<float>(share));
}

Vec4f TexturePyramid::value(const Texture& texture, const Vec2d& uv, const TextureFootprint& footprint) const {
  if (!texture.mipmaps) return bilinear(0, texture, uv);
  const Vec2d size(image_->width, image_->height);
  const FootprintAxes axes = axes_of(footprint.x * size, footprint.y * size);
  if (!std::isfinite(axes.major_length)) return bilinear(level_count(), texture, uv);
  // A bilinear lookup between texels of width w spreads by w^2 / 4 (the texel's w^2 / 12 and the tent's w^2 / 6), a
  // probe of the footprint's width s by s^2 / 12.
  constexpr double width_of_probe = std::numbers::sqrt3;
  const double narrowest = std::max(axes.minor_length, axes.major_length / most_probes);
  const double probes =
      std::clamp(std::ceil(axes.major_length / std::max(narrowest, width_of_probe)), 1.0, most_probes);
  const double width = narrowest / width_of_probe;
  if (probes == 1) return trilinear(width, texture, uv);
  const Vec2d step = axes.major / size / probes;
  Vec4f sum(0);
  for (double k = 0.5 * (1 - probes); k < 0.5 * probes; ++k) sum += trilinear(width, texture, uv + k * step);
  return sum / static_cast<float>(probes);
}

}  // namespace penumbra
