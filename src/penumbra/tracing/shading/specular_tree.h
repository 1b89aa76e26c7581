#pragma once

#include <optional>

#include "penumbra/math/ray.h"
#include "penumbra/tracing/ray_tracer.h"
#include "penumbra/tracing/shading/bsdf.h"
#include "penumbra/tracing/shading/filtered_textures.h"
#include "penumbra/tracing/shading/interior.h"
#include "penumbra/tracing/shading/media.h"

namespace penumbra {

/// Lobes up to this roughness are followed by mirror and refraction rays (docs/guide/rendering.md).
inline constexpr double followed_roughness = 0.1;

/// The recursion of Whitted 1979: from each surface that a ray meets, its mirror and its refraction ray are followed,
/// each with the weight that it carries to the root, until a visitor ends it. What the surfaces do with it is the
/// visitor's: to see them, or to note where light comes from. Thread-safe.
class SpecularTree {
 public:
  /// A ray of the tree: its weight at the root, its depth, and the media it travels in.
  struct Branch {
    Rgb weight{1.0F};
    int depth = 0;
    Vec3d start{0};  ///< the point that it leaves, m; the ray itself starts a rounding error beside it
    Interior interior{};
    std::optional<RayDifferential> differential{};  ///< of the ray; none: textures are read at points
    Bands bands{};                                  ///< what the components of weight and radiance stand for
  };
  /// A surface met.
  struct Node {
    const Ray& ray;
    const SurfacePoint& point;
    const SurfaceMaterial& surface;
    const Bsdf& bsdf;
    Vec3d wo;       ///< unit, back along the ray
    bool front;     ///< the ray met the front
    Rgb passed;     ///< what the way here left, without the surface's opacity
    Branch branch;  ///< as it goes on from here: weight with absorption on the way here and opacity
  };
  /// The way of a ray to where it ends.
  struct Stretch {
    Ray ray;              ///< t_max is its length, m; infinite when it leaves the scene
    Surroundings around;  ///< what it travels in
    const Branch& branch;
  };
  class Visitor {
   public:
    virtual ~Visitor() = default;
    /// Radiance that the surface sends back along the ray by itself, reflection and refraction that the tree follows
    /// left out. May follow more rays.
    virtual Rgb surface(const Node& node) = 0;
    /// Radiance of a ray that leaves the scene.
    virtual Rgb sky(const Ray& ray, const Branch& branch) = 0;
    /// Radiance that the media along a ray send back along it; asked only where something scatters.
    virtual Rgb air(const Stretch&) { return Rgb(0); }
    /// Whether a ray of this weight at the root is followed from a ray of this depth: 0 no, 1 yes, more when it stands
    /// for others that are not (Russian roulette).
    virtual float followed(const Rgb& weight, int depth) = 0;
    /// A ray is about to be traced.
    virtual void count(bool refracted, int depth) = 0;
  };

  /// @param front_sides_only backs of opaque surfaces are black. @param textures averaged over what rays with
  /// differentials cover; none: read at points. The tracer and the textures must outlive the tree.
  SpecularTree(const RayTracer& tracer, bool front_sides_only, const FilteredTextures* textures = nullptr)
      : tracer_(tracer),
        media_(tracer.scene()),
        front_sides_only_(front_sides_only),
        textures_(textures != nullptr && textures->any() ? textures : nullptr) {}

  /// What comes back along a ray, W/(m^2 sr) if the visitor answers so. With wavelengths a ray that glass disperses is
  /// refracted three times, each time for one of them.
  Rgb trace(const Ray& ray, const Branch& branch, Visitor& visitor) const;
  /// What a ray of the visitor's own choice brings to a node, times `weight`. @param direction unit.
  /// @param refracted whether it goes through the surface. @param differential of that ray, if it is known.
  Rgb follow(const SurfacePoint& point, const Branch& from, const Vec3d& direction, const Rgb& weight, bool refracted,
             Visitor& visitor, const std::optional<RayDifferential>& differential = std::nullopt) const;

  [[nodiscard]] const RayTracer& tracer() const { return tracer_; }

 private:
  Rgb follow_dispersed(const Node& node, const Dispersion& dispersion, Visitor& visitor) const;

  const RayTracer& tracer_;
  Media media_;
  bool front_sides_only_;
  const FilteredTextures* textures_;
};

}  // namespace penumbra
