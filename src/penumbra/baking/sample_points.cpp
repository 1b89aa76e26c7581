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

constexpr int lanes = RayPacket::size;
constexpr std::size_t packets_a_block = 16;

/// Sixteen directions spread over the hemisphere.
const std::array<Vec3d, lanes>& directions_of_look() {
  static const auto directions = [] {
    std::array<Vec3d, lanes> all;
    for (std::uint32_t k = 0; k < all.size(); ++k) all[k] = sample_cosine_hemisphere(owen_sobol_2d(k, 1));
    return all;
  }();
  return directions;
}

void set_lane(RayPacket& packet, int lane, const Ray& ray) {
  const Vec3f o(ray.origin), d(ray.direction);
  packet.origin_x[lane] = o.x, packet.origin_y[lane] = o.y, packet.origin_z[lane] = o.z;
  packet.direction_x[lane] = d.x, packet.direction_y[lane] = d.y, packet.direction_z[lane] = d.z;
  packet.t_min[lane] = 0;
  packet.t_max[lane] = static_cast<float>(ray.t_max);
  packet.active[lane] = -1;
}

bool is_back(const RayPacket& packet, const HitPacket& hits, int lane) {
  return packet.direction_x[lane] * hits.normal_x[lane] + packet.direction_y[lane] * hits.normal_y[lane] +
             packet.direction_z[lane] * hits.normal_z[lane] >=
         0;
}

/// One bit for each lane whose ray meets something. @param ray_of the ray of a lane; none: it meets nothing.
template <class RayOf>
std::uint32_t hidden_lanes(const RayTracer& tracer, int count, const RayOf& ray_of) {
  RayPacket packet{};
  std::uint32_t sent = 0;
  for (int i = 0; i < count; ++i) {
    const std::optional<Ray> ray = ray_of(i);
    if (!ray) continue;
    set_lane(packet, i, *ray);
    sent |= 1U << i;
  }
  if (sent == 0) return 0;
  tracer.occluded(packet, false);
  std::uint32_t free = 0;
  for (int i = 0; i < count; ++i) free |= packet.active[i] != 0 ? 1U << i : 0U;
  return sent & ~free;
}

/// Of a texel's edge: a wall this near to its point is in its way.
constexpr double in_the_way = 0.02;
/// Height of a line of sight between neighbouring places, parts of its length.
constexpr double clearance = 0.02;

}  // namespace

SamplePoints::SamplePoints(const RayTracer& tracer, const TexelMap& map, const AtlasSpace& space,
                           const Progress& progress)
    : tracer_(tracer), map_(map), texels_(map.texels()), flags_(map.texels().count(), 0) {
  const Bounds all = tracer.bounds();
  if (!all.empty()) rounding_ = float_error * std::max(largest_component(all.lower), largest_component(all.upper));
  const std::size_t packets = (texels_.count() + lanes - 1) / lanes;
  // In rounds, so that the caller hears of it and can stop.
  const std::size_t round = std::max(packets_a_block, packets / 32 / packets_a_block * packets_a_block);
  const auto in_rounds = [&](double begin, const auto& look) {
    for (std::size_t start = 0; start < packets && !progress.stop_requested(); start += round) {
      const std::size_t some = std::min(round, packets - start);
      parallel_for(some, packets_a_block, [&](std::size_t first, std::size_t last) {
        for (std::size_t p = start + first; p < start + last; ++p) {
          look(p, static_cast<std::uint32_t>(p * lanes),
               static_cast<int>(std::min<std::size_t>(lanes, texels_.count() - p * lanes)));
        }
      });
      progress.tell("texels", begin + 0.5 * static_cast<double>(start + some) / static_cast<double>(packets));
    }
  };
  std::vector<std::vector<Moved>> found((packets + packets_a_block - 1) / packets_a_block);
  in_rounds(0, [&](std::size_t packet, std::uint32_t first, int count) {
    const std::uint32_t backs = meet_backs(first, count), walls = stand_in_walls(first, count);
    for (int i = 0; i < count && (backs | walls) >> i != 0; ++i) {
      if ((((backs | walls) >> i) & 1U) == 0) continue;
      const auto moved = examine(first + static_cast<std::uint32_t>(i), ((walls >> i) & 1U) != 0, space);
      if (moved) found[packet / packets_a_block].push_back(*moved);
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
  in_rounds(0.5, [&](std::size_t, std::uint32_t first, int count) {
    const std::uint32_t covered = have_something_on_them(first, count);
    for (int i = 0; i < count; ++i) {
      if (((covered >> i) & 1U) != 0) flags_[first + static_cast<std::uint32_t>(i)] |= cut;
    }
  });
}

Place SamplePoints::own(std::uint32_t texel) const {
  return {texels_.positions[texel], texels_.normal(texel), texels_.shading_normal(texel)};
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

std::optional<Ray> SamplePoints::sight_line(const Place& a, const Place& b) const {
  // High enough to clear the surface's own curvature.
  const Vec3d way = b.position - a.position;
  const double distance = length(way);
  if (!(distance > 0)) return std::nullopt;
  const Vec3d from = lifted(a) + clearance * distance * a.normal, to = lifted(b) + clearance * distance * b.normal;
  const double between = length(to - from);
  return Ray{.origin = from, .direction = (to - from) / between, .t_max = between};
}

bool SamplePoints::are_on_one_side(const Place& a, const Place& b) const {
  const auto line = sight_line(a, b);
  return !line || !tracer_.occluded(*line);
}

std::uint32_t SamplePoints::on_side_of(const Place& point, std::uint32_t texel) const {
  constexpr std::array<std::array<int, 2>, 9> beside{
      {{0, 0}, {1, 0}, {-1, 0}, {0, 1}, {0, -1}, {1, 1}, {-1, 1}, {1, -1}, {-1, -1}}};
  const bool back = dot(point.normal, texels_.normal(texel)) < 0;
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

std::uint32_t SamplePoints::have_something_on_them(std::uint32_t first, int count) const {
  std::uint32_t covered = 0;
  // To the corners of each texel, which may lie beyond its face: only what stands in between counts.
  for (const Vec2d& corner_step : {Vec2d(-0.5, -0.5), Vec2d(0.5, -0.5), Vec2d(-0.5, 0.5), Vec2d(0.5, 0.5)}) {
    covered |= hidden_lanes(tracer_, count, [&](int i) -> std::optional<Ray> {
      if (((covered >> i) & 1U) != 0) return std::nullopt;
      const std::uint32_t texel = first + static_cast<std::uint32_t>(i);
      const TexelMap::Steps steps = map_.steps(texels_.triangles[texel]);
      const Place middle = (*this)[texel];
      Place corner = middle;
      corner.position = texels_.positions[texel] + corner_step.x * steps.right + corner_step.y * steps.down;
      return sight_line(middle, corner);
    });
  }
  return covered;
}

std::uint32_t SamplePoints::stand_in_walls(std::uint32_t first, int count) const {
  std::uint32_t in_wall = 0;
  for (const auto step : {&TexelMap::Steps::right, &TexelMap::Steps::down}) {
    in_wall |= hidden_lanes(tracer_, count, [&](int i) -> std::optional<Ray> {
      const std::uint32_t texel = first + static_cast<std::uint32_t>(i);
      const Vec3d way = map_.steps(texels_.triangles[texel]).*step;
      const double size = length(way);
      if (!(size > 0)) return std::nullopt;
      return Ray{
          .origin = lifted(own(texel)) - in_the_way * way, .direction = way / size, .t_max = 2 * in_the_way * size};
    });
  }
  return in_wall;
}

std::uint32_t SamplePoints::meet_backs(std::uint32_t first, int count) const {
  const Vec3d& direction = directions_of_look()[0];
  RayPacket packet{};
  for (int i = 0; i < count; ++i) {
    const Place place = own(first + static_cast<std::uint32_t>(i));
    set_lane(packet, i, {.origin = lifted(place), .direction = Frame(place.normal).to_world(direction)});
  }
  HitPacket hits;
  tracer_.nearest(packet, hits);
  std::uint32_t backs = 0;
  for (int i = 0; i < count; ++i) {
    if (hits.object[i] != HitPacket::no_hit && is_back(packet, hits, i)) backs |= 1U << i;
  }
  return backs;
}

std::optional<SamplePoints::Moved> SamplePoints::examine(std::uint32_t texel, bool in_wall,
                                                         const AtlasSpace& space) const {
  const bool is_inside = sees_only_backs(own(texel));
  if (!is_inside && !in_wall) return std::nullopt;
  if (const auto free = nearest_free(texel, space)) return Moved{texel, *free, false};
  if (is_inside) return Moved{texel, own(texel), true};
  return std::nullopt;
}

bool SamplePoints::sees_only_backs(const Place& place) const {
  const auto& directions = directions_of_look();
  const Frame frame(place.normal);
  const Vec3d origin = lifted(place);
  RayPacket packet{};
  HitPacket hits;
  for (int i = 0; i < lanes; ++i) {
    set_lane(packet, i, {.origin = origin, .direction = frame.to_world(directions[static_cast<std::size_t>(i)])});
  }
  tracer_.nearest(packet, hits);
  for (int i = 0; i < lanes; ++i) {
    if (hits.object[i] == HitPacket::no_hit || !is_back(packet, hits, i)) return false;
  }
  return true;
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
