#include "penumbra/io/zip_reader.h"

#include <fmt/format.h>
#include <zlib.h>

#include <algorithm>
#include <limits>
#include <span>

#include "penumbra/file/file_error.h"
#include "penumbra/file/input_file.h"

namespace penumbra {
namespace {

constexpr std::uint64_t wide = 0xFFFFFFFFU;  // the true number stands in the 64-bit fields
constexpr std::uint64_t end_size = 22, wide_end_size = 56, wide_locator_size = 20;
// No deflated stream grows by more (zlib's technical notes): a greater size is a lie or an attack.
constexpr std::uint64_t largest_growth = 1032;

std::vector<std::byte> inflate(std::span<const std::byte> packed, std::uint64_t size) {
  std::vector<std::byte> out(size);
  ::z_stream stream{};
  if (::inflateInit2(&stream, -MAX_WBITS) != Z_OK) throw std::bad_alloc();
  constexpr std::size_t most = std::numeric_limits<uInt>::max();
  std::size_t taken = 0, made = 0;
  int state = Z_OK;
  while (state == Z_OK) {
    const std::size_t in = std::min(most, packed.size() - taken), room = std::min(most, out.size() - made);
    // zlib does not write through next_in, though its type lets it.
    stream.next_in = const_cast<Bytef*>(reinterpret_cast<const Bytef*>(packed.data() + taken));
    stream.avail_in = static_cast<uInt>(in);
    stream.next_out = reinterpret_cast<Bytef*>(out.data() + made);
    stream.avail_out = static_cast<uInt>(room);
    state = ::inflate(&stream, Z_NO_FLUSH);
    taken += in - stream.avail_in;
    made += room - stream.avail_out;
    if (state == Z_OK && stream.avail_in == in && stream.avail_out == room) break;  // it cannot go on
  }
  ::inflateEnd(&stream);
  if (state != Z_STREAM_END || made != size) out.clear();
  return out;
}

}  // namespace

ZipReader::ZipReader(const std::filesystem::path& path) : path_(path.string()), bytes_(read_file(path)) {
  const std::uint64_t end = find_end();
  std::uint64_t count = number(end + 10, 2), directory = number(end + 16, 4);
  if (count == 0xFFFF || directory == wide) {
    if (end < wide_locator_size || number(end - wide_locator_size, 4) != 0x07064b50) {
      throw FileError(path_, fmt::format("byte {}", end),
                      "the archive's 64-bit directory is missing; the file is damaged");
    }
    const std::uint64_t wide_end = number(end - wide_locator_size + 8, 8);
    if (wide_end > bytes_.size() || bytes_.size() - wide_end < wide_end_size || number(wide_end, 4) != 0x06064b50) {
      throw FileError(path_, fmt::format("byte {}", end), "the archive's 64-bit directory is damaged");
    }
    count = number(wide_end + 32, 8);
    directory = number(wide_end + 48, 8);
  }
  read_directory(directory, count);
}

std::uint64_t ZipReader::number(std::uint64_t at, int size) const {
  if (at > bytes_.size() || bytes_.size() - at < static_cast<std::uint64_t>(size)) {
    throw FileError(path_, fmt::format("byte {}", at), "the archive is cut short");
  }
  std::uint64_t value = 0;
  for (int i = 0; i < size; ++i)
    value |= std::to_integer<std::uint64_t>(bytes_[at + static_cast<std::uint64_t>(i)]) << (8 * i);
  return value;
}

// The record at the end may be followed by a comment of up to 65535 bytes.
std::uint64_t ZipReader::find_end() const {
  if (bytes_.size() >= end_size) {
    const std::uint64_t last = bytes_.size() - end_size, first = last > 0xFFFF ? last - 0xFFFF : 0;
    for (std::uint64_t at = last + 1; at-- > first;) {
      if (number(at, 4) == 0x06054b50) return at;
    }
  }
  throw FileError(path_, "", "is no .npz file: the directory of a ZIP archive is missing; the file may be cut short");
}

void ZipReader::read_directory(std::uint64_t at, std::uint64_t count) {
  for (std::uint64_t k = 0; k < count; ++k) {
    if (number(at, 4) != 0x02014b50)
      throw FileError(path_, fmt::format("byte {}", at), "the archive's directory is damaged");
    Member member;
    member.flags = number(at + 8, 2);
    member.method = number(at + 10, 2);
    member.checksum = number(at + 16, 4);
    member.packed_size = number(at + 20, 4);
    member.size = number(at + 24, 4);
    member.offset = number(at + 42, 4);
    const std::uint64_t name_size = number(at + 28, 2), extra = number(at + 30, 2), comment = number(at + 32, 2);
    const std::uint64_t name_at = at + 46, extra_at = name_at + name_size;
    if (extra_at + extra > bytes_.size())
      throw FileError(path_, fmt::format("byte {}", at), "the archive is cut short");
    read_wide_sizes(member, extra_at, extra_at + extra);
    members_[std::string(reinterpret_cast<const char*>(bytes_.data() + name_at), name_size)] = member;
    at = extra_at + extra + comment;
  }
}

void ZipReader::read_wide_sizes(Member& member, std::uint64_t at, std::uint64_t end) const {
  while (at + 4 <= end) {
    const std::uint64_t kind = number(at, 2), next = at + 4 + number(at + 2, 2);
    std::uint64_t field = at + 4;
    if (kind == 1) {
      for (std::uint64_t* value : {&member.size, &member.packed_size, &member.offset}) {
        if (*value != wide || field + 8 > std::min(next, end)) continue;
        *value = number(field, 8);
        field += 8;
      }
    }
    at = next;
  }
}

const ZipReader::Member& ZipReader::member(const std::string& name) const {
  const auto found = members_.find(name);
  if (found == members_.end()) throw FileError(path_, "", fmt::format("the archive holds no {}", name));
  return found->second;
}

std::vector<std::byte> ZipReader::read(const std::string& name) const {
  const Member& m = member(name);
  if (number(m.offset, 4) != 0x04034b50)
    throw FileError(path_, name, "does not begin where the directory says; the file is damaged");
  if ((m.flags & 1U) != 0) throw FileError(path_, name, "is encrypted; save it without a password");
  if (m.method != 0 && m.method != 8)
    throw FileError(path_, name, "is packed in an unknown way; save it stored or deflated");
  const std::uint64_t begin = m.offset + 30 + number(m.offset + 26, 2) + number(m.offset + 28, 2);
  if (begin > bytes_.size() || bytes_.size() - begin < m.packed_size) throw FileError(path_, name, "is cut short");
  if (m.method == 0 ? m.size != m.packed_size : m.size / largest_growth > m.packed_size) {
    throw FileError(path_, name, "has a size that cannot be; the file is damaged");
  }
  const auto packed = std::span(bytes_).subspan(begin, m.packed_size);
  std::vector<std::byte> out =
      m.method == 0 ? std::vector<std::byte>(packed.begin(), packed.end()) : inflate(packed, m.size);
  const auto* text = reinterpret_cast<const Bytef*>(out.data());
  if (out.size() != m.size || ::crc32_z(0, text, out.size()) != m.checksum) {
    throw FileError(path_, name, "is damaged: its checksum does not fit");
  }
  return out;
}

}  // namespace penumbra
