#pragma once

#include <span>
#include <vector>

#include "penumbra/radiosity/meshing/lamp_irradiance.h"
#include "penumbra/radiosity/meshing/shading_mesh.h"
#include "penumbra/radiosity/patch_mesh.h"
#include "penumbra/render/diffuse_light.h"
#include "penumbra/render/element_sight.h"
#include "penumbra/tracing/ray_tracer.h"

namespace penumbra {

/// The light of a radiosity solution at any point of the scene's surfaces: the lamps' own exactly, where the surface is
/// flat (Lambert's edge sum over what is seen of each), the rest interpolated between the elements.
class SolutionLight final : public DiffuseLight {
 public:
  /// @param tracer of the scene. @param elements each patch an element, of the scene. @param irradiance of the elements
  /// from everywhere, [element * 3 + band], W/m^2. @param caustics the part of it that comes straight from lights by
  /// way of mirrors and glass; empty: not known. @param lamps of the same scene. Tracer and lamps must outlive this.
  SolutionLight(const RayTracer& tracer, const PatchMesh& elements, std::span<const double> irradiance,
                std::span<const double> caustics, const LampIrradiance& lamps);

  [[nodiscard]] Rgb direct(const Place& place, std::uint64_t key, std::uint32_t rays) const override;
  [[nodiscard]] Rgb indirect(const Place& place) const override;
  [[nodiscard]] Rgb caustics(const Place& place) const override;
  [[nodiscard]] bool knows_caustics() const override { return !caustics_.empty(); }
  [[nodiscard]] Rgb total(const Place& place) const override;
  [[nodiscard]] double fineness(const Place& place) const override;
  [[nodiscard]] bool is_lamp(const Place& place) const override;

 private:
  [[nodiscard]] std::optional<ElementSight::Place> find(const Place& place) const;
  [[nodiscard]] Rgb blend(const std::vector<double>& at_vertices, const ElementSight::Place& at) const;
  void find_lamps(const PatchMesh& elements);

  const RayTracer& tracer_;
  const Scene& scene_;
  const LampIrradiance& lamps_;
  ShadingMesh shading_;
  ElementSight sight_;
  std::vector<LampIrradiance::View> views_;  // by element
  std::vector<bool> lamp_elements_;
  std::vector<double> sizes_;                        // of the elements, m
  std::vector<double> indirect_, caustics_, total_;  // [vertex * 3 + band]
  double size_ = 1;
};

}  // namespace penumbra
