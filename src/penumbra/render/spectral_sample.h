#pragma once

#include <array>

#include "penumbra/math/bands.h"
#include "penumbra/render/film.h"
#include "penumbra/render/pixel_sampler.h"
#include "penumbra/scene/fluorescence.h"

namespace penumbra {

/// The bands of a camera ray: wavelengths drawn from the sampler, or linear Rec. 709, for which nothing is drawn.
[[nodiscard]] inline Bands sample_bands(bool spectral, PixelSampler& sampler) {
  return spectral ? Bands::sample(sampler.next_1d()) : Bands();
}

/// Where the way of the first wavelength is no longer that of the others, as in glass that disperses: it goes on for
/// all three.
inline void leave_hero_alone(Rgb& throughput) {
  if (throughput.y == 0 && throughput.z == 0) return;
  throughput = Rgb(3 * throughput.x, 0, 0);
}

/// Turns what a camera ray saw in `bands` into linear Rec. 709, for the film.
inline void to_rgb(PixelEstimate& seen, const Bands& bands) {
  if (!bands.spectral()) return;
  seen.radiance = bands.to_rgb(seen.radiance);
  seen.direct = bands.to_rgb(seen.direct);
  seen.albedo = bands.to_rgb(bands.emission(Rgb(1)) * seen.albedo);  // as it looks in white light
}

/// Light that a fluorescent surface radiates at a sample's wavelengths, followed back to where it was absorbed.
struct Absorption {
  Bands bands;         ///< at shorter wavelengths
  Rgb reradiation{0};  ///< of each component: see Fluorescence::reradiation
};
[[nodiscard]] inline Absorption sample_absorption(const Fluorescence& fluorescence, const Bands& bands,
                                                  PixelSampler& sampler) {
  Absorption found;
  const Vec2d u = sampler.next_2d();
  std::array<double, 3> absorbed = bands.wavelengths();
  for (std::size_t k = 0; k < 3; ++k) {
    const double again = fluorescence.reradiation(absorbed[k]);
    found.reradiation[static_cast<int>(k)] = static_cast<float>(again);
    if (again > 0) absorbed[k] = fluorescence.sample_absorbed(absorbed[k], u.x, u.y);
  }
  found.bands = bands.shifted_to(absorbed);
  return found;
}

}  // namespace penumbra
