#include "penumbra/image/layer_picture.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>
#include <string>

namespace penumbra {
namespace {

/// The least and largest finite value of a channel.
struct Range {
  float least = std::numeric_limits<float>::infinity();
  float largest = -std::numeric_limits<float>::infinity();
};

Range range_of(const Image& image, std::size_t channel) {
  Range range;
  for (std::size_t i = channel; i < image.data.size(); i += image.channels.size()) {
    if (!std::isfinite(image.data[i])) continue;
    range.least = std::min(range.least, image.data[i]);
    range.largest = std::max(range.largest, image.data[i]);
  }
  return range;
}

}  // namespace

Image layer_picture(const Image& image, std::string_view layer) {
  const std::string prefix = std::string(layer) + ".";
  const auto begins = [&](const std::string& name) { return name.rfind(prefix, 0) == 0; };
  const auto found = std::find_if(image.channels.begin(), image.channels.end(), begins);
  if (found == image.channels.end()) throw std::invalid_argument("the picture has no layer " + std::string(layer));
  const auto first = static_cast<std::size_t>(found - image.channels.begin());
  const bool one = static_cast<std::size_t>(std::count_if(found, image.channels.end(), begins)) < 3;

  Image picture(image.width, image.height);
  picture.metadata = image.metadata;
  picture.metadata["layer"] = std::string(layer);
  for (std::size_t band = 0; band < 3; ++band) {
    const std::size_t channel = one ? first : first + band;
    Range range{0, 1};
    if (one) range = {0, range_of(image, channel).largest};
    if (layer == "normal") range = {-1, 1};
    if (layer == "position") range = range_of(image, channel);
    const float width = range.largest > range.least ? range.largest - range.least : 1;
    for (std::size_t i = 0; i < picture.data.size() / 3; ++i) {
      const float value = image.data[i * image.channels.size() + channel];
      picture.data[3 * i + band] = std::isfinite(value) ? std::max(0.0F, (value - range.least) / width) : 0;
    }
  }
  return picture;
}

}  // namespace penumbra
