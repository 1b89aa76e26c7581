#include "penumbra/baking/sample_points.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <utility>

#include "penumbra/math/frame.h"
#include "penumbra/math/sampling.h"
#include "penumbra/math/sobol.h"
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

/// Sixteen directions spread over the hemisphere.
std::array<Vec3d, RayPacket::size> directions_of_look() {
  std::array<Vec3d, RayPacket::size> all;
  for (std::uint32_t k = 0; k < all.size(); ++k) all[k] = sample_cosine_hemisphere(owen_sobol_2d(k, 1));
  return all;
}

/// Of a texel's edge: a wall this near to its point is in its way.
constexpr double in_the_way = 0.02;
/// Height of a line of sight between neighbouring places, parts of its length.
constexpr double clearance = 0.02;

}  // namespace

SamplePoints::SamplePoints(const RayTracer& tracer, const TexelMap& map, const AtlasSpace& space)
    : tracer_(tracer), map_(map), texels_(map.texels()), flags_(map.texels().count(), 0) {
  const Bounds all = tracer.bounds();
  if (!all.empty()) rounding_ = float_error * std::max(largest_component(all.lower), largest_component(all.upper));
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
        flags_[m.texel] = enclosed;
      } else {
        moved_.emplace(m.texel, m.place);
      }
    }
  }
  parallel_for(texels_.count(), block, [&](std::size_t first, std::size_t last) {
    for (std::size_t t = first; t < last; ++t) {
      if (has_something_on_it(static_cast<std::uint32_t>(t))) flags_[t] |= cut;
    }
  });
}

Place SamplePoints::own(std::uint32_t texel) const {
  return {texels_.positions[texel], texels_.normals[texel], texels_.shading_normals[texel]};
}

Place SamplePoints::operator[](std::uint32_t texel) const {
  if (!moved_.empty()) {
    const auto at = moved_.find(texel);
    if (at != moved_.end()) return at->second;
  }
  return own(texel);
}

Vec3d SamplePoints::lifted(const Place& place) const {
  const Vec3d& n = place.normal;
  return place.position + rounding_ * (std::abs(n.x) + std::abs(n.y) + std::abs(n.z)) * n;
}

bool SamplePoints::are_on_one_side(const Place& a, const Place& b) const {
  // High enough to clear the surface's own curvature.
  const Vec3d way = b.position - a.position;
  const double distance = length(way);
  if (!(distance > 0)) return true;
  const Vec3d from = lifted(a) + clearance * distance * a.normal, to = lifted(b) + clearance * distance * b.normal;
  const double between = length(to - from);
  return !tracer_.occluded({.origin = from, .direction = (to - from) / between, .t_max = between});
}

std::uint32_t SamplePoints::on_side_of(const Place& point, std::uint32_t texel) const {
  constexpr std::array<std::array<int, 2>, 9> beside{
      {{0, 0}, {1, 0}, {-1, 0}, {0, 1}, {0, -1}, {1, 1}, {-1, 1}, {1, -1}, {-1, -1}}};
  const bool back = dot(point.normal, texels_.normals[texel]) < 0;
  std::uint32_t best = TexelMap::none;
  double nearest = std::numeric_limits<double>::infinity();
  for (const auto& [right, down] : beside) {
    const std::uint32_t other = map_.beside(texel, right, down);
    if (other == TexelMap::none || is_enclosed(other)) continue;
    const Place place = back ? (*this)[other].reversed() : (*this)[other];
    const double distance = length_squared(place.position - point.position);
    if (distance < nearest && are_on_one_side(point, place)) best = other, nearest = distance;
  }
  return best == TexelMap::none ? texel : best;
}

bool SamplePoints::has_something_on_it(std::uint32_t texel) const {
  const TexelMap::Steps steps = map_.steps(texels_.triangles[texel]);
  const Place middle = (*this)[texel];
  // Corners of the texel, which may lie beyond its face: only what stands in between counts.
  const Vec3d centre = texels_.positions[texel];
  for (const auto& [right, down] : {std::pair{-0.5, -0.5}, {0.5, -0.5}, {-0.5, 0.5}, {0.5, 0.5}}) {
    Place corner = middle;
    corner.position = centre + right * steps.right + down * steps.down;
    if (!are_on_one_side(middle, corner)) return true;
  }
  return false;
}

std::optional<SamplePoints::Moved> SamplePoints::examine(std::uint32_t texel, const AtlasSpace& space) const {
  const bool is_inside = sees_only_backs(own(texel));
  if (!is_inside && !stands_in_wall(texel)) return std::nullopt;
  if (const auto free = nearest_free(texel, space)) return Moved{texel, *free, false};
  if (is_inside) return Moved{texel, own(texel), true};
  return std::nullopt;
}

bool SamplePoints::sees_only_backs(const Place& place) const {
  static const std::array<Vec3d, RayPacket::size> directions = directions_of_look();
  const Frame frame(place.normal);
  const Vec3f origin(lifted(place));
  RayPacket packet;
  HitPacket hits;
  for (int i = 0; i < RayPacket::size; ++i) {
    const Vec3f d(frame.to_world(directions[static_cast<std::size_t>(i)]));
    packet.origin_x[i] = origin.x, packet.origin_y[i] = origin.y, packet.origin_z[i] = origin.z;
    packet.direction_x[i] = d.x, packet.direction_y[i] = d.y, packet.direction_z[i] = d.z;
    packet.t_min[i] = 0, packet.t_max[i] = HUGE_VALF;
    packet.active[i] = -1;
  }
  tracer_.nearest(packet, hits);
  for (int i = 0; i < RayPacket::size; ++i) {
    if (hits.object[i] == HitPacket::no_hit) return false;
    const float side = packet.direction_x[i] * hits.normal_x[i] + packet.direction_y[i] * hits.normal_y[i] +
                       packet.direction_z[i] * hits.normal_z[i];
    if (side < 0) return false;
  }
  return true;
}

bool SamplePoints::stands_in_wall(std::uint32_t texel) const {
  const TexelMap::Steps steps = map_.steps(texels_.triangles[texel]);
  const Vec3d middle = lifted(own(texel));
  for (const Vec3d& step : {steps.right, steps.down}) {
    const double size = length(step);
    if (!(size > 0)) continue;
    const Ray ray{.origin = middle - in_the_way * step, .direction = step / size, .t_max = 2 * in_the_way * size};
    if (tracer_.occluded(ray)) return true;
  }
  return false;
}

std::optional<Place> SamplePoints::nearest_free(std::uint32_t texel, const AtlasSpace& space) const {
  static const std::array<Vec2d, 16> points = points_of_texel();
  const std::uint32_t chart = map_.chart(texel);
  for (const Vec2d& offset : points) {
    const auto p = space.at(space.middle(texel) + offset, chart);
    if (!p) continue;
    const Place place{p->position, p->geometric_normal, p->shading_normal};
    if (!sees_only_backs(place)) return place;
  }
  return std::nullopt;
}

}  // namespace penumbra
