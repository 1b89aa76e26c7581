#include "penumbra/scene/thin_lens.h"

#include <cmath>

namespace penumbra {

ThinLens thin_lens(double f_number, double focus, double vertical_fov, double frame_height) {
  // The frame stands at v behind the lens, where v follows from what it shows; 1 / f = 1 / v + 1 / focus.
  const double v = frame_height / 2 / std::tan(vertical_fov / 2);
  const double focal_length = v * focus / (v + focus);
  return {.radius = focal_length / f_number / 2, .focus = focus, .aperture = DiskAperture{}, .cat_eye = 0};
}

}  // namespace penumbra
