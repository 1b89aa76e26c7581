#pragma once

#include <cstdint>
#include <vector>

#include "penumbra/baking/metal_texels.h"
#include "penumbra/baking/sample_points.h"
#include "penumbra/math/rng.h"
#include "penumbra/math/spectrum.h"
#include "penumbra/tracing/ray_tracer.h"
#include "penumbra/tracing/shading/environment_map.h"

namespace penumbra {

/// Where a ray ends, and what it carries.
struct Landing {
  static constexpr std::uint32_t nowhere = 0xffffffffU;
  std::uint32_t side = nowhere;  ///< twice the texel, plus 1 for its back; nowhere: it left the scene, or was absorbed
  bool is_plain = true;          ///< weight is 1
  Rgb weight{1.0F};              ///< what of the radiosity there arrives
  Rgb extra{0.0F};               ///< radiosity (pi times radiance, W/m^2) picked up on the way, weighed
};

/// Which lamps count as straight light, by triangle and side: rays that meet them at once must not count them again.
struct StraightLamps {
  std::vector<std::uint8_t> of_triangle;  ///< bit 0 the front, bit 1 the back

  [[nodiscard]] bool holds(std::uint32_t triangle, bool back) const {
    return (of_triangle[triangle] & (back ? 2U : 1U)) != 0;
  }
};

/// Rays from texels to texels: straight, or by way of mirrors, metal, glass and what is half transparent.
///
/// Thread-safe. At a surface that does more than reflect diffusely one of the things it does is chosen for each ray, in
/// proportion to its strength: the ray ends on its diffuse share, or goes on; opaque metal is that of the texel, see
/// MetalTexels. The dielectric layer over diffuse surfaces is left out, as
/// reflectance is taken to be base colour (1 - metallic) (1 - transmission).
class TexelRays {
 public:
  /// `points` and `lamps` must outlive this.
  TexelRays(const SamplePoints& points, const AtlasSpace& space, const StraightLamps& lamps);

  /// Traces a packet. @param keys of the random choices of each lane for this ray.
  void trace(const RayPacket& rays, std::uint64_t key, Landing (&landings)[RayPacket::size]) const;

  [[nodiscard]] const TexelMap& map() const { return map_; }
  [[nodiscard]] const SamplePoints& points() const { return points_; }

 private:
  enum class Kind : std::uint8_t {
    matt,   // rays end there
    metal,  // opaque, in part at least
    other   // each ray looks the surface up
  };
  /// What a ray does at a surface.
  struct Turn {
    enum class Fate { ends, goes_on, is_lost } fate = Fate::is_lost;
    Rgb weight{1.0F};  ///< of what comes back that way
    Ray ray{};         ///< where it goes on
  };
  static Kind kind_of(const Material& m);
  [[nodiscard]] Landing follow(Ray ray, Hit hit, std::uint64_t key) const;
  [[nodiscard]] Turn turn_at_metal(const Ray& ray, const Hit& hit, std::uint32_t texel, CounterRng& random) const;
  [[nodiscard]] Turn turn_at_other(const Ray& ray, const Hit& hit, CounterRng& random) const;
  [[nodiscard]] Rgb sky(const Vec3d& direction) const;

  [[nodiscard]] std::uint32_t texel_at(const Hit& hit, std::uint32_t triangle, bool back) const;

  const SamplePoints& points_;
  const RayTracer& tracer_;
  const TexelMap& map_;
  const StraightLamps& lamps_;
  EnvironmentMap environment_;
  MetalTexels metals_;
  std::vector<Kind> kinds_;  // by triangle
};

}  // namespace penumbra
