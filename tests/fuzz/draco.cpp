#include <array>
#include "penumbra/io/draco_mesh.h"

#include "reader.h"

void penumbra::fuzz::read(std::span<const std::byte> bytes) {
  constexpr std::array<std::uint32_t, 3> wanted{0, 1, 2};
  (void)decode_draco(bytes, wanted);
}
