#pragma once

#include <array>

#include "penumbra/tracing/ray_tracer.h"

namespace penumbra {

/// Sixteen values side by side.
using Lanes = std::array<float, RayPacket::size>;

/// Sixteen vectors side by side.
struct alignas(64) VectorLanes {
  Lanes x, y, z;

  void set(int lane, const Vec3f& v) {
    const auto i = static_cast<std::size_t>(lane);
    x[i] = v.x;
    y[i] = v.y;
    z[i] = v.z;
  }
};

/// Sixteen colours side by side.
struct alignas(64) ColourLanes {
  Lanes r, g, b;

  void set(std::size_t lane, const Rgb& c) { r[lane] = c.x, g[lane] = c.y, b[lane] = c.z; }
  [[nodiscard]] Rgb get(std::size_t lane) const { return {r[lane], g[lane], b[lane]}; }
};

/// The triangles that a packet's rays hit, as gathered lane by lane.
struct alignas(64) HitTriangles {
  VectorLanes v0, v1, v2;
  VectorLanes normal;  ///< interpolated shading normal; ignored where `smooth` is 0
  Lanes u, v;
  Lanes smooth;  ///< 1 where the mesh has normals
  Lanes mirror;  ///< -1 where the instance mirrors, else 1
};

/// The spheres and planes that a packet's rays hit.
struct alignas(64) HitShapes {
  VectorLanes centre;  ///< of a sphere; a point of a plane
  VectorLanes normal;  ///< of a plane; finite in all lanes that count
  Lanes radius;        ///< 0 of a plane
  Lanes flat;          ///< 1 where it is a plane, 0 where a sphere
  Lanes t;
  Lanes met{};  ///< 1 in lanes that hit a shape, else 0
};

/// Surface points of a packet, as shading needs them.
struct alignas(64) PointLanes {
  VectorLanes position;
  VectorLanes normal;     ///< shading, unit, on the side of the ray's origin
  VectorLanes geometric;  ///< geometric, unit, on the side of the ray's origin
  Lanes error;            ///< how far a ray's origin must move along `geometric`, m
  Lanes front;            ///< 1 where the front was hit, else 0
  Lanes facing;           ///< cosine of the shading normal with the way back; <= 0 where it is turned away
};

/// A light's points for each lane, and what they send.
struct alignas(64) LightLanes {
  VectorLanes position;  ///< or direction towards a far light
  VectorLanes normal;
  Lanes both_sides;       ///< 1 where both sides emit
  Lanes inverse_density;  ///< m^2
};

/// A camera's directions over a raster, single precision: (corner + x step_x + y step_y), not unit, but one unit long
/// along `forward`, which is.
struct RasterDirections {
  Vec3f eye{0}, corner{0}, step_x{0}, step_y{0}, forward{0};
};

/// Rays of a perspective camera through raster positions `x`, `y` (pixels), from `t` 0 to infinity.
void aim_camera(const RasterDirections& camera, const Lanes& x, const Lanes& y, RayPacket& rays);

/// Works out points and normals from triangles hit. @param rays where the rays came from.
void shade_points(const RayPacket& rays, const HitTriangles& hits, PointLanes& points);

/// The same from spheres and planes hit.
void shade_shapes(const RayPacket& rays, const HitShapes& hits, PointLanes& points);
/// Takes the lanes of others where `from_others` is not 0.
void choose_points(const Lanes& from_others, const PointLanes& others, PointLanes& points);

/// Where rays leave to, mirrored about the shading normal; `chance` is 1, or 0 where the mirror image lies behind the
/// surface.
struct alignas(64) BounceLanes {
  VectorLanes origin;
  VectorLanes direction;
  Lanes chance;
};
void reflect_rays(const RayPacket& rays, const PointLanes& points, BounceLanes& reflected);

/// The two rays that leave a smooth dielectric: `chance` is Fresnel's term for unpolarised light, and 1 less it, 0
/// where a ray cannot go. @param ior of the solid behind the front.
void split_rays(const RayPacket& rays, const PointLanes& points, const Lanes& ior, BounceLanes& reflected,
                BounceLanes& refracted);

/// Takes rays straight through the glass that they met: they start beyond it and keep their ends; `through` gets what
/// its surface lets pass, by the cosine outside. @param ior of the glass.
void pass_straight(const PointLanes& points, const Lanes& ior, RayPacket& rays, Lanes& through);

/// Shadow rays from surface points to points of an area light; `geometry` gets cos cos' / (r^2 density), 0 where no
/// light can go. Lanes of `shadow` with geometry 0, or not in `lit_lanes`, sleep.
void aim_at_area(const PointLanes& points, const LightLanes& light, const std::int32_t* lit_lanes, RayPacket& shadow,
                 Lanes& geometry);

/// The same for a light without a body. @param far whether `position` is a direction.
/// @param inverse_square whether light falls off by the squared distance; else by nothing, times pi (see PointLight).
/// @param range m, 0: none.
void aim_at_point(const PointLanes& points, const LightLanes& light, bool far, bool inverse_square, float range,
                  const std::int32_t* lit_lanes, RayPacket& shadow, Lanes& geometry);

/// Light that matt surfaces scatter on: adds reflectance / pi x `light` x `passed` x `geometry` in active lanes of
/// `shadow`. @param passed share of the light that nothing held up.
void add_light(const ColourLanes& reflectance, const ColourLanes& light, const ColourLanes& passed,
               const Lanes& geometry, const RayPacket& shadow, ColourLanes& radiance);
/// Adds what comes of an ambient radiance.
void add_ambient(const ColourLanes& reflectance, const Rgb& ambient, ColourLanes& radiance);

}  // namespace penumbra
