#pragma once

#include <optional>

#include "penumbra/math/frame.h"
#include "penumbra/math/spectrum.h"
#include "penumbra/tracing/shading/surface_material.h"

namespace penumbra {

/// A direction chosen by a BSDF.
struct BsdfSample {
  Vec3d direction{0};  ///< unit, world, away from the surface
  Rgb weight{0};       ///< f |cos| / pdf: what the throughput is multiplied by
  double pdf = 0;      ///< 1/sr of solid angle; 0 for an ideal (delta) lobe
  bool ideal = false;  ///< mirror or refraction without spread: light sampling cannot find it
  bool transmitted = false;
};

/// The rays that Whitted's recursion follows from a hit, and their weights.
struct SpecularSplit {
  Rgb reflected{0};               ///< weight of the mirror ray, 0 when there is none
  Vec3d reflection_direction{0};  ///< unit
  Rgb refracted{0};               ///< weight of the refraction ray, 0 when there is none (or total reflection)
  Vec3d refraction_direction{0};  ///< unit
};

/// How light scatters at one point: built from a material evaluated there. Directions are unit, world space and point
/// away from the surface: `wo` to where light goes (the eye), `wi` to where it comes from.
/// Reciprocal (up to the eta^2 of refraction, which is left out: radiance is stored divided by eta^2) and never
/// reflects more than arrives.
class Bsdf {
 public:
  /// @param shading its normal is the shading normal; may lie on either side.
  /// @param geometric_normal unit, towards the front; tells front from back and inside from outside.
  Bsdf(const SurfaceMaterial& material, const Frame& shading, const Vec3d& geometric_normal);

  /// f(wo, wi), 1/sr, of all lobes with spread; 0 when no light can go that way.
  [[nodiscard]] Rgb evaluate(const Vec3d& wo, const Vec3d& wi) const;
  /// Density of `sample` over solid angle, 1/sr, of the lobes with spread.
  [[nodiscard]] double pdf(const Vec3d& wo, const Vec3d& wi) const;
  /// Chooses a lobe by `u_lobe` and a direction by `u`. None when the light is absorbed.
  [[nodiscard]] std::optional<BsdfSample> sample(const Vec3d& wo, double u_lobe, const Vec2d& u) const;

  /// The mirror and refraction rays of lobes whose roughness is at most `roughness_limit`, taken as ideal.
  [[nodiscard]] SpecularSplit specular_split(const Vec3d& wo, double roughness_limit) const;
  /// f(wo, wi) of the lobes that `specular_split` leaves out.
  [[nodiscard]] Rgb evaluate_unsplit(const Vec3d& wo, const Vec3d& wi, double roughness_limit) const;

  /// Diffuse reflectance under normal incidence, 0..1: what ambient light is multiplied by, and the albedo layer.
  [[nodiscard]] Rgb diffuse_reflectance() const;
  /// Whether any lobe has spread, so that shadow rays can bring light.
  [[nodiscard]] bool has_spread() const;

 private:
  SurfaceMaterial material_;
  Frame frame_;
  Vec3d geometric_normal_;
};

}  // namespace penumbra
