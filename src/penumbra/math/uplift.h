#pragma once

#include "penumbra/math/vec.h"

namespace penumbra {

/// Spectra for linear Rec. 709 colours, which hold three numbers where a spectrum holds infinitely many.
///
/// Three basis spectra, the reflectances of red (1,0,0), green (0,1,0) and blue (0,0,1), lie in 0..1 and sum to 1 at
/// every wavelength (the construction of Mallett & Yuksel, "Spectral Primary Decomposition for Rendering with sRGB
/// Reflectance", EGSR 2019). So, by linearity, for every colour of 0..1
///   - the reflectance r R(l) + g G(l) + b B(l) lies between the least and the largest of r, g, b: never beyond energy;
///   - under D65 it looks exactly r, g, b again: the round trip is the identity;
///   - grey is flat.
/// Among all bases with these properties ours is the smoothest: the squares of the second differences and a tenth of
/// those of the first were minimised over values every 10 nm (tools/uplift_basis.py), linear in between.
///
/// Emission is unbounded: the same combination times D65 (`white_radiance`), so that RGB white shines as D65.
///
/// @return R, G and B at the wavelength in nm; beyond the visible range those of its end.
[[nodiscard]] Vec3d uplift_basis(double wavelength);

}  // namespace penumbra
