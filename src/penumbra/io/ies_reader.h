#pragma once

#include <filesystem>
#include <string_view>

#include "penumbra/scene/photometric_web.h"

namespace penumbra {

/// Reads a luminaire's photometric file: IES LM-63-1986, -1991, -1995 or -2002, type C. TILT=NONE, or TILT=INCLUDE with
/// factors for luminaires that are tilted from how they were measured.
/// Candela values are multiplied by the file's candela multiplier and ballast factors; symmetric planes (horizontal
/// angles that end at 0, 90, 180, or run from 90 to 270) stand for those that they mirror. Throws FileError with the
/// line.
[[nodiscard]] PhotometricWeb read_ies(const std::filesystem::path& path);

/// The same from text. @param path what errors call the file.
[[nodiscard]] PhotometricWeb parse_ies(std::string_view text, const std::filesystem::path& path);

}  // namespace penumbra
