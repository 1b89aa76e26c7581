#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "penumbra/math/bounds.h"
#include "penumbra/math/vec.h"

namespace penumbra {

/// Chooses among many emitters the ones that matter at a point: a hierarchy over their places, powers and directions
/// (Conty Estevez & Kulla, "Importance Sampling of Many Lights with Adaptive Tree Splitting", 2018, without splitting;
/// the bounds as in Pharr, Jakob & Humphreys, "Physically Based Rendering", 4th ed., 12.6.3).
///
/// An emitter that can send light to the point is chosen with a chance above 0, in proportion to what it may bring
/// there unhindered, as far as its part of the tree tells. Thread-safe.
class LightTree {
 public:
  /// What bounds an emitter's light.
  struct Emitter {
    Bounds bounds;            ///< where it is, m
    Vec3d axis{0, 0, 1};      ///< unit, the middle of its normals
    double spread = 0;        ///< rad, 0..pi: how far its normals turn from the axis
    double beam = 0;          ///< rad, 0..pi: how far from its normals it shines
    bool both_sides = false;  ///< it shines from its back, too
    double power = 0;         ///< W, > 0
  };

  LightTree() = default;
  explicit LightTree(std::span<const Emitter> emitters);

  [[nodiscard]] bool empty() const { return nodes_.empty(); }

  struct Choice {
    std::uint32_t emitter;
    double chance;    ///< of this emitter
    double leftover;  ///< of the random number, uniform in 0..1 again
  };
  /// @param normal unit, of the surface at `point`, either side; 0: light counts alike from all sides.
  /// None when no emitter can shine there.
  [[nodiscard]] std::optional<Choice> choose(const Vec3d& point, const Vec3d& normal, double u) const;
  /// The chance with which `choose` takes an emitter.
  [[nodiscard]] double chance(std::uint32_t emitter, const Vec3d& point, const Vec3d& normal) const;

 private:
  struct Node {
    Emitter light;  // all of its part of the tree as one
    std::uint32_t parent = 0;
    std::uint32_t right = 0;    // the left child follows its parent; 0: a leaf
    std::uint32_t emitter = 0;  // of a leaf
  };

  std::uint32_t build(std::span<const Emitter> emitters, std::span<std::uint32_t> order, std::uint32_t parent);

  std::vector<Node> nodes_;
  std::vector<std::uint32_t> leaf_of_;  // by emitter
};

}  // namespace penumbra
