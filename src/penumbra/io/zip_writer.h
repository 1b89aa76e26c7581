#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "penumbra/file/output_file.h"
#include "penumbra/io/spool_file.h"

namespace penumbra {

/// Writes an archive of stored (uncompressed) members, with 64-bit sizes where they are needed (PKWARE APPNOTE 6.3).
class ZipWriter {
 public:
  explicit ZipWriter(OutputFile& out) : out_(out) {}

  void add(std::string_view name, std::string_view bytes);
  /// A member that is `head` followed by the spool's bytes.
  void add(std::string_view name, std::string_view head, SpoolFile& tail);
  /// The directory at the end. Nothing may be added after it.
  void finish();

 private:
  struct Member {
    std::string name;
    std::uint32_t checksum;
    std::uint64_t size, offset;
  };
  void begin_member(std::string_view name, std::uint32_t checksum, std::uint64_t size);
  void write(std::string_view bytes);

  OutputFile& out_;
  std::uint64_t at_ = 0;
  std::vector<Member> members_;
};

}  // namespace penumbra
