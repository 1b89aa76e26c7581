#pragma once

#include <cstdint>
#include <string>

#include "penumbra/scene/scene.h"

namespace penumbra {

/// What tells scenes apart, as 64-bit hashes: equal scenes have equal ones on every machine of one byte order.
struct SceneFingerprint {
  std::uint64_t ways = 0;   ///< what light's ways depend on: surfaces, mirrors and glass, where lights stand
  std::uint64_t light = 0;  ///< what light is: colours and intensities of lights and surfaces, textures

  bool operator==(const SceneFingerprint&) const = default;
};

/// Names and cameras do not count.
[[nodiscard]] SceneFingerprint fingerprint(const Scene& scene);

/// 16 hexadecimal digits each, and back; a text that is none gives 0.
[[nodiscard]] std::string to_text(std::uint64_t hash);
[[nodiscard]] std::uint64_t hash_of_text(const std::string& text);

}  // namespace penumbra
