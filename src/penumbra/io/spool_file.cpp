#include "penumbra/io/spool_file.h"

#include <fcntl.h>
#include <unistd.h>
#include <zlib.h>

#include <algorithm>
#include <cerrno>
#include <string>
#include <system_error>
#include <utility>

#include "penumbra/file/output_file.h"

namespace penumbra {
namespace {

constexpr std::size_t buffer_size = std::size_t{1} << 18;

[[noreturn]] void fail(const std::filesystem::path& path, const char* doing) {
  throw std::system_error(errno, std::generic_category(),
                          path.string() + ": temporary data beside it cannot be " + doing);
}

}  // namespace

SpoolFile::SpoolFile(const std::filesystem::path& beside) : path_(beside) {
  std::string name = beside.string() + ".spool-XXXXXX";
  descriptor_ = ::mkostemp(name.data(), O_CLOEXEC);
  if (descriptor_ < 0) {  // the output may be a pipe in a folder that takes no files
    name = (std::filesystem::temp_directory_path() / "penumbra.spool-XXXXXX").string();
    descriptor_ = ::mkostemp(name.data(), O_CLOEXEC);
  }
  if (descriptor_ < 0) fail(path_, "created");
  ::unlink(name.c_str());  // gone with the process, however that ends
  buffer_.reserve(buffer_size);
}

SpoolFile::~SpoolFile() {
  if (descriptor_ >= 0) ::close(descriptor_);
}

SpoolFile::SpoolFile(SpoolFile&& other) noexcept
    : path_(std::move(other.path_)),
      descriptor_(std::exchange(other.descriptor_, -1)),
      buffer_(std::move(other.buffer_)),
      size_(other.size_),
      checksum_(other.checksum_) {}

void SpoolFile::write(std::span<const std::byte> bytes) {
  size_ += bytes.size();
  while (!bytes.empty()) {
    const std::size_t part = std::min(bytes.size(), buffer_size - buffer_.size());
    buffer_.insert(buffer_.end(), bytes.begin(), bytes.begin() + static_cast<std::ptrdiff_t>(part));
    bytes = bytes.subspan(part);
    if (buffer_.size() == buffer_size) flush();
  }
}

void SpoolFile::flush() {
  checksum_ = static_cast<std::uint32_t>(
      ::crc32_z(checksum_, reinterpret_cast<const unsigned char*>(buffer_.data()), buffer_.size()));
  std::span<const std::byte> bytes(buffer_);
  while (!bytes.empty()) {
    const ssize_t wrote = ::write(descriptor_, bytes.data(), bytes.size());
    if (wrote < 0 && errno == EINTR) continue;
    if (wrote < 0) fail(path_, "written");
    bytes = bytes.subspan(static_cast<std::size_t>(wrote));
  }
  buffer_.clear();
}

void SpoolFile::read(std::uint64_t offset, std::span<std::byte> bytes) {
  flush();
  while (!bytes.empty()) {
    const ssize_t got = ::pread(descriptor_, bytes.data(), bytes.size(), static_cast<off_t>(offset));
    if (got < 0 && errno == EINTR) continue;
    if (got <= 0) fail(path_, "read back");
    bytes = bytes.subspan(static_cast<std::size_t>(got));
    offset += static_cast<std::uint64_t>(got);
  }
}

void SpoolFile::copy_to(OutputFile& out) {
  std::vector<std::byte> block(buffer_size);
  for (std::uint64_t at = 0; at < size_; at += block.size()) {
    const std::span part =
        std::span(block).first(static_cast<std::size_t>(std::min<std::uint64_t>(block.size(), size_ - at)));
    read(at, part);
    out.write(part);
  }
}

}  // namespace penumbra
