#include "penumbra/baking/texel_direct.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "penumbra/parallel/parallel_for.h"

namespace penumbra {
namespace {

constexpr std::size_t texels_a_group = 16;
/// Light bends at a texel when it departs from its neighbours' mean by more than this share of the largest.
constexpr float bend = 0.004F;
/// The same at the edge of a chart, where only one neighbour can be compared.
constexpr float step = 0.05F;
/// Points across a texel where light bends, and where shadows are hard.
constexpr int points_across = 4, points_across_hard = 8;

float departure(const Rgb& v) { return std::max({std::abs(v.x), std::abs(v.y), std::abs(v.z)}); }

class DirectLight {
 public:
  DirectLight(const StraightLight& straight, const SamplePoints& points, const AtlasSpace& space, const TexelMap& map)
      : straight_(straight), points_(points), space_(space), map_(map), light_(3 * map.texels().count(), 0) {}

  void look_at_points(std::span<const std::uint32_t> texels) {
    std::array<Place, texels_a_group> places;
    std::array<Vec3d, texels_a_group> found;
    double reach = 0;
    for (std::size_t k = 0; k < texels.size(); ++k) {
      places[k] = points_[texels[k]];
      reach = std::max(reach, map_.texels().footprint(texels[k]));
    }
    straight_.at(std::span(places).first(texels.size()), reach, found);
    for (std::size_t k = 0; k < texels.size(); ++k) set(light_, texels[k], Rgb(found[k]));
  }

  /// Whether light varies over a texel in a way that its middle does not tell.
  [[nodiscard]] bool bends(std::uint32_t texel) const {
    const Rgb own = of(texel);
    for (const auto& [right, down] : {std::pair{1, 0}, {0, 1}}) {
      const std::uint32_t before = map_.beside(texel, -right, -down), after = map_.beside(texel, right, down);
      const bool has_before = before != TexelMap::none, has_after = after != TexelMap::none;
      const Rgb a = has_before ? of(before) : own, b = has_after ? of(after) : own;
      const float most = std::max({departure(own), departure(a), departure(b)});
      if (has_before && has_after && departure(0.5F * (a + b) - own) > bend * most) return true;
      if (has_before != has_after && departure(a + b - 2.0F * own) > step * most) return true;
    }
    return false;
  }

  /// The mean over the free part of a texel; its point's light where it has none.
  [[nodiscard]] Rgb mean_over(std::uint32_t texel) const {
    const int across = straight_.has_hard_shadows() ? points_across_hard : points_across;
    std::vector<Place> places;
    for (int k = 0; k < across * across; ++k) {
      const Vec2d offset((k % across + 0.5) / across - 0.5, (k / across + 0.5) / across - 0.5);
      const auto p = space_.at(space_.middle(texel) + offset, map_.chart(texel));
      if (!p) continue;
      const Place place{p->position, p->geometric_normal, p->shading_normal};
      if (points_.are_on_one_side(points_[texel], place)) places.push_back(place);
    }
    if (places.empty()) return of(texel);
    std::vector<Vec3d> found(places.size());
    straight_.at(places, map_.texels().footprint(texel), found);
    Vec3d sum(0);
    for (const Vec3d& light : found) sum += light;
    return Rgb(sum / static_cast<double>(places.size()));
  }

  [[nodiscard]] Rgb of(std::uint32_t texel) const {
    return {light_[std::size_t{3} * texel], light_[std::size_t{3} * texel + 1], light_[std::size_t{3} * texel + 2]};
  }
  static void set(std::vector<float>& light, std::uint32_t texel, const Rgb& value) {
    for (int b = 0; b < 3; ++b) light[std::size_t{3} * texel + static_cast<std::size_t>(b)] = value[b];
  }
  std::vector<float>& light() { return light_; }

 private:
  const StraightLight& straight_;
  const SamplePoints& points_;
  const AtlasSpace& space_;
  const TexelMap& map_;
  std::vector<float> light_;
};

}  // namespace

std::vector<float> direct_light_of_texels(const StraightLight& straight, const SamplePoints& points,
                                          const AtlasSpace& space, const TexelMap& map,
                                          std::span<const std::uint32_t> order, const Progress& progress) {
  DirectLight direct(straight, points, space, map);
  if (straight.is_dark()) return std::move(direct.light());
  // In rounds, so that the caller hears of it and can stop.
  const std::size_t groups = (order.size() + texels_a_group - 1) / texels_a_group;
  const std::size_t round = std::max<std::size_t>(256, groups / 32);
  for (std::size_t start = 0; start < groups && !progress.stop_requested(); start += round) {
    parallel_for(std::min(round, groups - start), 16, [&](std::size_t first, std::size_t last) {
      for (std::size_t g = start + first; g < start + last; ++g) {
        const std::size_t begin = g * texels_a_group;
        direct.look_at_points(order.subspan(begin, std::min(texels_a_group, order.size() - begin)));
      }
    });
    progress.tell("direct light",
                  0.5 * static_cast<double>(std::min(groups, start + round)) / static_cast<double>(groups));
  }
  std::vector<std::uint32_t> bent;
  for (std::uint32_t t = 0; t < order.size(); ++t) {
    if (direct.bends(t)) bent.push_back(t);
  }
  std::vector<Rgb> means(bent.size());
  for (std::size_t start = 0; start < bent.size() && !progress.stop_requested(); start += 16 * round) {
    const std::size_t some = std::min(16 * round, bent.size() - start);
    parallel_for(some, 32, [&](std::size_t first, std::size_t last) {
      for (std::size_t k = start + first; k < start + last; ++k) means[k] = direct.mean_over(bent[k]);
    });
    for (std::size_t k = start; k < start + some; ++k) DirectLight::set(direct.light(), bent[k], means[k]);
    progress.tell("direct light", 0.5 + 0.5 * static_cast<double>(start + some) / static_cast<double>(bent.size()));
  }
  return std::move(direct.light());
}

}  // namespace penumbra
