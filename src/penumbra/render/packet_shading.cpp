#include "penumbra/render/packet_shading.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <numbers>

#include "penumbra/render/lane_loops.h"

namespace penumbra {
namespace {

constexpr int n = RayPacket::size;
constexpr auto rounding = static_cast<float>(float_error);
constexpr float end_margin = 1 - 4 * 0x1p-24F;

}  // namespace

PENUMBRA_CLONES void aim_camera(const RasterDirections& camera, const Lanes& x, const Lanes& y,
                                RayPacket& __restrict rays) {
  for (std::size_t i = 0; i < n; ++i) {
    const float dx = camera.corner.x + x[i] * camera.step_x.x + y[i] * camera.step_y.x;
    const float dy = camera.corner.y + x[i] * camera.step_x.y + y[i] * camera.step_y.y;
    const float dz = camera.corner.z + x[i] * camera.step_x.z + y[i] * camera.step_y.z;
    const float inverse = 1 / std::sqrt(dx * dx + dy * dy + dz * dz);
    rays.direction_x[i] = dx * inverse;
    rays.direction_y[i] = dy * inverse;
    rays.direction_z[i] = dz * inverse;
    rays.origin_x[i] = camera.eye.x;
    rays.origin_y[i] = camera.eye.y;
    rays.origin_z[i] = camera.eye.z;
    rays.t_min[i] = 0;
    rays.t_max[i] = std::numeric_limits<float>::infinity();
  }
}

PENUMBRA_CLONES void shade_points(const RayPacket& rays, const HitTriangles& hits, PointLanes& __restrict points) {
  for (std::size_t i = 0; i < n; ++i) {
    const float v0x = hits.v0.x[i], v0y = hits.v0.y[i], v0z = hits.v0.z[i];
    const float ax = hits.v1.x[i] - v0x, ay = hits.v1.y[i] - v0y, az = hits.v1.z[i] - v0z;
    const float bx = hits.v2.x[i] - v0x, by = hits.v2.y[i] - v0y, bz = hits.v2.z[i] - v0z;
    const float u = hits.u[i], v = hits.v[i];
    const float px = v0x + u * ax + v * bx, py = v0y + u * ay + v * by, pz = v0z + u * az + v * bz;
    const float edge = std::max(std::max(std::max(std::abs(ax), std::abs(ay)), std::abs(az)),
                                std::max(std::max(std::abs(bx), std::abs(by)), std::abs(bz)));
    const float reach = std::max(std::max(std::abs(v0x), std::abs(v0y)), std::abs(v0z));
    float gx = ay * bz - az * by, gy = az * bx - ax * bz, gz = ax * by - ay * bx;
    const float scale = hits.mirror[i] / std::sqrt(std::max(gx * gx + gy * gy + gz * gz, 1e-37F));
    gx *= scale;
    gy *= scale;
    gz *= scale;
    const float dx = rays.direction_x[i], dy = rays.direction_y[i], dz = rays.direction_z[i];
    const float towards = gx * dx + gy * dy + gz * dz;
    const float side = towards < 0 ? 1.0F : -1.0F;
    gx *= side;
    gy *= side;
    gz *= side;
    float nx = hits.normal.x[i], ny = hits.normal.y[i], nz = hits.normal.z[i];
    const float along = nx * gx + ny * gy + nz * gz;
    const float size = nx * nx + ny * ny + nz * nz;
    const bool smooth = (hits.smooth[i] != 0) & (size > 1e-30F);
    const float turn = (along < 0 ? -1.0F : 1.0F) / std::sqrt(std::max(size, 1e-37F));
    nx = smooth ? nx * turn : gx;
    ny = smooth ? ny * turn : gy;
    nz = smooth ? nz * turn : gz;
    points.position.x[i] = px;
    points.position.y[i] = py;
    points.position.z[i] = pz;
    points.geometric.x[i] = gx;
    points.geometric.y[i] = gy;
    points.geometric.z[i] = gz;
    points.normal.x[i] = nx;
    points.normal.y[i] = ny;
    points.normal.z[i] = nz;
    // Clearance along the normal of an error box with equal sides.
    points.error[i] = rounding * (reach + 2 * edge) * (std::abs(gx) + std::abs(gy) + std::abs(gz));
    points.front[i] = towards < 0 ? 1.0F : 0.0F;
    points.facing[i] = -(nx * dx + ny * dy + nz * dz);
  }
}

PENUMBRA_CLONES void shade_shapes(const RayPacket& rays, const HitShapes& hits, PointLanes& __restrict points) {
  for (std::size_t i = 0; i < n; ++i) {
    const float dx = rays.direction_x[i], dy = rays.direction_y[i], dz = rays.direction_z[i];
    const float t = hits.t[i], r = hits.radius[i], flat = hits.flat[i], round = 1 - hits.flat[i];
    const float cx = hits.centre.x[i], cy = hits.centre.y[i], cz = hits.centre.z[i];
    // From the centre, or from the plane's point.
    const float ox = rays.origin_x[i] + t * dx - cx, oy = rays.origin_y[i] + t * dy - cy,
                oz = rays.origin_z[i] + t * dz - cz;
    const float scale = round / std::sqrt(std::max(ox * ox + oy * oy + oz * oz, 1e-37F));
    const float mx = flat * hits.normal.x[i] + scale * ox, my = flat * hits.normal.y[i] + scale * oy,
                mz = flat * hits.normal.z[i] + scale * oz;
    // Moved onto the shape.
    const float off = ox * mx + oy * my + oz * mz;
    const float px = cx + flat * (ox - off * mx) + r * mx, py = cy + flat * (oy - off * my) + r * my,
                pz = cz + flat * (oz - off * mz) + r * mz;
    const float towards = mx * dx + my * dy + mz * dz;
    const float side = towards < 0 ? 1.0F : -1.0F;
    const float reach = std::max(std::max(std::abs(px), std::abs(py)), std::abs(pz)) + r;
    points.position.x[i] = px;
    points.position.y[i] = py;
    points.position.z[i] = pz;
    points.normal.x[i] = points.geometric.x[i] = side * mx;
    points.normal.y[i] = points.geometric.y[i] = side * my;
    points.normal.z[i] = points.geometric.z[i] = side * mz;
    points.error[i] = rounding * reach * (std::abs(mx) + std::abs(my) + std::abs(mz));
    points.front[i] = towards < 0 ? 1.0F : 0.0F;
    points.facing[i] = std::abs(towards);
  }
}

PENUMBRA_CLONES void choose_points(const Lanes& from_others, const PointLanes& others, PointLanes& __restrict points) {
  const auto choose = [&](const Lanes& other, Lanes& own) {
    for (std::size_t i = 0; i < n; ++i) own[i] = pick(from_others[i] != 0, other[i], own[i]);
  };
  choose(others.position.x, points.position.x);
  choose(others.position.y, points.position.y);
  choose(others.position.z, points.position.z);
  choose(others.geometric.x, points.geometric.x);
  choose(others.geometric.y, points.geometric.y);
  choose(others.geometric.z, points.geometric.z);
  choose(others.normal.x, points.normal.x);
  choose(others.normal.y, points.normal.y);
  choose(others.normal.z, points.normal.z);
  choose(others.error, points.error);
  choose(others.front, points.front);
  choose(others.facing, points.facing);
}

PENUMBRA_CLONES void reflect_rays(const RayPacket& rays, const PointLanes& points, BounceLanes& __restrict reflected) {
  for (std::size_t i = 0; i < n; ++i) {
    const float nx = points.normal.x[i], ny = points.normal.y[i], nz = points.normal.z[i];
    const float gx = points.geometric.x[i], gy = points.geometric.y[i], gz = points.geometric.z[i];
    const float twice = 2 * points.facing[i];
    const float x = rays.direction_x[i] + twice * nx;
    const float y = rays.direction_y[i] + twice * ny;
    const float z = rays.direction_z[i] + twice * nz;
    const float scale = 1 / std::sqrt(std::max(x * x + y * y + z * z, 1e-37F));
    reflected.origin.x[i] = points.position.x[i] + points.error[i] * gx;
    reflected.origin.y[i] = points.position.y[i] + points.error[i] * gy;
    reflected.origin.z[i] = points.position.z[i] + points.error[i] * gz;
    reflected.direction.x[i] = x * scale;
    reflected.direction.y[i] = y * scale;
    reflected.direction.z[i] = z * scale;
    const bool goes = (x * gx + y * gy + z * gz > 0) & (points.facing[i] > 0);
    reflected.chance[i] = goes ? 1.0F : 0.0F;
  }
}

PENUMBRA_CLONES void split_rays(const RayPacket& rays, const PointLanes& points, const Lanes& ior,
                                BounceLanes& __restrict reflected, BounceLanes& __restrict refracted) {
  reflect_rays(rays, points, reflected);
  for (std::size_t i = 0; i < n; ++i) {
    const float nx = points.normal.x[i], ny = points.normal.y[i], nz = points.normal.z[i];
    const float gx = points.geometric.x[i], gy = points.geometric.y[i], gz = points.geometric.z[i];
    const float cosine = std::min(points.facing[i], 1.0F);
    const float eta = points.front[i] != 0 ? ior[i] : 1 / ior[i];
    const float below = eta * eta - 1 + cosine * cosine;  // (eta cos of refraction)^2
    const float root = std::sqrt(std::max(below, 0.0F));
    const float s = (cosine - root) / (cosine + root);
    const float p = (eta * eta * cosine - root) / (eta * eta * cosine + root);
    const bool total = !(below > 0);
    const float fresnel = total ? 1.0F : 0.5F * (s * s + p * p);
    const float inverse = 1 / eta;
    const float along = (cosine - root) * inverse;
    const float x = rays.direction_x[i] * inverse + along * nx;
    const float y = rays.direction_y[i] * inverse + along * ny;
    const float z = rays.direction_z[i] * inverse + along * nz;
    const float scale = 1 / std::sqrt(std::max(x * x + y * y + z * z, 1e-37F));
    refracted.origin.x[i] = points.position.x[i] - points.error[i] * gx;
    refracted.origin.y[i] = points.position.y[i] - points.error[i] * gy;
    refracted.origin.z[i] = points.position.z[i] - points.error[i] * gz;
    refracted.direction.x[i] = x * scale;
    refracted.direction.y[i] = y * scale;
    refracted.direction.z[i] = z * scale;
    const bool goes = !total & (x * gx + y * gy + z * gz < 0) & (points.facing[i] > 0);
    refracted.chance[i] = goes ? 1 - fresnel : 0.0F;
    reflected.chance[i] *= fresnel;
  }
}

PENUMBRA_CLONES void pass_straight(const PointLanes& points, const Lanes& ior, RayPacket& __restrict rays,
                                   Lanes& __restrict through) {
  for (std::size_t i = 0; i < n; ++i) {
    const float gx = points.geometric.x[i], gy = points.geometric.y[i], gz = points.geometric.z[i];
    const float dx = rays.direction_x[i], dy = rays.direction_y[i], dz = rays.direction_z[i];
    const float cosine = std::min(std::abs(dx * gx + dy * gy + dz * gz), 1.0F);
    const float eta = ior[i];
    const float root = std::sqrt(std::max(eta * eta - 1 + cosine * cosine, 0.0F));
    const float s = (cosine - root) / std::max(cosine + root, 1e-20F);
    const float p = (eta * eta * cosine - root) / std::max(eta * eta * cosine + root, 1e-20F);
    through[i] = 1 - 0.5F * (s * s + p * p);
    const float ox = points.position.x[i] - points.error[i] * gx, oy = points.position.y[i] - points.error[i] * gy,
                oz = points.position.z[i] - points.error[i] * gz;
    rays.t_max[i] -= (ox - rays.origin_x[i]) * dx + (oy - rays.origin_y[i]) * dy + (oz - rays.origin_z[i]) * dz;
    rays.origin_x[i] = ox;
    rays.origin_y[i] = oy;
    rays.origin_z[i] = oz;
    rays.t_min[i] = 0;
  }
}

PENUMBRA_CLONES void aim_at_area(const PointLanes& points, const LightLanes& light, const std::int32_t* lit_lanes,
                                 RayPacket& __restrict shadow, Lanes& __restrict geometry) {
  for (std::size_t i = 0; i < n; ++i) {
    const float ox = points.position.x[i] + points.error[i] * points.geometric.x[i];
    const float oy = points.position.y[i] + points.error[i] * points.geometric.y[i];
    const float oz = points.position.z[i] + points.error[i] * points.geometric.z[i];
    const float lx = light.normal.x[i], ly = light.normal.y[i], lz = light.normal.z[i];
    float tx = light.position.x[i], ty = light.position.y[i], tz = light.position.z[i];
    // The end is moved out of the light's own error box, to the side of the surface.
    const float out = lx * (ox - tx) + ly * (oy - ty) + lz * (oz - tz);
    const float reach =
        std::max(std::max(std::abs(tx), std::abs(ty)), std::abs(tz)) + std::sqrt(light.inverse_density[i]);
    const float lift = (out < 0 ? -2.0F : 2.0F) * rounding * reach;
    tx += lift * lx;
    ty += lift * ly;
    tz += lift * lz;
    const float wx = tx - ox, wy = ty - oy, wz = tz - oz;
    const float r2 = std::max(wx * wx + wy * wy + wz * wz, 1e-37F);
    const float inverse = 1 / std::sqrt(r2);
    const float dx = wx * inverse, dy = wy * inverse, dz = wz * inverse;
    const float cos_light = -(dx * lx + dy * ly + dz * lz);
    const float emitting = std::max(cos_light, -cos_light * light.both_sides[i]);
    const float cos_surface = dx * points.normal.x[i] + dy * points.normal.y[i] + dz * points.normal.z[i];
    const float above = dx * points.geometric.x[i] + dy * points.geometric.y[i] + dz * points.geometric.z[i];
    const bool reaches = (lit_lanes[i] != 0) & (emitting > 0) & (cos_surface > 0) & (above > 0);
    geometry[i] = reaches ? emitting * cos_surface * light.inverse_density[i] / r2 : 0.0F;
    shadow.origin_x[i] = ox;
    shadow.origin_y[i] = oy;
    shadow.origin_z[i] = oz;
    shadow.direction_x[i] = dx;
    shadow.direction_y[i] = dy;
    shadow.direction_z[i] = dz;
    shadow.t_min[i] = 0;
    shadow.t_max[i] = r2 * inverse * end_margin;
    shadow.active[i] = reaches ? -1 : 0;
  }
}

PENUMBRA_CLONES void aim_at_point(const PointLanes& points, const LightLanes& light, bool far, bool inverse_square,
                                  float range, const std::int32_t* lit_lanes, RayPacket& __restrict shadow,
                                  Lanes& __restrict geometry) {
  const float is_far = far ? 1.0F : 0.0F;
  const float falls = !far && inverse_square ? 1.0F : 0.0F;
  const float constant = far ? 1.0F : std::numbers::pi_v<float>;
  const float inverse_range = range > 0 ? 1 / range : 0.0F;
  const float farthest = far ? std::numeric_limits<float>::infinity() : 0.0F;
  for (std::size_t i = 0; i < n; ++i) {
    const float ox = points.position.x[i] + points.error[i] * points.geometric.x[i];
    const float oy = points.position.y[i] + points.error[i] * points.geometric.y[i];
    const float oz = points.position.z[i] + points.error[i] * points.geometric.z[i];
    const float wx = light.position.x[i] - (1 - is_far) * ox;
    const float wy = light.position.y[i] - (1 - is_far) * oy;
    const float wz = light.position.z[i] - (1 - is_far) * oz;
    const float r2 = std::max(wx * wx + wy * wy + wz * wz, 1e-37F);
    const float inverse = 1 / std::sqrt(r2);
    const float dx = wx * inverse, dy = wy * inverse, dz = wz * inverse;
    const float cos_surface = dx * points.normal.x[i] + dy * points.normal.y[i] + dz * points.normal.z[i];
    const float above = dx * points.geometric.x[i] + dy * points.geometric.y[i] + dz * points.geometric.z[i];
    const float q = r2 * inverse_range * inverse_range;
    const float window = std::max(0.0F, 1 - q * q);
    const float strength = falls * (window / r2) + (1 - falls) * constant;
    const bool reaches = (lit_lanes[i] != 0) & (cos_surface > 0) & (above > 0) & (strength > 0);
    geometry[i] = reaches ? cos_surface * strength : 0.0F;
    shadow.origin_x[i] = ox;
    shadow.origin_y[i] = oy;
    shadow.origin_z[i] = oz;
    shadow.direction_x[i] = dx;
    shadow.direction_y[i] = dy;
    shadow.direction_z[i] = dz;
    shadow.t_min[i] = 0;
    shadow.t_max[i] = std::max(r2 * inverse * end_margin, farthest);
    shadow.active[i] = reaches ? -1 : 0;
  }
}

PENUMBRA_CLONES void add_light(const ColourLanes& reflectance, const ColourLanes& light, const ColourLanes& passed,
                               const Lanes& geometry, const RayPacket& shadow, ColourLanes& __restrict radiance) {
  for (std::size_t i = 0; i < n; ++i) {
    const float arrives = shadow.active[i] != 0 ? geometry[i] * std::numbers::inv_pi_v<float> : 0.0F;
    radiance.r[i] += reflectance.r[i] * light.r[i] * passed.r[i] * arrives;
    radiance.g[i] += reflectance.g[i] * light.g[i] * passed.g[i] * arrives;
    radiance.b[i] += reflectance.b[i] * light.b[i] * passed.b[i] * arrives;
  }
}

PENUMBRA_CLONES void add_ambient(const ColourLanes& reflectance, const Rgb& ambient, ColourLanes& __restrict radiance) {
  for (std::size_t i = 0; i < n; ++i) {
    radiance.r[i] += ambient.x * reflectance.r[i];
    radiance.g[i] += ambient.y * reflectance.g[i];
    radiance.b[i] += ambient.z * reflectance.b[i];
  }
}

}  // namespace penumbra
