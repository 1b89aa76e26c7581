#pragma once

#include <string>

#include "cli/program.h"

namespace penumbra::test {

/// A matt square of reflectance 0.5 in the plane z = 0, from -1 to 1, facing +z, that emits `emission` W/(m^2 sr); an
/// OBJ with its MTL. Returns the path.
[[nodiscard]] std::string matt_square(const Workshop& workshop, double emission = 0, double half_side = 1);

/// A glTF triangle seen by two cameras, "front" and "side". Returns the path.
[[nodiscard]] std::string two_cameras(const Workshop& workshop);

}  // namespace penumbra::test
