#pragma once

#include <memory>
#include <span>
#include <vector>

#include "penumbra/parallel/progress.h"
#include "penumbra/radiosity/meshing/lamp_irradiance.h"
#include "penumbra/radiosity/meshing/shading_mesh.h"
#include "penumbra/radiosity/patch_mesh.h"
#include "penumbra/render/element_sight.h"
#include "penumbra/render/render.h"
#include "penumbra/tracing/ray_tracer.h"
#include "penumbra/tracing/shading/environment_map.h"
#include "penumbra/tracing/shading/media.h"

namespace penumbra {

/// What to draw over the light.
enum class ElementOutlines { none, dark };

struct RadiosityViewOptions {
  bool smooth = true;  ///< irradiance interpolated between vertices; else each element in its one colour
  /// The scene's lamps, whose light is then exact at the vertices, so that shadows are as crisp as the elements allow;
  /// none: all light is blended from the elements. Read by the constructor alone, and only when smooth.
  const LampIrradiance* lamps = nullptr;
  ElementOutlines outlines = ElementOutlines::none;
  double outline_width = 0.0015;  ///< of an outline, as a share of the distance to the eye
};

/// A diffuse solution as it looks from anywhere: radiance B / pi, of the side that is seen.
///
/// Rays meet the elements themselves, so each picture is exact for them and has no noise. Irradiance is interpolated
/// over the shading mesh and multiplied by each element's own reflectance; emission is added, so that lamps shine.
/// Air that absorbs dims what is seen through it. Elements seen from a side that has none are black; rays that meet
/// none see the environment.
class RadiosityView {
 public:
  /// @param elements each patch an element. @param irradiance of the elements from everywhere, [element * 3 + band],
  /// W/m^2. @param scene for its environment; it and its images must outlive the view, `elements` need not.
  RadiosityView(const PatchMesh& elements, std::span<const double> irradiance, const Scene& scene,
                const RadiosityViewOptions& options = {});

  /// Other light on the same elements, blended from them.
  void relight(std::span<const double> irradiance);

  /// What a ray sees: layers of the first surface, radiance W/(m^2 sr).
  struct Sight {
    bool hit = false;
    Rgb radiance{0}, emission{0}, albedo{0};
    Vec3d position{0}, normal{0, 0, 1};
    double distance = 0;
    std::uint32_t object = 0;
  };
  [[nodiscard]] Sight look(const Ray& ray) const;

 private:
  [[nodiscard]] Sight look_through_clear_air(const Ray& ray) const;
  [[nodiscard]] double outline(std::uint32_t element, const Vec3d& position, double distance) const;

  ShadingMesh shading_;
  RadiosityViewOptions options_;
  EnvironmentMap environment_;
  Media media_;
  std::vector<Vec3d> normals_;  // of the elements
  std::vector<double> reflectance_, emission_;
  std::vector<std::uint32_t> objects_;
  std::vector<double> light_;                 // at the shading mesh's vertices or, flat, of the elements
  std::vector<std::vector<Vec3d>> outlines_;  // of the elements, when they are drawn
  std::unique_ptr<ElementSight> sight_;
};

/// Draws a picture of a solution; reads size, samples, filter, region, layers, seed and time limit of the options.
/// Layers `direct` and `indirect` are emission and the rest. Throws std::invalid_argument for options out of range.
[[nodiscard]] RenderResult render(const RadiosityView& view, const Camera& camera, const RenderOptions& options,
                                  const Progress& progress = {});

}  // namespace penumbra
