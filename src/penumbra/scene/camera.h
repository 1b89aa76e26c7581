#pragma once

#include <optional>
#include <string>
#include <variant>

#include "penumbra/math/ray.h"
#include "penumbra/math/transform.h"
#include "penumbra/scene/motion.h"
#include "penumbra/scene/thin_lens.h"

namespace penumbra {

struct PerspectiveLens {
  double vertical_fov = 0.6911503837897546;  ///< rad, full angle, 0 < fov < pi
};

struct OrthographicLens {
  double height = 2;  ///< m, full height of what is seen
};

/// All directions: longitude runs along the picture's width, with the view in the middle, latitude along its height, up
/// at the top (equirectangular). Twice as wide as high, its pixels are square.
struct PanoramicLens {};

/// A circle of directions, as high as the picture or as wide, whichever is less: the angle from the view grows evenly
/// with the distance from the middle (equidistant).
struct FisheyeLens {
  double fov = 3.141592653589793;  ///< rad, full angle across the circle, 0 < fov <= 2 pi
};

/// An eye. It looks along its own -z with +y up (glTF); the picture's aspect ratio is width / height in pixels.
struct Camera {
  std::string name;
  Mat4d to_world{1.0};  ///< rigid; scale is ignored
  std::variant<PerspectiveLens, OrthographicLens, PanoramicLens, FisheyeLens> lens = PerspectiveLens{};
  std::optional<ThinLens> thin_lens = std::nullopt;  ///< of a perspective camera; none: a pinhole, all is sharp
  Motion motion{};       ///< where it is while the shutter is open; empty: it rests at `to_world`
  std::string extras{};  ///< as Instance::extras

  /// The ray through picture coordinates (x, y): x in 0..1 from left to right, y in 0..1 from top to bottom; through
  /// the middle of a thin lens. Outside a fisheye's circle its direction is 0.
  /// @param aspect width / height of the whole picture.
  [[nodiscard]] Ray ray(double x, double y, double aspect) const;
};

}  // namespace penumbra
