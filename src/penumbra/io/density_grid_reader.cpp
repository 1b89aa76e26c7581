#include "penumbra/io/density_grid_reader.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>

#include "penumbra/file/file_error.h"
#include "penumbra/io/npz_reader.h"
#include "penumbra/io/vdb_grid.h"

namespace penumbra {
namespace {

// At density 1, 1/m, where a file does not say.
constexpr float usual_absorption = 0.2F;
constexpr float usual_scattering = 0.8F;

/// Reads one .npz.
class NpzGrid {
 public:
  explicit NpzGrid(const std::filesystem::path& path) : path_(path.string()), npz_(path) {}

  Medium read() {
    Medium medium{.name = std::filesystem::path(path_).stem().string(),
                  .absorption = coefficient("absorption", usual_absorption),
                  .scattering = coefficient("scattering", usual_scattering)};
    if (npz_.has("g")) {
      const auto g = npz_.reals("g").values;
      if (g.size() != 1 || !(std::abs(g[0]) < 1)) fail("g", "must be one number between -1 and 1");
      medium.asymmetry = static_cast<float>(g[0]);
    }
    medium.density = grid();
    return medium;
  }

 private:
  [[noreturn]] void fail(std::string_view array, std::string_view sentence) const {
    throw FileError(path_, fmt::format("array '{}'", array), sentence);
  }

  Rgb coefficient(const char* name, float usual) const {
    if (!npz_.has(name)) return Rgb(usual);
    const auto c = npz_.reals(name).values;
    const bool good = c.size() == 3 && std::ranges::all_of(c, [](double v) { return v >= 0 && v < 1e30; });
    if (!good) fail(name, "must hold 3 numbers of 0 or more, in 1/m");
    return {static_cast<float>(c[0]), static_cast<float>(c[1]), static_cast<float>(c[2])};
  }

  DensityGrid grid() const {
    if (!npz_.has("density") || !npz_.has("bounds")) {
      throw FileError(path_, "",
                      "is no density grid: it needs an array 'density' of three dimensions x, y, z and an array "
                      "'bounds' of 2 x 3, the lower and the upper corner in metres");
    }
    const auto bounds = npz_.reals("bounds").values;
    if (bounds.size() != 6) fail("bounds", "must hold 2 x 3 numbers, the lower and the upper corner in metres");
    DensityGrid grid;
    grid.box = {{bounds[0], bounds[1], bounds[2]}, {bounds[3], bounds[4], bounds[5]}};
    for (int axis = 0; axis < 3; ++axis) {
      if (!(grid.box.upper[axis] > grid.box.lower[axis]) || !std::isfinite(grid.box.extent()[axis])) {
        fail("bounds", "must be finite, the upper corner above the lower one in x, y and z");
      }
    }
    constexpr std::size_t longest_head = 65546;
    if (npz_.bytes_of("density") > most_grid_bytes + longest_head)
      fail("density", "holds more than 1 GiB; resample it");
    const NpzReader::Reals density = npz_.reals("density");
    if (density.shape.size() != 3 || density.values.empty()) {
      fail("density", fmt::format("has {} dimensions; a grid has three, x, y and z", density.shape.size()));
    }
    for (int axis = 0; axis < 3; ++axis) {
      const std::size_t cells = density.shape[static_cast<std::size_t>(axis)];
      if (cells > std::numeric_limits<std::uint32_t>::max()) fail("density", "has too many cells");
      grid.cells[static_cast<std::size_t>(axis)] = static_cast<std::uint32_t>(cells);
    }
    grid.values.assign(density.values.begin(), density.values.end());
    const auto is_density = [](float v) { return v >= 0 && v <= std::numeric_limits<float>::max(); };
    if (!std::ranges::all_of(grid.values, is_density)) fail("density", "holds values below 0, or none at all (NaN)");
    return grid;
  }

  std::string path_;
  NpzReader npz_;
};

}  // namespace

Medium read_density_grid(const std::filesystem::path& path) {
  const std::string extension = path.extension().string();
  if (extension == ".npz") return NpzGrid(path).read();
  if (extension != ".vdb") {
    throw FileError(path.string(), "", "density grids are read from .npz and .vdb files; convert it to one of these");
  }
  return {.name = path.stem().string(),
          .absorption = Rgb(usual_absorption),
          .scattering = Rgb(usual_scattering),
          .density = read_vdb_grid(path)};
}

}  // namespace penumbra
