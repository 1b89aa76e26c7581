#include "penumbra/image/image_io.h"

#include "reader.h"

void penumbra::fuzz::read(std::span<const std::byte> bytes) {
  // PNG and JPEG: whatever is neither is refused at once.
  (void)decode_image8(bytes, "input.png");
}
