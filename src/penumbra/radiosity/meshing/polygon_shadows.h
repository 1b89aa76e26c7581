#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "penumbra/math/bounds.h"
#include "penumbra/math/polygon.h"
#include "penumbra/radiosity/box_tree.h"
#include "penumbra/scene/scene.h"
#include "penumbra/tracing/shading/light_sampling.h"

namespace penumbra {

/// How much of each flat lamp single points of a scene see, exactly and without rays: Lambert's edge sum over what is
/// left of the lamp when the pyramids over all polygons in between are cut out of it. Thread-safe.
class PolygonShadows {
 public:
  static constexpr std::size_t most_occluders = 32;

  /// @param through_glass whether transparent surfaces let light pass, see Shadow. @param with_occluders whether
  /// visible_factor() will be asked for. The scene must stay as it is; it need not outlive this.
  PolygonShadows(const Scene& scene, const LightSampler& lights, bool through_glass, bool with_occluders);

  /// Whether a light, by its number in the LightSampler, is a flat lamp of even radiance and few corners.
  [[nodiscard]] bool has(std::size_t light) const { return !lamps_[light].polygons.empty(); }
  /// Of such a lamp, W/(m^2 sr).
  [[nodiscard]] const Rgb& radiance(std::size_t light) const { return lamps_[light].radiance; }

  /// A point of a surface, seen from one side.
  struct Receiver {
    Vec3d position{0};
    double rounding = 0;    ///< of each coordinate, m
    Vec3d side{0, 0, 1};    ///< unit, geometric normal of that side
    Vec3d normal{0, 0, 1};  ///< unit, by which light is weighed
  };
  /// Form factor of the receiver to the lamp with nothing in between, 0..1: irradiance over pi times radiance.
  /// @pre has(light).
  [[nodiscard]] double open_factor(std::size_t light, const Receiver& to) const;
  /// The same of what is seen of the lamp. None where more than `most_occluders` polygons may stand in between, or
  /// something else than an opaque polygon: a ball, glass, a surface with holes.
  /// @pre has(light) and the occluders were asked for.
  [[nodiscard]] std::optional<double> visible_factor(std::size_t light, const Receiver& to) const;

 private:
  using Polygon = std::vector<Vec3d>;
  struct Lamp {
    std::vector<Polygon> polygons;  // counter-clockwise seen from where they shine
    Rgb radiance{0};
    bool both_sides = false;
  };

  void add_lamp(const Scene& scene, const LightSampler::Source& source);
  void add_occluders(const Scene& scene, bool through_glass);
  [[nodiscard]] Polygon lit_part(const Lamp& lamp, const Polygon& polygon, const Receiver& to) const;
  [[nodiscard]] bool list_occluders(const Polygon& lamp, const Receiver& to, std::vector<Polygon>& between) const;

  std::vector<Lamp> lamps_;         // by light
  std::vector<Polygon> occluders_;  // empty: what is no opaque polygon
  std::vector<Bounds> bounds_;
  std::vector<Plane3> planes_;  // infinite ones
  BoxTree tree_;
};

}  // namespace penumbra
