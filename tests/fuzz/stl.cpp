#include "penumbra/io/stl_reader.h"

#include "reader.h"

void penumbra::fuzz::read(std::span<const std::byte> bytes) {
  with_file(bytes, "stl", [](const auto& path) { (void)read_stl(path); });
}
