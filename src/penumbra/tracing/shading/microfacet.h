#pragma once

#include "penumbra/math/vec.h"

namespace penumbra {

/// Isotropic GGX (Trowbridge-Reitz) microfacets with Smith's shadowing. Directions are unit, local to a frame whose z
/// is the surface normal, and point away from the surface.
///
/// Sources: Walter, Marschner, Li & Torrance, "Microfacet Models for Refraction through Rough Surfaces", EGSR 2007;
/// Heitz, "Understanding the Masking-Shadowing Function in Microfacet-Based BRDFs", JCGT 3(2), 2014.
class Ggx {
 public:
  /// @param alpha width of the distribution, > 0: the square of glTF's roughness.
  explicit Ggx(double alpha) : alpha_(alpha) {}

  /// Microfacet area per solid angle and surface area, D(h), 1/sr; 0 below the surface. Its integral with cos is 1.
  [[nodiscard]] double distribution(const Vec3d& h) const;
  /// Smith's Lambda of a direction on either side: hidden over visible microfacet area (Heitz 2014, eq. 72).
  [[nodiscard]] double lambda(const Vec3d& w) const;
  /// Share of microfacets visible from `w`, G1 = 1/(1 + Lambda), 0..1.
  [[nodiscard]] double masking(const Vec3d& w) const { return 1 / (1 + lambda(w)); }
  /// Share visible from both, height-correlated, 0..1 (Heitz 2014, eq. 99); both on the same side of the surface.
  [[nodiscard]] double masking_shadowing(const Vec3d& wo, const Vec3d& wi) const {
    return 1 / (1 + (lambda(wo) + lambda(wi)));
  }

  /// A microfacet normal among those that `wo` sees (Dupuy & Benyoub, "Sampling Visible GGX Normals with Spherical
  /// Caps", HPG 2023). @param wo above the surface. @param u uniform in [0, 1)^2.
  [[nodiscard]] Vec3d sample_visible_normal(const Vec3d& wo, const Vec2d& u) const;
  /// Density of `sample_visible_normal` over solid angle of h, 1/sr: G1(wo) D(h) |wo.h| / |cos wo|.
  [[nodiscard]] double visible_normal_pdf(const Vec3d& wo, const Vec3d& h) const;

 private:
  double alpha_;
};

}  // namespace penumbra
