#include "penumbra/file/input_file.h"

#include <cerrno>
#include <cstring>
#include <fstream>
#include <system_error>

#include "penumbra/file/file_error.h"

namespace penumbra {

std::vector<std::byte> read_file(const std::filesystem::path& path, std::size_t max_bytes) {
  std::error_code error;
  const auto status = std::filesystem::status(path, error);
  if (status.type() == std::filesystem::file_type::not_found) {
    throw FileError(path.string(), "", "no such file; check the path and its spelling");
  }
  if (error) throw FileError(path.string(), "", "cannot be read: " + error.message());
  if (std::filesystem::is_directory(status)) {
    throw FileError(path.string(), "", "is a directory; name a file in it");
  }
  std::ifstream in(path, std::ios::binary);
  if (!in) throw FileError(path.string(), "", std::string("cannot be opened: ") + std::strerror(errno));

  std::vector<std::byte> bytes;
  std::vector<char> block(std::size_t{1} << 20);
  // Read until the end instead of trusting a size: pipes and /dev files have none.
  while (in) {
    in.read(block.data(), static_cast<std::streamsize>(block.size()));
    const auto got = static_cast<std::size_t>(in.gcount());
    if (bytes.size() + got > max_bytes) {
      throw FileError(path.string(), "",
                      "is larger than " + std::to_string(max_bytes) + " bytes, the most that is read");
    }
    const auto* first = reinterpret_cast<const std::byte*>(block.data());
    bytes.insert(bytes.end(), first, first + got);
  }
  if (in.bad()) throw FileError(path.string(), "byte " + std::to_string(bytes.size()), "cannot be read further");
  return bytes;
}

}  // namespace penumbra
