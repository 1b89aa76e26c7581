#include "penumbra/render/film.h"

#include <algorithm>
#include <limits>

#include "penumbra/parallel/parallel_for.h"

namespace penumbra {
namespace {

constexpr std::size_t clearing_grain = std::size_t{1} << 16;  // pixels

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

std::vector<Aov> in_order(std::vector<Aov> aovs) {
  std::sort(aovs.begin(), aovs.end());
  aovs.erase(std::unique(aovs.begin(), aovs.end()), aovs.end());
  return aovs;
}

}  // namespace

std::vector<std::string> picture_channels(std::span<const Aov> aovs) {
  std::vector<std::string> channels = {"R", "G", "B"};
  for (const Aov aov : in_order({aovs.begin(), aovs.end()})) {
    const LayerName layer = layer_name(aov);
    for (const char* part : layer.parts) channels.push_back(std::string(layer.name) + "." + part);
  }
  return channels;
}

Film::Film(const Region& area, std::vector<Aov> aovs, bool measures_noise)
    : area_(area),
      aovs_(in_order(std::move(aovs))),
      width_(static_cast<std::size_t>(area.x1 - area.x0)),
      size_(width_ * static_cast<std::size_t>(area.y1 - area.y0)),
      pixels_(std::make_unique_for_overwrite<Pixel[]>(size_)) {
  const auto clear = [&](std::size_t first, std::size_t last) {
    std::fill(pixels_.get() + first, pixels_.get() + last, Pixel{});
  };
  size_ <= clearing_grain ? clear(0, size_) : parallel_for(size_, clearing_grain, clear);
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

double Film::mean_samples() const { return static_cast<double>(sample_count()) / static_cast<double>(size_); }

std::uint64_t Film::sample_count() const {
  std::uint64_t sum = 0;
  for (std::size_t i = 0; i < size_; ++i) sum += static_cast<std::uint64_t>(pixels_[i].samples);
  return sum;
}

void Film::develop_pixel(std::size_t i, float* out) const {
  const Pixel& p = pixels_[i];
  if (p.samples == 0) return;
  const double n = p.samples;
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
}

// A row of colours alone.
void Film::develop_colours(std::size_t first, float* out) const {
  for (const Pixel* p = &pixels_[first]; p != &pixels_[first] + width_; ++p, out += 3) {
    if (p->samples == 0) continue;
    for (int band = 0; band < 3; ++band) out[band] = static_cast<float>(p->radiance[band] / p->samples);
  }
}

void Film::develop_into(Image& picture, int left, int top) const {
  const std::size_t channels = picture.channels.size();
  const auto rows = static_cast<std::size_t>(area_.y1 - area_.y0);
  const auto develop_rows = [&](std::size_t first, std::size_t last) {
    for (std::size_t row = first; row < last; ++row) {
      float* out = picture.pixel(area_.x0 - left, area_.y0 - top + static_cast<int>(row));
      if (aovs_.empty()) {
        develop_colours(row * width_, out);
        continue;
      }
      for (std::size_t column = 0; column < width_; ++column)
        develop_pixel(row * width_ + column, out + column * channels);
    }
  };
  const std::size_t rows_a_task = std::max<std::size_t>(1, clearing_grain / width_);
  rows <= rows_a_task ? develop_rows(0, rows) : parallel_for(rows, rows_a_task, develop_rows);
}

Image Film::develop() const {
  Image image(area_.x1 - area_.x0, area_.y1 - area_.y0, picture_channels(aovs_));
  develop_into(image, area_.x0, area_.y0);
  return image;
}

}  // namespace penumbra
