#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "penumbra/baking/sample_points.h"
#include "penumbra/baking/texel_rays.h"
#include "penumbra/radiosity/meshing/lamp_irradiance.h"
#include "penumbra/radiosity/patch_mesh.h"
#include "penumbra/tracing/shading/shadow.h"

namespace penumbra {

/// Light straight from lamps: the emissive faces without a texture that emit most, points, spots and far lights.
///
/// Faces exactly, with every other face opaque (LampIrradiance); where surfaces have holes, by 64 shadow rays to each.
/// Points, spots and far lights by one shadow ray, which AlphaMode::blend and glass attenuate as they do in a render
/// (Shadow): no other ray finds these lights.
class StraightLight {
 public:
  struct Options {
    bool front_sides_only = false;  ///< backs do not emit
    bool opaque_shadows = false;    ///< glass stops the shadow rays of points, spots and far lights
  };

  /// @param tracer of the atlas's scene. Both must outlive this.
  StraightLight(const LightmapAtlas& atlas, const RayTracer& tracer, const Options& options);

  [[nodiscard]] const StraightLamps& lamps() const { return straight_; }
  [[nodiscard]] bool is_dark() const { return light_->lamps().empty() && bodiless_.empty(); }
  /// Whether shadows have no penumbra: there are points, spots or far lights.
  [[nodiscard]] bool has_hard_shadows() const { return !bodiless_.empty(); }
  /// What the lamps send out, W, summed over bands: faces, points and spots; of far lights, see far_irradiance().
  [[nodiscard]] double power() const;
  /// The part of the light at a place that comes from far lights and from points without falloff, W/m^2: their power
  /// is what reaches the scene.
  [[nodiscard]] Vec3d far_irradiance(const Place& place) const;

  /// Irradiance at places close together, W/m^2. @param reach how far around each the surface belongs to it, m.
  void at(std::span<const Place> places, double reach, std::span<Vec3d> irradiance) const;

  /// Light from one direction.
  struct Beam {
    Vec3d direction{0};    ///< unit, to where it comes from
    Rgb irradiance{0.0F};  ///< on a surface that faces it, W/m^2
  };
  /// The light of lamps at a point in space as beams that together are it: low-discrepancy directions to each lamp,
  /// even over what is seen of it with nothing in between, as many to each; those that reach it unhindered.
  /// @param normal unit: only what comes from its side; zero: all.
  [[nodiscard]] std::vector<Beam> beams(const Vec3d& point, const Vec3d& normal, std::uint32_t samples,
                                        std::uint64_t key) const;

 private:
  void choose_lamps(bool front_sides_only);
  void part_lamps();
  [[nodiscard]] Vec3d look(const LampIrradiance::View& view, const Place& place) const;
  [[nodiscard]] std::optional<Beam> beam_of(const Lamp& lamp, const Vec3d& point, const Vec3d& normal) const;
  void add_beams(const Lamp& lamp, const Vec3d& point, const Vec3d& normal, std::uint32_t samples, std::uint64_t key,
                 std::vector<Beam>& beams) const;
  [[nodiscard]] Vec3d from_bodiless(const Place& place, bool far_only) const;
  [[nodiscard]] Vec3d lifted(const Place& place) const;

  const LightmapAtlas& atlas_;
  const RayTracer& tracer_;
  LightSampler sampler_;
  PatchMesh faces_;
  std::unique_ptr<LampIrradiance> light_;  // of faces alone
  std::vector<Lamp> bodiless_;             // points, spots and far lights
  Shadow shadow_;
  StraightLamps straight_;
  bool has_holes_ = false;  // a material with AlphaMode::mask
  double rounding_ = 0;
};

}  // namespace penumbra
