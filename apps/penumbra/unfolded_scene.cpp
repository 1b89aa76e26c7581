#include "unfolded_scene.h"

#include <fmt/core.h>

#include <stdexcept>
#include <utility>
#include <variant>

#include "penumbra/scene/shape_mesh.h"
#include "run_limits.h"
#include "usage_error.h"
#include "world_options.h"

namespace penumbra::cli {
namespace {

Scene without_shapes(Scene scene, std::vector<std::string>& warnings) {
  bool exact = false, endless = false;
  for (const ShapeObject& object : scene.shapes) {
    (std::holds_alternative<Plane>(object.shape) ? endless : exact) = true;
  }
  if (exact) warnings.emplace_back("exact spheres, disks and cylinders are baked as triangles");
  if (endless) {
    warnings.push_back(fmt::format("planes without end are cut to squares of {} m", 2 * plane_cut(scene).half));
  }
  return tessellated(std::move(scene));
}

LightmapAtlas made_atlas(Scene scene, const BakeArguments& arguments) {
  AtlasOptions options;
  options.size = arguments.lightmap_size.value_or(0);
  options.texels_per_metre = arguments.texels_per_metre.value_or(0);
  try {
    return make_lightmap_atlas(std::move(scene), options);
  } catch (const std::invalid_argument& refused) {
    throw UsageError(
        fmt::format("--{}: {}", options.texels_per_metre > 0 ? "texels-per-metre" : "lightmap-size", refused.what()));
  }
}

}  // namespace

UnfoldedScene unfold_scene(const BakeArguments& arguments, Console& console, Interrupt& interrupt,
                           std::vector<std::string>& warnings) {
  UnfoldedScene unfolded;
  const Stopwatch load_watch;
  console.progress("load", 0);
  SceneOptions options = arguments.scene;
  // Where only matter counts, no light is missed.
  if (arguments.kind() == BakeKind::occlusion) options.environment = "0,0,0";
  Scene scene = without_shapes(load_scene(options, warnings), warnings);
  if (arguments.kind() == BakeKind::occlusion) scene.environment.reset();
  refuse_air(scene, arguments.output);
  console.warn(warnings);
  require_room_for_faces(scene, arguments.scene.source);
  unfolded.load_seconds = load_watch.seconds();
  interrupt.something_to_keep();

  const Stopwatch mesh_watch;
  console.progress("mesh", 0);
  unfolded.atlas = made_atlas(std::move(scene), arguments);
  unfolded.texels = make_texels(unfolded.atlas);
  unfolded.mesh_seconds = mesh_watch.seconds();
  return unfolded;
}

TexelSolution::Options solution_options(const BakeArguments& arguments, double noise) {
  return {.noise = noise,
          .front_sides_only = arguments.scene.front_sides_only,
          .opaque_shadows = arguments.opaque_shadows,
          .seed = arguments.common.seed};
}

AtlasFacts facts_of(const UnfoldedScene& scene) {
  return {.width = scene.atlas.width,
          .height = scene.atlas.height,
          .texels_per_metre = scene.atlas.texels_per_metre,
          .charts = scene.atlas.charts.size(),
          .triangles = scene.atlas.first_triangle.back(),
          .texels = scene.texels.count()};
}

Report report_on(const AtlasFacts& atlas) {
  return {{"width", atlas.width},         {"height", atlas.height}, {"charts", atlas.charts},
          {"triangles", atlas.triangles}, {"texels", atlas.texels}, {"texels_per_metre", atlas.texels_per_metre}};
}

}  // namespace penumbra::cli
