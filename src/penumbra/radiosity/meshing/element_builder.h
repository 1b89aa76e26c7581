#pragma once

#include <cstdint>
#include <span>
#include <unordered_map>
#include <vector>

#include "penumbra/radiosity/patch_mesh.h"
#include "penumbra/scene/scene.h"

namespace penumbra {

/// The input polygons of a scene as planar convex patches, for elements to be cut from: faces without area and faces
/// that lie exactly on another are left out with a warning. Textures are not looked at.
[[nodiscard]] MadePatchMesh make_element_faces(const Scene& scene, PatchSides sides, int shape_segments);

/// Collects elements, each one patch and one surface of a mesh.
class ElementBuilder {
 public:
  /// @param faces names the surfaces: an element of its patch p is named and numbered as the surface of p. Must outlive
  /// this.
  explicit ElementBuilder(const PatchMesh& faces);

  /// Adds a piece of radiating patch `parent`, oriented as it; returns the element's number. Equal corners are shared.
  std::uint32_t add(std::uint32_t parent, std::span<const Vec3d> cell);

  /// The elements, with their parents' reflectance and emission.
  [[nodiscard]] PatchMesh finish() &&;

 private:
  struct PositionHash {
    std::size_t operator()(const Vec3d& p) const;
  };

  const PatchMesh& faces_;
  PatchMesh mesh_;
  std::unordered_map<Vec3d, std::uint32_t, PositionHash> vertex_of_;
};

/// Sets reflectance and emission of each surface to their averages over its patches. @param elements of this scene,
/// whose surfaces name its faces.
void paint_elements(const Scene& scene, int shape_segments, PatchMesh& elements);

}  // namespace penumbra
