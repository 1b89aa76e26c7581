#pragma once

#include <optional>

#include "penumbra/math/spectrum.h"
#include "penumbra/math/vec.h"

namespace penumbra {

/// A share of power, 0..1, for the two linear polarisations: electric field perpendicular (s) and parallel (p) to the
/// plane of incidence.
struct Polarised {
  double s = 0;
  double p = 0;

  /// For unpolarised light.
  [[nodiscard]] double mean() const { return 0.5 * (s + p); }
};

/// Where light goes at a plane-parallel plate; the rest, 1 - reflectance - transmittance, is absorbed within.
struct PlateShares {
  double reflectance = 0;
  double transmittance = 0;
};

/// Reflectance of a smooth interface between two dielectrics (Fresnel 1823; Born & Wolf, "Principles of
/// Optics", 1.5.2).
/// @param cos_theta of incidence, 0..1, in the medium of index `n_from`. @param n_from,n_to refractive indices, > 0.
/// Exactly 1 under total internal reflection. The interface transmits 1 minus this.
[[nodiscard]] Polarised fresnel_dielectric(double cos_theta, double n_from, double n_to);

/// Reflectance of a smooth metal of complex index eta + i k, relative to the medium of incidence
/// (Born & Wolf 14.2, in the real-valued form of Lagarde, "Memo on Fresnel equations", 2013).
/// @param cos_theta of incidence, 0..1. @param eta > 0. @param k >= 0.
[[nodiscard]] Polarised fresnel_conductor(double cos_theta, double eta, double k);

/// Schlick's approximation f0 + (f90 - f0)(1 - cos_theta)^5 (Schlick 1994, eq. 15; f90 as in glTF's
/// KHR_materials_specular).
[[nodiscard]] double fresnel_schlick(double cos_theta, double f0, double f90 = 1);

/// Reflectance of a dielectric at normal incidence, ((n_to - n_from)/(n_to + n_from))^2.
[[nodiscard]] double normal_reflectance(double n_from, double n_to);

/// Reflectance of a smooth dielectric under diffuse (Lambertian) unpolarised light that comes from the thin side: the
/// mean over the projected solid angle (Walsh 1926; closed form in Duntley 1942).
/// @param n index of the dense medium relative to the thin one, >= 1.
[[nodiscard]] double fresnel_diffuse_external(double n);
/// The same from within the dense medium: 1 - (1 - external)/n^2.
[[nodiscard]] double fresnel_diffuse_internal(double n);

/// Snell's law: the direction that continues `w` beyond an interface, unit; nothing under total internal reflection.
/// @param w unit, away from the interface, in the medium of index `n_from`. @param normal unit, on the side of `w`.
/// The result points away from the interface too, into the medium of index `n_to`.
[[nodiscard]] std::optional<Vec3d> refract(const Vec3d& w, const Vec3d& normal, double n_from, double n_to);

/// The mirror image of `w` about `normal`, both pointing away from the surface; unit when they are.
[[nodiscard]] inline Vec3d reflect(const Vec3d& w, const Vec3d& normal) { return 2 * glm::dot(w, normal) * normal - w; }

/// A plane-parallel plate in a vacuum, all internal reflections summed without interference, for unpolarised light: the
/// mean of what the two polarisations each do. Without absorption the transmittance is the mean of (1 - R)/(1 + R).
/// @param cos_theta of incidence, 0..1. @param n index of the plate, >= 1.
/// @param optical_depth sigma x thickness along the normal, >= 0, infinite allowed.
[[nodiscard]] PlateShares fresnel_plate(double cos_theta, double n, double optical_depth = 0);

/// Beer-Lambert: the share of light left after `distance` metres. @param sigma attenuation, 1/m, >= 0, infinite
/// allowed.
[[nodiscard]] double beer_lambert(double sigma, double distance);

/// The attenuation coefficient, 1/m, that leaves `colour` of white light after `attenuation_distance` metres
/// (KHR_materials_volume): -ln(colour)/distance. 0 for an infinite distance, infinite where the colour is 0.
[[nodiscard]] Vec3d attenuation_coefficient(const Rgb& colour, double attenuation_distance);

/// What a volume of that colour leaves after `distance` metres, 0..1; 1 for an infinite attenuation distance.
[[nodiscard]] Rgb volume_transmittance(const Rgb& colour, double attenuation_distance, double distance);

}  // namespace penumbra
