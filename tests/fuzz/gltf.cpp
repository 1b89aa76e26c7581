#include "penumbra/io/gltf_reader.h"

#include "reader.h"

// At rest, then in motion.
void penumbra::fuzz::read(std::span<const std::byte> bytes) {
  with_file(bytes, "gltf", [](const auto& path) {
    (void)read_gltf(path);
    (void)read_gltf(path, {.shutter = Shutter{0, 1}});
  });
}
