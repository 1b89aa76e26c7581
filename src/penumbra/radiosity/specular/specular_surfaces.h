#pragma once

#include <cstdint>
#include <vector>

#include "penumbra/radiosity/patch_mesh.h"
#include "penumbra/scene/scene.h"

namespace penumbra {

/// Whether light that a material does not reflect diffusely is followed on: mirrors, metals, glass, and dielectric
/// layers smooth enough that pictures follow them too (roughness up to `followed_roughness`; layers whose roughness is
/// a texture count as rough).
[[nodiscard]] bool is_specular(const Material& material);

/// The elements as light by way of mirrors and glass sees them.
struct SpecularElements {
  std::vector<std::uint32_t> materials;  ///< of each element
  std::vector<bool> specular;            ///< of each element, see is_specular
  /// What no light ends on: specular, and neither reflecting diffusely nor emitting.
  std::vector<bool> only_specular;
  [[nodiscard]] bool any() const;
};

/// @param elements of the scene. @param shape_segments as they were made.
[[nodiscard]] SpecularElements find_specular_elements(const Scene& scene, const PatchMesh& elements,
                                                      int shape_segments);

/// Leaves to the diffuse reflectance of specular elements what their mirrors and layers let through, so that both
/// together reflect no more than arrives.
void share_reflectance(const Scene& scene, const SpecularElements& specular, PatchMesh& elements);

}  // namespace penumbra
