#pragma once

#include <memory>
#include <optional>
#include <vector>

#include "penumbra/radiosity/meshing/shading_mesh.h"
#include "penumbra/tracing/ray_tracer.h"

namespace penumbra {

/// The elements of a shading mesh as rays meet them: of two sides in one place, the one that faces the ray.
/// Thread-safe.
class ElementSight {
 public:
  /// A place on an element.
  struct Place {
    double distance = 0;         ///< along the ray, m
    std::uint32_t triangle = 0;  ///< of the shading mesh
    std::uint32_t element = 0;
    double weights[3]{};  ///< of the triangle's corners; sum 1
    bool faces = false;   ///< the element's own side was met
  };

  /// Shading mesh and normals are read here alone. @param normals unit, of the elements.
  ElementSight(const ShadingMesh& shading, std::span<const Vec3d> normals);

  /// What a ray meets first.
  [[nodiscard]] std::optional<Place> nearest(const Ray& ray) const;
  /// The element's side that lies at a point of a surface and looks to `side` (unit), within `reach` (m) along it.
  [[nodiscard]] std::optional<Place> at(const Vec3d& point, const Vec3d& side, double reach) const;

 private:
  /// Elements whose normals lie in one half of all directions: a face and its back never in the same.
  struct Half {
    std::unique_ptr<Scene> scene;
    std::unique_ptr<RayTracer> tracer;
    std::vector<std::uint32_t> triangles;  // of the shading mesh
  };
  [[nodiscard]] Half make_half(const ShadingMesh& shading, bool positive) const;
  [[nodiscard]] std::optional<Place> meet(const Half& half, const Ray& ray) const;

  std::vector<Vec3d> normals_;
  std::vector<std::uint32_t> element_of_triangle_;
  Half halves_[2];
};

}  // namespace penumbra
