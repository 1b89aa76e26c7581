#include "penumbra/baking/sample_points.h"

#include <algorithm>
#include <array>

#include "penumbra/parallel/parallel_for.h"

namespace penumbra {
namespace {

/// Points of a texel, parts of its edge from its middle, nearest first.
std::array<Vec2d, 16> points_of_texel() {
  std::array<Vec2d, 16> points;
  for (std::size_t k = 0; k < 16; ++k) {
    points[k] = {(static_cast<double>(k % 4) - 1.5) / 4, (static_cast<double>(k / 4) - 1.5) / 4};
  }
  std::stable_sort(points.begin(), points.end(), [](const Vec2d& a, const Vec2d& b) { return dot(a, a) < dot(b, b); });
  return points;
}

/// Of a texel's edge: a wall this near to its point is in its way.
constexpr double in_the_way = 0.02;

}  // namespace

SamplePoints::SamplePoints(const TexelRays& rays, const AtlasSpace& space)
    : rays_(rays), texels_(rays.map().texels()), enclosed_(texels_.count(), 0) {
  constexpr std::size_t block = 256;
  std::vector<std::vector<Moved>> found((texels_.count() + block - 1) / block);
  parallel_for(texels_.count(), block, [&](std::size_t first, std::size_t last) {
    for (std::size_t t = first; t < last; ++t) {
      if (auto moved = examine(static_cast<std::uint32_t>(t), space)) found[first / block].push_back(*moved);
    }
  });
  for (const auto& some : found) {
    for (const Moved& m : some) {
      if (m.enclosed) {
        enclosed_[m.texel] = 1;
      } else {
        moved_.emplace(m.texel, m.place);
      }
    }
  }
}

Place SamplePoints::operator[](std::uint32_t texel) const {
  if (!moved_.empty()) {
    const auto at = moved_.find(texel);
    if (at != moved_.end()) return at->second;
  }
  return {texels_.positions[texel], texels_.normals[texel], texels_.shading_normals[texel]};
}

std::optional<SamplePoints::Moved> SamplePoints::examine(std::uint32_t texel, const AtlasSpace& space) const {
  const Place own{texels_.positions[texel], texels_.normals[texel], texels_.shading_normals[texel]};
  const bool enclosed = sees_only_backs(own);
  if (!enclosed && !stands_in_wall(texel)) return std::nullopt;
  if (const auto free = nearest_free(texel, space)) return Moved{texel, *free, false};
  if (enclosed) return Moved{texel, own, true};
  return std::nullopt;
}

bool SamplePoints::sees_only_backs(const Place& place) const {
  Outlook outlook(1);
  const Vec3d origin = rays_.lifted(place.position, place.normal);
  for (int lane = 0; lane < Outlook::lanes; ++lane) outlook.set(lane, origin, place.normal, place.normal, 1);
  RayPacket packet;
  HitPacket hits;
  outlook.rays(0, packet);
  rays_.tracer().nearest(packet, hits);
  for (int i = 0; i < RayPacket::size; ++i) {
    if (hits.object[i] == HitPacket::no_hit) return false;
    const float side = packet.direction_x[i] * hits.normal_x[i] + packet.direction_y[i] * hits.normal_y[i] +
                       packet.direction_z[i] * hits.normal_z[i];
    if (side < 0) return false;
  }
  return true;
}

bool SamplePoints::stands_in_wall(std::uint32_t texel) const {
  const TexelMap::Steps steps = rays_.map().steps(texels_.triangles[texel]);
  const Vec3d middle = rays_.lifted(texels_.positions[texel], texels_.normals[texel]);
  for (const Vec3d& step : {steps.right, steps.down}) {
    const double size = length(step);
    if (!(size > 0)) continue;
    const Ray ray{.origin = middle - in_the_way * step, .direction = step / size, .t_max = 2 * in_the_way * size};
    if (rays_.tracer().occluded(ray)) return true;
  }
  return false;
}

std::optional<Place> SamplePoints::nearest_free(std::uint32_t texel, const AtlasSpace& space) const {
  static const std::array<Vec2d, 16> points = points_of_texel();
  const std::uint32_t chart = rays_.map().chart(texel);
  for (const Vec2d& offset : points) {
    const auto p = space.at(space.middle(texel) + offset, chart);
    if (!p) continue;
    const Place place{p->position, p->geometric_normal, p->shading_normal};
    if (!sees_only_backs(place)) return place;
  }
  return std::nullopt;
}

}  // namespace penumbra
