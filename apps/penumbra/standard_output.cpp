#include "standard_output.h"

#include <cerrno>
#include <cstdio>
#include <system_error>

namespace penumbra::cli {

void write_standard_output(std::string_view text) {
  const bool whole = std::fwrite(text.data(), 1, text.size(), stdout) == text.size();
  if (!whole || std::fflush(stdout) != 0) {
    throw std::system_error(errno, std::generic_category(), "standard output cannot be written");
  }
}

}  // namespace penumbra::cli
