#include <fmt/core.h>

#include <filesystem>
#include <optional>

#include "command.h"
#include "common_options.h"
#include "console.h"
#include "exit_code.h"
#include "penumbra/file/output_file.h"
#include "penumbra/io/gltf_writer.h"
#include "penumbra/scene/builtin_scenes.h"
#include "report.h"
#include "run_limits.h"
#include "standard_output.h"

namespace penumbra::cli {
namespace {

struct SceneArguments {
  std::string name;
  std::string output;
  bool list = false;
  CommonOptions common;
};

void check(const SceneArguments& arguments) {
  if (arguments.list && !arguments.name.empty())
    throw UsageError("--list takes no scene; leave '" + arguments.name + "' or --list away");
  if (arguments.list && !arguments.output.empty()) throw UsageError("--list writes no file; leave -o away");
  if (!arguments.list && arguments.name.empty())
    throw UsageError("no scene named; penumbra scene --list shows the built-in ones");
  if (!arguments.list && arguments.output.empty()) throw UsageError("no file to write to; add -o FILE.glb");
  if (!arguments.list && std::filesystem::path(arguments.output).extension() != ".glb") {
    throw UsageError("-o " + arguments.output + ": scenes are written as .glb; end the name in .glb");
  }
  check_report(arguments.common);
}

std::optional<SceneArguments> parse(const std::vector<std::string>& arguments) {
  SceneArguments result;
  OptionParser parser("scene", "--list | NAME -o FILE.glb [options]",
                      "lists the built-in scenes, or writes one as a file");
  parser.positional("NAME", "a built-in scene with its parameters: NAME?key=value&key=value", result.name);
  parser.group("Scenes");
  parser.flag("--list", "print the built-in scenes and their parameters", result.list);
  parser.value("-o,--output", "FILE.glb", "the glTF file to write",
               [&](const OptionValue& v) { result.output = v.text; });
  add_common_options(parser, result.common);
  parser.examples({"penumbra scene --list", "penumbra scene 'atrium?triangles=100000' -o atrium.glb"});
  if (!parser.parse(arguments)) return std::nullopt;
  check(result);
  return result;
}

Report listed() {
  Report scenes = Report::array();
  for (const BuiltinScene& scene : builtin_scenes()) {
    scenes.push_back({{"name", scene.name}, {"parameters", scene.parameters}, {"description", scene.description}});
  }
  return {{"scenes", scenes}};
}

int list_scenes(const CommonOptions& common) {
  write_report(common, listed());
  if (common.json) return exit_done;
  std::string table;
  for (const BuiltinScene& scene : builtin_scenes()) {
    table += fmt::format("{:18}{}\n", scene.name, scene.description);
    if (!scene.parameters.empty()) table += fmt::format("{:18}  {}\n", "", scene.parameters);
  }
  write_standard_output(table);
  return exit_done;
}

int write_scene(const SceneArguments& arguments) {
  check_creatable(arguments.output);
  Console console(arguments.common);
  const RunLimits limits(arguments.common);
  const Stopwatch watch;
  const std::string prefix = "builtin:";
  const std::string name = arguments.name.starts_with(prefix) ? arguments.name.substr(prefix.size()) : arguments.name;
  console.progress("make", 0);
  const Scene scene = make_builtin_scene(name);
  console.progress("write", 0);
  const std::vector<std::string> warnings = write_glb(arguments.output, scene);
  console.warn(warnings);
  console.say(fmt::format("{}: {} objects, {} triangles, {:.2f} s", arguments.output, scene.object_count(),
                          scene.triangle_count(), watch.seconds()));
  write_report(arguments.common, {{"command", "scene"},
                                  {"scene", name},
                                  {"output", arguments.output},
                                  {"objects", scene.object_count()},
                                  {"triangles", scene.triangle_count()},
                                  {"seconds", watch.seconds()},
                                  {"warnings", warnings},
                                  {"peak_rss_bytes", peak_memory()}});
  return exit_done;
}

}  // namespace

int run_scene(const std::vector<std::string>& arguments) {
  const auto parsed = parse(arguments);
  if (!parsed) return exit_done;
  return parsed->list ? list_scenes(parsed->common) : write_scene(*parsed);
}

}  // namespace penumbra::cli
