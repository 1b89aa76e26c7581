#pragma once

#include <cstddef>
#include <filesystem>
#include <string>
#include <vector>

#include "penumbra/math/vec.h"
#include "penumbra/radiosity/form_factors/factor_matrix.h"
#include "penumbra/radiosity/patch_mesh.h"

namespace penumbra::figures {

using Polygon = std::vector<Vec3d>;

/// Patches, each a row of its own; those from `obstructions` on only hide.
[[nodiscard]] PatchMesh mesh_of(const std::vector<Polygon>& radiating, const std::vector<Polygon>& obstructions = {});

/// n x n equal parts of a parallelogram.
[[nodiscard]] std::vector<Polygon> subdivided(const Polygon& parallelogram, int n);

/// Two unit squares that face each other at a distance: the lower looks up, the upper down.
[[nodiscard]] Polygon lower_square();
[[nodiscard]] Polygon upper_square(double distance);
/// A unit square that stands on the lower square's edge x = 0, looking along x.
[[nodiscard]] Polygon standing_square();

/// A file of tests/data/view3d.
[[nodiscard]] PatchMesh model_mesh(const std::string& name);

/// The 3 x 4 x 5 box with two cubes and its factors, computed independently to 1e-8 (the file names the source).
struct ReferenceBox {
  PatchMesh mesh;
  std::vector<std::vector<double>> factors;
};
[[nodiscard]] ReferenceBox reference_box();

/// Over the rows: the sum over j of |F_ij - truth_ij|, its mean and largest, and the largest that the method estimated.
struct RowErrors {
  double mean = 0, worst = 0, estimated = 0;
};
[[nodiscard]] RowErrors row_errors(const FactorMatrix& matrix, const std::vector<std::vector<double>>& truth);

/// One file a page of docs/theory; each draws its pictures into a folder.
void draw_point(const std::filesystem::path& folder);
void draw_nusselt(const std::filesystem::path& folder);
void draw_hemicube(const std::filesystem::path& folder);
void draw_analytic(const std::filesystem::path& folder);
void draw_adaptive(const std::filesystem::path& folder);
void draw_ray_cast(const std::filesystem::path& folder);
void draw_bsp_tree(const std::filesystem::path& folder);
void draw_auto(const std::filesystem::path& folder);

}  // namespace penumbra::figures
