#pragma once

#include <array>
#include <cstdint>

#include "penumbra/render/packet_shading.h"

namespace penumbra {

using KeyLanes = std::array<std::uint64_t, RayPacket::size>;
using IndexLanes = std::array<std::uint32_t, RayPacket::size>;

/// owen_sobol_1d and owen_sobol_2d (math/sobol.h) for sixteen keys and indices, cut to the 24 bits of single precision:
/// in [0, 1).
void owen_sobol_1d(const IndexLanes& index, const KeyLanes& key, Lanes& u);
void owen_sobol_2d(const IndexLanes& index, const KeyLanes& key, Lanes& u, Lanes& v);

}  // namespace penumbra
