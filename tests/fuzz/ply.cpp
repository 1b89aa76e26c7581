#include "penumbra/io/ply_reader.h"

#include "reader.h"

void penumbra::fuzz::read(std::span<const std::byte> bytes) {
  with_file(bytes, "ply", [](const auto& path) { (void)read_ply(path); });
}
