#include "penumbra/io/vdb_grid.h"

#include "penumbra/file/file_error.h"
#include "penumbra/io/density_grid_reader.h"

#ifdef PENUMBRA_OPENVDB
#include <fmt/format.h>
#include <openvdb/openvdb.h>
#include <openvdb/tools/Interpolation.h>

#include <algorithm>
#include <cmath>
#endif

namespace penumbra {

#ifdef PENUMBRA_OPENVDB

namespace {

openvdb::FloatGrid::Ptr float_grid(openvdb::io::File& file) {
  openvdb::FloatGrid::Ptr first;
  for (auto name = file.beginName(); name != file.endName(); ++name) {
    const auto grid = openvdb::gridPtrCast<openvdb::FloatGrid>(file.readGrid(name.gridName()));
    if (!grid) continue;
    if (name.gridName() == "density") return grid;
    if (!first) first = grid;
  }
  return first;
}

// Densities at the centres of even cells over the world bounds of what is there.
DensityGrid sampled(const openvdb::FloatGrid& grid, const std::string& path) {
  const openvdb::CoordBBox voxels = grid.evalActiveVoxelBoundingBox();
  if (voxels.empty()) throw FileError(path, "", "its density grid is empty");
  const openvdb::BBoxd index(voxels.min().asVec3d() - openvdb::Vec3d(0.5),
                             voxels.max().asVec3d() + openvdb::Vec3d(0.5));
  const openvdb::BBoxd world = grid.transform().indexToWorld(index);
  DensityGrid made;
  made.box = {{world.min().x(), world.min().y(), world.min().z()}, {world.max().x(), world.max().y(), world.max().z()}};
  const openvdb::Vec3d size = grid.voxelSize();
  double count = 1;
  for (int axis = 0; axis < 3; ++axis) {
    const double cells = std::max(1.0, std::round(made.box.extent()[axis] / size[axis]));
    count *= cells;
    if (count > static_cast<double>(most_grid_bytes / sizeof(float))) {
      throw FileError(path, "", "its density grid would take more than 1 GiB; resample it");
    }
    made.cells[static_cast<std::size_t>(axis)] = static_cast<std::uint32_t>(cells);
  }
  const openvdb::tools::GridSampler<openvdb::FloatGrid, openvdb::tools::BoxSampler> sampler(grid);
  const Vec3d step = made.box.extent() / Vec3d(made.cells[0], made.cells[1], made.cells[2]);
  for (std::uint32_t x = 0; x < made.cells[0]; ++x) {
    for (std::uint32_t y = 0; y < made.cells[1]; ++y) {
      for (std::uint32_t z = 0; z < made.cells[2]; ++z) {
        const Vec3d at = made.box.lower + (Vec3d(x, y, z) + 0.5) * step;
        const float density = sampler.wsSample({at.x, at.y, at.z});
        if (!std::isfinite(density)) throw FileError(path, "", "its density grid holds values that are not finite");
        made.values.push_back(std::max(0.0F, density));
      }
    }
  }
  return made;
}

}  // namespace

bool reads_vdb() { return true; }

DensityGrid read_vdb_grid(const std::filesystem::path& path) {
  try {
    openvdb::initialize();
    openvdb::io::File file(path.string());
    file.open();
    const openvdb::FloatGrid::Ptr grid = float_grid(file);
    if (!grid) throw FileError(path.string(), "", "holds no float grid, so no density");
    return sampled(*grid, path.string());
  } catch (const openvdb::Exception& e) {
    throw FileError(path.string(), "", fmt::format("cannot be read as OpenVDB: {}", e.what()));
  }
}

#else

bool reads_vdb() { return false; }

DensityGrid read_vdb_grid(const std::filesystem::path& path) {
  throw FileError(path.string(), "",
                  "this program was built without OpenVDB and reads no .vdb; install libopenvdb-dev and libboost-dev "
                  "and build again, or convert the grid to .npz");
}

#endif

}  // namespace penumbra
