#pragma once

#include <optional>
#include <vector>

#include "penumbra/io/gltf_accessor.h"
#include "penumbra/io/gltf_document.h"
#include "penumbra/math/transform.h"

namespace penumbra {

/// What bends a mesh: the weights of its morph targets, then the matrices of its skin's joints.
struct GltfDeformation {
  std::vector<double> weights;  ///< of the targets; empty or all 0: none counts
  std::vector<Mat4d> joints;    ///< from the mesh's own space to the world; empty: no skin

  [[nodiscard]] bool morphs() const;
  [[nodiscard]] bool bends() const { return morphs() || !joints.empty(); }
};

/// The joints of skin `index`: placement of each times its inverse bind matrix (glTF 2.0, section 3.7.3).
/// @param to_world of all nodes. Throws FileError.
[[nodiscard]] std::vector<Mat4d> gltf_joints(GltfDocument& document, GltfAccessors& accessors,
                                             const std::vector<Mat4d>& to_world, std::uint64_t index,
                                             const JsonPlace& user);

/// Vertices after their deformation; three numbers a vertex, tangents four. Empty where the primitive has none.
struct DeformedVertices {
  std::vector<float> positions, normals, tangents;
};

/// What deformation needs to know of a primitive's vertices.
struct DeformedAttributes {
  const GltfElements& position;
  const std::optional<GltfElements>& normal;
  const std::optional<GltfElements>& tangent;
  const std::optional<GltfElements> (&joints)[2];   ///< four joints a vertex and set
  const std::optional<GltfElements> (&weights)[2];  ///< and their shares
};

/// Bends a primitive: adds its targets' displacements by their weights, then moves each vertex by the mean of its
/// joints' matrices (linear blend skinning). Throws FileError at `primitive`.
[[nodiscard]] DeformedVertices deformed(const GltfDeformation& deformation, const DeformedAttributes& from,
                                        GltfDocument& document, GltfAccessors& accessors, const JsonPlace& primitive);

}  // namespace penumbra
