#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "penumbra/radiosity/patch_mesh.h"
#include "penumbra/radiosity/patch_tracer.h"
#include "penumbra/radiosity/specular/specular_surfaces.h"
#include "penumbra/tracing/shading/environment_map.h"
#include "penumbra/tracing/shading/light_sampling.h"
#include "penumbra/tracing/shading/specular_tree.h"

namespace penumbra {

/// A specular element as another one sees it.
struct SpecularSight {
  std::uint32_t element = 0;
  double factor = 0;  ///< form factor to it, 0..1
};

/// Where rays that started at mirrors and glass ended.
struct SpecularLandings {
  struct Landing {
    std::uint32_t element;
    Vec3f weight;  ///< share, per band
  };
  struct Half {
    std::vector<Landing> landings;  ///< in the order of rays
    Vec3d left{0};                  ///< share that left the scene
    Vec3d sky{0};                   ///< pi times the environment's radiance that the rays see, by their shares, W/m^2
  };
  std::array<Half, 2> halves;  ///< two independent estimates of the same
  std::uint64_t rays = 0;
};

/// Follows light between elements by way of mirrors and glass. Thread-safe.
class SpecularPaths {
 public:
  /// Everything must outlive this. @param front_sides_only backs of opaque surfaces are black.
  SpecularPaths(const Scene& scene, const PatchMesh& elements, bool front_sides_only, std::uint64_t seed);

  /// Light that an element exchanges with others by way of the specular elements that it sees: `rays` stratified rays
  /// go there, the recursion of Whitted goes on, and where it lands on an element its weight is noted. The shares of
  /// all rays together are the form factors to the specular elements, however many rays get there.
  [[nodiscard]] SpecularLandings cast(std::uint32_t element, std::span<const SpecularSight> seen, int rays) const;

  /// Power of a light without a body that ends on elements by way of mirrors and glass, W for each unit of its
  /// strength in a band (the largest band of its intensity or irradiance is its unit). @param light number in lights().
  [[nodiscard]] SpecularLandings shoot(std::size_t light, std::span<const std::uint32_t> targets, int rays) const;

  [[nodiscard]] const LightSampler& lights() const { return lights_; }

 private:
  class Walker;
  struct Sender;
  bool aim(const Sender& from, std::uint32_t index, std::uint64_t key, Walker& walker, double& met) const;
  [[nodiscard]] Vec3d on_surface(std::uint32_t element, const Vec3d& point) const;
  [[nodiscard]] std::uint32_t landing(const SurfacePoint& point, const Vec3d& wo) const;

  const Scene& scene_;
  const PatchMesh& elements_;
  RayTracer tracer_;
  SpecularTree tree_;
  PatchTracer patches_;
  LightSampler lights_;
  std::uint64_t seed_;
  double size_ = 1;  // of the scene, m
};

}  // namespace penumbra
