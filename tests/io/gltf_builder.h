#pragma once

#include <unistd.h>

#include <cstddef>
#include <cstdint>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <initializer_list>
#include <nlohmann/json.hpp>
#include <string>
#include <string_view>
#include <vector>

#include "io/temporary_file.h"
#include "penumbra/io/gltf_reader.h"
#include "penumbra/math/transform.h"
#include "penumbra/scene/scene.h"

namespace penumbra::test {

constexpr int gltf_int8 = 5120;
constexpr int gltf_uint8 = 5121;
constexpr int gltf_int16 = 5122;
constexpr int gltf_uint16 = 5123;
constexpr int gltf_uint32 = 5125;
constexpr int gltf_float = 5126;

/// A glTF under construction: JSON that tests may change at will, and one buffer.
struct GltfBuilder {
  nlohmann::json json = {
      {"asset", {{"version", "2.0"}}}, {"scene", 0}, {"scenes", {{{"nodes", nlohmann::json::array()}}}}};
  std::string bytes;

  std::size_t add(const char* list, nlohmann::json element) {
    json[list].push_back(std::move(element));
    return json[list].size() - 1;
  }
  std::size_t add_view(std::string_view content, int stride = 0) {
    bytes.resize((bytes.size() + 3) / 4 * 4);
    nlohmann::json view = {{"buffer", 0}, {"byteOffset", bytes.size()}, {"byteLength", content.size()}};
    if (stride > 0) view["byteStride"] = stride;
    bytes += content;
    return add("bufferViews", view);
  }
  template <class T>
  static std::string packed(const std::vector<T>& values) {
    std::string content(values.size() * sizeof(T), '\0');
    if (!values.empty()) std::memcpy(content.data(), values.data(), content.size());
    return content;
  }
  /// Tightly packed values; count follows from the type.
  template <class T>
  std::size_t add_accessor(const std::vector<T>& values, const char* type, int component, bool normalised = false) {
    const std::string_view kind(type);
    const std::size_t width = kind == "SCALAR" ? 1 : kind == "MAT4" ? 16 : static_cast<std::size_t>(type[3] - '0');
    nlohmann::json accessor = {{"bufferView", add_view(packed(values))},
                               {"componentType", component},
                               {"count", values.size() / width},
                               {"type", type}};
    if (normalised) accessor["normalized"] = true;
    return add("accessors", accessor);
  }
  /// A node in the scene that shows a new mesh of one primitive; returns the mesh.
  std::size_t show(nlohmann::json primitive) {
    const std::size_t mesh = add("meshes", {{"primitives", {std::move(primitive)}}});
    show_node({{"mesh", mesh}});
    return mesh;
  }
  std::size_t show_node(nlohmann::json node) {
    const std::size_t index = add("nodes", std::move(node));
    json["scenes"][0]["nodes"].push_back(index);
    return index;
  }

  [[nodiscard]] std::string glb() const {
    nlohmann::json whole = json;
    std::string binary = bytes;
    binary.resize((binary.size() + 3) / 4 * 4);
    if (!binary.empty()) whole["buffers"] = {{{"byteLength", binary.size()}}};
    std::string text = whole.dump();
    text.resize((text.size() + 3) / 4 * 4, ' ');
    const auto word = [](std::size_t value) {
      const auto v = static_cast<std::uint32_t>(value);
      return std::string(reinterpret_cast<const char*>(&v), 4);
    };
    std::string file = "glTF" + word(2) + word(20 + text.size() + (binary.empty() ? 0 : 8 + binary.size()));
    file += word(text.size()) + "JSON" + text;
    if (!binary.empty()) file += word(binary.size()) + std::string("BIN\0", 4) + binary;
    return file;
  }
  [[nodiscard]] LoadedScene read(const ReadOptions& options = {}) const {
    const TemporaryFile file(glb(), ".glb");
    return read_gltf(file.path(), options);
  }
  /// A channel of the file's first animation.
  void animate(std::size_t node, const char* path, const std::vector<float>& times, const std::vector<float>& values,
               const char* type, const char* interpolation = "LINEAR") {
    if (!json.contains("animations")) json["animations"] = {nlohmann::json::object()};
    nlohmann::json& animation = json["animations"][0];
    animation["samplers"].push_back({{"input", add_accessor(times, "SCALAR", gltf_float)},
                                     {"output", add_accessor(values, type, gltf_float)},
                                     {"interpolation", interpolation}});
    animation["channels"].push_back(
        {{"sampler", animation["samplers"].size() - 1}, {"target", {{"node", node}, {"path", path}}}});
  }
};

/// A folder of files that goes away with its object.
class TemporaryFolder {
 public:
  TemporaryFolder() {
    std::string name = (std::filesystem::path(testing::TempDir()) / "penumbra-XXXXXX").string();
    path_ = ::mkdtemp(name.data());
  }
  ~TemporaryFolder() {
    std::error_code ignored;
    std::filesystem::remove_all(path_, ignored);
  }
  TemporaryFolder(const TemporaryFolder&) = delete;
  TemporaryFolder& operator=(const TemporaryFolder&) = delete;

  std::filesystem::path write(const std::string& name, std::string_view content) const {
    const auto file = path_ / name;
    std::filesystem::create_directories(file.parent_path());
    std::ofstream(file, std::ios::binary).write(content.data(), static_cast<std::streamsize>(content.size()));
    return file;
  }
  [[nodiscard]] const std::filesystem::path& path() const { return path_; }

 private:
  std::filesystem::path path_;
};

/// The unit cube [0, 1]^3: corner i stands at the bits of i (x, y, z), faces seen from outside are counter-clockwise.
inline const std::vector<float> cube_positions = {0, 0, 0, 1, 0, 0, 0, 1, 0, 1, 1, 0,
                                                  0, 0, 1, 1, 0, 1, 0, 1, 1, 1, 1, 1};
inline const std::vector<std::uint32_t> cube_indices = {0, 2, 3, 0, 3, 1, 4, 5, 7, 4, 7, 6, 0, 1, 5, 0, 5, 4,
                                                        2, 6, 7, 2, 7, 3, 0, 4, 6, 0, 6, 2, 1, 3, 7, 1, 7, 5};

/// Area and signed volume (positive when the front is outside) of all instances, in the world.
struct Extent {
  double area = 0;
  double volume = 0;
};
inline Extent extent_of(const Scene& scene) {
  Extent sum;
  for (const Instance& instance : scene.instances) {
    const Mesh& mesh = scene.meshes[instance.mesh];
    for (const auto& t : mesh.triangles) {
      const Vec3d a = transform_point(instance.to_world, mesh.positions[t[0]]);
      const Vec3d b = transform_point(instance.to_world, mesh.positions[t[1]]);
      const Vec3d c = transform_point(instance.to_world, mesh.positions[t[2]]);
      sum.area += length(cross(b - a, c - a)) / 2;
      sum.volume += dot(a, cross(b, c)) / 6;
    }
  }
  return sum;
}

/// Whether some warning holds `words`; how many do.
inline int warnings_with(const LoadedScene& loaded, std::string_view words) {
  int count = 0;
  for (const auto& warning : loaded.warnings) count += warning.find(words) != std::string::npos ? 1 : 0;
  return count;
}

}  // namespace penumbra::test
