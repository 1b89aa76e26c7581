#include "penumbra/io/gltf_reader.h"

#include "reader.h"

void penumbra::fuzz::read(std::span<const std::byte> bytes) {
  with_file(bytes, "gltf", [](const auto& path) { (void)read_gltf(path); });
}
