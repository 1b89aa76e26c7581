#pragma once

#include <cstddef>

#include "penumbra/scene/mesh.h"

namespace penumbra {

// The measures of the hall, metres: +Y up, the nave along z, the court in the middle of an aisle of one bay.
namespace hall {
inline constexpr double bay = 3;
inline constexpr int bays_x = 4, bays_z = 7;
inline constexpr double court_x = 6, court_z = 10.5;  ///< half sizes, to the column axes
inline constexpr double outer_x = 9, outer_z = 13.5;  ///< half sizes, to the outer walls
inline constexpr double eaves = 10;                   ///< height of the aisle ceiling and of the vault's springing
}  // namespace hall

/// What the shell's triangles are made of, as indices of materials.
struct ShellMaterials {
  std::uint32_t floor = 0, wall = 0, vault = 0;
};

/// The hall's floor, walls, aisle ceilings and barrel vault: one closed surface, fronts inwards. With enough triangles
/// the walls show their stones.
/// @param triangles how many; met exactly, or one less when it cannot be even. At least 40.
[[nodiscard]] Mesh atrium_shell(std::size_t triangles, const ShellMaterials& materials);

}  // namespace penumbra
