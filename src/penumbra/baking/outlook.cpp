#include "penumbra/baking/outlook.h"

#include <cmath>

#include "penumbra/math/frame.h"
#include "penumbra/math/rng.h"
#include "penumbra/math/sobol.h"

namespace penumbra {
namespace {

constexpr int lanes = Outlook::lanes;
/// Directions of all lanes lie in one of 2^cell_digits cells of the hemisphere.
constexpr int cell_digits = 6;

/// Bits [2 - each] of a lane's place in a square of 4 x 4 (lanes stand along a Morton curve).
std::uint32_t lane_column(int lane) { return static_cast<std::uint32_t>((lane & 1) | ((lane >> 1) & 2)); }
std::uint32_t lane_row(int lane) { return static_cast<std::uint32_t>(((lane >> 1) & 1) | ((lane >> 2) & 2)); }

/// Cosine-distributed directions about z (Malley's method on the concentric map of Shirley & Chiu 1997), all lanes
/// alike so that compilers make vectors of it.
void cosine_directions(const std::uint32_t (&bits_u)[lanes], const std::uint32_t (&bits_v)[lanes], float (&x)[lanes],
                       float (&y)[lanes], float (&z)[lanes]) {
  for (int i = 0; i < lanes; ++i) {
    // 24 bits, so that the conversion is exact; half a step keeps clear of the middle's 0/0.
    const float a = (static_cast<float>(static_cast<std::int32_t>(bits_u[i] >> 8)) + 0.5F) * 0x1p-23F - 1.0F;
    const float b = (static_cast<float>(static_cast<std::int32_t>(bits_v[i] >> 8)) + 0.5F) * 0x1p-23F - 1.0F;
    const bool wide = std::abs(a) > std::abs(b);
    const float r = wide ? a : b, other = wide ? b : a;
    const float phi = 0.78539816F * (other / r);
    const float p2 = phi * phi;
    const float s = phi * (1.0F + p2 * (-0.16666667F + p2 * (8.3333310e-3F + p2 * -1.9840874e-4F)));
    const float c = 1.0F + p2 * (-0.5F + p2 * (4.1666638e-2F + p2 * (-1.3888378e-3F + p2 * 2.4760495e-5F)));
    x[i] = r * (wide ? c : s);
    y[i] = r * (wide ? s : c);
    const float rest = 1.0F - r * r;
    z[i] = std::sqrt(rest > 0.0F ? rest : 0.0F);
  }
}

/// From the disk of Malley's method to that of Lambert's equal-area map.
void spread_evenly(float (&x)[lanes], float (&y)[lanes], float (&z)[lanes]) {
  for (int i = 0; i < lanes; ++i) {
    const float r2 = 1.0F - z[i] * z[i], stretch = std::sqrt(2.0F - r2);
    x[i] *= stretch;
    y[i] *= stretch;
    z[i] = 1.0F - r2;
  }
}

}  // namespace

Outlook::Outlook(std::uint64_t key, Spread spread) : spread_(spread) {
  seed_[0] = static_cast<std::uint32_t>(mix_bits(key));
  seed_[1] = static_cast<std::uint32_t>(mix_bits(key) >> 32);
  for (int lane = 0; lane < lanes; ++lane) set(lane, Vec3d(0), Vec3d(0, 0, 1), Vec3d(0, 0, 1), 0), clear(lane);
}

void Outlook::set(int lane, const Vec3d& position, const Vec3d& normal, const Vec3d& facing, std::uint64_t key) {
  const Frame frame(normal);
  for (int axis = 0; axis < 3; ++axis) {
    origin_[axis][lane] = static_cast<float>(position[axis]);
    tangent_[axis][lane] = static_cast<float>(frame.tangent[axis]);
    bitangent_[axis][lane] = static_cast<float>(frame.bitangent[axis]);
    normal_[axis][lane] = static_cast<float>(normal[axis]);
    facing_[axis][lane] = static_cast<float>(facing[axis]);
  }
  const std::uint64_t random = mix_bits(key);
  shift_[0][lane] = (lane_column(lane) << 30) | (static_cast<std::uint32_t>(random) >> 2);
  shift_[1][lane] = (lane_row(lane) << 30) | (static_cast<std::uint32_t>(random >> 32) >> 2);
  used_[lane] = -1;
}

void Outlook::rays(std::uint32_t index, RayPacket& packet) const {
  const std::uint32_t u = owen_scramble(sobol_bits(index, 0), seed_[0]);
  const std::uint32_t v = owen_scramble(sobol_bits(index, 1), seed_[1]);
  std::uint32_t bits_u[lanes], bits_v[lanes];
  for (int i = 0; i < lanes; ++i) {
    bits_u[i] = u ^ (shift_[0][i] >> (cell_digits / 2));
    bits_v[i] = v ^ (shift_[1][i] >> (cell_digits / 2));
  }
  float x[lanes], y[lanes], z[lanes];
  cosine_directions(bits_u, bits_v, x, y, z);
  if (spread_ == Spread::even) spread_evenly(x, y, z);
  for (int i = 0; i < lanes; ++i) {
    const float dx = x[i] * tangent_[0][i] + y[i] * bitangent_[0][i] + z[i] * normal_[0][i];
    const float dy = x[i] * tangent_[1][i] + y[i] * bitangent_[1][i] + z[i] * normal_[1][i];
    const float dz = x[i] * tangent_[2][i] + y[i] * bitangent_[2][i] + z[i] * normal_[2][i];
    packet.origin_x[i] = origin_[0][i];
    packet.origin_y[i] = origin_[1][i];
    packet.origin_z[i] = origin_[2][i];
    packet.t_min[i] = 0;
    packet.t_max[i] = HUGE_VALF;
    packet.direction_x[i] = dx;
    packet.direction_y[i] = dy;
    packet.direction_z[i] = dz;
    const bool above = dx * facing_[0][i] + dy * facing_[1][i] + dz * facing_[2][i] > 0.0F;
    packet.active[i] = above ? used_[i] : 0;
  }
}

}  // namespace penumbra
