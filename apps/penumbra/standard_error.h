#pragma once

#include <string_view>

namespace penumbra::cli {

/// Says it on standard error at once. Where nobody listens, as behind a closed pipe, nothing is said: the work goes on,
/// and how it ended is in the exit code.
void write_standard_error(std::string_view text);

}  // namespace penumbra::cli
