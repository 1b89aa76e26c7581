#include <array>
#include "penumbra/io/draco_mesh.h"

#include "reader.h"

void penumbra::fuzz::read(std::span<const std::byte> bytes) {
  constexpr std::array<std::uint32_t, 1> wanted{0};  // the positions, which every mesh has
  (void)decode_draco(bytes, wanted);
}
