#include <fmt/format.h>

#include <filesystem>
#include <optional>

#include "camera_options.h"
#include "command.h"
#include "console.h"
#include "exit_code.h"
#include "penumbra/file/output_file.h"
#include "penumbra/render/camera_rays.h"
#include "picture_size.h"
#include "ray_tree_drawing.h"
#include "ray_tree_text.h"
#include "report.h"
#include "run_limits.h"
#include "scene_options.h"
#include "standard_output.h"

namespace penumbra::cli {
namespace {

struct ExplainArguments {
  SceneOptions scene;
  CameraOptions camera;
  CommonOptions common;
  PictureSize size;
  std::optional<glm::ivec2> pixel;
  std::string output;
  RayTreeOptions tree;
};

glm::ivec2 pixel_of(const OptionValue& v) {
  constexpr const char* what = "a pixel X,Y, counted from 0,0 at the top left, such as 400,300";
  const auto numbers = number_list(v, 2, what);
  const glm::ivec2 pixel(numbers[0], numbers[1]);
  if (Vec2d(pixel) != Vec2d(numbers[0], numbers[1])) {
    throw UsageError(fmt::format("{} takes {}, not '{}'", v.option, what, v.text));
  }
  return pixel;
}

void check(const ExplainArguments& a) {
  if (!a.pixel) throw UsageError("no pixel to explain; add --pixel X,Y, counted from 0,0 at the top left");
  if (a.pixel->x < 0 || a.pixel->y < 0 || a.pixel->x >= a.size.width || a.pixel->y >= a.size.height) {
    throw UsageError(fmt::format("--pixel {},{} lies outside a picture of {}x{}; --size sets that", a.pixel->x,
                                 a.pixel->y, a.size.width, a.size.height));
  }
  if (a.output.empty()) return;
  const std::string extension = std::filesystem::path(a.output).extension().string();
  if (extension != ".svg" && extension != ".json" && extension != ".dot" && extension != ".txt") {
    throw UsageError(
        fmt::format("-o {}: a ray tree is written as .svg, .json, .dot or .txt; end the name in one of "
                    "them",
                    a.output));
  }
  check_creatable(a.output);
}

std::optional<ExplainArguments> parse(const std::vector<std::string>& arguments) {
  ExplainArguments result;
  OptionParser parser("explain", "SCENE --pixel X,Y [options]", "shows every ray behind a pixel, and why each ended");
  parser.group("Tree");
  parser.value("--pixel", "X,Y", "the pixel, counted from 0,0 at the top left; the ray through its middle is followed",
               [&](const OptionValue& v) { result.pixel = pixel_of(v); });
  add_picture_size_option(parser, result.size);
  parser.value("-o,--output", "TREE",
               "write the tree: .svg draws it over the scene's outline, .json, .dot (Graphviz) or .txt (default: text "
               "on standard output)",
               [&](const OptionValue& v) { result.output = v.text; });
  parser.value(
      "--max-depth", "N", "longest path after the primary ray, in segments (default: 16)",
      [&](const OptionValue& v) { result.tree.max_depth = static_cast<int>(whole_number(v, 1, 1000, "segments")); });
  parser.value("--min-throughput", "X", "rays that weigh less in the picture, 0 to 1, are not sent (default: 0.001)",
               [&](const OptionValue& v) {
                 result.tree.min_throughput = real_number(v, "a share of the light from 0 to 1");
                 if (result.tree.min_throughput < 0 || result.tree.min_throughput > 1) {
                   throw UsageError("--min-throughput takes a share of the light from 0 to 1, not '" + v.text + "'");
                 }
               });
  parser.flag("--opaque-shadows", "glass stops shadow rays (default: it attenuates them)", result.tree.opaque_shadows);
  add_camera_options(parser, result.camera);
  add_scene_options(parser, result.scene);
  add_common_options(parser, result.common);
  parser.examples({"penumbra explain builtin:whitted --pixel 400,300",
                   "penumbra explain builtin:cornell-spheres --pixel 500,420 -o tree.svg"});
  if (!parser.parse(arguments)) return std::nullopt;
  check(result.scene);
  check(result.camera);
  check(result);
  check_report(result.common);
  return result;
}

std::string written_as(const std::string& extension, const RayTree& tree, const Scene& scene,
                       const std::string& title) {
  if (extension == ".svg") return tree_as_svg(tree, scene, title);
  if (extension == ".json") return tree_as_json(tree, scene).dump(2) + "\n";
  if (extension == ".dot") return tree_as_dot(tree, scene);
  return tree_as_text(tree, scene);
}

int explain_pixel(const ExplainArguments& arguments) {
  Console console(arguments.common);
  const RunLimits limits(arguments.common);
  std::vector<std::string> warnings;
  const Scene scene = load_scene(arguments.scene, warnings);
  console.warn(warnings);
  const RayTracer tracer(scene);
  const double aspect = static_cast<double>(arguments.size.width) / arguments.size.height;
  const Camera camera = choose_camera(arguments.camera, tracer, aspect, arguments.scene.source);
  const CameraRays rays(camera, arguments.size.width, arguments.size.height, FilterKind::box, 1);
  const Ray primary = rays.through(arguments.pixel->x + 0.5, arguments.pixel->y + 0.5);
  if (primary.direction == Vec3d(0)) {
    throw UsageError(fmt::format("--pixel {},{} lies outside the fisheye's circle, so no ray leaves it",
                                 arguments.pixel->x, arguments.pixel->y));
  }
  RayTreeOptions options = arguments.tree;
  options.front_sides_only = arguments.scene.front_sides_only;
  options.differential = rays.differential(primary);
  const RayTree tree = make_ray_tree(tracer, primary, options);

  const std::string title = fmt::format("pixel {},{} of {}: {} rays, radiance {:.4g} {:.4g} {:.4g} W/(m^2 sr)",
                                        arguments.pixel->x, arguments.pixel->y, arguments.scene.source,
                                        tree.rays.size(), tree.radiance.x, tree.radiance.y, tree.radiance.z);
  if (!arguments.output.empty()) {
    OutputFile file(arguments.output);
    file.write(written_as(std::filesystem::path(arguments.output).extension().string(), tree, scene, title));
    file.commit();
    console.say(fmt::format("{}: {}", arguments.output, title));
  } else if (!arguments.common.json) {
    write_standard_output(title + "\n" + tree_as_text(tree, scene));
  }
  write_report(arguments.common, {{"command", "explain"},
                                  {"version", PENUMBRA_VERSION},
                                  {"scene", arguments.scene.source},
                                  {"pixel", {arguments.pixel->x, arguments.pixel->y}},
                                  {"radiance", {tree.radiance.x, tree.radiance.y, tree.radiance.z}},
                                  {"rays", tree_as_json(tree, scene)},
                                  {"warnings", warnings}});
  return exit_done;
}

}  // namespace

int run_explain(const std::vector<std::string>& arguments) {
  const auto parsed = parse(arguments);
  return parsed ? explain_pixel(*parsed) : exit_done;
}

}  // namespace penumbra::cli
