#include "penumbra/render/direct_light.h"

#include <cmath>

#include "penumbra/render/ray_tally.h"

namespace penumbra {

Rgb DirectLight::reflected(const SurfacePoint& point, const Bsdf& bsdf, const Vec3d& wo, double roughness_limit,
                           int depth, PixelSampler& sampler, RayCounts& rays) const {
  Rgb sum(0);
  for (std::size_t light = 0; light < lights_.light_count(); ++light) {
    const auto s = lights_.sample_light(light, point, sampler.next_2d());
    if (!s) continue;
    const Rgb f = bsdf.evaluate_unsplit(wo, s->direction, roughness_limit);
    if (is_black(f)) continue;
    count(rays, RayPurpose::shadow, depth);
    const auto cosine = static_cast<float>(std::abs(dot(bsdf.shading_normal(), s->direction)));
    sum += f * cosine * s->weight() * shadow_.transmittance(s->shadow_ray);
  }
  return sum;
}

}  // namespace penumbra
