#include "penumbra/io/matrix_reader.h"

#include <string_view>

#include "reader.h"

// By its beginning: an archive, the arrays of one, Matrix Market or a table.
void penumbra::fuzz::read(std::span<const std::byte> bytes) {
  const std::string_view text(reinterpret_cast<const char*>(bytes.data()), bytes.size());
  const auto use = [](const std::filesystem::path& path) { (void)read_matrix(path); };
  if (text.starts_with("\x93NUMPY")) {
    return with_arrays(bytes, {"format", "shape", "data", "indices", "indptr", "row", "col", "area", "name", "partial"},
                       use);
  }
  with_file(bytes, text.starts_with("PK") ? "npz" : text.starts_with("%") ? "mtx" : "csv", use);
}
