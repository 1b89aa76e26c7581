#include "penumbra/image/webp_decode.h"

#include "reader.h"

void penumbra::fuzz::read(std::span<const std::byte> bytes) { (void)decode_webp(bytes, "input.webp"); }
