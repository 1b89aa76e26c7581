#include "penumbra/render/film.h"

#include <algorithm>
#include <limits>

#include "penumbra/parallel/parallel_for.h"

namespace penumbra {
namespace {

struct LayerName {
  const char* name;
  std::vector<const char*> parts;
};

LayerName layer_name(Aov aov) {
  switch (aov) {
    case Aov::albedo:
      return {"albedo", {"R", "G", "B"}};
    case Aov::normal:
      return {"normal", {"X", "Y", "Z"}};
    case Aov::depth:
      return {"depth", {"Z"}};
    case Aov::position:
      return {"position", {"X", "Y", "Z"}};
    case Aov::object:
      return {"object", {"id"}};
    case Aov::direct:
      return {"direct", {"R", "G", "B"}};
    case Aov::indirect:
      return {"indirect", {"R", "G", "B"}};
    case Aov::variance:
      return {"variance", {"R", "G", "B"}};
    case Aov::rays:
      return {"rays", {"count"}};
  }
  return {};
}

}  // namespace

Film::Film(int width, int height, std::vector<Aov> aovs, bool measures_noise)
    : width_(width),
      height_(height),
      aovs_(std::move(aovs)),
      size_(static_cast<std::size_t>(width) * static_cast<std::size_t>(height)),
      pixels_(std::make_unique_for_overwrite<Pixel[]>(size_)) {
  parallel_for(size_, 1U << 16, [&](std::size_t first, std::size_t last) {
    std::fill(pixels_.get() + first, pixels_.get() + last, Pixel{});
  });
  std::sort(aovs_.begin(), aovs_.end());
  aovs_.erase(std::unique(aovs_.begin(), aovs_.end()), aovs_.end());
  if (!aovs_.empty()) layers_.resize(size_);
  if (measures_noise) squares_.resize(size_);
}

void Film::add_layers(int x, int y, const PixelEstimate& e, const Vec3d& weighted) {
  Layers& l = layers_[index(x, y)];
  if (pixels_[index(x, y)].samples == 1) {
    l.position = e.position;
    l.depth = e.depth;
    l.object = e.object;
  }
  l.squares += weighted * weighted;
  l.direct += Vec3d(e.direct);
  l.albedo += Vec3d(e.albedo);
  l.normal += Vec3d(e.normal);
  l.rays += e.rays;
}

void Film::add_nothing(int x, int y) {
  PixelEstimate nothing;
  nothing.depth = std::numeric_limits<float>::infinity();
  add(x, y, nothing, 0);
}

double Film::mean_samples() const {
  double sum = 0;
  for (std::size_t i = 0; i < size_; ++i) sum += pixels_[i].samples;
  return sum / static_cast<double>(size_);
}

Image Film::develop() const {
  std::vector<std::string> channels = {"R", "G", "B"};
  for (const Aov aov : aovs_) {
    const LayerName layer = layer_name(aov);
    for (const char* part : layer.parts) channels.push_back(std::string(layer.name) + "." + part);
  }
  Image image(width_, height_, channels);
  const auto develop_pixel = [&](std::size_t i) {
    const Pixel& p = pixels_[i];
    if (p.samples == 0) return;
    const double n = p.samples;
    float* out = image.data.data() + i * channels.size();
    const auto put = [&](const Vec3d& v) {
      for (int c = 0; c < 3; ++c) *out++ = static_cast<float>(v[c]);
    };
    const Vec3d mean = Vec3d(p.radiance[0], p.radiance[1], p.radiance[2]) / n;
    put(mean);
    for (const Aov aov : aovs_) {
      const Layers& l = layers_[i];
      switch (aov) {
        case Aov::albedo:
          put(l.albedo / n);
          break;
        case Aov::normal:
          put(length(l.normal) > 0 ? normalize(l.normal) : Vec3d(0));
          break;
        case Aov::depth:
          *out++ = l.depth;
          break;
        case Aov::position:
          put(Vec3d(l.position));
          break;
        case Aov::object:
          *out++ = l.object;
          break;
        case Aov::direct:
          put(l.direct / n);
          break;
        case Aov::indirect:
          put(mean - l.direct / n);
          break;
        case Aov::variance:
          put(n > 1 ? glm::max(Vec3d(0), l.squares / n - mean * mean) / (n - 1) : Vec3d(0));
          break;
        case Aov::rays:
          *out++ = static_cast<float>(l.rays / n);
          break;
      }
    }
  };
  parallel_for(size_, 1U << 16, [&](std::size_t first, std::size_t last) {
    for (std::size_t i = first; i < last; ++i) develop_pixel(i);
  });
  return image;
}

}  // namespace penumbra
