#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "penumbra/scene/scene.h"

namespace penumbra {

/// A scene and what its reader had to say about it: each warning is one full sentence that names file, place and
/// what was done; like cases are counted into one ("3 zero-area triangles were kept but receive no light").
struct LoadedScene {
  Scene scene;
  std::vector<std::string> warnings;
};

}  // namespace penumbra
