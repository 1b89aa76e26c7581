#pragma once

#include <string>
#include <variant>

#include "penumbra/math/ray.h"
#include "penumbra/math/transform.h"

namespace penumbra {

struct PerspectiveLens {
  double vertical_fov = 0.6911503837897546;  ///< rad, full angle, 0 < fov < pi
};

struct OrthographicLens {
  double height = 2;  ///< m, full height of what is seen
};

/// An eye. It looks along its own -z with +y up (glTF); the picture's aspect ratio is width / height in pixels.
struct Camera {
  std::string name;
  Mat4d to_world{1.0};  ///< rigid; scale is ignored
  std::variant<PerspectiveLens, OrthographicLens> lens = PerspectiveLens{};

  /// The ray through picture coordinates (x, y): x in 0..1 from left to right, y in 0..1 from top to bottom.
  /// @param aspect width / height of the whole picture.
  [[nodiscard]] Ray ray(double x, double y, double aspect) const;
};

}  // namespace penumbra
