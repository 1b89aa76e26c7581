#pragma once

#include <optional>
#include <vector>

#include "penumbra/math/vec.h"
#include "penumbra/scene/thin_lens.h"

namespace penumbra {

/// Points of a lens's opening, as dense as light passes there.
class ApertureSampler {
 public:
  /// Throws std::invalid_argument for an opening through which no light passes, or options out of range.
  explicit ApertureSampler(const ThinLens& lens);

  /// A point of the opening in units of the lens's radius, x to the right and y up as the eye looks through it; none
  /// where the second rim stands in the way.
  /// @param at where the ray crosses the picture: 0 in its middle, length 1 in its corners.
  [[nodiscard]] std::optional<Vec2d> sample(const Vec2d& u, const Vec2d& at) const;

 private:
  [[nodiscard]] Vec2d in_blades(const Vec2d& u) const;
  [[nodiscard]] Vec2d in_picture(const Vec2d& u) const;

  enum class Kind { disk, blades, image } kind_ = Kind::disk;
  double cat_eye_;
  int blades_ = 0;
  double rotation_ = 0;
  int width_ = 0, height_ = 0;
  std::vector<double> rows_;     // cumulated light of the rows, from 0 to 1
  std::vector<double> columns_;  // of the texels of each row, [row * (width + 1) + column]
};

}  // namespace penumbra
