#include "reader.h"

#include <unistd.h>

#include <fstream>
#include <stdexcept>
#include <string>
#include <string_view>

#include "penumbra/file/file_error.h"
#include "penumbra/file/output_file.h"
#include "penumbra/io/zip_writer.h"

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

std::filesystem::path input_file(const char* extension) {
  static const Folder folder;
  return folder.path() / (std::string("input.") + extension);
}

}  // namespace

void with_file(std::span<const std::byte> bytes, const char* extension,
               const std::function<void(const std::filesystem::path&)>& use) {
  const auto path = input_file(extension);
  std::ofstream(path, std::ios::binary)
      .write(reinterpret_cast<const char*>(bytes.data()), static_cast<std::streamsize>(bytes.size()));
  use(path);
}

void with_arrays(std::span<const std::byte> bytes, std::initializer_list<const char*> names,
                 const std::function<void(const std::filesystem::path&)>& use) {
  constexpr std::string_view magic = "\x93NUMPY";
  std::string_view rest(reinterpret_cast<const char*>(bytes.data()), bytes.size());
  const auto path = input_file("npz");
  OutputFile out(path);
  ZipWriter zip(out);
  for (const char* name : names) {
    if (rest.empty()) break;
    const std::string_view array = rest.substr(0, rest.find(magic, 1));
    zip.add(std::string(name) + ".npy", array);
    rest.remove_prefix(array.size());
  }
  zip.finish();
  out.commit();
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
