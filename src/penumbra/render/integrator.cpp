#include "penumbra/render/integrator.h"

namespace penumbra {

void RayIntegrator::render(const PixelBlock& block, Film& film, RayCounts& rays) const {
  for (int y = block.y0; y < block.y1; ++y) {
    for (int x = block.x0; x < block.x1; ++x) {
      for (int sample = block.first_sample; sample < block.last_sample; ++sample) {
        PixelSampler sampler(seed_, x, y, sample);
        const auto [ray, weight] = camera_.ray(x, y, sampler);
        if (weight == 0) {
          film.add_nothing(x, y);
          continue;
        }
        const std::uint64_t before = rays.total();
        PixelEstimate estimate = this->estimate(ray, sampler, rays);
        estimate.rays = static_cast<float>(rays.total() - before);
        film.add(x, y, estimate, weight);
      }
    }
  }
}

}  // namespace penumbra
