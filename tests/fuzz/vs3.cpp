#include "penumbra/io/vs3_reader.h"

#include "reader.h"

void penumbra::fuzz::read(std::span<const std::byte> bytes) {
  with_file(bytes, "vs3", [](const auto& path) { (void)read_vs3(path); });
}
