#pragma once

#include <string_view>

namespace penumbra::cli {

/// Prints and flushes. Throws std::system_error when the reader is gone or the device is full.
void write_standard_output(std::string_view text);

}  // namespace penumbra::cli
