#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "penumbra/baking/sample_points.h"
#include "penumbra/baking/texel_rays.h"
#include "penumbra/radiosity/meshing/lamp_irradiance.h"
#include "penumbra/radiosity/patch_mesh.h"

namespace penumbra {

/// Light straight from lamps: the emissive faces without a texture that emit most, points, spots and far lights.
///
/// Exact, with every face opaque (LampIrradiance). Where surfaces have holes, by 64 shadow rays to each lamp.
class StraightLight {
 public:
  /// @param tracer of the atlas's scene. Both must outlive this. @param front_sides_only backs do not emit.
  StraightLight(const LightmapAtlas& atlas, const RayTracer& tracer, bool front_sides_only);

  [[nodiscard]] const StraightLamps& lamps() const { return straight_; }
  [[nodiscard]] bool is_dark() const { return light_->lamps().empty(); }
  /// Whether shadows have no penumbra: there are points, spots or far lights.
  [[nodiscard]] bool has_hard_shadows() const { return hard_shadows_; }

  /// Irradiance at places close together, W/m^2. @param reach how far around each the surface belongs to it, m.
  void at(std::span<const Place> places, double reach, std::span<Vec3d> irradiance) const;

  /// Light from one direction.
  struct Beam {
    Vec3d direction{0};    ///< unit, to where it comes from
    Rgb irradiance{0.0F};  ///< on a surface that faces it, W/m^2
  };
  /// The light of lamps at a point in space as beams that together are it: points of lamps by low-discrepancy samples,
  /// as many to each, all that reach the point unhindered. @param normal unit: only what comes from its side; zero:
  /// all.
  [[nodiscard]] std::vector<Beam> beams(const Vec3d& point, const Vec3d& normal, std::uint32_t samples,
                                        std::uint64_t key) const;

 private:
  void choose_lamps(bool front_sides_only);
  void look(const LampIrradiance::View& view, const Place& place, Vec3d& irradiance) const;

  const LightmapAtlas& atlas_;
  const RayTracer& tracer_;
  LightSampler sampler_;
  PatchMesh faces_;
  std::unique_ptr<LampIrradiance> light_;
  StraightLamps straight_;
  bool hard_shadows_ = false;
  bool has_holes_ = false;  // a material with AlphaMode::mask
  double rounding_ = 0;
};

}  // namespace penumbra
