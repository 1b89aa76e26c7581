// Gives a target every file of the folders named, in any build: replay_NAME FOLDER... . Seeds are well-formed but for
// a few that show refusals; what once crashed lies among the regressions.
#include <fmt/core.h>

#include <algorithm>
#include <exception>
#include <filesystem>
#include <string>
#include <vector>

#include "penumbra/file/input_file.h"
#include "reader.h"

namespace {

std::vector<std::filesystem::path> files_below(int count, char** folders) {
  std::vector<std::filesystem::path> files;
  for (int i = 0; i < count; ++i) {
    if (!std::filesystem::is_directory(folders[i])) continue;  // no regressions of this format yet
    for (const auto& entry : std::filesystem::recursive_directory_iterator(folders[i])) {
      if (entry.is_regular_file()) files.push_back(entry.path());
    }
  }
  std::sort(files.begin(), files.end());
  return files;
}

}  // namespace

int main(int argc, char** argv) {
  int read = 0, refused = 0, broken = 0;
  for (const auto& file : files_below(argc - 1, argv + 1)) {
    try {
      ++(penumbra::fuzz::is_refused(penumbra::read_file(file)) ? refused : read);
    } catch (const std::exception& defect) {
      fmt::print("{}: {}\n", file.string(), defect.what());
      ++broken;
    }
  }
  fmt::print("{} read, {} refused, {} neither\n", read, refused, broken);
  // A target that reads no seed at all tests nothing.
  return broken == 0 && read > 0 ? 0 : 1;
}
