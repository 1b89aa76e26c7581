#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <span>
#include <vector>

namespace penumbra {

class OutputFile;

/// Bytes that are written now and read back later, in a nameless file beside the output, so that they need no memory.
/// Throws std::system_error when the device refuses.
class SpoolFile {
 public:
  /// @param beside a file in whose folder the spool stands.
  explicit SpoolFile(const std::filesystem::path& beside);
  ~SpoolFile();
  SpoolFile(SpoolFile&&) noexcept;
  SpoolFile& operator=(SpoolFile&&) = delete;

  void write(std::span<const std::byte> bytes);
  template <class T>
  void write_value(const T& value) {
    write(std::as_bytes(std::span(&value, 1)));
  }

  [[nodiscard]] std::uint64_t size() const { return size_; }
  /// CRC-32 (IEEE 802.3) of all that was written.
  [[nodiscard]] std::uint32_t checksum() {
    flush();
    return checksum_;
  }

  /// Appends everything to `out`.
  void copy_to(OutputFile& out);
  /// Reads bytes [offset, offset + bytes.size()). @pre they were written.
  void read(std::uint64_t offset, std::span<std::byte> bytes);

 private:
  void flush();

  std::filesystem::path path_;
  int descriptor_ = -1;
  std::vector<std::byte> buffer_;
  std::uint64_t size_ = 0;
  std::uint32_t checksum_ = 0;
};

}  // namespace penumbra
