#include "occlusion_bake.h"

#include <fmt/core.h>

#include <utility>

#include "console.h"
#include "exit_code.h"
#include "interrupt.h"
#include "penumbra/baking/atlas_light.h"
#include "penumbra/baking/baked_scene.h"
#include "penumbra/baking/texel_openness.h"
#include "penumbra/io/gltf_writer.h"
#include "penumbra/parallel/parallel_for.h"
#include "report.h"
#include "run_limits.h"
#include "unfolded_scene.h"

namespace penumbra::cli {
namespace {

AtlasLight occlusion_picture(const UnfoldedScene& scene, const TexelOpenness& found) {
  AtlasLightOptions options;
  options.channels = {"Y"};
  options.buried = found.buried;
  AtlasLight made = make_atlas_light(scene.atlas, scene.texels, found.open, options);
  fill_gaps(made);
  return made;
}

std::vector<std::string> write_model(const BakeArguments& arguments, LightmapAtlas atlas, AtlasLight picture,
                                     bool partial) {
  BakedScene baked = baked_scene(std::move(atlas), std::move(picture), BakeProfile::occlusion, 0);
  if (arguments.occlusion_distance) baked.notes["distance"] = fmt::format("{:.6g} m", *arguments.occlusion_distance);
  baked.notes["partial"] = partial ? "true" : "false";
  return write_glb(arguments.output, baked.scene, baked.notes,
                   GltfLightmap{.texture = *baked.lightmap, .uv_set = 1, .kind = GltfLightmap::Kind::occlusion});
}

}  // namespace

int bake_occlusion(const BakeArguments& arguments) {
  Console console(arguments.common);
  Interrupt interrupt;  // before the first thread of the work
  const RunLimits limits(arguments.common);
  std::vector<std::string> warnings;
  UnfoldedScene scene = unfold_scene(arguments, console, interrupt, warnings);
  const AtlasFacts facts = facts_of(scene);

  const Stopwatch gather_watch;
  OpennessOptions options;
  options.distance = arguments.occlusion_distance.value_or(options.distance);
  options.seed = arguments.common.seed;
  options.progress = {[&](std::string_view stage, double fraction) { console.progress(stage, fraction); },
                      interrupt.token()};
  const TexelOpenness found = openness_of_texels(scene.atlas, scene.texels, options);
  AtlasLight picture = occlusion_picture(scene, found);
  const double gather = gather_watch.seconds();

  const Stopwatch write_watch;
  console.progress("write", 0);
  const std::vector<std::string> said =
      write_model(arguments, std::move(scene.atlas), std::move(picture), found.partial);
  console.warn(said);
  warnings.insert(warnings.end(), said.begin(), said.end());
  const double write = write_watch.seconds();

  if (found.partial) console.insist(arguments.output + ": partial, the computation was stopped; texels are black");
  console.say(fmt::format("{}: {} texels in {} charts on {} x {}, {:.2f} s", arguments.output, facts.texels,
                          facts.charts, facts.width, facts.height,
                          scene.load_seconds + scene.mesh_seconds + gather + write));
  write_report(
      arguments.common,
      {{"command", "bake"},
       {"version", PENUMBRA_VERSION},
       {"scene", arguments.scene.source},
       {"output", arguments.output},
       {"profile", "ao"},
       {"seed", arguments.common.seed},
       {"elements", facts.texels},
       {"atlas", report_on(facts)},
       {"rays", found.rays},
       {"seconds", {{"load", scene.load_seconds}, {"mesh", scene.mesh_seconds}, {"gather", gather}, {"write", write}}},
       {"threads", thread_count()},
       {"peak_rss_bytes", peak_memory()},
       {"partial", found.partial},
       {"warnings", warnings}});
  return interrupt.requested() ? exit_interrupted : exit_done;
}

}  // namespace penumbra::cli
