// The Cornell box of 256 x 256 pixels against a reference of 0.5 % noise (tests/data/cornell_reference): the error of
// means over 4 x 4 pixels relative to the mean, the lamp left out, and of single pixels. Blender's Cycles draws the
// same box, exported as glTF, where it is installed: its materials are made matt and its pixels boxes, as ours are.

#include <fmt/format.h>
#include <unistd.h>

#include <cmath>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <iterator>

#include "penumbra/image/image_io.h"
#include "penumbra/scene/builtin_scenes.h"
#include "section.h"

namespace penumbra::bench {
namespace {

constexpr int side = 256;

Image read_reference() {
  std::ifstream in(PENUMBRA_REFERENCE, std::ios::binary);
  const std::vector<char> bytes((std::istreambuf_iterator<char>(in)), {});
  Image image(side, side);
  const std::size_t payload = image.data.size() * sizeof(float);
  if (bytes.size() > payload) std::memcpy(image.data.data(), bytes.data() + (bytes.size() - payload), payload);
  return image;
}

/// Lamp pixels and two around them do not count.
bool near_lamp(const Image& reference, int x, int y) {
  for (int v = std::max(0, y - 2); v <= std::min(side - 1, y + 2); ++v) {
    for (int u = std::max(0, x - 2); u <= std::min(side - 1, x + 2); ++u) {
      if (max_component(reference.rgb(u, v)) >= 10) return true;
    }
  }
  return false;
}

/// Root mean square error of means over `block` x `block` pixels, over the mean.
double error(const Image& a, const Image& reference, int block) {
  double squares = 0, sum = 0;
  int blocks = 0;
  for (int y = 0; y < side; y += block) {
    for (int x = 0; x < side; x += block) {
      Vec3d difference(0), mean(0);
      int n = 0;
      for (int k = 0; k < block * block; ++k) {
        const int u = x + k % block, v = y + k / block;
        if (near_lamp(reference, u, v)) continue;
        difference += Vec3d(a.rgb(u, v)) - Vec3d(reference.rgb(u, v));
        mean += Vec3d(reference.rgb(u, v));
        ++n;
      }
      if (n == 0) continue;
      squares += dot(difference, difference) / (3.0 * n * n);
      sum += (mean.x + mean.y + mean.z) / (3.0 * n);
      ++blocks;
    }
  }
  return std::sqrt(squares / blocks) / (sum / blocks);
}

/// What the script needs to know of each material: its colour and what it emits.
nlohmann::json materials_of(const Scene& scene) {
  nlohmann::json all;
  for (const Material& m : scene.materials) {
    const auto words = [](const Rgb& c) { return nlohmann::json{c.x, c.y, c.z}; };
    all[m.name] = {words(m.base_colour), words(m.emission)};
  }
  return all;
}

struct Setting {
  std::string name;
  std::string command;  ///< writes picture.exr
};

constexpr const char* cycles_script = R"(import bpy, json, numpy, sys
numpy.bool = bool  # the glTF importer of Debian 12's Blender wants an older numpy
folder, samples = sys.argv[-2], int(sys.argv[-1])
bpy.ops.wm.read_factory_settings(use_empty=True)
bpy.ops.import_scene.gltf(filepath=folder + "/box.glb")
scene = bpy.context.scene
scene.render.engine = "CYCLES"
scene.camera = next(o for o in scene.objects if o.type == "CAMERA")
scene.render.resolution_x = scene.render.resolution_y = 256
scene.render.threads_mode = "FIXED"
scene.render.threads = 2
scene.cycles.device = "CPU"
scene.cycles.samples = samples
scene.cycles.use_adaptive_sampling = False
scene.cycles.use_denoising = False
scene.cycles.max_bounces = scene.cycles.diffuse_bounces = 64
scene.cycles.sample_clamp_indirect = 0
scene.cycles.pixel_filter_type = "BOX"
scene.cycles.filter_width = 1
for material in bpy.data.materials:
    colour, emission = json.load(open(folder + "/materials.json")).get(material.name, (None, None))
    if colour is None:
        continue
    nodes, links = material.node_tree.nodes, material.node_tree.links
    nodes.clear()
    strength = max(emission)
    shader = nodes.new("ShaderNodeEmission" if strength > 0 else "ShaderNodeBsdfDiffuse")
    shader.inputs["Color"].default_value = [c / strength for c in emission] + [1] if strength > 0 else colour + [1]
    if strength > 0:
        shader.inputs["Strength"].default_value = strength
    links.new(shader.outputs[0], nodes.new("ShaderNodeOutputMaterial").inputs["Surface"])
scene.view_settings.view_transform = "Raw"
scene.render.image_settings.file_format = "OPEN_EXR"
scene.render.image_settings.color_depth = "32"
scene.render.filepath = folder + "/picture.exr"
bpy.ops.render.render(write_still=True)
)";

}  // namespace

nlohmann::json compare_cornell_box(const Arguments& a) {
  const auto folder = std::filesystem::temp_directory_path() / fmt::format("bench_cornell_{}", getpid());
  std::filesystem::create_directories(folder);
  const std::string at = folder.string();
  const std::string ours = a.program + " render builtin:cornell-box --size 256x256 --threads 2 -q -o " + at +
                           "/picture.exr --stats " + at + "/stats.json ";
  std::vector<Setting> settings;
  for (const int spp : {16, 64, 256}) {
    if (a.quick && spp > 64) continue;
    settings.push_back({fmt::format("path, {} spp", spp), fmt::format("{}--integrator path --spp {}", ours, spp)});
  }
  for (const int spp : {4, 16}) {
    settings.push_back({fmt::format("two-pass, {} spp", spp),
                        fmt::format("{}--integrator two-pass --spp {} --elements 4000", ours, spp)});
  }
  const bool has_blender = std::system("command -v blender >/dev/null 2>&1") == 0;
  if (has_blender) {
    std::ofstream(folder / "cycles.py") << cycles_script;
    std::ofstream(folder / "materials.json") << materials_of(make_builtin_scene("cornell-box"));
    (void)!std::system(fmt::format("{} scene cornell-box -o {}/box.glb -q >/dev/null 2>&1", a.program, at).c_str());
    for (const int spp : {16, 64, 256}) {
      if (a.quick && spp > 16) continue;
      settings.push_back({fmt::format("Cycles, {} spp", spp),
                          fmt::format("blender -b -P {}/cycles.py -- {} {} >{}/log 2>&1", at, at, spp, at)});
    }
  }
  fmt::print("\nThe Cornell box, 256 x 256, two threads, whole process\n");
  if (!has_blender) fmt::print("Blender is not installed; install Debian's package blender to compare\n");
  fmt::print("{:>20} {:>8} {:>8} {:>14} {:>14}\n", "", "s", "cpu s", "block error %", "pixel error %");

  const Image reference = read_reference();
  nlohmann::json report{{"blender_installed", has_blender}};
  for (const Setting& s : settings) {
    std::filesystem::remove(folder / "picture.exr");
    int status = 0;
    const Cost cost = cost_of(RUSAGE_CHILDREN, [&] { status = std::system(s.command.c_str()); });
    if (status != 0 || !std::filesystem::exists(folder / "picture.exr")) {
      fmt::print("{:>20} failed\n", s.name);
      continue;
    }
    const Image picture = read_image(folder / "picture.exr");
    const double block = error(picture, reference, 4), pixel = error(picture, reference, 1);
    fmt::print("{:>20} {:>8.2f} {:>8.2f} {:>14.2f} {:>14.2f}\n", s.name, cost.wall, cost.cpu, 100 * block, 100 * pixel);
    report["runs"].push_back({{"name", s.name},
                              {"seconds", cost.wall},
                              {"cpu_seconds", cost.cpu},
                              {"block_error", block},
                              {"pixel_error", pixel}});
  }
  std::filesystem::remove_all(folder);
  return report;
}

}  // namespace penumbra::bench
