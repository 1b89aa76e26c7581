#pragma once

#include <cstdint>
#include <optional>
#include <unordered_map>
#include <vector>

#include "penumbra/baking/atlas_space.h"
#include "penumbra/baking/texel_rays.h"

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
  /// @param order of the texels, for speed. All must outlive this.
  SamplePoints(const TexelRays& rays, const AtlasSpace& space);

  /// Of the front.
  [[nodiscard]] Place operator[](std::uint32_t texel) const;
  /// Whether all that sixteen rays from the texel, and from every other point of it, met at first were backs: inside
  /// solid matter, if no light comes there.
  [[nodiscard]] bool is_enclosed(std::uint32_t texel) const { return enclosed_[texel] != 0; }
  /// The same for any place.
  [[nodiscard]] bool sees_only_backs(const Place& place) const;

 private:
  struct Moved {
    std::uint32_t texel;
    Place place;
    bool enclosed;
  };
  [[nodiscard]] std::optional<Moved> examine(std::uint32_t texel, const AtlasSpace& space) const;
  [[nodiscard]] bool stands_in_wall(std::uint32_t texel) const;
  [[nodiscard]] std::optional<Place> nearest_free(std::uint32_t texel, const AtlasSpace& space) const;

  const TexelRays& rays_;
  const Texels& texels_;
  std::unordered_map<std::uint32_t, Place> moved_;
  std::vector<std::uint8_t> enclosed_;
};

}  // namespace penumbra
