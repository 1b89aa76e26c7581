#pragma once

#include "penumbra/math/vec.h"

namespace penumbra {

/// What the eye sees and pictures can show, nm: nothing outside counts for a picture.
inline constexpr double shortest_visible = 380;
inline constexpr double longest_visible = 780;

/// CIE 1931 colour matching functions x, y, z of the 2-degree observer at a wavelength in nm: the multi-lobe fit of
/// Wyman, Sloan & Shirley, "Simple Analytic Approximations to the CIE XYZ Color Matching Functions", JCGT 2(2), 2013
/// (table 1, within 1 % of the tabulated functions' largest values). 0 outside the visible range.
[[nodiscard]] Vec3d cie_matching(double wavelength);

/// CIE standard illuminant D65, relative, 100 at 560 nm: linear between the values that CIE 15:2004 tabulates every 10
/// nm from 300 to 830; 0 outside.
[[nodiscard]] double illuminant_d65(double wavelength);

/// Linear Rec. 709 of light of one wavelength, per W/(m^2 sr) (negative where the colour lies outside what red, green
/// and blue can mix), scaled so that light of D65 with 3 W/(m^2 sr) between 380 and 780 nm is exactly (1, 1, 1): the 3
/// W are one for each band of an RGB white. Each band's scale differs by less than 0.1 % from what the white point of
/// ITU-R BT.709 would give, which is the error of the fit.
[[nodiscard]] Vec3d rec709_matching(double wavelength);

/// Spectral radiance of RGB white 1, W/(m^2 sr nm): D65 scaled as above; 0 outside the visible range.
[[nodiscard]] double white_radiance(double wavelength);

}  // namespace penumbra
