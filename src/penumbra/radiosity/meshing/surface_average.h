#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "penumbra/math/vec.h"
#include "penumbra/radiosity/meshing/face_table.h"
#include "penumbra/tracing/placed_mesh.h"

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

  /// The mean over a convex polygon that lies on a face, world space. About one sample a texel, on a regular grid, so
  /// that what varies linearly is averaged exactly.
  [[nodiscard]] SurfacePaint over(std::uint32_t face, std::span<const Vec3d> polygon) const;

 private:
  struct FaceSurface;

  [[nodiscard]] bool is_even(const Material& material, std::size_t object) const;
  [[nodiscard]] double detail(std::uint32_t face, const Material& material, const PlacedMesh& mesh) const;

  const Scene* scene_;
  const FaceTable* faces_;
  std::vector<PlacedMesh> placed_;  // by instance
};

}  // namespace penumbra
