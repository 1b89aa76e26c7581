#include "cli/program.h"

#include <fcntl.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <csignal>
#include <cstdlib>
#include <fstream>
#include <iterator>
#include <stdexcept>
#include <thread>

#include "test_paths.h"

extern char** environ;

namespace penumbra::test {
namespace {

pid_t spawn(const std::vector<std::string>& words, const std::string& out, const std::string& err) {
  std::vector<char*> argv;
  std::vector<std::string> copies = words;
  for (std::string& word : copies) argv.push_back(word.data());
  argv.push_back(nullptr);
  posix_spawn_file_actions_t files;
  posix_spawn_file_actions_init(&files);
  posix_spawn_file_actions_addopen(&files, STDIN_FILENO, "/dev/null", O_RDONLY, 0);
  posix_spawn_file_actions_addopen(&files, STDOUT_FILENO, out.c_str(), O_WRONLY | O_CREAT | O_TRUNC, 0600);
  posix_spawn_file_actions_addopen(&files, STDERR_FILENO, err.c_str(), O_WRONLY | O_CREAT | O_TRUNC, 0600);
  pid_t process = -1;
  const int failure = ::posix_spawn(&process, argv[0], &files, nullptr, argv.data(), environ);
  posix_spawn_file_actions_destroy(&files);
  if (failure != 0) throw std::runtime_error("cannot run " + words[0]);
  return process;
}

int code_of(int status) { return WIFEXITED(status) ? WEXITSTATUS(status) : 1000 + WTERMSIG(status); }

std::vector<std::string> with_program(const std::vector<std::string>& arguments) {
  std::vector<std::string> words{PENUMBRA_PROGRAM};
  words.insert(words.end(), arguments.begin(), arguments.end());
  return words;
}

}  // namespace

Workshop::Workshop() {
  std::string name = (std::filesystem::temp_directory_path() / "penumbra-cli-XXXXXX").string();
  if (::mkdtemp(name.data()) == nullptr) throw std::runtime_error("cannot make a folder for the test");
  folder_ = name;
}

Workshop::~Workshop() {
  std::error_code none;
  std::filesystem::remove_all(folder_, none);
}

std::string Workshop::file(std::string_view name, std::string_view text) const {
  std::ofstream(folder_ / name, std::ios::binary) << text;
  return path(name);
}

std::vector<std::string> Workshop::contents() const {
  std::vector<std::string> names;
  for (const auto& entry : std::filesystem::directory_iterator(folder_))
    names.push_back(entry.path().filename().string());
  std::sort(names.begin(), names.end());
  return names;
}

Outcome command(const std::vector<std::string>& words) {
  const Workshop pipes;
  const pid_t process = spawn(words, pipes.path("out"), pipes.path("err"));
  int status = 0;
  ::waitpid(process, &status, 0);
  return {code_of(status), read_text(pipes.path("out")), read_text(pipes.path("err"))};
}

Outcome penumbra(const std::vector<std::string>& arguments) { return command(with_program(arguments)); }

Running::Running(const std::vector<std::string>& arguments)
    : process_(spawn(with_program(arguments), pipes_.path("out"), pipes_.path("err"))) {}

bool Running::says(std::string_view text) {
  constexpr int tries = 2000;
  for (int i = 0; i < tries && !reaped_; ++i) {
    if (read_text(pipes_.path("err")).find(text) != std::string::npos) return true;
    reaped_ = ::waitpid(process_, &status_, WNOHANG) == process_;
    std::this_thread::sleep_for(std::chrono::milliseconds(10));
  }
  return false;
}

void Running::signal(int number) const { ::kill(process_, number); }

Outcome Running::end() {
  if (!reaped_) ::waitpid(process_, &status_, 0);
  reaped_ = true;
  return {code_of(status_), read_text(pipes_.path("out")), read_text(pipes_.path("err"))};
}

std::string read_text(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), {}};
}

}  // namespace penumbra::test
