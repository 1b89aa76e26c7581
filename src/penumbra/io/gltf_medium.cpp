#include "penumbra/io/gltf_medium.h"

#include <fmt/format.h>

#include <cmath>
#include <cstring>

#include "penumbra/io/density_grid_reader.h"

namespace penumbra {
namespace {

Rgb coefficient(const JsonPlace& place, std::string_view key) {
  const auto c = place.numbers<3>(key, {0, 0, 0});
  const Rgb value(Vec3d(c[0], c[1], c[2]));
  const bool good = value.x >= 0 && value.y >= 0 && value.z >= 0 && std::isfinite(max_component(value));
  if (!good) place.fail(fmt::format("its {} must be 0 or more in each band, in 1/m", key));
  return value;
}

std::optional<Bounds> box_of(const JsonPlace& place) {
  if (!place.has("lower") && !place.has("upper")) return std::nullopt;
  const auto low = place.numbers<3>("lower", {0, 0, 0}), high = place.numbers<3>("upper", {0, 0, 0});
  const Bounds box{{low[0], low[1], low[2]}, {high[0], high[1], high[2]}};
  const bool good = box.lower.x < box.upper.x && box.lower.y < box.upper.y && box.lower.z < box.upper.z;
  if (!good) place.fail("its box must have its upper corner above its lower one in x, y and z");
  return box;
}

// Densities that the glTF itself holds.
DensityGrid held_grid(GltfDocument& document, const JsonPlace& density, const std::optional<Bounds>& box) {
  if (!box) density.fail("the medium needs lower and upper, the corners of its box");
  const auto cells = density.numbers<3>("cells", {0, 0, 0});
  DensityGrid grid;
  grid.box = *box;
  double count = 1;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    if (!(cells[axis] >= 1) || cells[axis] != std::floor(cells[axis]) || cells[axis] > 1e6) {
      density.fail("its cells must be three whole numbers above 0, along x, y and z");
    }
    grid.cells[axis] = static_cast<std::uint32_t>(cells[axis]);
    count *= cells[axis];
  }
  const auto view = document.view(density.required_whole("bufferView"), density);
  if (static_cast<double>(view.bytes.size()) != 4 * count) {
    density.fail(fmt::format("its buffer view has {} bytes, but {} cells of 4 bytes need {}", view.bytes.size(), count,
                             4 * count));
  }
  grid.values.resize(view.bytes.size() / 4);
  std::memcpy(grid.values.data(), view.bytes.data(), view.bytes.size());
  return grid;
}

}  // namespace

Medium read_gltf_medium(GltfDocument& document, const JsonPlace& place) {
  Medium medium;
  medium.box = box_of(place);
  if (const auto density = place.object("density")) {
    if (density->has("file")) {
      medium = read_density_grid(document.uri_file(density->text("file"), *density));
    } else {
      medium.density = held_grid(document, *density, medium.box);
      medium.box.reset();
    }
  }
  if (place.has("name")) medium.name = place.text("name");
  if (place.has("absorption")) medium.absorption = coefficient(place, "absorption");
  if (place.has("scattering")) medium.scattering = coefficient(place, "scattering");
  if (const auto g = place.number("g")) {
    if (!(std::abs(*g) < 1)) place.fail("its g must lie between -1 and 1");
    medium.asymmetry = static_cast<float>(*g);
  }
  return medium;
}

}  // namespace penumbra
