#include "penumbra/file/output_file.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <string>
#include <system_error>

#include "penumbra/file/file_error.h"

namespace penumbra {
namespace {

[[noreturn]] void fail(const std::filesystem::path& path, const char* doing) {
  throw std::system_error(errno, std::generic_category(), path.string() + ": cannot be " + doing);
}

// A name of this process beside the final one, so two runs never share it.
std::filesystem::path partial_name(const std::filesystem::path& path) {
  auto name = path;
  name += ".partial-" + std::to_string(::getpid());
  return name;
}

// Pipes, terminals, /dev/null: renaming over them would take them away from everyone else.
bool is_device(const std::filesystem::path& path) {
  std::error_code none;
  const auto status = std::filesystem::status(path, none);
  return std::filesystem::exists(status) && !std::filesystem::is_regular_file(status) &&
         !std::filesystem::is_directory(status);
}

// A link is followed, so that the file it names is renewed and the link stays.
std::filesystem::path followed(const std::filesystem::path& path) {
  std::error_code none;
  if (!std::filesystem::is_symlink(path, none)) return path;
  auto target = std::filesystem::canonical(path, none);
  return none ? path : target;
}

}  // namespace

OutputFile::OutputFile(const std::filesystem::path& path) : path_(followed(path)), in_place_(is_device(path_)) {
  partial_ = in_place_ ? path_ : partial_name(path_);
  if (std::filesystem::is_directory(path_)) {
    throw FileError(path_.string(), "", "is a directory; name a file to write");
  }
  descriptor_ = ::open(partial_.c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0666);
  if (descriptor_ < 0) {
    const int cause = errno;
    const auto folder = path_.parent_path();
    const bool no_folder = cause == ENOENT && !folder.empty();
    throw FileError(path_.string(), "",
                    no_folder ? "cannot be created: there is no folder " + folder.string() + "; make it first"
                              : std::string("cannot be created: ") + std::strerror(cause));
  }
}

OutputFile::~OutputFile() {
  if (descriptor_ >= 0) {
    ::close(descriptor_);
    if (!in_place_) ::unlink(partial_.c_str());
  }
}

void OutputFile::write(std::span<const std::byte> bytes) {
  while (!bytes.empty()) {
    const ssize_t wrote = ::write(descriptor_, bytes.data(), bytes.size());
    if (wrote < 0 && errno == EINTR) continue;
    if (wrote < 0) fail(path_, "written");
    bytes = bytes.subspan(static_cast<std::size_t>(wrote));
  }
}

void OutputFile::write(std::string_view text) { write(std::as_bytes(std::span(text))); }

void OutputFile::commit() {
  if (::fsync(descriptor_) != 0 && errno != EINVAL && errno != EROFS) fail(path_, "written");
  if (!in_place_ && ::rename(partial_.c_str(), path_.c_str()) != 0) fail(path_, "renamed into place");
  ::close(descriptor_);
  descriptor_ = -1;
}

void check_creatable(const std::filesystem::path& path) {
  if (!is_device(path)) {
    OutputFile{path};
  } else if (::access(path.c_str(), W_OK) != 0) {
    throw FileError(path.string(), "", std::string("cannot be written: ") + std::strerror(errno));
  }
}

}  // namespace penumbra
