#include "penumbra/io/gltf_reader.h"

#include <fmt/format.h>

#include <algorithm>
#include <functional>
#include <map>
#include <optional>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "penumbra/file/file_error.h"
#include "penumbra/io/gltf_accessor.h"
#include "penumbra/io/gltf_animation.h"
#include "penumbra/io/gltf_camera.h"
#include "penumbra/io/gltf_deformation.h"
#include "penumbra/io/gltf_document.h"
#include "penumbra/io/gltf_light.h"
#include "penumbra/io/gltf_material.h"
#include "penumbra/io/gltf_medium.h"
#include "penumbra/io/gltf_mesh.h"
#include "penumbra/io/gltf_node.h"
#include "penumbra/io/gltf_texture.h"
#include "penumbra/io/ies_reader.h"
#include "penumbra/scene/luminaire.h"

namespace penumbra {
namespace {

Rgb colour_of(const JsonPlace& place, std::string_view key) {
  const auto c = place.numbers<3>(key, {1, 1, 1});
  const Rgb colour(Vec3d(c[0], c[1], c[2]));
  if (!(colour.x >= 0 && colour.y >= 0 && colour.z >= 0)) place.fail(fmt::format("{} must not be negative", key));
  return colour;
}

/// Reads the document into one scene.
class SceneReader {
 public:
  SceneReader(const std::filesystem::path& path, const ReadOptions& options)
      : options_(options),
        document_(path, options),
        accessors_(document_),
        textures_(document_, scene_),
        meshes_(document_, accessors_,
                [this](std::int64_t index, const JsonPlace& user) { return material(index, user); }),
        animation_(options.plays() ? GltfAnimation(document_, accessors_, options.animation) : GltfAnimation()),
        nodes_(document_, animation_) {
    if (options.plays()) time_ = options.instant();
  }

  LoadedScene read() {
    read_materials();
    const auto scene = gltf_scene(document_, options_.scene);
    for (const GltfNode& node : nodes_.placed(scene, time_)) place(node);
    if (scene) read_scene_extras(*scene);
    note_what_is_not_drawn();
    check();
    return {std::move(scene_), document_.warnings().sentences()};
  }

 private:
  void read_materials() {
    const std::size_t count = document_.count("materials");
    for (std::size_t m = 0; m < count; ++m) {
      scene_.materials.push_back(read_gltf_material(document_, textures_, m));
      const auto extras = document_.item("materials", "material", m, document_.root()).extras("penumbra");
      if (const auto medium = extras ? extras->object("medium") : std::nullopt) {
        scene_.materials.back().medium = static_cast<std::uint32_t>(scene_.media.size());
        scene_.media.push_back(read_gltf_medium(document_, *medium));
      }
    }
  }

  std::uint32_t material(std::int64_t index, const JsonPlace& user) {
    if (index >= 0) {
      (void)document_.item("materials", "material", static_cast<std::uint64_t>(index), user);
      return static_cast<std::uint32_t>(index);
    }
    if (!default_material_) {
      default_material_ = static_cast<std::uint32_t>(scene_.materials.size());
      scene_.materials.push_back(gltf_default_material());
    }
    return *default_material_;
  }

  void place(const GltfNode& node) {
    const JsonPlace place = document_.item("nodes", "node", node.index, document_.root());
    const std::string name = place.text("name");
    if (const auto mesh = place.whole("mesh")) place_mesh(*mesh, place, name, node);
    if (const auto index = place.whole("camera")) {
      const JsonPlace eye = document_.item("cameras", "camera", *index, place);
      Camera camera = read_gltf_camera(eye, node.to_world);
      if (!name.empty()) camera.name = name;
      camera.extras = place.extras_without("penumbra");
      camera.motion = motion_of(node, [&](const Mat4d& m) { return read_gltf_camera(eye, m).to_world; });
      scene_.cameras.push_back(std::move(camera));
    }
    const auto extensions = place.object("extensions");
    if (const auto light = extensions ? extensions->object("KHR_lights_punctual") : std::nullopt) {
      place_light(*light, name, place.extras_without("penumbra"), node.to_world);
      if (options_.shutter && node.moves) note_still_light(place);
    }
  }

  /// The way that a node goes while the shutter is open. @param made what becomes of a placement.
  Motion motion_of(const GltfNode& node, const std::function<Mat4d(const Mat4d&)>& made) {
    if (!options_.shutter || !node.moves) return {};
    const JsonPlace place = document_.item("nodes", "node", node.index, document_.root());
    const double opens = options_.shutter->opens;
    const double open_for = options_.shutter->closes - opens;
    return sampled_motion([&](double share) {
      document_.count_work(node.depth, place);
      return made(nodes_.to_world(node.index, opens + share * open_for));
    });
  }

  void note_still_light(const JsonPlace& node) {
    document_.warnings().count("lights that move stand still, where they are in the middle of the exposure",
                               node.place());
  }

  void place_mesh(std::uint64_t index, const JsonPlace& node, const std::string& name, const GltfNode& placed) {
    const GltfDeformation bent = deformation_of(index, node, placed);
    // Joints lead straight to the world (glTF 2.0, section 3.7.3.3).
    const bool has_skin = !bent.joints.empty();
    for (const std::uint32_t mesh : bent.bends() ? read_meshes(index, node, bent) : shared_meshes(index, node)) {
      Instance instance{.name = name.empty() ? scene_.meshes[mesh].name : name, .mesh = mesh};
      instance.extras = node.extras_without("penumbra");
      if (!has_skin) {
        instance.to_world = placed.to_world;
        instance.motion = motion_of(placed, [](const Mat4d& m) { return m; });
      }
      if (!instance.motion.empty() && shines(scene_.meshes[mesh])) {
        instance.motion.clear();
        note_still_light(node);
      }
      scene_.instances.push_back(std::move(instance));
    }
  }

  [[nodiscard]] bool shines(const Mesh& mesh) const {
    return std::any_of(mesh.materials.begin(), mesh.materials.end(),
                       [&](std::uint32_t m) { return scene_.materials[m].emits(); });
  }

  std::vector<std::uint32_t> read_meshes(std::uint64_t index, const JsonPlace& node, const GltfDeformation& bent) {
    std::vector<std::uint32_t> made;
    for (Mesh& mesh : meshes_.read(index, node, bent)) {
      made.push_back(static_cast<std::uint32_t>(scene_.meshes.size()));
      scene_.meshes.push_back(std::move(mesh));
    }
    return made;
  }

  // A mesh that keeps its shape is read when its first node is placed, and shared by all of them.
  const std::vector<std::uint32_t>& shared_meshes(std::uint64_t index, const JsonPlace& node) {
    auto known = meshes_of_.find(index);
    if (known == meshes_of_.end()) known = meshes_of_.emplace(index, read_meshes(index, node, {})).first;
    return known->second;
  }

  // Weights of the animation, else of the node, else of the mesh.
  GltfDeformation deformation_of(std::uint64_t index, const JsonPlace& node, const GltfNode& placed) {
    GltfDeformation bent;
    const JsonPlace mesh = document_.item("meshes", "mesh", index, node);
    if (auto played = animation_.weights(placed.index, time_)) {
      bent.weights = std::move(*played);
    } else if (node.has("weights") || mesh.has("weights")) {
      bent.weights = (node.has("weights") ? node : mesh).number_list("weights");
    }
    if (const auto skin = node.whole("skin")) {
      if (node_places_.empty()) node_places_ = nodes_.to_world(time_);
      bent.joints = gltf_joints(document_, accessors_, node_places_, *skin, node);
    }
    if (options_.shutter && bent.bends() && (animation_.morphs(placed.index) || !bent.joints.empty())) {
      document_.warnings().count(
          "skins and morph targets keep the shape that they have in the middle of the exposure; only whole objects "
          "blur",
          node.place());
    }
    return bent;
  }

  void place_light(const JsonPlace& user, const std::string& name, std::string said, const Mat4d& to_world) {
    const auto extensions = document_.root().object("extensions");
    const auto holder = extensions ? extensions->object("KHR_lights_punctual") : std::nullopt;
    const auto lights = holder ? holder->list("lights") : std::nullopt;
    const std::uint64_t index = user.required_whole("light");
    const std::size_t count = lights ? lights->size() : 0;
    if (index >= count)
      user.fail(
          fmt::format("names light {}, but the file has {}, counted from 0; export the file again", index, count));
    const JsonPlace place = lights->item(static_cast<std::size_t>(index), "light");
    Light light = read_gltf_light(place, to_world);
    if (!name.empty()) light.name = name;
    light.extras = std::move(said);
    scene_.lights.push_back(std::move(light));
    const auto extras = place.extras("penumbra");
    if (extras && extras->has("ies")) hang_luminaire(*extras, to_world);
  }

  // A measured luminaire hangs with its nadir along -y of its node, horizontal angle 0 along -z; on a spot light its
  // nadir is the light's axis.
  void hang_luminaire(const JsonPlace& extras, const Mat4d& to_world) {
    const std::size_t light = scene_.lights.size() - 1;
    if (!can_wear_web(scene_.lights[light])) extras.fail("ies belongs to point and spot lights alone");
    const std::string uri = extras.text("ies");
    const std::vector<std::byte> bytes = document_.uri_bytes(uri, extras);
    PhotometricWeb web = parse_ies({reinterpret_cast<const char*>(bytes.data()), bytes.size()}, uri);
    const Vec3d down = -Vec3d(to_world[1]), ahead = -Vec3d(to_world[2]);
    const bool turned = std::holds_alternative<PointLight>(scene_.lights[light].kind) && length(cross(down, ahead)) > 0;
    if (!turned) return wear_web(scene_, light, std::move(web));
    const Vec3d nadir = normalize(down);
    wear_web(scene_, light, std::move(web), nadir, normalize(ahead - dot(ahead, nadir) * nadir));
  }

  void read_scene_extras(const JsonPlace& scene) {
    scene_.extras = scene.extras_without("penumbra");
    const auto extras = scene.extras("penumbra");
    if (!extras) return;
    if (const auto environment = extras->object("environment")) {
      scene_.environment = Environment{.radiance = colour_of(*environment, "radiance"),
                                       .image = std::nullopt,
                                       .backdrop_only = environment->flag("backdrop_only", false)};
    }
    if (const auto media = extras->list("media")) {
      for (std::size_t i = 0; i < media->size(); ++i) {
        scene_.air.push_back(static_cast<std::uint32_t>(scene_.media.size()));
        scene_.media.push_back(read_gltf_medium(document_, media->item(i, "medium")));
      }
    }
    if (extras->has("ambient")) {
      scene_.lights.push_back({.name = "ambient", .kind = AmbientLight{colour_of(*extras, "ambient")}});
    }
  }

  void note_what_is_not_drawn() {
    const bool has_animation = document_.count("animations") > 0;
    if (has_animation && !options_.plays()) {
      document_.warnings().count("animations are not played; the scene is drawn at rest", "");
    }
    if (!has_animation && options_.plays()) {
      document_.warnings().count("there is no animation, so nothing moves", "");
    }
    if (scene_.instances.empty()) document_.warnings().count("the scene has no mesh, so there is nothing to draw", "");
  }

  void check() const {
    try {
      validate(scene_);
    } catch (const std::invalid_argument& wrong) {
      throw FileError(document_.file(), "", fmt::format("{}; export the file again", wrong.what()));
    }
  }

  ReadOptions options_;
  GltfDocument document_;
  GltfAccessors accessors_;
  Scene scene_;
  GltfTextures textures_;
  GltfMeshes meshes_;
  GltfAnimation animation_;
  GltfNodes nodes_;
  std::optional<double> time_;      // of the animation, where one is played
  std::vector<Mat4d> node_places_;  // of all nodes at that time, once a skin asks
  std::optional<std::uint32_t> default_material_;
  std::map<std::uint64_t, std::vector<std::uint32_t>> meshes_of_;
};

}  // namespace

LoadedScene read_gltf(const std::filesystem::path& path, const ReadOptions& options) {
  return SceneReader(path, options).read();
}

}  // namespace penumbra
