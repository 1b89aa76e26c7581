#include "standard_error.h"

#include <cstdio>

namespace penumbra::cli {

void write_standard_error(std::string_view text) {
  std::fwrite(text.data(), 1, text.size(), stderr);
  std::fflush(stderr);
}

}  // namespace penumbra::cli
