#pragma once

#include <cstdint>
#include <optional>
#include <unordered_map>
#include <vector>

#include "penumbra/baking/atlas_space.h"
#include "penumbra/baking/outlook.h"
#include "penumbra/parallel/progress.h"
#include "penumbra/tracing/ray_tracer.h"

namespace penumbra {

/// A place on a surface where light is asked for.
struct Place {
  Vec3d position{0};
  Vec3d normal{0, 0, 1};   ///< unit, geometric, of the side that is asked about
  Vec3d shading{0, 0, 1};  ///< unit, on the same side

  /// The other side of the surface.
  [[nodiscard]] Place reversed() const { return {position, -normal, -shading}; }
};

/// Where the light of each texel is looked up: at its own point unless that lies inside solid matter, or in a wall;
/// then at the nearest free point of the texel.
class SamplePoints {
 public:
  /// All must outlive this. Stopped early, the rest keep their own points.
  SamplePoints(const RayTracer& tracer, const TexelMap& map, const AtlasSpace& space, const Progress& progress = {});

  /// Of the front.
  [[nodiscard]] Place operator[](std::uint32_t texel) const;
  /// Whether all that sixteen rays from the texel, and from every other point of it, met at first were backs: inside
  /// solid matter, if no light comes there.
  [[nodiscard]] bool is_enclosed(std::uint32_t texel) const { return (flags_[texel] & enclosed) != 0; }
  /// Whether something stands on the texel, so that parts of it lie on another side than its sample point.
  [[nodiscard]] bool is_cut(std::uint32_t texel) const { return (flags_[texel] & cut) != 0; }
  /// For a point of a cut texel: that texel, or one beside it, whose sample point is on the point's side of whatever
  /// stands there.
  [[nodiscard]] std::uint32_t on_side_of(const Place& point, std::uint32_t texel) const;
  /// Whether nothing stands between two places on a surface near each other.
  [[nodiscard]] bool are_on_one_side(const Place& a, const Place& b) const;

  /// Pushed off the surface, so that a ray does not meet it again.
  [[nodiscard]] Vec3d lifted(const Place& place) const;
  [[nodiscard]] const TexelMap& map() const { return map_; }
  [[nodiscard]] const RayTracer& tracer() const { return tracer_; }

 private:
  struct Moved {
    std::uint32_t texel;
    Place place;
    bool enclosed;
  };
  static constexpr std::uint8_t enclosed = 1, cut = 2;
  [[nodiscard]] bool sees_only_backs(const Place& place) const;
  [[nodiscard]] Place own(std::uint32_t texel) const;
  /// What stands between two places near each other would cross this ray; none where they are one.
  [[nodiscard]] std::optional<Ray> sight_line(const Place& a, const Place& b) const;
  // Of up to sixteen texels from `first` on, one bit each.
  [[nodiscard]] std::uint32_t meet_backs(std::uint32_t first, int count) const;
  [[nodiscard]] std::uint32_t stand_in_walls(std::uint32_t first, int count) const;
  [[nodiscard]] std::uint32_t have_something_on_them(std::uint32_t first, int count) const;
  /// Where a texel is looked up when a first look says that it may lie inside solid matter, or in a wall.
  [[nodiscard]] std::optional<Moved> examine(std::uint32_t texel, bool in_wall, const AtlasSpace& space) const;
  [[nodiscard]] std::optional<Place> nearest_free(std::uint32_t texel, const AtlasSpace& space) const;

  const RayTracer& tracer_;
  const TexelMap& map_;
  const Texels& texels_;
  double rounding_ = 0;
  std::unordered_map<std::uint32_t, Place> moved_;
  std::vector<std::uint8_t> flags_;
};

}  // namespace penumbra
