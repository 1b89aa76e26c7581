#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>

#include "penumbra/radiosity/form_factors/form_factor_method.h"
#include "penumbra/radiosity/form_factors/occluder_polygons.h"
#include "penumbra/radiosity/patch_mesh.h"

namespace penumbra {

/// Patches that send and elements that receive, by the `auto` method: only what passes between the two is computed, a
/// row at a time. Thread-safe.
class PatchExchange {
 public:
  /// @param senders of `patches`. @param occluders what stands in the way, made from the faces. @param surveyed see
  /// AutoFormFactors::Settings. Patches and elements are copied.
  PatchExchange(const PatchMesh& patches, std::span<const std::uint32_t> senders, const PatchMesh& elements,
                const std::shared_ptr<const OccluderPolygons>& occluders, FormFactorOptions options,
                std::size_t surveyed);
  PatchExchange(const PatchExchange&) = delete;  // the method knows where the mesh stands
  PatchExchange& operator=(const PatchExchange&) = delete;

  /// A_i F_ij (m^2) from a sender to the elements, by ascending element; together no more than A_i.
  [[nodiscard]] PatchRow from_sender(std::size_t sender) const;
  /// From an element to the senders, by ascending sender.
  [[nodiscard]] PatchRow from_element(std::size_t element) const;

 private:
  void add(std::span<const Vec3d> polygon, std::uint32_t surface);

  std::size_t sender_count_;
  PatchMesh mesh_;  ///< two surfaces: all senders, all elements
  std::unique_ptr<FormFactorMethod> method_;
};

}  // namespace penumbra
