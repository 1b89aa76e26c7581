#pragma once

#include "penumbra/render/film.h"
#include "penumbra/tracing/shading/bsdf.h"

namespace penumbra {

/// Notes what the layers hold of the first surface that a camera ray met.
/// @param direct radiance of the picture that came by this surface alone.
inline void note_surface(PixelEstimate& seen, const Ray& ray, const SurfacePoint& point, const SurfaceMaterial& surface,
                         const Bsdf& bsdf, const Rgb& direct) {
  seen.direct = direct;
  const SpecularSplit split = bsdf.specular_split(-ray.direction, 1.0);
  seen.albedo = glm::min(Rgb(1), bsdf.diffuse_reflectance() + split.reflected + split.refracted);
  seen.normal = Vec3f(surface.shading.normal);
  seen.position = Vec3f(point.position);
  seen.depth = static_cast<float>(length(point.position - ray.origin));
  seen.object = static_cast<float>(point.object);
}

/// Notes that a camera ray left the scene.
inline void note_miss(PixelEstimate& seen, const Rgb& sky) {
  seen.direct = sky;
  seen.depth = std::numeric_limits<float>::infinity();
}

}  // namespace penumbra
