#pragma once

#include <cstddef>
#include <filesystem>

#include "penumbra/scene/medium.h"

namespace penumbra {

/// The most bytes of densities that are read, in the file's own precision.
inline constexpr std::size_t most_grid_bytes = std::size_t{1} << 30;

/// Reads smoke: a medium with a density grid, by the file's extension.
///
/// .npz (NumPy): `density`, an array of three dimensions x, y, z of single or double precision, >= 0, values at the
/// centres of the cells; `bounds`, 2 x 3, lower and upper corner in the world, m. Optional: `absorption` and
/// `scattering`, 3 values each, 1/m at density 1 (default: 0.2 and 0.8 in all bands), and `g`, one value (default 0).
///
/// .vdb (OpenVDB): the float grid `density`, else the first float grid, in its own world coordinates (m), with the same
/// default coefficients. Only where the program was built with OpenVDB.
///
/// Throws FileError, also for more than `most_grid_bytes`.
[[nodiscard]] Medium read_density_grid(const std::filesystem::path& path);

/// Whether this build reads .vdb.
[[nodiscard]] bool reads_vdb();

}  // namespace penumbra
