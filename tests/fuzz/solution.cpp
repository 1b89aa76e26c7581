#include "penumbra/io/element_table.h"
#include "reader.h"

void penumbra::fuzz::read(std::span<const std::byte> bytes) {
  with_arrays(bytes,
              {"cx",
               "cy",
               "cz",
               "nx",
               "ny",
               "nz",
               "area",
               "reflectance_r",
               "reflectance_g",
               "reflectance_b",
               "emission_r",
               "emission_g",
               "emission_b",
               "irradiance_r",
               "irradiance_g",
               "irradiance_b",
               "radiosity_r",
               "radiosity_g",
               "radiosity_b",
               "surface",
               "object",
               "side",
               "vertices",
               "corner_offsets",
               "corners",
               "partial"},
              [](const auto& path) { (void)read_element_table(path); });
}
