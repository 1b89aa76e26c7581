#include "penumbra/render/wave_integrator.h"

#include "penumbra/render/shadow_scout.h"

namespace penumbra {

void WaveIntegrator::prepare(const SpecularTree& tree, const RenderOptions& options, const Reach& reach) {
  if (direct_.is_selective()) direct_.send_more_at(scout_shadows(direct_, tree, camera(), options, first_pass_));
  if (options.spectral || options.front_sides_only || !direct_.sends_one_ray_each()) return;
  waves_ = RayWaves::make(tree.tracer(), camera(), direct_.lights(),
                          {.max_depth = reach.max_depth,
                           .min_throughput = reach.min_throughput,
                           .at_middles = options.samples_per_pixel == 1,
                           .through_glass = !options.opaque_shadows,
                           .textures = &textures_,
                           .seed = options.seed});
}

}  // namespace penumbra
