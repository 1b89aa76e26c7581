#include "penumbra/render/packet_differentials.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "penumbra/render/lane_loops.h"

namespace penumbra {
namespace {

constexpr std::size_t n = RayPacket::size;

}  // namespace

// See CameraRays::differential.
PENUMBRA_CLONES void aim_differentials(const RasterDirections& camera, float spacing, const RayPacket& rays,
                                       DifferentialLanes& __restrict to) {
  const Vec3f f = camera.forward, right = camera.step_x, down = camera.step_y;
  for (std::size_t i = 0; i < n; ++i) {
    const float x = rays.direction_x[i], y = rays.direction_y[i], z = rays.direction_z[i];
    const float shrink = spacing * (x * f.x + y * f.y + z * f.z);
    const float along_right = x * right.x + y * right.y + z * right.z;
    const float along_down = x * down.x + y * down.y + z * down.z;
    to.direction_x.x[i] = shrink * (right.x - along_right * x);
    to.direction_x.y[i] = shrink * (right.y - along_right * y);
    to.direction_x.z[i] = shrink * (right.z - along_right * z);
    to.direction_y.x[i] = shrink * (down.x - along_down * x);
    to.direction_y.y[i] = shrink * (down.y - along_down * y);
    to.direction_y.z[i] = shrink * (down.z - along_down * z);
    to.origin_x.x[i] = to.origin_x.y[i] = to.origin_x.z[i] = 0;
    to.origin_y.x[i] = to.origin_y.y[i] = to.origin_y.z[i] = 0;
  }
}

namespace {

// Where neighbours' rays meet the surface's plane.
inline void meet_plane(const RayPacket& rays, const VectorLanes& origin, const VectorLanes& direction,
                       const PointLanes& points, VectorLanes& __restrict met) {
  for (std::size_t i = 0; i < n; ++i) {
    const float dx = rays.direction_x[i], dy = rays.direction_y[i], dz = rays.direction_z[i];
    const float gx = points.geometric.x[i], gy = points.geometric.y[i], gz = points.geometric.z[i];
    const float t = (points.position.x[i] - rays.origin_x[i]) * dx + (points.position.y[i] - rays.origin_y[i]) * dy +
                    (points.position.z[i] - rays.origin_z[i]) * dz;
    const float ax = origin.x[i] + t * direction.x[i], ay = origin.y[i] + t * direction.y[i],
                az = origin.z[i] + t * direction.z[i];
    const float back = (ax * gx + ay * gy + az * gz) / (dx * gx + dy * gy + dz * gz);
    met.x[i] = ax - back * dx;
    met.y[i] = ay - back * dy;
    met.z[i] = az - back * dz;
  }
}

}  // namespace

PENUMBRA_CLONES void find_footprints(const RayPacket& rays, const DifferentialLanes& differentials,
                                     const PointLanes& points, FootprintLanes& __restrict footprints) {
  meet_plane(rays, differentials.origin_x, differentials.direction_x, points, footprints.x);
  meet_plane(rays, differentials.origin_y, differentials.direction_y, points, footprints.y);
}

PENUMBRA_CLONES void bend_normals(const PointLanes& points, const Lanes& curvature, const FootprintLanes& footprints,
                                  FootprintLanes& __restrict changes) {
  for (std::size_t i = 0; i < n; ++i) {
    const float bend = curvature[i] * (2 * points.front[i] - 1);
    changes.x.x[i] = bend * footprints.x.x[i];
    changes.x.y[i] = bend * footprints.x.y[i];
    changes.x.z[i] = bend * footprints.x.z[i];
    changes.y.x[i] = bend * footprints.y.x[i];
    changes.y.y[i] = bend * footprints.y.y[i];
    changes.y.z[i] = bend * footprints.y.z[i];
  }
}

namespace {

// D' = D - 2 (D.N) N, differentiated (Igehy 1999, equation 15).
inline void reflect_change(const RayPacket& rays, const PointLanes& points, const VectorLanes& before,
                           const VectorLanes& bend, VectorLanes& __restrict after) {
  for (std::size_t i = 0; i < n; ++i) {
    const float dx = rays.direction_x[i], dy = rays.direction_y[i], dz = rays.direction_z[i];
    const float nx = points.normal.x[i], ny = points.normal.y[i], nz = points.normal.z[i];
    const float bx = bend.x[i], by = bend.y[i], bz = bend.z[i];
    const float cosine = -points.facing[i];
    const float change = before.x[i] * nx + before.y[i] * ny + before.z[i] * nz + dx * bx + dy * by + dz * bz;
    after.x[i] = before.x[i] - 2 * (cosine * bx + change * nx);
    after.y[i] = before.y[i] - 2 * (cosine * by + change * ny);
    after.z[i] = before.z[i] - 2 * (cosine * bz + change * nz);
  }
}

// D' = eta D - mu N with mu = eta D.N - D'.N, differentiated (Igehy 1999, equations 18 and 19).
inline void refract_change(const RayPacket& rays, const PointLanes& points, const BounceLanes& beyond, const Lanes& ior,
                           const VectorLanes& before, const VectorLanes& bend, VectorLanes& __restrict after) {
  for (std::size_t i = 0; i < n; ++i) {
    const float dx = rays.direction_x[i], dy = rays.direction_y[i], dz = rays.direction_z[i];
    const float nx = points.normal.x[i], ny = points.normal.y[i], nz = points.normal.z[i];
    const float bx = bend.x[i], by = bend.y[i], bz = bend.z[i];
    const float eta = points.front[i] != 0 ? 1 / ior[i] : ior[i];
    const float cosine = -points.facing[i];
    const float cosine_beyond = beyond.direction.x[i] * nx + beyond.direction.y[i] * ny + beyond.direction.z[i] * nz;
    const float mu = eta * cosine - cosine_beyond;
    const float slope = eta - eta * eta * cosine / cosine_beyond;
    const float change = slope * (before.x[i] * nx + before.y[i] * ny + before.z[i] * nz + dx * bx + dy * by + dz * bz);
    after.x[i] = eta * before.x[i] - mu * bx - change * nx;
    after.y[i] = eta * before.y[i] - mu * by - change * ny;
    after.z[i] = eta * before.z[i] - mu * bz - change * nz;
  }
}

}  // namespace

PENUMBRA_CLONES void reflect_differentials(const RayPacket& rays, const PointLanes& points,
                                           const DifferentialLanes& differentials, const FootprintLanes& footprints,
                                           const FootprintLanes& changes, DifferentialLanes& __restrict reflected) {
  reflected.origin_x = footprints.x;
  reflected.origin_y = footprints.y;
  reflect_change(rays, points, differentials.direction_x, changes.x, reflected.direction_x);
  reflect_change(rays, points, differentials.direction_y, changes.y, reflected.direction_y);
}

PENUMBRA_CLONES void refract_differentials(const RayPacket& rays, const PointLanes& points,
                                           const DifferentialLanes& differentials, const FootprintLanes& footprints,
                                           const FootprintLanes& changes, const BounceLanes& beyond, const Lanes& ior,
                                           DifferentialLanes& __restrict refracted) {
  refracted.origin_x = footprints.x;
  refracted.origin_y = footprints.y;
  refract_change(rays, points, beyond, ior, differentials.direction_x, changes.x, refracted.direction_x);
  refract_change(rays, points, beyond, ior, differentials.direction_y, changes.y, refracted.direction_y);
}

namespace {

constexpr float most_boxes = 64;
constexpr float narrowest_box = 0.25F;  // squares; see checker.cpp

// Integral from 0 to x of the wave that is +1 where floor(x) is even and -1 where it is odd.
inline float wave_integral(float x) {
  const float phase = x - 2 * std::floor(0.5F * x);
  return phase < 1 ? phase : 2 - phase;
}

// The mean of that wave over a box. One that is narrower than a square holds at most one border, which is measured from
// its middle, so that rounding does not matter.
inline float mean_wave(float middle, float width) {
  const float border = std::floor(middle + 0.5F);
  const float parity = border - 2 * std::floor(0.5F * border);
  const float from_border = 2 * (middle - border) / std::max(width, 1e-20F);
  const float narrow = (1 - 2 * parity) * std::max(-1.0F, std::min(1.0F, from_border));
  const float wide = (wave_integral(middle + 0.5F * width) - wave_integral(middle - 0.5F * width)) / width;
  return pick(width <= 1, narrow, wide);
}

/// The boxes along a footprint's long axis over which a chequer is averaged, in squares.
struct alignas(64) Boxes {
  Lanes middle_a, middle_b;
  Lanes step_a, step_b;
  Lanes width_a, width_b;
  Lanes count;
};

}  // namespace

// As checker.cpp has it: in the plane of the two axes nearest to the surface's, boxes that spread as the footprint
// does.
PENUMBRA_CLONES void average_checkers(const PointLanes& points, const Lanes& inverse_size,
                                      const FootprintLanes& footprints, Lanes& __restrict shares) {
  Boxes boxes;
  for (std::size_t i = 0; i < n; ++i) {
    const float nx = std::abs(points.geometric.x[i]), ny = std::abs(points.geometric.y[i]),
                nz = std::abs(points.geometric.z[i]);
    const bool along_x = (nx > ny) & (nx > nz);
    const bool keeps_z = along_x | (ny >= nz);
    const float inverse = inverse_size[i];
    const float at_a = inverse * pick(along_x, points.position.y[i], points.position.x[i]);
    const float at_b = inverse * pick(keeps_z, points.position.z[i], points.position.y[i]);
    const float xa = inverse * pick(along_x, footprints.x.y[i], footprints.x.x[i]);
    const float xb = inverse * pick(keeps_z, footprints.x.z[i], footprints.x.y[i]);
    const float ya = inverse * pick(along_x, footprints.y.y[i], footprints.y.x[i]);
    const float yb = inverse * pick(keeps_z, footprints.y.z[i], footprints.y.y[i]);
    // The ellipse with the footprint's second moments, see axes_of.
    const float aa = xa * xa + ya * ya, ab = xa * xb + ya * yb, bb = xb * xb + yb * yb;
    const float half = 0.5F * (aa - bb);
    const float root = std::sqrt(half * half + ab * ab);
    const float major = std::sqrt(0.5F * (aa + bb) + root);
    const float minor = std::abs(xa * yb - xb * ya) / std::max(major, 1e-30F);
    const float along_a = pick(half > 0, half + root, ab);
    const float along_b = pick(half > 0, ab, root - half);
    const float size = std::sqrt(along_a * along_a + along_b * along_b);
    const float to_unit = 1 / std::max(size, 1e-30F);
    const float a = pick(size > 1e-30F, along_a * to_unit, 1.0F), b = pick(size > 1e-30F, along_b * to_unit, 0.0F);
    const float count = std::max(1.0F, std::min(most_boxes, std::ceil(major / std::max(minor, narrowest_box))));
    const float step = major / count;
    boxes.step_a[i] = step * a;
    boxes.step_b[i] = step * b;
    boxes.width_a[i] = std::sqrt(step * step * a * a + minor * minor * b * b);
    boxes.width_b[i] = std::sqrt(step * step * b * b + minor * minor * a * a);
    const float first = 0.5F * (1 - count);
    // By whole periods, which are exact, towards the origin: there are digits to spare there.
    boxes.middle_a[i] = at_a - 2 * std::floor(0.5F * at_a) + first * boxes.step_a[i];
    boxes.middle_b[i] = at_b - 2 * std::floor(0.5F * at_b) + first * boxes.step_b[i];
    boxes.count[i] = pick(inverse > 0, count, 0.0F);
  }
  float most = 1;
  for (std::size_t i = 0; i < n; ++i) most = std::max(most, boxes.count[i]);
  Lanes sums{};
  for (float k = 0; k < most; ++k) {
    for (std::size_t i = 0; i < n; ++i) {
      const float product = mean_wave(boxes.middle_a[i] + k * boxes.step_a[i], boxes.width_a[i]) *
                            mean_wave(boxes.middle_b[i] + k * boxes.step_b[i], boxes.width_b[i]);
      sums[i] += pick(k < boxes.count[i], product, 0.0F);
    }
  }
  for (std::size_t i = 0; i < n; ++i) {
    const float mean = sums[i] / std::max(boxes.count[i], 1.0F);
    shares[i] = pick(std::abs(mean) <= 1.001F, 0.5F - 0.5F * mean, 0.5F);  // nothing is known of endless footprints
  }
}

}  // namespace penumbra
