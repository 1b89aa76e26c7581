#include "penumbra/radiosity/meshing/element_builder.h"

#include <algorithm>
#include <bit>
#include <cassert>
#include <utility>

#include "penumbra/math/rng.h"
#include "penumbra/parallel/parallel_for.h"
#include "penumbra/radiosity/meshing/face_table.h"
#include "penumbra/radiosity/meshing/surface_average.h"

namespace penumbra {

MadePatchMesh make_element_faces(const Scene& scene, PatchSides sides, int shape_segments) {
  PatchMeshOptions options;
  options.sides = sides;
  options.degenerate = DegenerateFaces::drop;
  options.duplicates = DuplicateFaces::drop;
  options.shape_segments = shape_segments;
  return make_patch_mesh(scene, options);
}

std::size_t ElementBuilder::PositionHash::operator()(const Vec3d& p) const {
  // + 0.0 makes one of the two zeros, which compare equal.
  return hash_key(std::bit_cast<std::uint64_t>(p.x + 0.0), std::bit_cast<std::uint64_t>(p.y + 0.0),
                  std::bit_cast<std::uint64_t>(p.z + 0.0));
}

ElementBuilder::ElementBuilder(const PatchMesh& faces) : faces_(faces) { mesh_.bands = faces.bands; }

std::uint32_t ElementBuilder::add(std::uint32_t parent, std::span<const Vec3d> cell) {
  assert(parent < faces_.radiating_count);
  std::vector<std::uint32_t> corners;
  for (const Vec3d& p : cell) {
    const auto [at, is_new] = vertex_of_.try_emplace(p, static_cast<std::uint32_t>(mesh_.vertices.size()));
    if (is_new) mesh_.vertices.push_back(p);
    corners.push_back(at->second);
  }
  const std::uint32_t row = faces_.surface_of[parent];
  mesh_.surfaces.push_back(faces_.surfaces[row]);
  mesh_.surfaces.back().area = 0;
  for (std::size_t b = 0; b < faces_.bands; ++b) {
    mesh_.reflectance.push_back(faces_.reflectance[row * faces_.bands + b]);
    mesh_.emission.push_back(faces_.emission[row * faces_.bands + b]);
  }
  return add_patch(mesh_, corners, static_cast<std::uint32_t>(mesh_.surfaces.size() - 1), faces_.face_of[parent]);
}

PatchMesh ElementBuilder::finish() && { return std::move(mesh_); }

void paint_elements(const Scene& scene, int shape_segments, PatchMesh& elements) {
  assert(elements.bands == 3 && elements.patch_count() == elements.radiating_count);
  const FaceTable faces(scene, shape_segments);
  const SurfaceAverage average(scene, faces);
  std::vector<SurfacePaint> paints(elements.patch_count());
  parallel_for(elements.patch_count(), 64, [&](std::size_t first, std::size_t last) {
    for (std::size_t p = first; p < last; ++p) {
      paints[p] = average.over(elements.surfaces[elements.surface_of[p]].face, elements.polygon(p));
    }
  });
  std::fill(elements.reflectance.begin(), elements.reflectance.end(), 0);
  std::fill(elements.emission.begin(), elements.emission.end(), 0);
  for (std::size_t p = 0; p < elements.patch_count(); ++p) {
    const std::uint32_t s = elements.surface_of[p];
    const PatchSurface& surface = elements.surfaces[s];
    const double share = elements.areas[p] / surface.area;
    const Vec3d& emission = surface.back ? paints[p].back_emission : paints[p].emission;
    for (std::size_t b = 0; b < 3; ++b) {
      elements.reflectance[3 * s + b] += share * paints[p].reflectance[static_cast<int>(b)];
      elements.emission[3 * s + b] += share * emission[static_cast<int>(b)];
    }
  }
}

}  // namespace penumbra
