#include "penumbra/image/hdr_file.h"

#include "reader.h"

void penumbra::fuzz::read(std::span<const std::byte> bytes) { (void)decode_hdr(bytes, "input.hdr"); }
