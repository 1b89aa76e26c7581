#pragma once

#include <cstdint>
#include <limits>
#include <optional>
#include <string>

#include "penumbra/math/dispersion.h"
#include "penumbra/math/spectrum.h"
#include "penumbra/scene/emission_spectrum.h"
#include "penumbra/scene/fluorescence.h"
#include "penumbra/scene/texture.h"

namespace penumbra {

/// Complex index of refraction of a metal, eta + i k, per band.
struct ConductorIor {
  Rgb eta{0.2F};
  Rgb k{3.0F};
};

enum class AlphaMode {
  opaque,
  mask,   ///< below the cutoff a hole for every ray
  blend,  ///< camera and shadow rays pass in part
};

/// How a surface reflects, transmits and emits: glTF's metallic-roughness model with its extensions,
/// plus the ideal mirror share of the classical models. Textures multiply the factors as glTF says.
///
/// Diffuse reflectance = base_colour (1 - metallic) (1 - transmission), under a specular layer;
/// purely Lambertian when specular, metallic, transmission and mirror are 0.
struct Material {
  std::string name;
  Rgb base_colour{0.8F};  ///< reflectance, 0..1; tint of what is transmitted
  float alpha = 1;        ///< opacity, for AlphaMode mask and blend
  AlphaMode alpha_mode = AlphaMode::opaque;
  float alpha_cutoff = 0.5F;

  float metallic = 0;         ///< 0..1
  float roughness = 1;        ///< perceptual, 0..1; GGX alpha = roughness^2
  float specular = 1;         ///< weight of the dielectric specular layer, 0..1; 0 leaves pure Lambert
  Rgb specular_colour{1.0F};  ///< scales the dielectric F0; F0 is clamped to 1
  float ior = 1.5F;           ///< of the dielectric interface, >= 1 (0 means Fresnel 1, as glTF allows)

  float transmission = 0;        ///< 0..1
  bool thin_walled = false;      ///< no refraction, no absorption: glTF without KHR_materials_volume
  Rgb attenuation_colour{1.0F};  ///< what remains of white light after attenuation_distance
  float attenuation_distance = std::numeric_limits<float>::infinity();  ///< m

  /// Index into Scene::media: what the closed surface holds. Light gets in where the surface is transparent; one that
  /// is not to be seen itself has AlphaMode::blend and alpha 0.
  std::optional<std::uint32_t> medium{};

  Rgb mirror{0.0F};                       ///< ideal specular reflectance, the same at every angle (Whitted's k_s)
  std::optional<ConductorIor> conductor;  ///< exact Fresnel of a metal in place of Schlick's for the metallic part

  Rgb emission{0.0F};         ///< emitted radiance, W/(m^2 sr)
  bool double_sided = false;  ///< emits from both sides (it reflects on both in any case)
  bool unlit = false;         ///< KHR_materials_unlit: the base colour is shown as radiance, light does not matter

  float normal_scale = 1;
  std::optional<TextureRef> base_colour_texture;         ///< sRGB, alpha in A
  std::optional<TextureRef> metallic_roughness_texture;  ///< linear, G roughness, B metallic
  std::optional<TextureRef> normal_texture;              ///< linear, tangent space, +Y up
  std::optional<TextureRef> emission_texture;            ///< sRGB
  std::optional<TextureRef> transmission_texture;        ///< linear, R
  std::optional<TextureRef> specular_texture;            ///< linear, A
  std::optional<TextureRef> specular_colour_texture;     ///< sRGB

  /// Two colours in squares of `checker_size` metres over the surface's own plane: Whitted's floor.
  /// The second colour; base_colour is the first. On a floor (normal along y) the square whose floor(x / size) +
  /// floor(z / size) is even, in world coordinates, has the first.
  std::optional<Rgb> checker_colour;
  float checker_size = 1;

  // What only spectral rendering shows (RenderOptions::spectral); else the colours above stand for it.

  std::optional<Dispersion> dispersion;  ///< index by wavelength of solid glass; `ior` is that of the d line
  /// In place of the base colour, within its bands. Of Lambertian materials only: specular, metallic, transmission and
  /// mirror are 0.
  std::optional<Fluorescence> fluorescence;
  /// In place of the emission, which is its colour. Of opaque materials without an emission texture only.
  std::optional<EmissionSpectrum> emission_spectrum;

  std::string extras{};  ///< as Instance::extras

  [[nodiscard]] bool emits() const { return !is_black(emission); }
};

}  // namespace penumbra
