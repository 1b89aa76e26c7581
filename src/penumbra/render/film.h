#pragma once

#include <algorithm>
#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "penumbra/image/image.h"
#include "penumbra/render/render.h"

namespace penumbra {

/// What one camera ray saw.
struct PixelEstimate {
  Rgb radiance{0};
  Rgb direct{0};      ///< the part that came from a light by at most one surface (emission seen included)
  Rgb albedo{0};      ///< of the first surface
  Vec3f normal{0};    ///< shading normal of the first surface, world
  Vec3f position{0};  ///< of the first surface, world, m
  float depth = 0;    ///< distance to the first surface along the ray, m; infinite where there is none
  float object = -1;  ///< number of the first surface's object; -1 where there is none
  float rays = 0;     ///< traced for this sample
};

/// The channels of a picture with these layers: "R", "G", "B", then "layer.C".
[[nodiscard]] std::vector<std::string> picture_channels(std::span<const Aov> aovs);

/// Sums of samples, pixel by pixel. Different pixels may be written at once. A film covers a picture or a part of it;
/// pixels are always those of the picture.
///
/// Colour, albedo, normal and rays are means over the samples; position, depth and object are those of the first
/// sample, since their means mean nothing. Variance is that of the pixel's mean.
class Film {
 public:
  /// @param measures_noise whether squared_error() will be asked for.
  Film(int width, int height, std::vector<Aov> aovs, bool measures_noise = false)
      : Film(Region{0, 0, width, height}, std::move(aovs), measures_noise) {}
  /// The same for a part of the picture.
  Film(const Region& area, std::vector<Aov> aovs, bool measures_noise = false);

  /// Whether more than colour is to be recorded.
  [[nodiscard]] bool has_layers() const { return !aovs_.empty(); }

  /// Adds a sample. @param weight of the reconstruction filter.
  void add(int x, int y, const PixelEstimate& estimate, float weight) {
    Pixel& p = pixels_[index(x, y)];
    const Vec3d c = Vec3d(weight * estimate.radiance);
    for (int band = 0; band < 3; ++band) p.radiance[band] += c[band];
    ++p.samples;
    if (!squares_.empty()) {
      const double bright = luminance(Rgb(c));
      squares_[index(x, y)] += bright * bright;
    }
    if (!layers_.empty()) add_layers(x, y, estimate, c);
  }

  /// Adds a sample along which no light comes.
  void add_nothing(int x, int y);

  /// Mean luminance of a pixel's samples, W/(m^2 sr).
  [[nodiscard]] double brightness(int x, int y) const {
    const Pixel& p = pixels_[index(x, y)];
    return p.samples > 0 ? luminance(Rgb(p.radiance[0], p.radiance[1], p.radiance[2])) / p.samples : 0;
  }
  /// Variance of that mean, as if the samples were independent (those of Owen-scrambled Sobol points do better).
  /// @pre the film measures noise and the pixel has at least two samples.
  [[nodiscard]] double squared_error(int x, int y) const {
    const double n = pixels_[index(x, y)].samples, mean = brightness(x, y);
    return std::max(0.0, squares_[index(x, y)] / n - mean * mean) / (n - 1);
  }

  [[nodiscard]] double mean_samples() const;
  /// Samples of all pixels together.
  [[nodiscard]] std::uint64_t sample_count() const;

  /// The picture so far; pixels without a sample are black.
  [[nodiscard]] Image develop() const;
  /// Writes the film's area into the picture that it is a part of. @pre `picture` has the channels of the film's
  /// layers, see `picture_channels`.
  void develop_into(Image& picture) const { develop_into(picture, 0, 0); }

 private:
  struct Pixel {
    double radiance[3];
    int samples;
  };
  struct Layers {
    Vec3d squares{0}, direct{0}, albedo{0}, normal{0};
    double rays = 0;
    Vec3f position{0};
    float depth = 0, object = -1;
  };

  [[nodiscard]] std::size_t index(int x, int y) const {
    return static_cast<std::size_t>(y - area_.y0) * width_ + static_cast<std::size_t>(x - area_.x0);
  }
  void develop_into(Image& picture, int left, int top) const;
  void develop_pixel(std::size_t pixel, float* out) const;
  void develop_colours(std::size_t first, float* out) const;
  void add_layers(int x, int y, const PixelEstimate& estimate, const Vec3d& weighted);

  Region area_;
  std::vector<Aov> aovs_;
  std::size_t width_, size_;
  std::unique_ptr<Pixel[]> pixels_;  // cleared on every thread: large pictures are mostly fresh pages
  std::vector<Layers> layers_;
  std::vector<double> squares_;  // of the samples' luminance
};

}  // namespace penumbra
