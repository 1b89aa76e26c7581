#include "penumbra/io/draco_mesh.h"

#include <draco/compression/decode.h>
#include <draco/compression/point_cloud/point_cloud_decoder.h>
#include <draco/core/decoder_buffer.h>
#include <draco/core/varint_decoding.h>
#include <draco/mesh/mesh.h>
#include <draco/metadata/metadata_decoder.h>
#include <fmt/format.h>

#include <cstring>
#include <memory>
#include <new>
#include <stdexcept>

namespace penumbra {
namespace {

[[noreturn]] void fail(const std::string& what) { throw std::invalid_argument("its Draco data " + what); }

draco::DecoderBuffer buffer_of(std::span<const std::byte> bytes) {
  draco::DecoderBuffer buffer;
  buffer.Init(reinterpret_cast<const char*>(bytes.data()), bytes.size());
  return buffer;
}

// The two counts that follow the header; from bitstream 2.2 on as varints, before as 32 bits (Draco bitstream
// specification, sections 3.2 and 4.1).
bool read_count(draco::DecoderBuffer& buffer, bool varint, std::uint32_t& count) {
  return varint ? draco::DecodeVarint(&count, &buffer) : buffer.Decode(&count);
}

// The decoder allocates what the bitstream claims, so the claims are compared with the bytes first. Real meshes take
// half a bit a triangle and more.
void check_claims(std::span<const std::byte> bytes) {
  draco::DecoderBuffer buffer = buffer_of(bytes);
  draco::DracoHeader header{};
  if (!draco::PointCloudDecoder::DecodeHeader(&buffer, &header).ok())
    fail("have no Draco header; export the file again");
  if (header.encoder_type != draco::TRIANGULAR_MESH) fail("hold no triangle mesh; export the file again");
  const int version = header.version_major * 256 + header.version_minor;
  if (version > 0x202) fail("are of a newer version than 2.2; export the file with an older encoder");
  if (version >= 0x103 && (header.flags & METADATA_FLAG_MASK) != 0) {
    draco::GeometryMetadata metadata;
    draco::MetadataDecoder decoder;
    if (!decoder.DecodeGeometryMetadata(&buffer, &metadata)) fail("have damaged metadata; export the file again");
  }
  buffer.set_bitstream_version(static_cast<std::uint16_t>(version));
  const bool edgebreaker = header.encoder_method == draco::MESH_EDGEBREAKER_ENCODING;
  std::uint8_t traversal = 0;
  std::uint32_t ignored = 0;
  if (edgebreaker && !buffer.Decode(&traversal)) fail("are cut off; copy or export the file again");
  if (edgebreaker && version < 0x202 && !read_count(buffer, version >= 0x200, ignored)) fail("are cut off");
  std::uint32_t first = 0;
  std::uint32_t second = 0;
  const bool varint = edgebreaker ? version >= 0x200 : version >= 0x202;
  if (!read_count(buffer, varint, first) || !read_count(buffer, varint, second)) {
    fail("are cut off; copy or export the file again");
  }
  const std::uint64_t most = (std::uint64_t{1} << 16) + 256 * std::uint64_t{bytes.size()};
  if (first > most || second > most) {
    fail(fmt::format("claim {} and {} faces and vertices in only {} bytes; export the file again", first, second,
                     bytes.size()));
  }
}

GltfComponent component_of(draco::DataType type) {
  switch (type) {
    case draco::DT_INT8:
      return GltfComponent::int8;
    case draco::DT_UINT8:
      return GltfComponent::uint8;
    case draco::DT_INT16:
      return GltfComponent::int16;
    case draco::DT_UINT16:
      return GltfComponent::uint16;
    case draco::DT_UINT32:
      return GltfComponent::uint32;
    case draco::DT_FLOAT32:
      return GltfComponent::float32;
    default:
      fail("hold an attribute of a type that glTF does not have; export the file again");
  }
}

DracoAttribute attribute_of(const draco::Mesh& mesh, std::uint32_t id) {
  const draco::PointAttribute* from = mesh.GetAttributeByUniqueId(id);
  if (from == nullptr) fail(fmt::format("have no attribute {}, which the primitive names; export the file again", id));
  if (from->num_components() < 1 || from->num_components() > 4) {
    fail(fmt::format("hold {} components in attribute {}, where glTF has 1 to 4", from->num_components(), id));
  }
  DracoAttribute attribute{
      .id = id, .components = from->num_components(), .type = component_of(from->data_type()), .values = {}};
  const std::size_t element = component_size(attribute.type) * static_cast<std::size_t>(attribute.components);
  attribute.values.resize(element * mesh.num_points());
  for (std::uint32_t point = 0; point < mesh.num_points(); ++point) {
    const draco::AttributeValueIndex value = from->mapped_index(draco::PointIndex(point));
    if (value.value() >= from->size() || !from->IsAddressValid(from->GetAddress(value) + element - 1)) {
      fail(fmt::format("point beyond the values of attribute {}; export the file again", id));
    }
    std::memcpy(attribute.values.data() + element * point, from->GetAddress(value), element);
  }
  return attribute;
}

DracoMesh copied(const draco::Mesh& mesh, std::span<const std::uint32_t> wanted) {
  DracoMesh copy;
  copy.vertex_count = mesh.num_points();
  copy.triangles.reserve(mesh.num_faces());
  for (std::uint32_t f = 0; f < mesh.num_faces(); ++f) {
    const draco::Mesh::Face& face = mesh.face(draco::FaceIndex(f));
    const std::array<std::uint32_t, 3> triangle{face[0].value(), face[1].value(), face[2].value()};
    for (const std::uint32_t corner : triangle) {
      if (corner >= mesh.num_points()) fail(fmt::format("hold triangle {} with a corner beyond its vertices", f));
    }
    copy.triangles.push_back(triangle);
  }
  for (const std::uint32_t id : wanted) copy.attributes.push_back(attribute_of(mesh, id));
  return copy;
}

}  // namespace

DracoMesh decode_draco(std::span<const std::byte> bytes, std::span<const std::uint32_t> wanted) {
  try {
    check_claims(bytes);
    draco::DecoderBuffer buffer = buffer_of(bytes);
    draco::Decoder decoder;
    auto decoded = decoder.DecodeMeshFromBuffer(&buffer);
    if (!decoded.ok()) fail("are damaged; copy or export the file again");
    const std::unique_ptr<draco::Mesh> mesh = std::move(decoded).value();
    return copied(*mesh, wanted);
  } catch (const std::bad_alloc&) {
    fail("claim more than fits into memory; export the file again");
  } catch (const std::length_error&) {
    fail("claim more than fits into memory; export the file again");
  }
}

}  // namespace penumbra
