#pragma once

#include <cstdint>
#include <vector>

#include "penumbra/render/render.h"

namespace penumbra {

/// Where in a picture the shadows of each lamp may end, and where a lamp is seen whole: a pixel at a time, for the
/// surfaces that the eye sees and, all together, for those that mirrors and glass show it. Lamps whose numbers differ
/// by 32 share a mark.
class ShadowBoundaries {
 public:
  /// What the first shadow rays of one pixel found; a bit for each lamp, for what is seen straight (the lower 32) and
  /// by way of mirrors and glass.
  struct First {
    std::uint32_t object = 0xFFFFFFFFU;  ///< first seen; none
    std::uint64_t hidden = 0;            ///< a ray to the lamp was stopped
    std::uint64_t partly = 0;            ///< passed in part
    std::uint64_t free = 0;              ///< passed
  };
  [[nodiscard]] static std::uint64_t bit(std::size_t lamp, bool by_mirrors) {
    return std::uint64_t{1} << (lamp % 32 + (by_mirrors ? 32 : 0));
  }

  /// Nowhere.
  ShadowBoundaries() = default;
  /// @param region to be marked, in the picture. @param seen of the pixels of `first`, row by row, which is the region
  /// with `margin` pixels around it as far as the picture goes.
  ShadowBoundaries(const Region& region, const Region& first, const std::vector<First>& seen);

  /// How far a pixel looks around, in a window of 5 x 5, and its neighbours with it.
  static constexpr int reach = 2;
  static constexpr int margin = reach + 1;

  [[nodiscard]] bool empty() const { return marks_.empty(); }
  /// Whether a shadow of the lamp may end here: of the first rays from the same object in the window around some passed
  /// and some did not, or some passed in part, or too little of the object is in the window to tell.
  /// @pre the pixel lies in the region.
  [[nodiscard]] bool crosses(int x, int y, std::size_t lamp, bool by_mirrors) const {
    return (marks_[index(x, y)].boundary & bit(lamp, by_mirrors)) != 0;
  }
  /// Whether all first rays around reached the lamp.
  [[nodiscard]] bool is_free(int x, int y, std::size_t lamp, bool by_mirrors) const {
    return (marks_[index(x, y)].free & bit(lamp, by_mirrors)) != 0;
  }

 private:
  struct Marks {
    std::uint64_t boundary = 0;
    std::uint64_t free = 0;
  };
  [[nodiscard]] std::size_t index(int x, int y) const {
    return static_cast<std::size_t>(y - region_.y0) * static_cast<std::size_t>(region_.x1 - region_.x0) +
           static_cast<std::size_t>(x - region_.x0);
  }

  Region region_;
  std::vector<Marks> marks_;
};

}  // namespace penumbra
