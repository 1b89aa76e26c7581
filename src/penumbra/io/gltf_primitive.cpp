#include "penumbra/io/gltf_primitive.h"

#include <fmt/format.h>

#include <algorithm>
#include <ctime>
#include <limits>
#include <stdexcept>
#include <string_view>
#include <utility>

namespace penumbra {
namespace {

struct Semantic {
  const char* name;
  int least_components;
  int most_components;
};
constexpr std::array<Semantic, gltf_attribute_count> semantics = {{{"POSITION", 3, 3},
                                                                   {"NORMAL", 3, 3},
                                                                   {"TANGENT", 4, 4},
                                                                   {"TEXCOORD_0", 2, 2},
                                                                   {"TEXCOORD_1", 2, 2},
                                                                   {"COLOR_0", 3, 4},
                                                                   {"JOINTS_0", 4, 4},
                                                                   {"JOINTS_1", 4, 4},
                                                                   {"WEIGHTS_0", 4, 4},
                                                                   {"WEIGHTS_1", 4, 4}}};

enum Mode : std::uint64_t { points, lines, line_loop, line_strip, triangle_list, triangle_strip, triangle_fan };

/// Where the corners come from: an index accessor, or the vertices in their order.
class Corners {
 public:
  Corners(std::optional<GltfElements> indices, std::size_t vertices) : indices_(indices), vertices_(vertices) {}

  [[nodiscard]] std::size_t count() const { return indices_ ? indices_->count : vertices_; }
  [[nodiscard]] std::uint32_t operator[](std::size_t i) const {
    return indices_ ? indices_->index(i) : static_cast<std::uint32_t>(i);
  }

 private:
  std::optional<GltfElements> indices_;
  std::size_t vertices_;
};

std::size_t triangle_count(std::uint64_t mode, std::size_t corners) {
  if (mode == triangle_list) return corners / 3;
  return corners < 3 ? 0 : corners - 2;
}

// glTF 2.0, section 3.7.2.1: the order that keeps the front of every triangle of strips and fans.
Mesh::Triangle triangle_of(const Corners& corners, std::uint64_t mode, std::size_t i) {
  if (mode == triangle_list) return {corners[3 * i], corners[3 * i + 1], corners[3 * i + 2]};
  if (mode == triangle_strip) return {corners[i], corners[i + 1 + i % 2], corners[i + 2 - i % 2]};
  return {corners[i + 1], corners[i + 2], corners[0]};
}

void check_attribute(const Semantic& semantic, int components, std::size_t count, std::size_t vertices,
                     const JsonPlace& place) {
  if (components < semantic.least_components || components > semantic.most_components) {
    place.fail(fmt::format("its {} has {} components instead of {}; export the file again", semantic.name, components,
                           semantic.least_components));
  }
  if (count != vertices) {
    place.fail(fmt::format("its {} has {} elements but its POSITION has {}; export the file again", semantic.name,
                           count, vertices));
  }
}

/// Attributes of the surface come first; those of skins are read when there is one.
std::size_t attributes_read(const GltfDeformation& deformation) {
  return deformation.joints.empty() ? joints_0_attribute : gltf_attribute_count;
}

void read_attributes(GltfAccessors& accessors, const JsonPlace& place, const JsonPlace& names, std::size_t count,
                     GltfPrimitive& primitive) {
  primitive.vertex_source.fill(-1);
  for (std::size_t a = 0; a < count; ++a) {
    const auto index = names.whole(semantics[a].name);
    if (!index) continue;
    primitive.vertex_source[a] = static_cast<std::int64_t>(*index);
    if (primitive.attributes[a]) continue;  // decompressed already
    primitive.attributes[a] = accessors.elements(*index, place);
  }
}

void read_triangles(GltfDocument& document, GltfAccessors& accessors, const JsonPlace& place, std::uint64_t mode,
                    GltfPrimitive& primitive) {
  const std::size_t vertices = primitive.attributes[position_attribute]->count;
  std::optional<GltfElements> indices;
  if (const auto index = place.whole("indices")) {
    indices = accessors.elements(*index, place);
    const bool is_index =
        indices->components == 1 && (indices->type == GltfComponent::uint8 || indices->type == GltfComponent::uint16 ||
                                     indices->type == GltfComponent::uint32);
    if (!is_index)
      place.fail(fmt::format("its indices (accessor {}) are no unsigned scalars; export the file again", *index));
    for (std::size_t i = 0; i < indices->count; ++i) {
      if (indices->index(i) >= vertices) {
        place.fail(
            fmt::format("index {} (element {} of accessor {}) points beyond its {} vertices; export the file again",
                        indices->index(i), i, *index, vertices));
      }
    }
  }
  const Corners corners(indices, vertices);
  const std::size_t count = triangle_count(mode, corners.count());
  if (corners.count() < 3 || (mode == triangle_list && corners.count() % 3 != 0)) {
    document.warnings().count("corners that make no whole triangle were left out", place.place());
  }
  primitive.triangles.reserve(count);
  for (std::size_t i = 0; i < count; ++i) {
    const Mesh::Triangle t = triangle_of(corners, mode, i);
    // A strip turns a corner by repeating vertices; what is between is no surface.
    const bool stitch = mode != triangle_list && (t[0] == t[1] || t[1] == t[2] || t[2] == t[0]);
    if (!stitch) primitive.triangles.push_back(t);
  }
}

void read_draco(GltfDocument& document, GltfAccessors& accessors, const JsonPlace& place, const JsonPlace& names,
                const JsonPlace& compressed, std::size_t count, GltfPrimitive& primitive) {
  const auto ids = compressed.object("attributes");
  if (!ids) compressed.fail("has no attributes; export the file again");
  std::vector<std::uint32_t> wanted;
  std::array<std::optional<std::size_t>, gltf_attribute_count> slot;
  for (std::size_t a = 0; a < count; ++a) {
    const auto id = names.has(semantics[a].name) ? ids->whole(semantics[a].name) : std::nullopt;
    if (!id) continue;
    if (*id > std::numeric_limits<std::uint32_t>::max()) ids->fail(fmt::format("{} is no Draco id", *id));
    slot[a] = wanted.size();
    wanted.push_back(static_cast<std::uint32_t>(*id));
  }
  const auto view = document.view(compressed.required_whole("bufferView"), compressed);
  // Some counts deep inside a bitstream are believed by the decoder: a few hundred bytes can keep it busy for seconds.
  // A step of work is a microsecond here.
  const std::clock_t began = std::clock();
  try {
    primitive.draco = std::make_shared<const DracoMesh>(decode_draco(view.bytes, wanted));
  } catch (const std::invalid_argument& wrong) {
    compressed.fail(wrong.what());
  }
  document.count_work(static_cast<std::size_t>(std::clock() - began) / (CLOCKS_PER_SEC / 1000000), compressed);
  const DracoMesh& mesh = *primitive.draco;
  primitive.triangles = mesh.triangles;
  for (std::size_t a = 0; a < count; ++a) {
    if (!slot[a]) continue;
    const DracoAttribute& from = mesh.attributes[*slot[a]];
    const auto told = accessors.shape(names.required_whole(semantics[a].name), place);
    primitive.attributes[a] =
        GltfElements{.data = from.values.data(),
                     .count = mesh.vertex_count,
                     .stride = component_size(from.type) * static_cast<std::size_t>(from.components),
                     .components = from.components,
                     .type = from.type,
                     .normalised = told.normalised};
  }
}

/// Puts what a deformation makes of the vertices in the place of the attributes.
void bend(GltfDocument& document, GltfAccessors& accessors, const JsonPlace& place, const GltfDeformation& deformation,
          GltfPrimitive& primitive) {
  auto& attributes = primitive.attributes;
  const std::optional<GltfElements> joints[2] = {attributes[joints_0_attribute], attributes[joints_1_attribute]};
  const std::optional<GltfElements> weights[2] = {attributes[weights_0_attribute], attributes[weights_1_attribute]};
  const DeformedAttributes from{*attributes[position_attribute], attributes[normal_attribute],
                                attributes[tangent_attribute], joints, weights};
  auto made = std::make_shared<DeformedVertices>(deformed(deformation, from, document, accessors, place));
  const auto replace = [&](std::size_t attribute, const std::vector<float>& numbers, int components) {
    if (!attributes[attribute]) return;
    attributes[attribute] = GltfElements{.data = reinterpret_cast<const std::byte*>(numbers.data()),
                                         .count = attributes[attribute]->count,
                                         .stride = static_cast<std::size_t>(components) * sizeof(float),
                                         .components = components,
                                         .type = GltfComponent::float32,
                                         .normalised = false};
  };
  replace(position_attribute, made->positions, 3);
  replace(normal_attribute, made->normals, 3);
  replace(tangent_attribute, made->tangents, 4);
  for (std::size_t a = joints_0_attribute; a < gltf_attribute_count; ++a) attributes[a].reset();
  primitive.deformed = std::move(made);
}

std::optional<JsonPlace> draco_of(const JsonPlace& place) {
  const auto extensions = place.object("extensions");
  return extensions ? extensions->object("KHR_draco_mesh_compression") : std::nullopt;
}

}  // namespace

std::size_t declared_triangles(const GltfAccessors& accessors, const JsonPlace& place) {
  const auto attributes = place.object("attributes");
  auto corners = place.whole("indices");
  if (!corners && attributes) corners = attributes->whole("POSITION");
  if (!corners) return 0;
  return triangle_count(place.whole("mode").value_or(triangle_list), accessors.shape(*corners, place).count);
}

std::optional<GltfPrimitive> read_gltf_primitive(GltfDocument& document, GltfAccessors& accessors,
                                                 const JsonPlace& place, const GltfDeformation& deformation) {
  const std::uint64_t mode = place.whole("mode").value_or(triangle_list);
  if (mode > triangle_fan)
    place.fail(fmt::format("its mode {} is none of glTF's (0 to 6); export the file again", mode));
  if (mode < triangle_list) {
    document.warnings().count("points and lines have no surface and were left out", place.place());
    return std::nullopt;
  }
  const auto names = place.object("attributes");
  if (!names) place.fail("has no attributes; export the file again");
  if (!names->has("POSITION")) {
    document.warnings().count("a primitive without POSITION was left out", place.place());
    return std::nullopt;
  }
  GltfPrimitive primitive;
  const auto compressed = draco_of(place);
  const std::size_t count = attributes_read(deformation);
  if (compressed) read_draco(document, accessors, place, *names, *compressed, count, primitive);
  read_attributes(accessors, place, *names, count, primitive);
  for (std::size_t a = 0; a < gltf_attribute_count; ++a) {
    if (const auto& found = primitive.attributes[a]) {
      check_attribute(semantics[a], found->components, found->count, primitive.attributes[position_attribute]->count,
                      place);
    }
  }
  if (!compressed) read_triangles(document, accessors, place, mode, primitive);
  if (deformation.bends()) bend(document, accessors, place, deformation, primitive);
  return primitive;
}

}  // namespace penumbra
