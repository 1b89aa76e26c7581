#pragma once

#include "penumbra/math/ray.h"
#include "penumbra/scene/medium.h"

namespace penumbra {

/// A density grid as a function of space, and exactly integrated along rays. The grid must outlive it.
class DensityField {
 public:
  explicit DensityField(const DensityGrid& grid);

  /// @pre `point` lies in the box.
  [[nodiscard]] double at(const Vec3d& point) const;
  /// The integral of the density over distance, m, from t0 to t1 along the ray, within the box. Between the planes
  /// through the cells' centres the density along a ray is a cubic, which two Gauss points integrate exactly; so the
  /// transmittance has no noise. @pre both ends lie in the box.
  [[nodiscard]] double integral(const Ray& ray, double t0, double t1) const;
  /// An upper bound of the density.
  [[nodiscard]] double maximum() const { return maximum_; }
  [[nodiscard]] const Bounds& box() const { return grid_->box; }

 private:
  [[nodiscard]] double at_lattice(const Vec3d& p) const;

  const DensityGrid* grid_;
  Vec3d scale_;  ///< cells a metre
  double maximum_ = 0;
};

}  // namespace penumbra
