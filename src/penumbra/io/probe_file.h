#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <span>

#include "penumbra/math/vec.h"

namespace penumbra {

/// Irradiance probes as arrays.
struct ProbeArrays {
  std::array<int, 3> count{};            ///< along x, y and z
  std::span<const Vec3d> positions;      ///< m, x fastest
  std::span<const float> coefficients;   ///< [(probe * 9 + coefficient) * 3 + band], W/(m^2 sr)
  std::span<const std::uint8_t> inside;  ///< 1: inside solid matter
  bool partial = false;                  ///< the computation was stopped
};

/// Writes .npz (NumPy, nothing pickled): `count` (3), `positions` (n, 3), `coefficients` (n, 9, 3), `inside` (n) and
/// `partial`; beside the final name and renamed when whole. Throws FileError, std::system_error.
void write_probe_arrays(const std::filesystem::path& path, const ProbeArrays& probes);

}  // namespace penumbra
