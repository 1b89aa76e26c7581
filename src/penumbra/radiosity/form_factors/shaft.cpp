#include "penumbra/radiosity/form_factors/shaft.h"

#include <algorithm>

namespace penumbra {

Shaft::Shaft(const Bounds& a, const Bounds& b) : hull_(a) {
  hull_.grow(b);
  // In each coordinate plane: for each of the four diagonal directions the hull of the two rectangles has at most one
  // slanted side, from the extreme corner of one to that of the other.
  for (int axis = 0; axis < 3; ++axis) {
    const int u = axis, v = (axis + 1) % 3;
    for (int quadrant = 0; quadrant < 4; ++quadrant) {
      const bool right = (quadrant & 1) != 0, up = (quadrant & 2) != 0;
      const double au = right ? a.upper[u] : a.lower[u], av = up ? a.upper[v] : a.lower[v];
      const double bu = right ? b.upper[u] : b.lower[u], bv = up ? b.upper[v] : b.lower[v];
      const double du = bu - au, dv = bv - av;
      // A slanted side exists when one corner is farther out along u and the other along v.
      const double su = right ? 1 : -1, sv = up ? 1 : -1;
      if (!(su * du * sv * dv < 0)) continue;
      Line line{u, v, dv, -du, 0};
      if (line.u * su + line.v * sv < 0) {
        line.u = -line.u;
        line.v = -line.v;
      }
      line.limit = line.u * au + line.v * av;
      lines_[count_++] = line;
    }
  }
}

bool Shaft::misses(const Bounds& box) const {
  for (int k = 0; k < 3; ++k)
    if (box.lower[k] > hull_.upper[k] || box.upper[k] < hull_.lower[k]) return true;
  for (std::size_t k = 0; k < count_; ++k) {
    const Line& l = lines_[k];
    const double nearest = l.u * (l.u > 0 ? box.lower[l.axis_u] : box.upper[l.axis_u]) +
                           l.v * (l.v > 0 ? box.lower[l.axis_v] : box.upper[l.axis_v]);
    if (nearest > l.limit) return true;
  }
  return false;
}

}  // namespace penumbra
