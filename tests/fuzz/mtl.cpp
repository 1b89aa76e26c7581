#include "penumbra/io/mtl_library.h"

#include "reader.h"

void penumbra::fuzz::read(std::span<const std::byte> bytes) {
  with_file(bytes, "mtl", [](const auto& path) {
    WarningTally warnings(path.string());
    (void)read_mtl(path, warnings);
  });
}
