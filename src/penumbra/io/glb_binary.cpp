#include "penumbra/io/glb_binary.h"

#include <bit>

namespace penumbra {

static_assert(std::endian::native == std::endian::little, "a .glb is little-endian");
static_assert(sizeof(Vec2f) == 8 && sizeof(Vec3f) == 12 && sizeof(Vec4f) == 16);

std::uint32_t GlbBinary::add_view(std::span<const std::byte> bytes, Target target) {
  views_.push_back({bytes_.size(), bytes.size(), target});
  bytes_.insert(bytes_.end(), bytes.begin(), bytes.end());
  bytes_.resize((bytes_.size() + 3) / 4 * 4);
  return static_cast<std::uint32_t>(views_.size() - 1);
}

std::uint32_t GlbBinary::add(const Accessor& accessor) {
  accessors_.push_back(accessor);
  return static_cast<std::uint32_t>(accessors_.size() - 1);
}

std::uint32_t GlbBinary::add_positions(std::span<const Vec3f> positions) {
  const std::uint32_t index = add_vectors(positions);
  std::array<Vec3f, 2> range{positions[0], positions[0]};
  for (const Vec3f& p : positions) range = {glm::min(range[0], p), glm::max(range[1], p)};
  accessors_[index].range = range;
  return index;
}

std::uint32_t GlbBinary::add_indices(std::span<const std::uint32_t> values, std::size_t vertex_count) {
  if (vertex_count > 65535) return add({add_view(std::as_bytes(values), indices), u32, 1, values.size(), {}});
  const std::vector<std::uint16_t> narrow(values.begin(), values.end());
  return add({add_view(std::as_bytes(std::span(narrow)), indices), u16, 1, values.size(), {}});
}

}  // namespace penumbra
