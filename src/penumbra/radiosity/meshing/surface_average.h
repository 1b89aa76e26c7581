#pragma once

#include <cstdint>
#include <span>

#include "penumbra/math/vec.h"
#include "penumbra/radiosity/meshing/face_table.h"

namespace penumbra {

/// What a piece of surface reflects and emits on average, red, green and blue.
struct SurfacePaint {
  Vec3d reflectance{0};    ///< diffuse, 0..1: base colour (1 - metallic) (1 - transmission)
  Vec3d emission{0};       ///< pi times the radiance that the front emits, W/m^2
  Vec3d back_emission{0};  ///< the same for the back: 0 unless the material is double-sided
};

/// Averages of materials, their textures and vertex colours over pieces of a scene's faces. An unlit material is a
/// picture of light: it neither reflects nor emits. Member functions are thread-safe.
class SurfaceAverage {
 public:
  /// The scene and the table must outlive this.
  SurfaceAverage(const Scene& scene, const FaceTable& faces);

  /// The mean over a convex polygon that lies on a face, world space. About one sample a texel, at most 576 for each
  /// triangle of the polygon, on a regular grid, so that what varies linearly is averaged exactly. A face has the
  /// material of its first triangle.
  [[nodiscard]] SurfacePaint over(std::uint32_t face, std::span<const Vec3d> polygon) const;

 private:
  struct FaceSurface;

  [[nodiscard]] bool is_even(const Material& material, std::size_t object) const;
  [[nodiscard]] double detail(std::uint32_t face, std::size_t object, const Material& material) const;
  [[nodiscard]] FaceSurface surface_of(std::uint32_t face, std::size_t object) const;
  [[nodiscard]] SurfacePaint sampled(const FaceSurface& surface, const Material& material, double samples_per_area,
                                     std::span<const Vec3d> polygon) const;

  const Scene* scene_;
  const FaceTable* faces_;
};

}  // namespace penumbra
