#pragma once

#include <array>

#include "penumbra/math/spectrum.h"

namespace penumbra {

/// What the three components of an Rgb stand for along one sample: red, green and blue, or three wavelengths.
///
/// Everything that carries light multiplies component by component, so the same code renders both. What is given in
/// linear Rec. 709 (colours of materials and lights) is turned into values at these wavelengths by `reflectance` and
/// `emission`, and what the sample found is turned back by `to_rgb`.
///
/// Wavelengths are chosen as by Wilkie, Nawaz, Droske, Weidlich & Hanika, "Hero Wavelength Spectral Sampling", EGSR
/// 2014: one, the hero, by a random number, the others by that number rotated by thirds; directions are chosen for all
/// three alike. Their density is such that every sample of white light is white by itself (to 6 % RMS): grey surfaces
/// in white light have no colour noise.
class Bands {
 public:
  /// Linear Rec. 709: colours stay as they are.
  Bands() = default;
  /// Three wavelengths. @param u uniform in [0, 1).
  [[nodiscard]] static Bands sample(double u);

  [[nodiscard]] bool spectral() const { return spectral_; }
  /// nm, the hero first. @pre spectral().
  [[nodiscard]] const std::array<double, 3>& wavelengths() const { return wavelengths_; }

  /// A reflectance, transmittance or tint of 0..1 (or whatever else mixes linearly, such as a metal's index).
  [[nodiscard]] Rgb reflectance(const Rgb& colour) const { return spectral_ ? uplift_ * colour : colour; }
  /// Emitted light: radiance, irradiance or intensity per nm.
  [[nodiscard]] Rgb emission(const Rgb& colour) const { return spectral_ ? white_ * (uplift_ * colour) : colour; }

  /// Light in these bands, per nm, as this sample's contribution to linear Rec. 709. Its mean over all samples is the
  /// colour; a single one may be negative.
  [[nodiscard]] Rgb to_rgb(const Rgb& light) const { return spectral_ ? sensor_ * light : light; }

  /// The same sample with its components at other wavelengths, nm, to where the light of these comes from (by
  /// fluorescence). `to_rgb` of the result is meaningless: what a shifted path finds counts at the first bands.
  [[nodiscard]] Bands shifted_to(const std::array<double, 3>& wavelengths) const;

 private:
  bool spectral_ = false;
  std::array<double, 3> wavelengths_{};
  Mat3f uplift_{1};  // column: red, green, blue; row: wavelength
  Rgb white_{1};     // spectral radiance of RGB white, 1/nm
  Mat3f sensor_{1};  // column: wavelength; row: red, green, blue
};

}  // namespace penumbra
