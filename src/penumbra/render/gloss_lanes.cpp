#include "penumbra/render/gloss_lanes.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "penumbra/render/lane_loops.h"
#include "penumbra/tracing/shading/fresnel.h"
#include "penumbra/tracing/shading/specular_albedo.h"

namespace penumbra {
namespace {

constexpr std::size_t n = RayPacket::size;

}  // namespace

GlossLayer::GlossLayer(const Material& m)
    : alpha(m.roughness * m.roughness),
      head_on(glm::min(static_cast<float>(normal_reflectance(1, m.ior)) * m.specular_colour, Rgb(1)) * m.specular),
      grazing(m.specular) {
  const double f0 = max_component(head_on), f90 = m.specular;
  const double open = 1 - specular_albedo_mean(m.roughness).of(f0, f90);
  inverse_open = open < 1e-6 ? 0.0F : static_cast<float>(1 / open);
  for (int k = 0; k < nodes; ++k) {
    const double root = static_cast<double>(k) / (nodes - 1);
    left[k] = static_cast<float>(1 - specular_albedo(m.roughness, root * root).of(f0, f90));
  }
  left[nodes] = left[nodes - 1];
}

float GlossLayer::left_at(float cosine) const {
  const float at = std::sqrt(std::clamp(cosine, 0.0F, 1.0F)) * (nodes - 1);
  const int k = static_cast<int>(at);
  return left[k] + (at - static_cast<float>(k)) * (left[k + 1] - left[k]);
}

void GlossLanes::set(std::size_t i, const GlossLayer* of, float facing) {
  layer[i] = of;
  alpha[i] = of != nullptr ? of->alpha : 1.0F;
  head_on.set(i, of != nullptr ? of->head_on : Rgb(0));
  grazing[i] = of != nullptr ? of->grazing : 0.0F;
  left[i] = of != nullptr ? of->left_at(facing) * of->inverse_open : 1.0F;
}

namespace {

/// What of light from the direction of shadow rays a layer reflects, but for its colour, and what it leaves.
struct alignas(64) Share {
  Lanes facets;  ///< D G / (4 cos cos'), 1/sr
  Lanes edge;    ///< Schlick's (1 - cos)^5
  Lanes left;
};

// Light that facets mirror (see Ggx): D(h) by the half vector between the ray back and the shadow ray.
PENUMBRA_CLONES void find_facets(const RayPacket& rays, const PointLanes& points, const Lanes& alpha,
                                 const RayPacket& shadow, Share& __restrict share) {
  for (std::size_t i = 0; i < n; ++i) {
    const float nx = points.normal.x[i], ny = points.normal.y[i], nz = points.normal.z[i];
    const float ix = shadow.direction_x[i], iy = shadow.direction_y[i], iz = shadow.direction_z[i];
    const float sx = ix - rays.direction_x[i], sy = iy - rays.direction_y[i], sz = iz - rays.direction_z[i];
    const float scale = 1 / std::sqrt(std::max(sx * sx + sy * sy + sz * sz, 1e-37F));
    const float hx = sx * scale, hy = sy * scale, hz = sz * scale;
    const float cos_h = hx * nx + hy * ny + hz * nz;
    const float cos_o = std::max(points.facing[i], 1e-6F);
    const float cos_i = std::max(ix * nx + iy * ny + iz * nz, 1e-6F);
    // The sine by a cross product: near the normal the cosine has lost it.
    const float cx = hy * nz - hz * ny, cy = hz * nx - hx * nz, cz = hx * ny - hy * nx;
    const float a2 = alpha[i] * alpha[i];
    const float stretch = cx * cx + cy * cy + cz * cz + a2 * cos_h * cos_h;
    const float distribution = a2 / (std::numbers::pi_v<float> * stretch * stretch);
    const float slope_o = a2 * (1 - std::min(cos_o * cos_o, 1.0F)) / (cos_o * cos_o);
    const float slope_i = a2 * (1 - std::min(cos_i * cos_i, 1.0F)) / (cos_i * cos_i);
    const float lambdas = 0.5F * (slope_o / (1 + std::sqrt(1 + slope_o)) + slope_i / (1 + std::sqrt(1 + slope_i)));
    share.facets[i] = distribution / ((1 + lambdas) * 4 * cos_o * cos_i);
    const float away = 1 - std::min(hx * ix + hy * iy + hz * iz, 1.0F);
    const float away2 = away * away;
    share.edge[i] = away2 * away2 * away;
  }
}

PENUMBRA_CLONES void add_shares(const GlossLanes& gloss, const Share& share, const ColourLanes& reflectance,
                                const ColourLanes& light, const ColourLanes& passed, const Lanes& geometry,
                                const RayPacket& shadow, ColourLanes& __restrict radiance) {
  const auto add = [&](const Lanes& base, const Lanes& head_on, const Lanes& bright, const Lanes& through,
                       Lanes& __restrict sum) {
    for (std::size_t i = 0; i < n; ++i) {
      const float fresnel = head_on[i] + (gloss.grazing[i] - head_on[i]) * share.edge[i];
      const float f =
          base[i] * std::numbers::inv_pi_v<float> * gloss.left[i] * share.left[i] + fresnel * share.facets[i];
      sum[i] += shadow.active[i] != 0 ? f * bright[i] * through[i] * geometry[i] : 0.0F;
    }
  };
  add(reflectance.r, gloss.head_on.r, light.r, passed.r, radiance.r);
  add(reflectance.g, gloss.head_on.g, light.g, passed.g, radiance.g);
  add(reflectance.b, gloss.head_on.b, light.b, passed.b, radiance.b);
}

}  // namespace

void add_glossy_light(const RayPacket& rays, const PointLanes& points, const GlossLanes& gloss,
                      const ColourLanes& reflectance, const ColourLanes& light, const ColourLanes& passed,
                      const Lanes& geometry, const RayPacket& shadow, ColourLanes& radiance) {
  Share share;
  find_facets(rays, points, gloss.alpha, shadow, share);
  for (std::size_t i = 0; i < n; ++i) {
    const float cosine = shadow.direction_x[i] * points.normal.x[i] + shadow.direction_y[i] * points.normal.y[i] +
                         shadow.direction_z[i] * points.normal.z[i];
    share.left[i] = gloss.layer[i] != nullptr ? gloss.layer[i]->left_at(cosine) : 1.0F;
  }
  add_shares(gloss, share, reflectance, light, passed, geometry, shadow, radiance);
}

}  // namespace penumbra
