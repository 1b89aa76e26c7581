#pragma once

#include "penumbra/render/packet_shading.h"

namespace penumbra {

/// Directions of diffuse reflection from surface points, density cos/pi about the shading normal, by u, v in [0, 1)
/// (sample_cosine_hemisphere in lanes). `chance` is 1, or 0 where the direction lies behind the surface; `density`
/// is 1/sr.
void scatter_rays(const PointLanes& points, const Lanes& u, const Lanes& v, BounceLanes& scattered, Lanes& density);

/// Of light that both a lamp's sample and a diffuse bounce may find, the sample's share (Veach & Guibas 1995, power
/// heuristic, exponent 2). Scales `geometry` of aim_at_area, whose shadow rays are given.
void share_with_bounce(const PointLanes& points, const RayPacket& shadow, Lanes& geometry);

}  // namespace penumbra
