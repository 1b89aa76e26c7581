#pragma once

#include "penumbra/math/ray.h"
#include "penumbra/tracing/ray_tracer.h"

namespace penumbra {

/// How a ray changes from one sample of the picture to its neighbour on the right (x) and below (y), to first order:
/// Igehy, "Tracing Ray Differentials", SIGGRAPH 1999.
struct RayDifferential {
  Vec3d origin_x{0}, origin_y{0};        ///< m
  Vec3d direction_x{0}, direction_y{0};  ///< of the unit direction
};

/// What a sample covers of a surface: the steps from where its ray meets it to where its neighbours' rays do, m.
struct Footprint {
  Vec3d x{0}, y{0};
};

/// Transfer (Igehy's equation 10): where the neighbours' rays meet the plane that the surface has at `point`.
[[nodiscard]] Footprint footprint_of(const Ray& ray, const RayDifferential& differential, const SurfacePoint& point);

/// Of a ray that goes straight on through the surface.
[[nodiscard]] RayDifferential passed_on(const RayDifferential& differential, const Footprint& footprint);

/// Of the mirror ray (equations 14 and 15). @param normal the unit normal about which it is reflected.
[[nodiscard]] RayDifferential reflected(const RayTracer& tracer, const Ray& ray, const RayDifferential& differential,
                                        const Footprint& footprint, const SurfacePoint& point, const Vec3d& normal);

/// Of the refracted ray (equations 16 to 19). @param direction where it goes, unit.
/// @param eta index of refraction on the ray's side over that beyond; read at normal incidence only, since elsewhere
/// the two directions tell it.
[[nodiscard]] RayDifferential refracted(const RayTracer& tracer, const Ray& ray, const RayDifferential& differential,
                                        const Footprint& footprint, const SurfacePoint& point, const Vec3d& normal,
                                        const Vec3d& direction, double eta);

}  // namespace penumbra
