#include "penumbra/io/meshopt_view.h"

#include <meshoptimizer.h>

#include <stdexcept>

namespace penumbra {
namespace {

[[noreturn]] void fail(const char* what) {
  throw std::invalid_argument(std::string("its meshopt data ") + what + "; export the file again");
}

// The most that the codecs can unpack from so many bytes: a group of 16 values of one byte each takes at least 2 bits;
// a triangle, or an index, at least one byte.
void check_size(std::size_t bytes, const MeshoptPacking& p) {
  constexpr std::size_t most_elements = 0xFFFFFFFFU;
  if (p.stride == 0 || p.stride > 256 || p.count > most_elements) fail("claim an impossible size");
  const bool fits = p.mode == "ATTRIBUTES"  ? p.count * p.stride / 64 <= bytes
                    : p.mode == "TRIANGLES" ? p.count / 3 <= bytes
                                            : p.count <= bytes;
  if (!fits) fail("are too short for the elements that they claim");
}

void check_kind(const MeshoptPacking& p) {
  const bool attributes = p.mode == "ATTRIBUTES";
  if (!attributes && p.mode != "TRIANGLES" && p.mode != "INDICES") fail("are of a mode that is not known");
  if (attributes && p.stride % 4 != 0) fail("have a byteStride that is no multiple of 4");
  if (!attributes && p.stride != 2 && p.stride != 4) fail("hold indices of neither 2 nor 4 bytes");
  if (p.mode == "TRIANGLES" && p.count % 3 != 0) fail("hold no whole triangles");
  if (p.filter == "NONE") return;
  const bool octahedral = p.filter == "OCTAHEDRAL" && (p.stride == 4 || p.stride == 8);
  const bool quaternion = p.filter == "QUATERNION" && p.stride == 8;
  const bool known = octahedral || quaternion || p.filter == "EXPONENTIAL";
  if (!attributes || !known) fail("have a filter that does not fit them");
}

void unfilter(const MeshoptPacking& p, std::vector<std::byte>& unpacked) {
  if (p.filter == "OCTAHEDRAL") meshopt_decodeFilterOct(unpacked.data(), p.count, p.stride);
  if (p.filter == "QUATERNION") meshopt_decodeFilterQuat(unpacked.data(), p.count, p.stride);
  if (p.filter == "EXPONENTIAL") meshopt_decodeFilterExp(unpacked.data(), p.count, p.stride);
}

}  // namespace

std::vector<std::byte> decode_meshopt(std::span<const std::byte> bytes, const MeshoptPacking& packing) {
  check_kind(packing);
  check_size(bytes.size(), packing);
  std::vector<std::byte> unpacked(packing.count * packing.stride);
  if (packing.count == 0) return unpacked;
  const auto* data = reinterpret_cast<const unsigned char*>(bytes.data());
  int wrong = 0;
  if (packing.mode == "ATTRIBUTES") {
    wrong = meshopt_decodeVertexBuffer(unpacked.data(), packing.count, packing.stride, data, bytes.size());
  } else if (packing.mode == "TRIANGLES") {
    wrong = meshopt_decodeIndexBuffer(unpacked.data(), packing.count, packing.stride, data, bytes.size());
  } else {
    wrong = meshopt_decodeIndexSequence(unpacked.data(), packing.count, packing.stride, data, bytes.size());
  }
  if (wrong != 0) fail("are damaged");
  unfilter(packing, unpacked);
  return unpacked;
}

}  // namespace penumbra
