#include "penumbra/math/uplift.h"

#include <algorithm>
#include <array>

#include "penumbra/math/cie_colour.h"

namespace penumbra {
namespace {

constexpr double step = 10;  // nm
// Red and green every 10 nm from 380 to 780; blue is what is left of 1.
constexpr std::array<std::array<double, 2>, 41> basis{{
    {0.156001, 0.000000}, {0.142770, 0.000000}, {0.128077, 0.000000}, {0.109895, 0.000000}, {0.085919, 0.000000},
    {0.056060, 0.000000}, {0.024849, 0.000000}, {0.002154, 0.000000}, {0.000000, 0.012350}, {0.000000, 0.105311},
    {0.000000, 0.280584}, {0.000000, 0.502381}, {0.000000, 0.720868}, {0.000000, 0.889915}, {0.000000, 0.981355},
    {0.000000, 1.000000}, {0.000000, 1.000000}, {0.000000, 1.000000}, {0.000000, 0.997800}, {0.011218, 0.944177},
    {0.181803, 0.762023}, {0.472398, 0.492569}, {0.763507, 0.227776}, {0.947505, 0.052495}, {1.000000, 0.000000},
    {1.000000, 0.000000}, {1.000000, 0.000000}, {1.000000, 0.000000}, {1.000000, 0.000000}, {1.000000, 0.000000},
    {1.000000, 0.000000}, {1.000000, 0.000000}, {0.999393, 0.000392}, {0.998436, 0.001009}, {0.997446, 0.001648},
    {0.996577, 0.002209}, {0.995873, 0.002663}, {0.995315, 0.003023}, {0.994868, 0.003312}, {0.994490, 0.003555},
    {0.994147, 0.003777},
}};

}  // namespace

Vec3d uplift_basis(double wavelength) {
  const double at = (std::clamp(wavelength, shortest_visible, longest_visible) - shortest_visible) / step;
  const auto cell = std::min(static_cast<std::size_t>(at), basis.size() - 2);
  const double part = at - static_cast<double>(cell);
  const auto& below = basis[cell];
  const auto& above = basis[cell + 1];
  const double red = below[0] + part * (above[0] - below[0]);
  const double green = below[1] + part * (above[1] - below[1]);
  return {red, green, 1 - red - green};
}

}  // namespace penumbra
