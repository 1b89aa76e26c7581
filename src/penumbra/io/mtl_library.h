#pragma once

#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <string_view>

#include "penumbra/io/warning_tally.h"
#include "penumbra/math/spectrum.h"

namespace penumbra {

/// A picture that a material of an MTL file names, with the options that are heeded.
struct MtlMap {
  std::string file;  ///< as written
  std::string place;
  Vec2d scale{1};   ///< -s, u and v
  Vec2d offset{0};  ///< -o, u and v, v upwards
  bool clamp = false;
};

/// What an MTL file says of a material; nothing where it is silent.
struct MtlMaterial {
  std::string file;                ///< the MTL file, as messages call it
  std::string place;               ///< "line 3"
  std::optional<Rgb> ambient;      ///< Ka
  std::optional<Rgb> diffuse;      ///< Kd, reflectance
  std::optional<Rgb> specular;     ///< Ks, reflectance
  std::optional<Rgb> emission;     ///< Ke, radiance, W/(m^2 sr)
  std::optional<Rgb> filter;       ///< Tf, transmittance
  std::optional<float> shininess;  ///< Ns, exponent
  std::optional<float> ior;        ///< Ni
  std::optional<float> opacity;    ///< d, or 1 - Tr where there is no d
  std::optional<int> illum;
  std::optional<MtlMap> diffuse_map;   ///< map_Kd
  std::optional<MtlMap> emission_map;  ///< map_Ke
  std::optional<MtlMap> opacity_map;   ///< map_d
};

using MtlLibrary = std::map<std::string, MtlMaterial, std::less<>>;

/// Reads an MTL file; of materials with one name the first stands. When no material has a Ke and one has a Ka above 1,
/// which no reflectance can be, that Ka is taken for its emission, with a warning.
/// @param path the file to read, and what messages call it. Throws FileError that names the line.
[[nodiscard]] MtlLibrary read_mtl(const std::filesystem::path& path, WarningTally& warnings);

}  // namespace penumbra
