#include "reader.h"

#include <unistd.h>

#include <fstream>
#include <stdexcept>
#include <string>

#include "penumbra/file/file_error.h"

namespace penumbra::fuzz {
namespace {

/// A folder that dies with the process.
class Folder {
 public:
  Folder() : path_(memory() / ("penumbra-fuzz-" + std::to_string(getpid()))) {
    std::filesystem::create_directories(path_);
  }
  ~Folder() {
    std::error_code ignored;
    std::filesystem::remove_all(path_, ignored);
  }
  Folder(const Folder&) = delete;
  Folder& operator=(const Folder&) = delete;

  [[nodiscard]] const std::filesystem::path& path() const { return path_; }

 private:
  // Files in memory where the system has them: a fuzzer writes thousands a second.
  static std::filesystem::path memory() {
    return std::filesystem::is_directory("/dev/shm") ? "/dev/shm" : std::filesystem::temp_directory_path();
  }

  std::filesystem::path path_;
};

}  // namespace

void with_file(std::span<const std::byte> bytes, const char* extension,
               const std::function<void(const std::filesystem::path&)>& use) {
  static const Folder folder;
  const auto path = folder.path() / (std::string("input.") + extension);
  std::ofstream(path, std::ios::binary)
      .write(reinterpret_cast<const char*>(bytes.data()), static_cast<std::streamsize>(bytes.size()));
  use(path);
}

bool is_refused(std::span<const std::byte> bytes) {
  try {
    read(bytes);
    return false;
  } catch (const FileError&) {
    return true;
  } catch (const std::invalid_argument&) {
    return true;
  }
}

}  // namespace penumbra::fuzz
