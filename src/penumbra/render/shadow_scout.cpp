#include "penumbra/render/shadow_scout.h"

#include <algorithm>
#include <vector>

#include "penumbra/parallel/parallel_for.h"
#include "penumbra/render/ray_tally.h"

namespace penumbra {
namespace {

constexpr int block_side = 4;                        // pixels whose lamp points are spread together
constexpr std::uint64_t own_numbers = 0x73636f7574;  // a key apart from the picture's
constexpr int usual_depth = 16;

/// Notes what the shadow rays of one pixel's tree find.
class Scout final : public SpecularTree::Visitor {
 public:
  Scout(const DirectLight& light, const RenderOptions& options, PixelSampler& sampler, RayCounts& rays)
      : light_(light), options_(options), sampler_(sampler), rays_(rays) {}

  Rgb surface(const SpecularTree::Node& node) override {
    const int depth = node.branch.depth;
    if (depth == 0) seen_.object = node.point.object;
    if (!node.bsdf.has_spread()) return Rgb(0);
    for (std::size_t lamp = 0; lamp < light_.lights().light_count(); ++lamp) {
      const auto met = light_.meet(node.point, node.bsdf, node.wo, followed_roughness, lamp, sampler_);
      if (!met) continue;
      penumbra::count(rays_, RayPurpose::shadow, depth);
      const std::uint64_t bit = ShadowBoundaries::bit(lamp, depth > 0);
      const Rgb& passed = met->passed;
      (is_black(passed) ? seen_.hidden : passed == Rgb(1) ? seen_.free : seen_.partly) |= bit;
    }
    return Rgb(0);
  }

  Rgb sky(const Ray&, const SpecularTree::Branch&) override { return Rgb(0); }

  float followed(const Rgb& weight, int depth) override {
    if (options_.integrator == IntegratorKind::appel) return 0;
    const int deepest = options_.max_depth > 0 ? options_.max_depth : usual_depth;
    return depth < deepest && max_component(weight) >= static_cast<float>(options_.min_throughput) ? 1 : 0;
  }

  void count(bool refracted, int depth) override {
    penumbra::count(rays_, refracted ? RayPurpose::refraction : RayPurpose::reflection, depth);
  }

  [[nodiscard]] const ShadowBoundaries::First& seen() const { return seen_; }

 private:
  const DirectLight& light_;
  const RenderOptions& options_;
  PixelSampler& sampler_;
  RayCounts& rays_;
  ShadowBoundaries::First seen_;
};

/// The place of a pixel in its block, such that any 4 in a row of this order lie in a quarter of the block.
int place_in_block(int x, int y) {
  const int u = x % block_side, v = y % block_side;
  return (u & 1) | (v & 1) << 1 | (u & 2) << 1 | (v & 2) << 2;
}

}  // namespace

ShadowBoundaries scout_shadows(const DirectLight& light, const SpecularTree& tree, const CameraRays& camera,
                               const RenderOptions& options, RayCounts& rays) {
  constexpr int margin = ShadowBoundaries::margin;
  const Region region = options.region.value_or(Region{0, 0, options.width, options.height});
  const Region first{std::max(0, region.x0 - margin), std::max(0, region.y0 - margin),
                     std::min(options.width, region.x1 + margin), std::min(options.height, region.y1 + margin)};
  const auto width = static_cast<std::size_t>(first.x1 - first.x0);
  const auto height = static_cast<std::size_t>(first.y1 - first.y0);
  std::vector<ShadowBoundaries::First> seen(width * height);
  std::vector<RayCounts> counts(height);
  parallel_for(height, 1, [&](std::size_t row, std::size_t) {
    const int y = first.y0 + static_cast<int>(row);
    for (int x = first.x0; x < first.x1; ++x) {
      PixelSampler sampler(hash_key(options.seed, own_numbers), x / block_side, y / block_side, place_in_block(x, y));
      const auto [ray, weight] = camera.ray(x, y, sampler);
      if (weight == 0) continue;
      count(counts[row], RayPurpose::primary, 0);
      Scout scout(light, options, sampler, counts[row]);
      tree.trace(ray, {.start = ray.origin}, scout);
      seen[row * width + static_cast<std::size_t>(x - first.x0)] = scout.seen();
    }
  });
  for (const RayCounts& c : counts) rays += c;
  return {region, first, seen};
}

}  // namespace penumbra
