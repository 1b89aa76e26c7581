#include <fcntl.h>
#include <fmt/core.h>
#include <fmt/ranges.h>
#include <unistd.h>

#include <csignal>
#include <exception>
#include <string>
#include <string_view>
#include <vector>

#include "command.h"
#include "exit_code.h"
#include "nearest_word.h"
#include "standard_output.h"
#include "usage_error.h"

namespace penumbra::cli {
namespace {

struct Command {
  std::string_view name;
  std::string_view summary;
  int (*run)(const std::vector<std::string>&);
};

constexpr Command commands[] = {
    {"render", "draws a picture of a scene", run_render},
    {"bake", "solves the diffuse light of a scene once, for every view", run_bake},
    {"factors", "computes the form factors (view factors) of a mesh", run_factors},
    {"exchange", "computes the exchange of heat by radiation between surfaces", run_exchange},
    {"explain", "shows every ray behind a pixel, and why each ended", run_explain},
    {"check", "looks for holes where light leaks, and for odd numbers in a scene", run_check},
    {"compare", "measures how far two pictures lie apart", run_compare},
    {"scene", "lists the built-in scenes, or writes one as a file", run_scene},
};

int show_overview() {
  std::string text = "Penumbra computes light in scenes.\n\nUsage: penumbra COMMAND [options]\n\n";
  for (const Command& command : commands) text += fmt::format("  {:10}{}\n", command.name, command.summary);
  text +=
      "\npenumbra COMMAND --help explains a command with all its options.\n\nA first picture:\n"
      "  penumbra render builtin:cornell-box --integrator path -o cornell.png\n";
  write_standard_output(text);
  return exit_done;
}

int run(const std::vector<std::string>& arguments) {
  if (arguments.empty() || arguments[0] == "--help" || arguments[0] == "-h" || arguments[0] == "help") {
    return show_overview();
  }
  if (arguments[0] == "--version") {
    write_standard_output("penumbra " PENUMBRA_VERSION "\n");
    return exit_done;
  }
  std::vector<std::string> known;
  for (const Command& command : commands) {
    if (arguments[0] == command.name) return command.run({arguments.begin() + 1, arguments.end()});
    known.emplace_back(command.name);
  }
  throw UsageError(fmt::format("unknown command '{}'{} (commands: {})", arguments[0], did_you_mean(arguments[0], known),
                               fmt::join(known, ", ")));
}

/// A standard stream that is closed would become the file that is opened next, and words would go into it. Here they
/// fail, as they should.
void occupy_closed_streams() {
  for (const int stream : {STDIN_FILENO, STDOUT_FILENO, STDERR_FILENO}) {
    if (::fcntl(stream, F_GETFD) < 0) (void)::open("/dev/null", O_RDONLY);  // takes the lowest number that is free
  }
}

/// A closed pipe or a file over its limit is an error that is told, not a sudden death.
void turn_signals_into_errors() {
  std::signal(SIGPIPE, SIG_IGN);
  std::signal(SIGXFSZ, SIG_IGN);
}

}  // namespace
}  // namespace penumbra::cli

int main(int argc, char** argv) {
  using namespace penumbra::cli;
  occupy_closed_streams();
  turn_signals_into_errors();
  try {
    return run({argv + (argc > 0 ? 1 : 0), argv + argc});
  } catch (...) {
    return report_failure(std::current_exception());
  }
}
