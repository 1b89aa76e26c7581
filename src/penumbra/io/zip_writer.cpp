#include "penumbra/io/zip_writer.h"

#include <zlib.h>

namespace penumbra {
namespace {

constexpr std::uint64_t wide = 0xFFFFFFFFU;  // from here on a size needs 64 bits

// Little-endian fields, one after the other.
class Fields {
 public:
  Fields& u16(std::uint64_t v) { return put(v, 2); }
  Fields& u32(std::uint64_t v) { return put(v, 4); }
  Fields& u64(std::uint64_t v) { return put(v, 8); }
  Fields& text(std::string_view t) {
    bytes_ += t;
    return *this;
  }
  [[nodiscard]] const std::string& bytes() const { return bytes_; }

 private:
  Fields& put(std::uint64_t v, int size) {
    for (int i = 0; i < size; ++i) bytes_ += static_cast<char>(v >> (8 * i) & 0xFF);
    return *this;
  }
  std::string bytes_;
};

constexpr std::uint64_t stored = 0;
constexpr std::uint64_t first_day = 0x21;  // 1 January 1980: archives of the same data are the same bytes

std::uint32_t checksum_of(std::string_view bytes) {
  return static_cast<std::uint32_t>(::crc32_z(0, reinterpret_cast<const unsigned char*>(bytes.data()), bytes.size()));
}

}  // namespace

void ZipWriter::write(std::string_view bytes) {
  out_.write(bytes);
  at_ += bytes.size();
}

void ZipWriter::begin_member(std::string_view name, std::uint32_t checksum, std::uint64_t size) {
  members_.push_back({std::string(name), checksum, size, at_});
  const bool big = size >= wide;
  Fields f;
  f.u32(0x04034b50).u16(big ? 45 : 20).u16(0).u16(stored).u16(0).u16(first_day).u32(checksum);
  f.u32(big ? wide : size).u32(big ? wide : size).u16(name.size()).u16(big ? 20 : 0).text(name);
  if (big) f.u16(1).u16(16).u64(size).u64(size);
  write(f.bytes());
}

void ZipWriter::add(std::string_view name, std::string_view bytes) {
  begin_member(name, checksum_of(bytes), bytes.size());
  write(bytes);
}

void ZipWriter::add(std::string_view name, std::string_view head, SpoolFile& tail) {
  const auto checksum = static_cast<std::uint32_t>(
      ::crc32_combine(checksum_of(head), tail.checksum(), static_cast<z_off_t>(tail.size())));
  begin_member(name, checksum, head.size() + tail.size());
  write(head);
  tail.copy_to(out_);
  at_ += tail.size();
}

void ZipWriter::finish() {
  const std::uint64_t directory = at_;
  for (const Member& m : members_) {
    const bool big = m.size >= wide || m.offset >= wide;
    Fields f;
    f.u32(0x02014b50).u16(45).u16(big ? 45 : 20).u16(0).u16(stored).u16(0).u16(first_day).u32(m.checksum);
    f.u32(big ? wide : m.size).u32(big ? wide : m.size).u16(m.name.size()).u16(big ? 28 : 0);
    f.u16(0).u16(0).u16(0).u32(0).u32(big ? wide : m.offset).text(m.name);
    if (big) f.u16(1).u16(24).u64(m.size).u64(m.size).u64(m.offset);
    write(f.bytes());
  }
  const std::uint64_t size = at_ - directory, end = at_;
  Fields f;
  if (directory >= wide) {
    f.u32(0x06064b50).u64(44).u16(45).u16(45).u32(0).u32(0).u64(members_.size()).u64(members_.size());
    f.u64(size).u64(directory);
    f.u32(0x07064b50).u32(0).u64(end).u32(1);
  }
  const bool far = directory >= wide;
  f.u32(0x06054b50).u16(0).u16(0).u16(members_.size()).u16(members_.size());
  f.u32(size).u32(far ? wide : directory).u16(0);
  write(f.bytes());
}

}  // namespace penumbra
