#pragma once

#include <cstdint>
#include <vector>

#include "penumbra/baking/chart_plane.h"
#include "penumbra/scene/scene.h"

namespace penumbra {

/// A scene cut into charts, each in its plane. Numbers are the scene's own, instances in order.
struct Unfolding {
  std::vector<std::uint32_t> first_triangle;     ///< by instance, and the total
  std::vector<std::uint32_t> chart_of_triangle;  ///< charts in order of their first triangles
  std::vector<ChartPlane> planes;                ///< by chart
  std::vector<std::uint32_t> objects;            ///< by chart
};

/// Cuts every instance into charts whose normals differ by at most `chart_angle`, rad, and which do not overlap when
/// projected: one that would is cut by half the angle. See grow_charts().
[[nodiscard]] Unfolding unfold(const Scene& scene, double chart_angle);

/// The first triangle of each instance when all are numbered in order, and the total.
[[nodiscard]] std::vector<std::uint32_t> number_triangles(const Scene& scene);

}  // namespace penumbra
