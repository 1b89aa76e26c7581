#pragma once

#include <cstddef>
#include <map>
#include <string>
#include <vector>

#include "penumbra/math/spectrum.h"

namespace penumbra {

/// A float picture: `channels.size()` planes interleaved per pixel, row 0 at the top, scene-linear.
/// Channel names follow OpenEXR: "R", "G", "B", "A", or "layer.R".
struct Image {
  int width = 0;
  int height = 0;
  std::vector<std::string> channels;
  std::vector<float> data;
  /// Free text that picture files carry along (camera, renderer, samples, "partial").
  std::map<std::string, std::string> metadata;

  Image() = default;
  /// A black picture. @pre width, height >= 1.
  Image(int width_, int height_, std::vector<std::string> channels_ = {"R", "G", "B"})
      : width(width_),
        height(height_),
        channels(std::move(channels_)),
        data(static_cast<std::size_t>(width_) * static_cast<std::size_t>(height_) * channels.size(), 0.0F) {}

  [[nodiscard]] std::size_t index(int x, int y) const {
    return (static_cast<std::size_t>(y) * static_cast<std::size_t>(width) + static_cast<std::size_t>(x)) *
           channels.size();
  }
  [[nodiscard]] float* pixel(int x, int y) { return data.data() + index(x, y); }
  [[nodiscard]] const float* pixel(int x, int y) const { return data.data() + index(x, y); }

  /// The first three channels. @pre there are at least three.
  [[nodiscard]] Rgb rgb(int x, int y) const {
    const float* p = pixel(x, y);
    return {p[0], p[1], p[2]};
  }
  void set_rgb(int x, int y, const Rgb& c) {
    float* p = pixel(x, y);
    p[0] = c.x;
    p[1] = c.y;
    p[2] = c.z;
  }
};

}  // namespace penumbra
