#include "penumbra/image/exr_file.h"

#include "reader.h"

void penumbra::fuzz::read(std::span<const std::byte> bytes) { (void)decode_exr(bytes, "input.exr"); }
