#include "penumbra/io/matrix_reader.h"

#include "reader.h"

void penumbra::fuzz::read(std::span<const std::byte> bytes) {
  // An archive begins with PK; all else is Matrix Market.
  const bool archive = bytes.size() > 1 && bytes[0] == std::byte{80} && bytes[1] == std::byte{75};
  with_file(bytes, archive ? "npz" : "mtx", [](const auto& path) { (void)read_matrix(path); });
}
