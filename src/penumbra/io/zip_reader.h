#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <map>
#include <string>
#include <vector>

namespace penumbra {

/// The members of a ZIP archive, stored or deflated, with 64-bit sizes where they are used (PKWARE APPNOTE 6.3). Holds
/// the file in memory. Sizes and places are checked before they are believed, checksums after reading.
class ZipReader {
 public:
  /// Throws FileError when the file cannot be read or has no directory of members.
  explicit ZipReader(const std::filesystem::path& path);

  [[nodiscard]] bool has(const std::string& name) const { return members_.contains(name); }
  /// A member's size once unpacked, as the directory claims it. Throws FileError when there is none of the name.
  [[nodiscard]] std::size_t size_of(const std::string& name) const { return member(name).size; }
  /// A member's bytes. Throws FileError when there is none of the name, it is cut short, damaged, encrypted, or packed
  /// in another way.
  [[nodiscard]] std::vector<std::byte> read(const std::string& name) const;
  /// The file as the user named it.
  [[nodiscard]] const std::string& path() const { return path_; }

 private:
  struct Member {
    std::uint64_t method = 0, flags = 0, checksum = 0, packed_size = 0, size = 0, offset = 0;
  };
  [[nodiscard]] const Member& member(const std::string& name) const;
  [[nodiscard]] std::uint64_t number(std::uint64_t at, int size) const;
  [[nodiscard]] std::uint64_t find_end() const;
  void read_directory(std::uint64_t at, std::uint64_t count);
  void read_wide_sizes(Member& member, std::uint64_t at, std::uint64_t end) const;

  std::string path_;
  std::vector<std::byte> bytes_;
  std::map<std::string, Member> members_;
};

}  // namespace penumbra
