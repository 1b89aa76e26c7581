#include "penumbra/tracing/shading/density_field.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace penumbra {
namespace {

// Gauss-Legendre of two points on 0..1: exact for cubics.
constexpr double first_gauss_point = 0.21132486540518713;

}  // namespace

DensityField::DensityField(const DensityGrid& grid)
    : grid_(&grid), scale_(Vec3d(grid.cells[0], grid.cells[1], grid.cells[2]) / grid.box.extent()) {
  for (const float v : grid.values) maximum_ = std::max(maximum_, static_cast<double>(v));
}

// In a lattice whose points are the cells' centres.
double DensityField::at_lattice(const Vec3d& p) const {
  std::size_t low[3], high[3];
  double part[3];
  for (int axis = 0; axis < 3; ++axis) {
    const double last = grid_->cells[static_cast<std::size_t>(axis)] - 1.0;
    const double x = std::clamp(p[axis], 0.0, last);
    low[axis] = static_cast<std::size_t>(x);
    high[axis] = std::min(low[axis] + 1, static_cast<std::size_t>(last));
    part[axis] = x - static_cast<double>(low[axis]);
  }
  const std::size_t ny = grid_->cells[1], nz = grid_->cells[2];
  const auto along_z = [&](std::size_t x, std::size_t y) {
    const float* row = grid_->values.data() + (x * ny + y) * nz;
    return (1 - part[2]) * row[low[2]] + part[2] * row[high[2]];
  };
  const auto along_y = [&](std::size_t x) {
    return (1 - part[1]) * along_z(x, low[1]) + part[1] * along_z(x, high[1]);
  };
  return (1 - part[0]) * along_y(low[0]) + part[0] * along_y(high[0]);
}

double DensityField::at(const Vec3d& point) const {
  return at_lattice((point - grid_->box.lower) * scale_ - Vec3d(0.5));
}

double DensityField::integral(const Ray& ray, double t0, double t1) const {
  const Vec3d start = (ray.origin - grid_->box.lower) * scale_ - Vec3d(0.5);
  const Vec3d step = ray.direction * scale_;
  // The next plane of the lattice along each axis, and how far planes are apart.
  double next[3], apart[3];
  for (int axis = 0; axis < 3; ++axis) {
    const double x = start[axis] + t0 * step[axis];
    apart[axis] = std::abs(1 / step[axis]);
    next[axis] = step[axis] > 0   ? (std::floor(x) + 1 - start[axis]) / step[axis]
                 : step[axis] < 0 ? (std::ceil(x) - 1 - start[axis]) / step[axis]
                                  : std::numeric_limits<double>::infinity();
  }
  double sum = 0;
  for (double t = t0; t < t1;) {
    const int axis = next[0] < next[1] ? (next[0] < next[2] ? 0 : 2) : (next[1] < next[2] ? 1 : 2);
    const double end = std::min(next[axis], t1);
    if (end > t) {
      const double a = t + first_gauss_point * (end - t), b = end - first_gauss_point * (end - t);
      sum += 0.5 * (end - t) * (at_lattice(start + a * step) + at_lattice(start + b * step));
      t = end;
    }
    next[axis] += apart[axis];
  }
  return sum;
}

}  // namespace penumbra
