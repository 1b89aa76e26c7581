#include "scenes.h"

#include <algorithm>
#include <cmath>
#include <fstream>
#include <numeric>
#include <sstream>
#include <stdexcept>

#include "penumbra/io/vs3_reader.h"

namespace penumbra::figures {

PatchMesh mesh_of(const std::vector<Polygon>& radiating, const std::vector<Polygon>& obstructions) {
  PatchMesh mesh;
  mesh.surfaces.resize(radiating.size());
  const auto add = [&](const Polygon& polygon, std::uint32_t surface, std::uint32_t face) {
    std::vector<std::uint32_t> corners(polygon.size());
    std::iota(corners.begin(), corners.end(), static_cast<std::uint32_t>(mesh.vertices.size()));
    mesh.vertices.insert(mesh.vertices.end(), polygon.begin(), polygon.end());
    add_patch(mesh, corners, surface, face);
  };
  std::uint32_t face = 0;
  for (const Polygon& p : radiating) {
    add(p, face, face);
    ++face;
  }
  for (const Polygon& p : obstructions) add(p, PatchMesh::no_surface, face++);
  return mesh;
}

std::vector<Polygon> subdivided(const Polygon& p, int n) {
  std::vector<Polygon> parts;
  const Vec3d u = (p[1] - p[0]) / static_cast<double>(n), v = (p[3] - p[0]) / static_cast<double>(n);
  for (int j = 0; j < n; ++j) {
    for (int i = 0; i < n; ++i) {
      const Vec3d at = p[0] + static_cast<double>(i) * u + static_cast<double>(j) * v;
      parts.push_back({at, at + u, at + u + v, at + v});
    }
  }
  return parts;
}

Polygon lower_square() { return {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}}; }
Polygon upper_square(double d) { return {{0, 0, d}, {0, 1, d}, {1, 1, d}, {1, 0, d}}; }
Polygon standing_square() { return {{0, 0, 0}, {0, 1, 0}, {0, 1, 1}, {0, 0, 1}}; }

PatchMesh model_mesh(const std::string& name) {
  return make_patch_mesh(read_vs3(std::string(PENUMBRA_FIGURE_DATA "/") + name).model).mesh;
}

ReferenceBox reference_box() {
  ReferenceBox box{model_mesh("box345_AB1.0.vs3"), {}};
  const std::size_t n = box.mesh.surface_count();
  box.factors.assign(n, std::vector<double>(n, 0.0));
  std::ifstream in(PENUMBRA_FIGURE_DATA "/box345_AB1.0_F.csv");
  if (!in) throw std::runtime_error("no reference factors in " PENUMBRA_FIGURE_DATA);
  for (std::string line; std::getline(in, line);) {
    if (line.empty() || line[0] == '#') continue;
    std::istringstream words(line);
    std::size_t i = 0, j = 0;
    double area = 0, factor = 0;
    char comma = 0;
    words >> i >> comma >> j >> comma >> area >> comma >> factor;
    box.factors.at(i - 1).at(j - 1) = factor;
    box.factors.at(j - 1).at(i - 1) = factor * area / box.mesh.surfaces[j - 1].area;
  }
  return box;
}

RowErrors row_errors(const FactorMatrix& matrix, const std::vector<std::vector<double>>& truth) {
  RowErrors errors;
  for (std::size_t i = 0; i < matrix.rows(); ++i) {
    double sum = 0;
    for (std::size_t j = 0; j < matrix.rows(); ++j) sum += std::abs(matrix.at(i, j) - truth[i][j]);
    errors.mean += sum / static_cast<double>(matrix.rows());
    errors.worst = std::max(errors.worst, sum);
    errors.estimated = std::max(errors.estimated, matrix.row_errors[i]);
  }
  return errors;
}

}  // namespace penumbra::figures
