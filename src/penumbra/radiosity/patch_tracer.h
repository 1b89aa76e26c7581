#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include "penumbra/math/ray.h"
#include "penumbra/radiosity/patch_mesh.h"
#include "penumbra/tracing/ray_tracer.h"

namespace penumbra {

/// Rays among the patches of a mesh.
///
/// All member functions are thread-safe. The mesh must outlive the tracer and stay unchanged.
class PatchTracer {
 public:
  static constexpr std::uint32_t no_patch = 0xFFFFFFFFU;

  explicit PatchTracer(const PatchMesh& mesh);

  /// The radiating patch whose front the ray meets first; no_patch when it meets nothing, an obstruction or a back. Of
  /// two coincident patches (a plate with two sides) the one that faces the ray counts.
  [[nodiscard]] std::uint32_t first_front(const Ray& ray) const;

  /// The same for sixteen rays; lanes that are not active get no_patch.
  void first_front(const RayPacket& rays, std::uint32_t* patches) const;

  /// Where a ray from `point` on a patch may start without meeting the patch itself.
  [[nodiscard]] Ray leave_patch(std::uint32_t patch, const Vec3d& point, const Vec3d& direction) const;

 private:
  [[nodiscard]] std::uint32_t facing(std::uint32_t triangle, const Vec3d& origin, const Vec3d& direction) const;
  void find_opposites();

  const PatchMesh& mesh_;
  std::vector<std::uint32_t> patch_of_triangle_;
  std::unique_ptr<Scene> scene_;
  std::unique_ptr<RayTracer> tracer_;
  std::vector<std::uint32_t>
      opposite_offsets_;  ///< patch p lies back to back with opposites_[offsets[p] .. offsets[p + 1])
  std::vector<std::uint32_t> opposites_;
  double error_ = 0;  ///< bound on a coordinate's rounding in the tracer, m
};

}  // namespace penumbra
