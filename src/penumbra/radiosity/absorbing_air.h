#pragma once

#include <span>

#include "penumbra/scene/scene.h"
#include "penumbra/tracing/shading/media.h"

namespace penumbra {

/// Cold air that absorbs between surfaces, for radiosity (Hottel & Sarofim, "Radiative Transfer", 1967): each form
/// factor is weighted by the mean transmittance of the rays that it stands for,
///
///     T_ij = int int cos cos' / (pi r^2) exp(-tau) dA dA' / int int cos cos' / (pi r^2) dA dA'.
///
/// A factor holds for all bands, so the air must be grey. What scatters is no matter of surfaces and refused.
class AbsorbingAir {
 public:
  /// The scene must outlive it. Throws std::invalid_argument when a medium of the scene scatters, is coloured, or fills
  /// a closed mesh.
  explicit AbsorbingAir(const Scene& scene);

  /// Nothing absorbs.
  [[nodiscard]] bool is_clear() const { return media_.none(); }
  /// The share of light left between two points, 0..1.
  [[nodiscard]] double transmittance(const Vec3d& from, const Vec3d& to) const;
  /// T_ij of two polygons in full view of each other, by Gauss points on both; exact to the square of their size over
  /// the optical length. @pre both are planar and convex with three corners or more.
  [[nodiscard]] double between(std::span<const Vec3d> a, std::span<const Vec3d> b) const;

 private:
  Media media_;
};

}  // namespace penumbra
