#include "penumbra/io/obj_reader.h"

#include "reader.h"

void penumbra::fuzz::read(std::span<const std::byte> bytes) {
  with_file(bytes, "obj", [](const auto& path) { (void)read_obj(path); });
}
