#include "penumbra/io/meshopt_view.h"

#include <array>

#include "reader.h"

// What glTF's JSON tells of a packed view comes first: a byte for the mode, one for the filter, two for the bytes an
// element and four for the number of elements, the lower ones first.
void penumbra::fuzz::read(std::span<const std::byte> bytes) {
  constexpr std::array modes{"ATTRIBUTES", "TRIANGLES", "INDICES"};
  constexpr std::array filters{"NONE", "OCTAHEDRAL", "QUATERNION", "EXPONENTIAL"};
  constexpr std::size_t head = 8;
  if (bytes.size() < head) return;
  const auto number = [&](std::size_t at, std::size_t size) {
    std::size_t value = 0;
    for (std::size_t i = 0; i < size; ++i) value |= std::to_integer<std::size_t>(bytes[at + i]) << (8 * i);
    return value;
  };
  const MeshoptPacking packing{.mode = modes[number(0, 1) % modes.size()],
                               .filter = filters[number(1, 1) % filters.size()],
                               .count = number(4, 4),
                               .stride = number(2, 2)};
  (void)decode_meshopt(bytes.subspan(head), packing);
}
