#include <fmt/core.h>

#include <algorithm>
#include <map>
#include <optional>

#include "command.h"
#include "console.h"
#include "exit_code.h"
#include "interrupt.h"
#include "penumbra/radiosity/leaks/leaks.h"
#include "penumbra/scene/lint.h"
#include "report.h"
#include "run_limits.h"
#include "scene_options.h"
#include "standard_output.h"

namespace penumbra::cli {
namespace {

constexpr std::size_t shown_of_a_kind = 10;

struct CheckArguments {
  SceneOptions scene;
  CommonOptions common;
};

std::optional<CheckArguments> parse(const std::vector<std::string>& arguments) {
  CheckArguments result;
  OptionParser parser("check", "SCENE [options]", "looks for holes where light leaks, and for odd numbers in a scene");
  add_scene_source(parser, result.scene);
  add_common_options(parser, result.common);
  parser.examples({"penumbra check room.glb", "penumbra check room.obj --unit mm --json"});
  if (!parser.parse(arguments)) return std::nullopt;
  check(result.scene);
  check_report(result.common);
  return result;
}

Report as_json(const Finding& f) {
  return {{"kind", name_of(f.kind)}, {"sentence", f.sentence}, {"position", {f.position.x, f.position.y, f.position.z}},
          {"object", f.object},      {"count", f.count},       {"size", f.size}};
}

std::string text_of(const std::vector<Finding>& findings) {
  std::map<FindingKind, std::size_t> seen;
  std::string text;
  for (const Finding& f : findings) {
    if (++seen[f.kind] <= shown_of_a_kind) text += fmt::format("{}: {}\n", name_of(f.kind), f.sentence);
  }
  for (const auto& [kind, count] : seen) {
    if (count > shown_of_a_kind) {
      text += fmt::format("{}: and {} more; --json lists them all\n", name_of(kind), count - shown_of_a_kind);
    }
  }
  return text;
}

int check_scene(const CheckArguments& arguments) {
  Console console(arguments.common);
  Interrupt interrupt;
  const RunLimits limits(arguments.common);
  const Stopwatch load_watch;
  console.progress("load", 0);
  const LoadedScene loaded = read_source(arguments.scene);
  console.warn(loaded.warnings);
  require_room_for_faces(loaded.scene, arguments.scene.source);
  const double load_seconds = load_watch.seconds();

  const Stopwatch check_watch;
  const Progress progress{[&](std::string_view stage, double fraction) { console.progress(stage, fraction); },
                          interrupt.token()};
  interrupt.something_to_keep();
  std::vector<Finding> all = find_leaks(loaded.scene, {}, progress);
  for (Finding& f : lint(loaded.scene)) all.push_back(std::move(f));
  const auto first_note = std::stable_partition(all.begin(), all.end(), [](const Finding& f) { return !f.deliberate; });
  const std::vector<Finding> findings(all.begin(), first_note), notes(first_note, all.end());

  Report report{{"command", "check"},
                {"version", PENUMBRA_VERSION},
                {"scene", arguments.scene.source},
                {"clean", findings.empty()},
                {"findings", Report::array()},
                {"notes", Report::array()},
                {"objects", loaded.scene.object_count()},
                {"triangles", loaded.scene.triangle_count()},
                {"seconds", {{"load", load_seconds}, {"check", check_watch.seconds()}}},
                {"peak_rss_bytes", peak_memory()},
                {"partial", interrupt.requested()},
                {"warnings", loaded.warnings}};
  for (const Finding& f : findings) report["findings"].push_back(as_json(f));
  for (const Finding& f : notes) report["notes"].push_back(as_json(f));
  write_report(arguments.common, report);
  if (!arguments.common.json) {
    std::string text = text_of(findings);
    if (!arguments.common.quiet) {
      for (const Finding& f : notes) text += fmt::format("note: {}\n", f.sentence);
      text += findings.empty() ? fmt::format("{}: clean\n", arguments.scene.source)
                               : fmt::format("{}: {} finding{}\n", arguments.scene.source, findings.size(),
                                             findings.size() == 1 ? "" : "s");
    }
    write_standard_output(text);
  }
  if (interrupt.requested()) {
    console.insist("partial: the check was stopped before all was looked at");
    return exit_interrupted;
  }
  return findings.empty() ? exit_done : exit_finding;
}

}  // namespace

int run_check(const std::vector<std::string>& arguments) {
  const auto parsed = parse(arguments);
  return parsed ? check_scene(*parsed) : exit_done;
}

}  // namespace penumbra::cli
