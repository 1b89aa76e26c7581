#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <utility>
#include <vector>

#include "penumbra/math/bounds.h"
#include "penumbra/math/polygon.h"
#include "penumbra/radiosity/box_tree.h"
#include "penumbra/radiosity/patch_mesh.h"
#include "penumbra/scene/scene.h"
#include "penumbra/tracing/ray_tracer.h"
#include "penumbra/tracing/shading/light_sampling.h"

namespace penumbra {

/// A light as meshing sees it: an emitting patch, a point, or a far light.
struct Lamp {
  enum class Kind { patch, point, far };
  Kind kind = Kind::patch;
  std::vector<Vec3d> corners;  ///< of the patch, counter-clockwise seen from where it shines; the point; none if far
  Vec3d direction{0};          ///< of a far light, unit, the way light goes
  Vec3d strength{0};           ///< radiosity of a patch, W/m^2; intensity of a point, W/sr; irradiance of a far light
  std::uint32_t patch = 0xffffffffU;  ///< of the faces
  std::uint32_t light = 0;            ///< number in the LightSampler of the scene; not for a patch
};

/// Irradiance at points straight from what emits: where shadows fall, exactly.
///
/// What a point sees of an emitting polygon is what remains when the pyramids over all polygons in between are cut out
/// of it; Lambert's edge sum over the rest is exact. Where more than `most_occluders` polygons may stand in between,
/// rays to points of the lamp decide instead (64, fewer where there are many lamps); also where a round shape does,
/// when its true form is asked for (ShadowRays::tracer). Points, spots (taken as points that shine all around) and far
/// lights get one shadow ray. Every face is opaque. Thread-safe.
class LampIrradiance {
 public:
  static constexpr std::size_t most_occluders = 32;

  /// @param faces the scene's faces as make_element_faces gives them; scene and faces must outlive this. Of the patches
  /// that emit only those with the largest power count: 99 % of it, at most `most_lamps`.
  LampIrradiance(const Scene& scene, const PatchMesh& faces, std::size_t most_lamps = 16);

  [[nodiscard]] std::span<const Lamp> lamps() const { return lamps_; }
  /// Other lamps instead: patches of the faces or parts of them that send out light at the moment, and those of before.
  /// Not while a View is in use.
  void set_lamps(std::vector<Lamp> lamps) { lamps_ = std::move(lamps); }
  [[nodiscard]] const PatchMesh& faces() const { return faces_; }
  /// Triangles of the faces, and the patch that each is a part of.
  [[nodiscard]] const RayTracer& tracer() const { return *tracer_; }
  [[nodiscard]] std::uint32_t patch_of_triangle(std::uint32_t triangle) const { return patch_of_triangle_[triangle]; }
  /// Bound on a coordinate's rounding in the tracer, m.
  [[nodiscard]] double rounding() const { return rounding_; }

  /// Rays to points of a lamp, where they decide.
  struct ShadowRays {
    std::uint64_t key = 0;    ///< of the points: the same everywhere, or another for each look, so that looks average
    std::uint32_t count = 0;  ///< to each lamp; 0: 16 to 64
    /// Of the scene, whose round shapes then stand in the way as they are, not as polygons; none: the faces.
    const RayTracer* tracer = nullptr;
  };
  /// Irradiance of a free point on a side, W/m^2: what is seen of lamps is decided by rays.
  /// @param geometric unit normal of the surface there. @param normal unit, that which the light is weighed by.
  [[nodiscard]] Vec3d at(const Vec3d& point, const Vec3d& geometric, const Vec3d& normal, const ShadowRays& rays) const;

  /// What may stand between each lamp and a polygon, listed once for many points.
  class View {
   public:
    /// Irradiance of a point of the polygon on the side of its normal, W/m^2, red, green, blue.
    [[nodiscard]] Vec3d at(const Vec3d& point) const { return at(point, ShadowRays{}); }
    [[nodiscard]] Vec3d at(const Vec3d& point, const ShadowRays& rays) const;
    /// Whether any lamp has a part on the lit side.
    [[nodiscard]] bool is_lit() const { return !seen_.empty(); }

   private:
    friend class LampIrradiance;
    struct Seen {
      std::uint32_t lamp;
      std::vector<std::vector<Vec3d>> occluders;  // in front of the receiver and of the lamp
      bool by_rays = false;
      bool is_round = false;  // polygons of a round shape are among the occluders
    };
    const LampIrradiance* owner_ = nullptr;
    Vec3d normal_{0};
    std::vector<Seen> seen_;
  };
  /// @param receiver a convex polygon on the scene's faces (a patch of the faces, or part of one).
  [[nodiscard]] View view(std::span<const Vec3d> receiver) const;

 private:
  void add_patches(std::size_t most_lamps);
  void add_lights();
  void list_occluders(std::span<const Vec3d> receiver, const Plane3& plane, View::Seen& seen) const;
  [[nodiscard]] double visible_factor(const Vec3d& point, const Vec3d& normal, const View::Seen& seen) const;
  [[nodiscard]] double sampled_factor(const Vec3d& point, const Vec3d& geometric, const Vec3d& normal, const Lamp& lamp,
                                      const ShadowRays& shadow) const;
  [[nodiscard]] Vec3d without_body(const Vec3d& point, const Vec3d& geometric, const Vec3d& normal, const Lamp& lamp,
                                   const ShadowRays& shadow) const;
  [[nodiscard]] bool is_hidden(const Vec3d& point, const Vec3d& normal, const Vec3d& direction, double distance,
                               const ShadowRays& shadow) const;

  const Scene& scene_;
  const PatchMesh& faces_;
  LightSampler sampler_;
  std::vector<Lamp> lamps_;
  std::unique_ptr<Scene> occluders_;
  std::unique_ptr<RayTracer> tracer_;
  std::vector<std::uint32_t> patch_of_triangle_;
  std::vector<Bounds> bounds_;  // by patch
  BoxTree tree_;                // of patches, fronts only
  double rounding_ = 0;
  double size_ = 0;
};

}  // namespace penumbra
