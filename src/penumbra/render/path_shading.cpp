#include "penumbra/render/path_shading.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "penumbra/render/lane_loops.h"

namespace penumbra {
namespace {

constexpr std::size_t n = RayPacket::size;

}  // namespace

PENUMBRA_CLONES void scatter_rays(const PointLanes& points, const Lanes& u, const Lanes& v,
                                  BounceLanes& __restrict scattered, Lanes& __restrict density) {
  constexpr float quarter = std::numbers::pi_v<float> / 4;
  for (std::size_t i = 0; i < n; ++i) {
    // Shirley & Chiu's disk, see sample_disk: an angle of at most pi/4 from one of the axes.
    const float a = 2 * u[i] - 1, b = 2 * v[i] - 1;
    const bool first = std::abs(a) > std::abs(b);
    const float r = first ? a : b;
    const float other = first ? b : a;
    const float divisor = r == 0 ? 1.0F : r;
    const float angle = quarter * (other / divisor);
    const float q = angle * angle;
    // Taylor's series, to 1e-8 up to pi/4.
    const float sine = angle * (1 + q * (-1.0F / 6 + q * (1.0F / 120 + q * (-1.0F / 5040 + q / 362880))));
    const float cosine = 1 + q * (-0.5F + q * (1.0F / 24 + q * (-1.0F / 720 + q / 40320)));
    const float c = first ? cosine : sine, s = first ? sine : cosine;
    const float x = r * c, y = r * s;
    const float z = std::sqrt(std::max(0.0F, 1 - x * x - y * y));
    // The frame stands on the front, see Frame and Bsdf; the direction goes to the side that was seen.
    const float side = points.front[i] != 0 ? 1.0F : -1.0F;
    const float nx = side * points.normal.x[i], ny = side * points.normal.y[i], nz = side * points.normal.z[i];
    const float sign = nz < 0 ? -1.0F : 1.0F;
    const float f = -1 / (sign + nz);
    const float g = nx * ny * f;
    const float dx = x * (1 + sign * nx * nx * f) + y * g + side * z * nx;
    const float dy = x * sign * g + y * (sign + ny * ny * f) + side * z * ny;
    const float dz = -x * sign * nx - y * ny + side * z * nz;
    const float gx = points.geometric.x[i], gy = points.geometric.y[i], gz = points.geometric.z[i];
    scattered.origin.x[i] = points.position.x[i] + points.error[i] * gx;
    scattered.origin.y[i] = points.position.y[i] + points.error[i] * gy;
    scattered.origin.z[i] = points.position.z[i] + points.error[i] * gz;
    scattered.direction.x[i] = dx;
    scattered.direction.y[i] = dy;
    scattered.direction.z[i] = dz;
    const bool goes = (dx * gx + dy * gy + dz * gz > 0) & (z > 0);
    scattered.chance[i] = goes ? 1.0F : 0.0F;
    density[i] = z * std::numbers::inv_pi_v<float>;
  }
}

PENUMBRA_CLONES void share_with_bounce(const PointLanes& points, const RayPacket& shadow, Lanes& __restrict geometry) {
  for (std::size_t i = 0; i < n; ++i) {
    const float cosine = shadow.direction_x[i] * points.normal.x[i] + shadow.direction_y[i] * points.normal.y[i] +
                         shadow.direction_z[i] * points.normal.z[i];
    // The lamp's density over solid angle is cosine / geometry, the bounce's cosine / pi.
    const float ratio = geometry[i] * std::numbers::inv_pi_v<float>;
    const float share = 1 / (1 + ratio * ratio);
    geometry[i] = cosine > 0 ? geometry[i] * share : 0.0F;
  }
}

}  // namespace penumbra
