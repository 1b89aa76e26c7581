#pragma once

namespace penumbra {

/// Share of light that a rough GGX surface with a Schlick Fresnel term reflects in a single bounce off its microfacets:
/// f0 * base + f90 * edge, 0..1.
struct SpecularAlbedo {
  double base = 0;
  double edge = 0;

  [[nodiscard]] double of(double f0, double f90) const { return f0 * base + f90 * edge; }
};

/// Directional albedo for light that leaves (or arrives) at `cos_theta`, 0..1. @param roughness glTF's, 0..1; 0 is
/// smooth. Interpolated in a table of 32 x 32 (roughness, sqrt(cos_theta)); absolute error below 2e-3 for cos_theta >=
/// 0.02.
[[nodiscard]] SpecularAlbedo specular_albedo(double roughness, double cos_theta);

/// Mean of `specular_albedo` over the hemisphere by projected solid angle, the exact integral of the interpolated
/// table.
[[nodiscard]] SpecularAlbedo specular_albedo_mean(double roughness);

}  // namespace penumbra
