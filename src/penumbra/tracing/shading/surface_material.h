#pragma once

#include <limits>
#include <optional>

#include "penumbra/math/bands.h"
#include "penumbra/math/frame.h"
#include "penumbra/math/spectrum.h"
#include "penumbra/scene/scene.h"
#include "penumbra/tracing/hit.h"
#include "penumbra/tracing/shading/filtered_textures.h"

namespace penumbra {

/// A material at one point: textures read, factors multiplied. See Material for the meaning of each.
struct SurfaceMaterial {
  Rgb base_colour{0.8F};
  float alpha = 1;  ///< what AlphaMode::blend lets see; 1 for the other modes
  float metallic = 0;
  float roughness = 1;
  float specular = 1;
  Rgb specular_colour{1.0F};
  float ior = 1.5F;
  float transmission = 0;
  bool thin_walled = false;
  Rgb mirror{0.0F};
  std::optional<ConductorIor> conductor;
  Rgb emission{0.0F};  ///< radiance from an emitting side, W/(m^2 sr)
  Frame shading;       ///< with the normal map applied; the normal in the geometric normal's hemisphere
};

/// The factors of a material without its textures; its shading frame is not set.
[[nodiscard]] SurfaceMaterial surface_material(const Material& material);
/// Reads the material and its textures at a point, or averages them over what a sample covers around it.
/// @param filtered of the same point; none: textures are read at the point itself.
[[nodiscard]] SurfaceMaterial surface_material(const Scene& scene, const SurfacePoint& point,
                                               const FilteredTextures::View* filtered = nullptr);

/// Index of refraction on the side that a ray comes from over that beyond. @param front the ray comes from outside.
[[nodiscard]] inline double relative_index(const SurfaceMaterial& surface, bool front) {
  if (surface.thin_walled || !(surface.ior > 0)) return 1;
  const auto ior = static_cast<double>(surface.ior);
  return front ? 1 / ior : ior;
}

/// The same in a sample's bands: colours become values at its wavelengths, a fluorescent surface has its ordinary
/// reflectance there, and glass that disperses has the index that the hero sees.
[[nodiscard]] SurfaceMaterial surface_material(const Scene& scene, const SurfacePoint& point, const Bands& bands,
                                               const FilteredTextures::View* filtered = nullptr);

/// A lamp's spectrum in a sample's bands, W/(m^2 sr nm). @pre bands.spectral().
[[nodiscard]] Rgb spectrum_in(const EmissionSpectrum& spectrum, const Bands& bands);

/// Whether the way of a ray through the material depends on its wavelength: solid glass with a dispersion.
[[nodiscard]] inline bool disperses(const Material& material) {
  return material.dispersion && material.transmission > 0 && !material.thin_walled;
}

/// `shading` bent just so far that `wo` sees its front: interpolated normals and normal maps turn away from the eye
/// near silhouettes, where a BSDF would show black. Unchanged where `wo` is on the same side of it as of the geometry.
/// @param geometric_normal unit, in the hemisphere of the shading normal. @param wo unit, to where light goes.
[[nodiscard]] Frame frame_towards(const Frame& shading, const Vec3d& geometric_normal, const Vec3d& wo);

}  // namespace penumbra
