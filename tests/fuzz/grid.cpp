#include "penumbra/io/density_grid_reader.h"
#include "reader.h"

void penumbra::fuzz::read(std::span<const std::byte> bytes) {
  with_arrays(bytes, {"density", "bounds", "absorption", "scattering", "g"},
              [](const auto& path) { (void)read_density_grid(path); });
}
