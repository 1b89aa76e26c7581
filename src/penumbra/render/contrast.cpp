#include "penumbra/render/contrast.h"

#include <algorithm>
#include <cmath>

#include "penumbra/parallel/parallel_for.h"
#include "penumbra/tracing/shading/media.h"

namespace penumbra {
namespace {

constexpr int samples_of_soft_scenes = 4;
constexpr float darkest = 0.01F;  // of the picture's mean

float mean_of(const Image& picture, const Region& r) {
  double sum = 0;
  for (int y = r.y0; y < r.y1; ++y) {
    for (int x = r.x0; x < r.x1; ++x) sum += luminance(picture.rgb(x, y));
  }
  return static_cast<float>(sum / (static_cast<double>(r.x1 - r.x0) * (r.y1 - r.y0)));
}

// Lamps that light comes from at more than one point.
bool has_soft_light(const Scene& scene) {
  if (scene.environment && !scene.environment->backdrop_only) return true;
  const auto is_wide = [](const Light& light) {
    const auto* far = std::get_if<DirectionalLight>(&light.kind);
    return far != nullptr && far->angular_radius > 0;
  };
  return std::any_of(scene.lights.begin(), scene.lights.end(), is_wide) ||
         std::any_of(scene.materials.begin(), scene.materials.end(), [](const Material& m) { return m.emits(); });
}

}  // namespace

std::vector<std::uint8_t> contrasted_pixels(const Image& picture, const Region& region, double contrast) {
  const auto threshold = static_cast<float>(contrast);
  const float floor = 2 * darkest * mean_of(picture, region);
  const auto differ = [&](int x0, int y0, int x1, int y1) {
    const float* a = picture.pixel(x0, y0);
    const float* b = picture.pixel(x1, y1);
    bool found = false;
    for (int band = 0; band < 3; ++band) {
      found = found || std::abs(a[band] - b[band]) > threshold * std::max(a[band] + b[band], floor);
    }
    return found;
  };
  const auto width = static_cast<std::size_t>(region.x1 - region.x0);
  std::vector<std::uint8_t> marks(width * static_cast<std::size_t>(region.y1 - region.y0), 0);
  parallel_for(static_cast<std::size_t>(region.y1 - region.y0), 16, [&](std::size_t first, std::size_t last) {
    for (std::size_t row = first; row < last; ++row) {
      const int y = region.y0 + static_cast<int>(row);
      for (int x = region.x0; x < region.x1; ++x) {
        bool found = false;
        for (int v = std::max(0, y - 1); v <= std::min(picture.height - 1, y + 1) && !found; ++v) {
          for (int u = std::max(0, x - 1); u <= std::min(picture.width - 1, x + 1) && !found; ++u) {
            found = differ(x, y, u, v);
          }
        }
        marks[row * width + static_cast<std::size_t>(x - region.x0)] = found ? 1 : 0;
      }
    }
  });
  return marks;
}

void leave_only(const Region& region, Image& picture) {
  for (int y = 0; y < picture.height; ++y) {
    for (int x = 0; x < picture.width; ++x) {
      const bool inside = x >= region.x0 && x < region.x1 && y >= region.y0 && y < region.y1;
      if (!inside) std::fill_n(picture.pixel(x, y), picture.channels.size(), 0.0F);
    }
  }
}

int samples_to_judge(const Camera& camera) {
  const bool has_lens = camera.thin_lens && camera.thin_lens->radius > 0;
  return has_lens || !camera.motion.empty() ? samples_of_soft_scenes : 1;
}

int samples_to_judge(const RayTracer& tracer, const Camera& camera) {
  const bool is_soft = tracer.has_motion() || has_soft_light(tracer.scene()) || !Media(tracer.scene()).none();
  return is_soft ? samples_of_soft_scenes : samples_to_judge(camera);
}

}  // namespace penumbra
