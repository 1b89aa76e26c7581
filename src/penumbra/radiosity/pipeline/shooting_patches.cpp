#include "penumbra/radiosity/pipeline/shooting_patches.h"

#include <utility>

#include "penumbra/math/polygon.h"
#include "penumbra/radiosity/meshing/adaptive_cells.h"
#include "penumbra/radiosity/meshing/element_builder.h"
#include "penumbra/radiosity/meshing/face_cells.h"
#include "penumbra/radiosity/meshing/polygon_division.h"

namespace penumbra {

ShootingPatches make_shooting_patches(const PatchMesh& faces, std::span<const ShadowLine> lines, double size,
                                      double least_size) {
  const AdaptiveCells plates(faces, 1, 0);
  std::vector<FaceCells> cells;
  for (const AdaptiveCells::Plate& plate : plates.plates()) {
    std::vector<FaceCells::Cell> of_plate;
    divide_polygon(faces.polygon(plate.front), size,
                   [&](std::span<const Vec3d> cell) { of_plate.emplace_back(cell.begin(), cell.end()); });
    cells.emplace_back(std::move(of_plate));
  }
  for (const ShadowLine& line : lines) {
    if (line.degree > 0) continue;
    cells[plates.plate_of(line.patch)].cut_along(line.ends[0], line.ends[1], faces.normals[line.patch], least_size);
  }
  ShootingPatches patches;
  ElementBuilder builder(faces);
  std::vector<Vec3d> turned;
  for (std::size_t k = 0; k < cells.size(); ++k) {
    const auto [front, back] = plates.plates()[k];
    for (const FaceCells::Cell& cell : cells[k].cells()) {
      if (!(polygon_area(cell) > 0)) continue;
      builder.add(front, cell);
      patches.face_of.push_back(front);
      if (back == AdaptiveCells::none) continue;
      turned.assign(cell.rbegin(), cell.rend());
      builder.add(back, turned);
      patches.face_of.push_back(back);
    }
  }
  patches.mesh = std::move(builder).finish();
  return patches;
}

}  // namespace penumbra
