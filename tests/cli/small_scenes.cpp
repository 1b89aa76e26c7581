#include "cli/small_scenes.h"

#include <fmt/core.h>

namespace penumbra::test {

std::string matt_square(const Workshop& workshop, double emission, double half_side) {
  const double h = half_side;
  (void)workshop.file("square.mtl",
                      fmt::format("newmtl matt\nKd 0.5 0.5 0.5\nKs 0 0 0\nKe {0} {0} {0}\nillum 1\n", emission));
  return workshop.file("square.obj",
                       fmt::format("mtllib square.mtl\nusemtl matt\nv -{0} -{0} 0\nv {0} -{0} 0\nv {0} {0} 0\n"
                                   "v -{0} {0} 0\nf 1 2 3 4\n",
                                   h));
}

std::string two_cameras(const Workshop& workshop) {
  return workshop.file("cameras.gltf", R"({
  "asset": {"version": "2.0"},
  "scene": 0,
  "scenes": [{"nodes": [0, 1, 2]}],
  "nodes": [{"mesh": 0}, {"camera": 0, "translation": [0.3, 0.3, 2]},
            {"camera": 1, "translation": [2, 0.3, 2], "rotation": [0, 0.3826834, 0, 0.9238795]}],
  "cameras": [{"name": "front", "type": "perspective", "perspective": {"yfov": 0.9, "znear": 0.1}},
              {"name": "side", "type": "perspective", "perspective": {"yfov": 0.9, "znear": 0.1}}],
  "meshes": [{"primitives": [{"attributes": {"POSITION": 0}}]}],
  "accessors": [{"bufferView": 0, "componentType": 5126, "count": 3, "type": "VEC3", "min": [0, 0, 0], "max": [1, 1, 0]}],
  "bufferViews": [{"buffer": 0, "byteLength": 36}],
  "buffers": [{"byteLength": 36,
               "uri": "data:application/octet-stream;base64,AAAAAAAAAAAAAAAAAACAPwAAAAAAAAAAAAAAAAAAgD8AAAAA"}]
})");
}

}  // namespace penumbra::test
