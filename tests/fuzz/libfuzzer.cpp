// The way libFuzzer calls a target.
#include <cstdint>

#include "reader.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  (void)penumbra::fuzz::is_refused(std::as_bytes(std::span(data, size)));
  return 0;
}
