#include "penumbra/render/shadow_boundaries.h"

#include <algorithm>

#include "penumbra/parallel/parallel_for.h"

namespace penumbra {
namespace {

using First = ShadowBoundaries::First;

/// With fewer pixels of its object in the window, of 25, a pixel cannot tell.
constexpr int fewest_of_an_object = 6;
constexpr std::uint64_t seen_straight = 0xFFFFFFFFU;

/// The first rays of the picture by pixel.
struct FirstRays {
  const Region& region;
  const std::vector<First>& seen;

  [[nodiscard]] const First& at(int x, int y) const {
    return seen[static_cast<std::size_t>(y - region.y0) * static_cast<std::size_t>(region.x1 - region.x0) +
                static_cast<std::size_t>(x - region.x0)];
  }
  [[nodiscard]] bool holds(int x, int y) const {
    return x >= region.x0 && x < region.x1 && y >= region.y0 && y < region.y1;
  }
};

/// What all rays around a pixel found: from its own object, and by way of mirrors from any.
First around(const FirstRays& rays, int x, int y) {
  constexpr int reach = ShadowBoundaries::reach;
  const First& own = rays.at(x, y);
  First all{.object = own.object};
  int of_object = 0;
  for (int v = y - reach; v <= y + reach; ++v) {
    for (int u = x - reach; u <= x + reach; ++u) {
      if (!rays.holds(u, v)) continue;
      const First& other = rays.at(u, v);
      const bool same = other.object == own.object;
      of_object += same ? 1 : 0;
      const std::uint64_t counted = same ? ~std::uint64_t{0} : ~seen_straight;
      all.hidden |= other.hidden & counted;
      all.partly |= other.partly & counted;
      all.free |= other.free & counted;
    }
  }
  if (of_object < fewest_of_an_object) all.partly |= (own.hidden | own.free) & seen_straight;
  return all;
}

std::uint64_t boundary_of(const First& f) { return (f.hidden & f.free) | f.partly; }

}  // namespace

ShadowBoundaries::ShadowBoundaries(const Region& region, const Region& first, const std::vector<First>& seen)
    : region_(region) {
  const FirstRays rays{first, seen};
  std::vector<First> windows(seen.size());
  parallel_for(static_cast<std::size_t>(first.y1 - first.y0), 1, [&](std::size_t row, std::size_t) {
    const int y = first.y0 + static_cast<int>(row);
    for (int x = first.x0; x < first.x1; ++x) {
      windows[row * static_cast<std::size_t>(first.x1 - first.x0) + static_cast<std::size_t>(x - first.x0)] =
          around(rays, x, y);
    }
  });
  const FirstRays wide{first, windows};
  marks_.resize(static_cast<std::size_t>(region.x1 - region.x0) * static_cast<std::size_t>(region.y1 - region.y0));
  parallel_for(static_cast<std::size_t>(region.y1 - region.y0), 1, [&](std::size_t row, std::size_t) {
    const int y = region.y0 + static_cast<int>(row);
    for (int x = region.x0; x < region.x1; ++x) {
      const First& own = wide.at(x, y);
      Marks marks{boundary_of(own), own.free & ~own.hidden & ~own.partly};
      // Where the object changes, a sample of this pixel may see the neighbour's.
      constexpr int sides[4][2] = {{-1, 0}, {1, 0}, {0, -1}, {0, 1}};
      for (const auto& [dx, dy] : sides) {
        if (!wide.holds(x + dx, y + dy)) continue;
        const First& other = wide.at(x + dx, y + dy);
        if (other.object == own.object) continue;
        marks.boundary |= boundary_of(other);
        marks.free &= ~(other.hidden | other.partly);
      }
      marks.free &= ~marks.boundary;
      marks_[index(x, y)] = marks;
    }
  });
}

}  // namespace penumbra
