#pragma once

#include <cstdint>
#include <memory>
#include <optional>

#include "penumbra/baking/texel_map.h"
#include "penumbra/tracing/ray_tracer.h"

namespace penumbra {

/// The unfolded scene as a plane of triangles: which point of the surface lies at a point of the atlas.
class AtlasSpace {
 public:
  /// @param tracer of the atlas's scene. Both must outlive this.
  AtlasSpace(const TexelMap& map, const RayTracer& tracer);

  /// The surface at atlas coordinates in texels, if it is of this chart; `object` and `primitive` are the scene's.
  [[nodiscard]] std::optional<SurfacePoint> at(const Vec2d& place, std::uint32_t chart) const;
  /// The surface at a texel's own point.
  [[nodiscard]] SurfacePoint at(std::uint32_t texel) const;
  /// The middle of a texel in the atlas.
  [[nodiscard]] Vec2d middle(std::uint32_t texel) const;

 private:
  const TexelMap& map_;
  const RayTracer& tracer_;
  std::unique_ptr<Scene> plane_;
  std::unique_ptr<RayTracer> plane_tracer_;
};

}  // namespace penumbra
