#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "penumbra/scene/scene.h"

namespace penumbra {

/// Shares of the light that meets a surface, in the band in which their sum is largest.
struct SentOn {
  float reflected = 0;
  float transmitted = 0;
  [[nodiscard]] float sum() const { return reflected + transmitted; }
};

/// What a material's numbers promise to send on. The metallic, dielectric and transmitting parts share the base colour;
/// an ideal mirror comes on top; a fluorescent one passes on what its matrix says of the band of which it says most.
/// (What is drawn never exceeds what arrives: see Bsdf. But then it is not what was
/// asked for.)
[[nodiscard]] SentOn sent_on(const Material& material);

/// The materials that would send on more than arrives, such as one that reflects 66 % and refracts 50 %; unlit ones
/// reflect nothing.
[[nodiscard]] std::vector<std::uint32_t> materials_beyond_energy(const Scene& scene);

/// Scales the reflectance and transmittance of those materials so that they send on just what arrives.
void fix_energy(Scene& scene);

/// material "red glass", or material 3 where it has no name.
[[nodiscard]] std::string material_label(const Scene& scene, std::size_t material);

}  // namespace penumbra
