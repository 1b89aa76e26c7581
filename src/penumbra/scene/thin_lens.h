#pragma once

#include <variant>

#include "penumbra/scene/texture.h"

namespace penumbra {

/// A round opening.
struct DiskAperture {};

/// A regular polygon whose corners lie on the lens's edge, as the blades of an iris leave it.
struct BladeAperture {
  int blades = 6;       ///< 3 or more
  double rotation = 0;  ///< rad, counter-clockwise as the eye looks through it; at 0 a corner points up
};

/// Any opening: light passes in proportion to the picture's first channel (linear). The picture fills the square around
/// the lens, its top up.
struct ImageAperture {
  TextureImage picture;
};

/// A lens without thickness that is in focus on one plane (Potmesil & Chakravarty 1981; Cook, Porter & Carpenter 1984).
/// A point at distance s is blurred to the shape of the aperture: on the plane in focus, scaled by |s - focus| / s.
struct ThinLens {
  double radius = 0;  ///< m, of the opening
  double focus = 1;   ///< m, from the eye to the plane in focus, along the view
  std::variant<DiskAperture, BladeAperture, ImageAperture> aperture = DiskAperture{};
  /// Optical vignetting: towards the picture's corners a second rim, this share of the radius away there, cuts the
  /// opening to a cat's eye, and the picture darkens; 0: none.
  double cat_eye = 0;
};

/// The lens that a camera has at an f-number N: aperture 2 r = f / N, where the focal length f brings the plane at
/// `focus` in focus behind a frame of `frame_height` (m; 0.024 is 35 mm film) that shows `vertical_fov` (rad) of it.
[[nodiscard]] ThinLens thin_lens(double f_number, double focus, double vertical_fov, double frame_height = 0.024);

}  // namespace penumbra
