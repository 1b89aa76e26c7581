#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <vector>

#include "penumbra/radiosity/form_factors/nusselt.h"
#include "penumbra/radiosity/meshing/element_builder.h"
#include "penumbra/radiosity/meshing/shading_mesh.h"
#include "penumbra/radiosity/meshing/uniform.h"
#include "radiosity/scene_makers.h"

/// A floor of 2 m by 2 m, a lamp of 0.5 m by 0.5 m at 2 m above its middle that emits 1 W/m^2, and a square of 0.4 m at
/// 0.5 m in between: umbra, penumbra and light, all in closed form.
namespace penumbra::shadow_floor {

inline Scene scene(bool with_blocker = true) {
  Scene scene = polygon_scene({floor_rectangle(-1, 1, -1, 1)});
  scene.materials[0] = matt(0.5);
  scene.materials.push_back(matt(0, 1 / std::numbers::pi));
  add_polygons(scene, "lamp", {reversed(floor_rectangle(-0.25, 0.25, -0.25, 0.25, 2))}, 1);
  if (with_blocker) add_polygons(scene, "blocker", {floor_rectangle(-0.2, 0.2, -0.2, 0.2, 0.5)});
  return scene;
}

/// Of a part of the lamp, seen from a floor point with nothing in between, W/m^2.
inline double from_part(const Vec3d& p, double x0, double x1, double y0, double y1) {
  if (!(x1 > x0 && y1 > y0)) return 0;
  return point_to_polygon(p, {0, 0, 1}, reversed(floor_rectangle(x0, x1, y0, y1, 2)));
}

inline double unhindered(const Vec3d& p) { return from_part(p, -0.25, 0.25, -0.25, 0.25); }

/// The lamp less the blocker's shadow on it, which is a square four times as large as the blocker.
inline double irradiance(const Vec3d& p) {
  const auto hidden = [](double c) {
    return std::array{std::clamp(c + 4 * (-0.2 - c), -0.25, 0.25), std::clamp(c + 4 * (0.2 - c), -0.25, 0.25)};
  };
  const auto [x0, x1] = hidden(p.x);
  const auto [y0, y1] = hidden(p.y);
  if (!(x1 > x0 && y1 > y0)) return unhindered(p);
  return from_part(p, -0.25, x0, -0.25, 0.25) + from_part(p, x1, 0.25, -0.25, 0.25) + from_part(p, x0, x1, -0.25, y0) +
         from_part(p, x0, x1, y1, 0.25);
}

/// The elements that lie on the floor, of whatever mesh.
inline PatchMesh floor_of(const PatchMesh& elements) {
  const MadePatchMesh faces = make_element_faces(scene(), PatchSides::front, 8);
  ElementBuilder builder(faces.mesh);
  for (std::size_t e = 0; e < elements.patch_count(); ++e) {
    if (elements.surfaces[e].face == 0 && !elements.surfaces[e].back) builder.add(0, elements.polygon(e));
  }
  return std::move(builder).finish();
}

/// The floor alone in squares, `count` or a few less.
inline PatchMesh uniform_floor(std::size_t count) {
  const double n = std::floor(std::sqrt(static_cast<double>(count)));
  return floor_of(make_uniform_elements(scene(), {.element_size = 2 / n, .sides = PatchSides::front}).mesh);
}

/// Values at the vertices of a floor's shading mesh, at a point of the floor.
inline double interpolate(const ShadingMesh& mesh, const std::vector<double>& values, const Vec3d& p) {
  for (const auto& [a, b, c] : mesh.triangles) {
    const Vec3d &pa = mesh.positions[a], &pb = mesh.positions[b], &pc = mesh.positions[c];
    if (p.x < std::min({pa.x, pb.x, pc.x}) || p.x > std::max({pa.x, pb.x, pc.x})) continue;
    const double area = cross(pb - pa, pc - pa).z;
    const double wb = cross(p - pa, pc - pa).z / area, wc = cross(pb - pa, p - pa).z / area;
    if (std::min({wb, wc, 1 - wb - wc}) < -1e-12) continue;
    return (1 - wb - wc) * values[a] + wb * values[b] + wc * values[c];
  }
  return NAN;
}

/// Root mean square over 100 x 100 points of the floor of what linear interpolation between exact values at the
/// vertices misses, W/m^2.
inline double rms_of(const PatchMesh& floor) {
  const ShadingMesh shading = make_shading_mesh(floor);
  std::vector<double> values;
  for (const Vec3d& p : shading.positions) values.push_back(irradiance(p));
  double sum = 0;
  for (int y = 0; y < 100; ++y) {
    for (int x = 0; x < 100; ++x) {
      const Vec3d p(-1 + 0.02 * (x + 0.37), -1 + 0.02 * (y + 0.61), 0);
      const double error = interpolate(shading, values, p) - irradiance(p);
      sum += error * error;
    }
  }
  return std::sqrt(sum / 10000);
}

}  // namespace penumbra::shadow_floor
