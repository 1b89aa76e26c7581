#include "penumbra/io/gltf_reader.h"

#include <fmt/format.h>

#include <map>
#include <optional>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "penumbra/file/file_error.h"
#include "penumbra/io/gltf_camera.h"
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
      : document_(path, options),
        textures_(document_, scene_),
        meshes_(document_, [this](std::int64_t index, const JsonPlace& user) { return material(index, user); }) {}

  LoadedScene read() {
    read_materials();
    for (const GltfNode& node : placed_gltf_nodes(document_)) place(node);
    if (const auto scene = gltf_scene(document_)) read_scene_extras(*scene);
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
    if (const auto mesh = place.whole("mesh")) place_mesh(*mesh, place, name, node.to_world);
    if (const auto index = place.whole("camera")) {
      Camera camera = read_gltf_camera(document_.item("cameras", "camera", *index, place), node.to_world);
      if (!name.empty()) camera.name = name;
      scene_.cameras.push_back(std::move(camera));
    }
    const auto extensions = place.object("extensions");
    if (const auto light = extensions ? extensions->object("KHR_lights_punctual") : std::nullopt) {
      place_light(*light, name, node.to_world);
    }
  }

  // A mesh is read when its first node is placed, and shared by all of them.
  void place_mesh(std::uint64_t index, const JsonPlace& node, const std::string& name, const Mat4d& to_world) {
    auto known = meshes_of_.find(index);
    if (known == meshes_of_.end()) {
      std::vector<std::uint32_t> made;
      for (Mesh& mesh : meshes_.read(index, node)) {
        made.push_back(static_cast<std::uint32_t>(scene_.meshes.size()));
        scene_.meshes.push_back(std::move(mesh));
      }
      known = meshes_of_.emplace(index, std::move(made)).first;
    }
    for (const std::uint32_t mesh : known->second) {
      scene_.instances.push_back(
          {.name = name.empty() ? scene_.meshes[mesh].name : name, .mesh = mesh, .to_world = to_world});
    }
    if (node.has("skin")) document_.warnings().count("skins are not applied; meshes are drawn in their bind pose", "");
  }

  void place_light(const JsonPlace& user, const std::string& name, const Mat4d& to_world) {
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
    if (document_.count("animations") > 0) {
      document_.warnings().count("animations are not played; the scene is drawn at rest", "");
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

  GltfDocument document_;
  Scene scene_;
  GltfTextures textures_;
  GltfMeshes meshes_;
  std::optional<std::uint32_t> default_material_;
  std::map<std::uint64_t, std::vector<std::uint32_t>> meshes_of_;
};

}  // namespace

LoadedScene read_gltf(const std::filesystem::path& path, const ReadOptions& options) {
  return SceneReader(path, options).read();
}

}  // namespace penumbra
