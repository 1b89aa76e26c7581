#include "penumbra/baking/texel_energy.h"

#include <vector>

#include "penumbra/baking/texel_solution.h"
#include "penumbra/parallel/parallel_for.h"

namespace penumbra {
namespace {

double sum_of(const Rgb& v) { return static_cast<double>(v.x) + static_cast<double>(v.y) + static_cast<double>(v.z); }

/// The area that each texel stands for, m^2: its footprint, scaled so that a chart's texels have its area together.
std::vector<double> areas_of_texels(const TexelMap& map) {
  const Texels& texels = map.texels();
  const LightmapAtlas& atlas = map.atlas();
  std::vector<double> true_area(atlas.charts.size(), 0), covered(atlas.charts.size(), 0);
  for (std::size_t i = 0; i < atlas.scene.instances.size(); ++i) {
    const Instance& placed = atlas.scene.instances[i];
    const Mesh& mesh = atlas.scene.meshes[placed.mesh];
    for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
      const auto& v = mesh.triangles[t];
      const Vec3d a = transform_point(placed.to_world, mesh.positions[v[0]]);
      const Vec3d area = cross(transform_point(placed.to_world, mesh.positions[v[1]]) - a,
                               transform_point(placed.to_world, mesh.positions[v[2]]) - a);
      true_area[atlas.chart_of_triangle[atlas.first_triangle[i] + t]] += 0.5 * length(area);
    }
  }
  const auto footprint = [&](std::uint32_t t) { return texels.footprint(t) * texels.footprint(t); };
  for (std::uint32_t t = 0; t < texels.count(); ++t) covered[map.chart(t)] += footprint(t);
  std::vector<double> areas(texels.count(), 0);
  for (std::uint32_t t = 0; t < texels.count(); ++t) {
    const std::uint32_t c = map.chart(t);
    if (covered[c] > 0) areas[t] = footprint(t) * true_area[c] / covered[c];
  }
  return areas;
}

}  // namespace

TexelEnergy texel_energy(const TexelSolution& solution) {
  constexpr std::size_t block = 1024;
  const LightCells& cells = solution.cells();
  const std::vector<double> areas = areas_of_texels(solution.map());
  // Sums over blocks in their order, so that the bits do not depend on the threads.
  std::vector<TexelEnergy> parts((cells.side_count() + block - 1) / block);
  parallel_for(cells.side_count(), block, [&](std::size_t first, std::size_t last) {
    TexelEnergy& part = parts[first / block];
    for (std::size_t s = first; s < last; ++s) {
      const LightCells::Side side = cells.side(s);
      double area = 0;
      for (const std::uint32_t t : side.texels) area += areas[t];
      const std::uint32_t texel = side.texels[side.texels.size() / 2];
      const Place place = side.back ? solution.points()[texel].reversed() : solution.points()[texel];
      part.emitted += area * (sum_of(side.emission) + static_cast<double>(side.sky) +
                              sum_of(Rgb(solution.straight().far_irradiance(place))));
      const double absorbed = area * sum_of(glm::max(Rgb(side.matt) - side.albedo, Rgb(0.0F)) * side.irradiance);
      (side.back && solution.backs_are_black() ? part.absorbed_by_backs : part.absorbed) += absorbed;
    }
  });
  TexelEnergy energy;
  energy.emitted = solution.straight().power();
  for (const TexelEnergy& part : parts) {
    energy.emitted += part.emitted;
    energy.absorbed += part.absorbed;
    energy.absorbed_by_backs += part.absorbed_by_backs;
  }
  energy.unshot = cells.unshot_fraction() * energy.emitted;
  energy.escaped = energy.emitted - energy.absorbed - energy.absorbed_by_backs - energy.unshot;
  return energy;
}

}  // namespace penumbra
