#pragma once

#include <cstdint>
#include <optional>
#include <string_view>
#include <vector>

#include "penumbra/tracing/ray_differential.h"
#include "penumbra/tracing/ray_tracer.h"

namespace penumbra {

/// A ray of Whitted's tree, with all that decides what it brings.
struct TreeRay {
  static constexpr std::int32_t none = -1;

  enum class Kind { primary, reflection, refraction, shadow };
  /// Why it goes no further, or that it does.
  enum class End {
    surface,       ///< met a surface, which sends rays on or sends light back by itself
    left_scene,    ///< met nothing: it sees the environment
    energy_spent,  ///< never sent: its weight in the picture lies below the bound
    too_deep,      ///< never sent: the depth is reached
    light,         ///< a shadow ray that reached its light, perhaps weakened
    hidden,        ///< a shadow ray that something opaque stopped
  };
  /// Where the light that meets a surface goes, per band; the parts sum to 1.
  struct Split {
    Rgb reflected{0};  ///< into the mirror direction
    Rgb refracted{0};  ///< through the surface, by refraction or where it is half transparent
    Rgb diffuse{0};    ///< into all directions of its side (the rough share; estimated at this angle)
    Rgb absorbed{0};
  };

  std::int32_t parent = none;  ///< into RayTree::rays; parents stand before their children
  Kind kind = Kind::primary;
  End end = End::surface;
  int depth = 0;       ///< reflections and refractions before it; a shadow ray has its surface's
  Vec3d origin{0};     ///< m
  Vec3d direction{0};  ///< unit; 0 for a ray that was never sent
  double length = 0;   ///< m; infinite when it left the scene
  Rgb weight{0};       ///< in the picture: what a radiance of 1 at its end adds to the pixel, absorption included
  Rgb radiance{0};     ///< W/(m^2 sr) that comes back along it; of a shadow ray what its light adds at the surface
  std::int32_t object = none;    ///< that it met, as the scene numbers them; of a hidden shadow ray the blocker
  std::int32_t material = none;  ///< of that
  std::int32_t light = none;     ///< of a shadow ray, as LightSampler numbers them
  bool front = true;             ///< the surface was met from its front
  std::optional<Split> split;    ///< of a surface
};

/// Every ray behind a pixel: the tree of Whitted 1979 with its shadow rays ('shadow feelers').
struct RayTree {
  Rgb radiance{0};            ///< of the pixel, W/(m^2 sr)
  std::vector<TreeRay> rays;  ///< [0] is the primary ray
};

struct RayTreeOptions {
  int max_depth = 16;  ///< as RenderOptions
  double min_throughput = 1e-3;
  bool opaque_shadows = false;
  bool front_sides_only = false;
  std::optional<RayDifferential> differential{};  ///< of the primary ray, for textures; none: read at points
};

/// Traces the tree of one camera ray. Lights with a body are met at their middle where they have one, else at one
/// point; so `whitted` with one sample a pixel sees the same radiance.
[[nodiscard]] RayTree make_ray_tree(const RayTracer& tracer, const Ray& primary, const RayTreeOptions& options = {});

/// "reflection", "left the scene", ...
[[nodiscard]] std::string_view name_of(TreeRay::Kind kind);
[[nodiscard]] std::string_view name_of(TreeRay::End end);

}  // namespace penumbra
