#include "penumbra/io/gltf_writer.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <map>
#include <nlohmann/json.hpp>
#include <numbers>
#include <optional>
#include <set>

#include "penumbra/file/file_error.h"
#include "penumbra/file/output_file.h"
#include "penumbra/image/image_io.h"
#include "penumbra/image/tonemap.h"
#include "penumbra/io/glb_binary.h"
#include "penumbra/io/gltf_light.h"
#include "penumbra/math/frame.h"
#include "penumbra/math/transform.h"
#include "penumbra/scene/shape_mesh.h"

namespace penumbra {

namespace {

using Json = nlohmann::ordered_json;

Json json_of(const Rgb& c) { return {c.x, c.y, c.z}; }

/// Column by column, as glTF has it.
Json json_of(const Mat4d& m) {
  Json values = Json::array();
  for (int column = 0; column < 4; ++column) {
    for (int row = 0; row < 4; ++row) values.push_back(m[column][row]);
  }
  return values;
}

/// Whether a node may carry it: glTF wants translation, rotation and scale, without shear and not flat.
bool is_rotation_and_scale(const Mat4d& m) {
  const std::array<Vec3d, 3> axis{Vec3d(m[0]), Vec3d(m[1]), Vec3d(m[2])};
  for (std::size_t k = 0; k < 3; ++k) {
    const Vec3d& a = axis[k];
    const Vec3d& b = axis[(k + 1) % 3];
    if (!(length(a) > 0) || std::abs(dot(a, b)) > 1e-6 * length(a) * length(b)) return false;
  }
  return true;
}

/// The mesh with a placement worked into its vertices.
Mesh placed(Mesh mesh, const Mat4d& to_world) {
  const Mat3d turn = normal_matrix(to_world);
  const double side = is_mirroring(to_world) ? -1 : 1;
  for (Vec3d& p : mesh.positions) p = transform_point(to_world, p);
  for (Vec3f& n : mesh.normals) n = Vec3f(side * (turn * Vec3d(n)));
  for (Vec4f& t : mesh.tangents) {
    t = Vec4f(Vec3f(transform_vector(to_world, Vec3d(t))), t.w * static_cast<float>(side));
  }
  if (side < 0) {
    for (Mesh::Triangle& t : mesh.triangles) std::swap(t[1], t[2]);
  }
  return mesh;
}

/// The part of a mesh that is of one material, with only the vertices it uses.
struct Primitive {
  std::uint32_t material = 0;
  std::vector<std::uint32_t> vertices;  ///< of the mesh
  std::vector<std::uint32_t> indices;   ///< into `vertices`
};

/// In the order in which the materials first appear.
std::vector<Primitive> primitives(const Mesh& mesh) {
  constexpr std::uint32_t unused = std::numeric_limits<std::uint32_t>::max();
  std::vector<Primitive> parts;
  std::map<std::uint32_t, std::size_t> part_of;
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    if (part_of.try_emplace(mesh.material_of(t), parts.size()).second) parts.push_back({mesh.material_of(t), {}, {}});
  }
  std::vector<std::uint32_t> renamed(mesh.positions.size());
  for (Primitive& part : parts) {
    std::ranges::fill(renamed, unused);
    for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
      if (mesh.material_of(t) != part.material) continue;
      for (const std::uint32_t v : mesh.triangles[t]) {
        if (renamed[v] == unused) {
          renamed[v] = static_cast<std::uint32_t>(part.vertices.size());
          part.vertices.push_back(v);
        }
        part.indices.push_back(renamed[v]);
      }
    }
  }
  return parts;
}

template <class Vector>
std::vector<Vector> picked(const std::vector<Vector>& values, const std::vector<std::uint32_t>& which) {
  std::vector<Vector> some;
  some.reserve(which.size());
  for (const std::uint32_t v : which) some.push_back(values[v]);
  return some;
}

/// glTF refuses normals that are not unit; one without a length says nothing, so any will do.
Vec3f unit(const Vec3f& n) {
  const float size = glm::length(n);
  return size > 0 ? n / size : Vec3f(0, 0, 1);
}

/// offset, rotation and scale of KHR_texture_transform; none when the matrix holds more.
struct TextureTransform {
  Vec2f offset{0};
  float rotation = 0;
  Vec2f scale{1};
};
std::optional<TextureTransform> decomposed(const Mat3f& m) {
  const Vec2f u(m[0]), v(m[1]);  // u' = su c u + sv s v + ou, v' = -su s u + sv c v + ov
  const float size_u = glm::length(u), size_v = glm::length(v);
  if (std::abs(glm::dot(u, v)) > 1e-5F * size_u * size_v) return std::nullopt;
  const float angle = size_u > 0 ? std::atan2(-u.y, u.x) : std::atan2(v.x, v.y);
  const Vec2f across(std::sin(angle), std::cos(angle));
  return TextureTransform{Vec2f(m[2]), angle, {size_u, glm::dot(v, across)}};
}

/// Writes one scene; the steps follow the file's own layout.
class GltfWriter {
 public:
  explicit GltfWriter(const Scene& scene) : scene_(scene), plane_cut_(plane_cut(scene)) {
    root_["asset"] = {{"version", "2.0"}, {"generator", "Penumbra"}};
    root_["scene"] = 0;
    root_["scenes"] = Json::array({Json::object()});
  }

  void write(const std::filesystem::path& path) {
    for (std::size_t i = 0; i < scene_.images.size(); ++i) image_of_.push_back(add_image(i));
    for (const Texture& texture : scene_.textures) add_texture(texture);
    for (const Material& material : scene_.materials) root_["materials"].push_back(json_of_material(material));
    for (const Instance& instance : scene_.instances) add_instance(instance);
    for (const ShapeObject& object : scene_.shapes) add_shape(object);
    for (const Light& light : scene_.lights) {
      std::visit([&](const auto& l) { add_light(light.name, l); }, light.kind);
      const bool has_node = !std::holds_alternative<AmbientLight>(light.kind);
      if (has_node) add_extras(root_["nodes"].back(), light.extras);
    }
    for (const Camera& camera : scene_.cameras) add_camera(camera);
    add_scene_extras();
    add_buffer();
    save(path);
  }

  void add_notes(const std::map<std::string, std::string>& notes) {
    for (const auto& [name, text] : notes) root_["scenes"][0]["extras"]["penumbra"]["baked"][name] = text;
  }

  void set_lightmap(const std::optional<GltfLightmap>& lightmap) { lightmap_ = lightmap; }

  [[nodiscard]] std::vector<std::string> take_warnings() { return std::move(warnings_); }

 private:
  void warn(const std::string& sentence) {
    if (std::ranges::find(warnings_, sentence) == warnings_.end()) warnings_.push_back(sentence);
  }
  /// The extension's object of an element, which is noted as used.
  Json& extension(Json& element, const std::string& name) {
    extensions_.insert(name);
    return element["extensions"][name] = Json::object();
  }
  /// Puts what the input said besides to what is ours to say.
  static void add_extras(Json& element, const std::string& text) {
    if (text.empty()) return;
    const Json kept = Json::parse(text, nullptr, false);
    if (kept.is_discarded()) return;
    if (!element.contains("extras")) {
      element["extras"] = kept;
    } else if (kept.is_object()) {
      for (const auto& [name, value] : kept.items()) {
        if (!element["extras"].contains(name)) element["extras"][name] = value;
      }
    }
  }
  std::size_t append(const char* array, Json element) {
    root_[array].push_back(std::move(element));
    return root_[array].size() - 1;
  }
  void add_node(Json node) {
    const std::size_t index = append("nodes", std::move(node));  // first: it moves what references into root_ point to
    root_["scenes"][0]["nodes"].push_back(index);
  }

  // Textures.

  /// Whether its texels are colours, which glTF keeps sRGB-encoded.
  [[nodiscard]] bool holds_colour(std::size_t image) const {
    const auto refers = [&](const std::optional<TextureRef>& ref) {
      return ref && scene_.textures[ref->texture].image == image;
    };
    return std::ranges::any_of(scene_.materials, [&](const Material& m) {
      return refers(m.base_colour_texture) || refers(m.emission_texture) || refers(m.specular_colour_texture);
    });
  }

  std::vector<std::uint8_t> quantised(const TextureImage& image, bool colour) {
    warn(fmt::format("image '{}' is kept in 8 bits, so its values are rounded and clamped to 0..1", image.name));
    const auto& texels = std::get<std::vector<float>>(image.texels);
    std::vector<std::uint8_t> bytes;
    bytes.reserve(texels.size());
    const auto channels = static_cast<std::size_t>(image.channels);
    for (std::size_t i = 0; i < texels.size(); ++i) {
      const bool alpha = channels % 2 == 0 && i % channels == channels - 1;
      bytes.push_back(colour && !alpha
                          ? srgb_encode8(texels[i])
                          : static_cast<std::uint8_t>(std::lround(255 * std::clamp(texels[i], 0.0F, 1.0F))));
    }
    return bytes;
  }

  /// Its index in the file; none when no texture uses it.
  std::optional<std::size_t> add_image(std::size_t index) {
    if (std::ranges::find(scene_.textures, index, &Texture::image) == scene_.textures.end()) return std::nullopt;
    const TextureImage& image = scene_.images[index];
    Image8 picture{.width = image.width, .height = image.height, .channels = image.channels, .data = {}};
    if (const auto* bytes = std::get_if<std::vector<std::uint8_t>>(&image.texels)) {
      picture.data = *bytes;
    } else {
      picture.data = quantised(image, holds_colour(index));
    }
    const std::uint32_t view = binary_.add_view(encode_png(picture), GlbBinary::none);
    Json element{{"bufferView", view}, {"mimeType", "image/png"}};
    if (!image.name.empty()) element["name"] = image.name;
    return append("images", std::move(element));
  }

  void add_texture(const Texture& texture) {
    const auto wrap = [](Wrap w) { return w == Wrap::repeat ? 10497 : w == Wrap::clamp ? 33071 : 33648; };
    const bool nearest = texture.filter == TexelFilter::nearest;
    Json sampler{{"magFilter", nearest ? 9728 : 9729},
                 {"minFilter", nearest           ? 9728
                               : texture.mipmaps ? 9987
                                                 : 9729},
                 {"wrapS", wrap(texture.wrap_u)},
                 {"wrapT", wrap(texture.wrap_v)}};
    Json& samplers = root_["samplers"];
    const auto found = std::find(samplers.begin(), samplers.end(), sampler);
    const auto index = static_cast<std::size_t>(found - samplers.begin());
    if (index == samplers.size()) samplers.push_back(std::move(sampler));
    append("textures", {{"sampler", index}, {"source", *image_of_[texture.image]}});
  }

  /// Sets `user[key]` when there is a texture.
  void add_texture_info(Json& user, const char* key, const std::optional<TextureRef>& ref) {
    if (!ref) return;
    Json info{{"index", ref->texture}};
    if (ref->uv_set != 0) info["texCoord"] = ref->uv_set;
    if (ref->transform != Mat3f(1.0F)) {
      const auto t = decomposed(ref->transform);
      if (!t) warn("a sheared texture transform is left out, because glTF knows none");
      if (t) {
        Json& e = extension(info, "KHR_texture_transform");
        e["offset"] = {t->offset.x, t->offset.y};
        e["rotation"] = t->rotation;
        e["scale"] = {t->scale.x, t->scale.y};
      }
    }
    user[key] = std::move(info);
  }

  // Materials.

  Json json_of_material(const Material& m) {
    Json json = Json::object();
    if (!m.name.empty()) json["name"] = m.name;
    const Rgb base = glm::clamp(m.base_colour, Rgb(0.0F), Rgb(1.0F));
    Json& pbr = json["pbrMetallicRoughness"];
    pbr = {{"baseColorFactor", {base.x, base.y, base.z, m.alpha}},
           {"metallicFactor", m.metallic},
           {"roughnessFactor", m.roughness}};
    add_texture_info(pbr, "baseColorTexture", m.base_colour_texture);
    add_texture_info(pbr, "metallicRoughnessTexture", m.metallic_roughness_texture);
    add_texture_info(json, "normalTexture", m.normal_texture);
    if (m.normal_texture && m.normal_scale != 1) json["normalTexture"]["scale"] = m.normal_scale;
    add_emission(json, m);
    if (m.alpha_mode == AlphaMode::mask) {
      json["alphaMode"] = "MASK";
      json["alphaCutoff"] = m.alpha_cutoff;
    }
    if (m.alpha_mode == AlphaMode::blend) json["alphaMode"] = "BLEND";
    if (m.double_sided) json["doubleSided"] = true;
    if (m.unlit) extension(json, "KHR_materials_unlit");
    add_interface(json, m);
    if (lightmap_ && lightmap_->kind == GltfLightmap::Kind::occlusion) {
      json["occlusionTexture"] = {{"index", lightmap_->texture}, {"texCoord", lightmap_->uv_set}};
    } else if (lightmap_) {
      extension(json, "MOZ_lightmap") = {
          {"index", lightmap_->texture}, {"texCoord", lightmap_->uv_set}, {"intensity", lightmap_->strength}};
    }
    add_material_extras(json, m);
    add_extras(json, m.extras);
    return json;
  }

  void add_emission(Json& json, const Material& m) {
    const float strength = std::max(1.0F, max_component(m.emission));
    if (m.emits()) json["emissiveFactor"] = json_of(m.emission / strength);
    if (strength > 1) extension(json, "KHR_materials_emissive_strength")["emissiveStrength"] = strength;
    add_texture_info(json, "emissiveTexture", m.emission_texture);
  }

  /// What the dielectric boundary reflects and lets through.
  void add_interface(Json& json, const Material& m) {
    if (m.specular != 1 || m.specular_colour != Rgb(1.0F) || m.specular_texture || m.specular_colour_texture) {
      Json& e = extension(json, "KHR_materials_specular");
      if (m.specular != 1) e["specularFactor"] = m.specular;
      if (m.specular_colour != Rgb(1.0F)) e["specularColorFactor"] = json_of(m.specular_colour);
      add_texture_info(e, "specularTexture", m.specular_texture);
      add_texture_info(e, "specularColorTexture", m.specular_colour_texture);
    }
    if (m.ior != 1.5F) extension(json, "KHR_materials_ior")["ior"] = m.ior;
    if (m.transmission == 0) return;
    Json& e = extension(json, "KHR_materials_transmission");
    e["transmissionFactor"] = m.transmission;
    add_texture_info(e, "transmissionTexture", m.transmission_texture);
    if (m.thin_walled) return;
    // More than no thickness says that there is a body; paths of ours find its thickness by themselves.
    Json& volume = extension(json, "KHR_materials_volume");
    volume["thicknessFactor"] = 1;
    if (std::isfinite(m.attenuation_distance)) volume["attenuationDistance"] = m.attenuation_distance;
    if (m.attenuation_colour != Rgb(1.0F)) volume["attenuationColor"] = json_of(m.attenuation_colour);
  }

  void add_spectra(Json& json, const Material& m) {
    if (m.dispersion) {
      // As 20 over Abbe's number for all who read glTF, and exactly for us.
      const double abbe = abbe_number(*m.dispersion);
      if (std::isfinite(abbe) && m.transmission > 0 && !m.thin_walled) {
        extension(json, "KHR_materials_dispersion")["dispersion"] = std::max(0.0, 20 / abbe);
      }
      Json& extras = json["extras"]["penumbra"];
      if (const auto* glass = std::get_if<Sellmeier>(&*m.dispersion)) {
        extras["sellmeier"] = {{"b", glass->b}, {"c_um2", glass->c}};
      } else if (const auto* plain = std::get_if<Cauchy>(&*m.dispersion)) {
        extras["cauchy"] = {{"a", plain->a}, {"b_um2", plain->b}, {"c_um4", plain->c}};
      }
    }
    if (m.fluorescence) {
      json["extras"]["penumbra"]["fluorescence"] = {{"edges_nm", m.fluorescence->edges},
                                                    {"matrix", m.fluorescence->matrix}};
    }
    if (m.emission_spectrum) {
      json["extras"]["penumbra"]["emission_spectrum"] = {{"edges_nm", m.emission_spectrum->edges},
                                                         {"radiance", m.emission_spectrum->radiance}};
    }
  }

  void add_material_extras(Json& json, const Material& m) {
    if (!is_black(m.mirror)) json["extras"]["penumbra"]["mirror"] = json_of(m.mirror);
    if (m.checker_colour) {
      json["extras"]["penumbra"]["checker"] = {{"colour", json_of(*m.checker_colour)}, {"size", m.checker_size}};
    }
    if (m.medium) json["extras"]["penumbra"]["medium"] = json_of_medium(scene_.media[*m.medium]);
    add_spectra(json, m);
    if (m.conductor) {
      warn(fmt::format("material '{}': the metal's refractive index is left out; its base colour stands for it",
                       m.name));
    }
  }

  Json json_of_medium(const Medium& m) {
    Json json{{"absorption", json_of(m.absorption)}, {"scattering", json_of(m.scattering)}, {"g", m.asymmetry}};
    if (!m.name.empty()) json["name"] = m.name;
    const auto box = m.density ? std::optional(m.density->box) : m.box;
    if (box) {
      json["lower"] = {box->lower.x, box->lower.y, box->lower.z};
      json["upper"] = {box->upper.x, box->upper.y, box->upper.z};
    }
    if (m.density) {
      json["density"] = {{"bufferView", binary_.add_view(std::as_bytes(std::span(m.density->values)), GlbBinary::none)},
                         {"cells", m.density->cells}};
    }
    return json;
  }

  // Geometry.

  /// How many sets of texture coordinates a material reads.
  [[nodiscard]] std::size_t uv_sets(const Material& m) const {
    std::size_t sets = 0;
    for (const auto* ref :
         {&m.base_colour_texture, &m.metallic_roughness_texture, &m.normal_texture, &m.emission_texture,
          &m.transmission_texture, &m.specular_texture, &m.specular_colour_texture}) {
      if (*ref) sets = std::max<std::size_t>(sets, (*ref)->uv_set + 1);
    }
    return sets;
  }

  Json json_of_primitive(const Mesh& mesh, const Primitive& part) {
    Json attributes;
    std::vector<Vec3f> positions;
    positions.reserve(part.vertices.size());
    for (const std::uint32_t v : part.vertices) positions.emplace_back(mesh.positions[v]);
    attributes["POSITION"] = binary_.add_positions(positions);
    if (!mesh.normals.empty()) {
      std::vector<Vec3f> normals = picked(mesh.normals, part.vertices);
      for (Vec3f& n : normals) n = unit(n);
      attributes["NORMAL"] = binary_.add_vectors(normals);
    }
    if (!mesh.normals.empty() && !mesh.tangents.empty()) {
      std::vector<Vec4f> tangents = picked(mesh.tangents, part.vertices);
      for (Vec4f& t : tangents) t = Vec4f(unit(Vec3f(t)), t.w < 0 ? -1.0F : 1.0F);
      attributes["TANGENT"] = binary_.add_vectors(tangents);
    }
    // Sets are numbered without a gap, and there must be as many as the material reads.
    const std::size_t sets = std::max(uv_sets(scene_.materials[part.material]), !mesh.uv[1].empty()   ? std::size_t{2}
                                                                                : !mesh.uv[0].empty() ? std::size_t{1}
                                                                                                      : 0);
    for (std::size_t set = 0; set < sets; ++set) {
      const std::vector<Vec2f> uv = mesh.uv[set].empty() ? std::vector<Vec2f>(part.vertices.size(), Vec2f(0))
                                                         : picked(mesh.uv[set], part.vertices);
      attributes[fmt::format("TEXCOORD_{}", set)] = binary_.add_vectors(uv);
    }
    if (!mesh.colours.empty()) attributes["COLOR_0"] = binary_.add_vectors(picked(mesh.colours, part.vertices));
    return {{"attributes", std::move(attributes)},
            {"indices", binary_.add_indices(part.indices, part.vertices.size())},
            {"material", part.material}};
  }

  std::size_t add_mesh(const Mesh& mesh) {
    Json json = Json::object();
    if (!mesh.name.empty()) json["name"] = mesh.name;
    for (const Primitive& part : primitives(mesh)) json["primitives"].push_back(json_of_primitive(mesh, part));
    add_extras(json, mesh.extras);
    return append("meshes", std::move(json));
  }

  void add_mesh_node(const std::string& name, std::size_t mesh, const Mat4d& to_world, const std::string& extras = {}) {
    Json node = Json::object();
    if (!name.empty()) node["name"] = name;
    node["mesh"] = mesh;
    if (to_world != Mat4d(1.0)) node["matrix"] = json_of(to_world);
    add_extras(node, extras);
    add_node(std::move(node));
  }

  void add_instance(const Instance& instance) {
    const Mesh& mesh = scene_.meshes[instance.mesh];
    if (mesh.triangles.empty()) {
      warn(fmt::format("object '{}' has no triangles and is left out", instance.name));
      return;
    }
    if (!is_rotation_and_scale(instance.to_world)) {
      add_mesh_node(instance.name, add_mesh(placed(mesh, instance.to_world)), Mat4d(1.0), instance.extras);
      return;
    }
    const auto [entry, added] = mesh_of_.try_emplace(instance.mesh, 0);
    if (added) entry->second = add_mesh(mesh);
    add_mesh_node(instance.name, entry->second, instance.to_world, instance.extras);
  }

  /// A shape's triangles are stored once; each material that wears them has a mesh of its own over the same accessors.
  std::size_t shape_mesh(const Shape& shape, std::uint32_t material) {
    const std::size_t kind = shape.index();
    if (!shape_primitive_.contains(kind)) {
      const Mesh mesh = unit_mesh(shape);
      shape_primitive_[kind] = json_of_primitive(mesh, primitives(mesh).front());
      shape_primitive_[kind]["name"] = mesh.name;
    }
    const auto [entry, added] = shape_mesh_.try_emplace({kind, material}, 0);
    if (!added) return entry->second;
    Json primitive = shape_primitive_[kind];
    const Json name = primitive["name"];
    primitive.erase("name");
    primitive["material"] = material;
    if (uv_sets(scene_.materials[material]) > 0) {
      warn(fmt::format("the texture of material '{}' is not drawn on exact shapes", scene_.materials[material].name));
      const std::size_t vertices = binary_.accessors()[primitive["attributes"]["POSITION"].get<std::size_t>()].count;
      for (std::size_t set = 0; set < uv_sets(scene_.materials[material]); ++set) {
        primitive["attributes"][fmt::format("TEXCOORD_{}", set)] =
            binary_.add_vectors(std::vector<Vec2f>(vertices, Vec2f(0)));
      }
    }
    return entry->second = append("meshes", {{"name", name}, {"primitives", Json::array({primitive})}});
  }

  void add_shape(const ShapeObject& object) {
    if (std::holds_alternative<Plane>(object.shape)) {
      warn(fmt::format("plane '{}' without end is cut to a square of {} m", object.name, 2 * plane_cut_.half));
    } else {
      warn("exact spheres, disks and cylinders are written as triangles");
    }
    add_mesh_node(object.name, shape_mesh(object.shape, object.material), placement(object.shape, plane_cut_));
  }

  // Lights and cameras.

  /// @param power W/sr or W/m^2; glTF wants cd or lx.
  void add_punctual(const std::string& name, const char* type, const Rgb& power, double range, const Mat4d& to_world,
                    Json more = Json::object()) {
    const float strongest = max_component(power);
    Json light = Json::object();
    if (!name.empty()) light["name"] = name;
    light["type"] = type;
    light["color"] = json_of(strongest > 0 ? power / strongest : Rgb(1.0F));
    light["intensity"] = static_cast<double>(strongest) * gltf_lumens_per_watt;
    if (std::isfinite(range)) light["range"] = range;
    light.update(more);
    lights_.push_back(std::move(light));
    Json node = Json::object();
    if (!name.empty()) node["name"] = name;
    node["matrix"] = json_of(to_world);
    extension(node, "KHR_lights_punctual")["light"] = lights_.size() - 1;
    add_node(std::move(node));
  }

  static Mat4d standing_at(const Vec3d& position, const Vec3d& direction = {0, 0, -1}) {
    const Frame frame(-normalize(direction));
    return {Vec4d(frame.tangent, 0), Vec4d(frame.bitangent, 0), Vec4d(frame.normal, 0), Vec4d(position, 1)};
  }

  void add_light(const std::string& name, const PointLight& light) {
    Json more = Json::object();
    if (!light.inverse_square) {
      more["extras"]["penumbra"]["falloff"] = "none";
      warn(fmt::format("light '{}' does not weaken with distance; other programs than this will let it", name));
    }
    if (light.web) {
      warn(fmt::format("light '{}': its photometric web is left out; name its file in extras.penumbra.ies", name));
    }
    add_punctual(name, "point", light.intensity, light.range, standing_at(light.position), std::move(more));
  }

  void add_light(const std::string& name, const SpotLight& light) {
    constexpr double right_angle = std::numbers::pi / 2;
    if (light.outer_angle > right_angle) warn(fmt::format("spot light '{}' is narrowed to a half-space", name));
    const double outer = std::min(light.outer_angle, right_angle);
    const double inner = std::clamp(light.inner_angle, 0.0, outer * (1 - 1e-6));
    add_punctual(name, "spot", light.intensity, light.range, standing_at(light.position, light.direction),
                 {{"spot", {{"innerConeAngle", inner}, {"outerConeAngle", outer}}}});
  }

  void add_light(const std::string& name, const DirectionalLight& light) {
    Json more = Json::object();
    if (light.angular_radius > 0) more["extras"]["penumbra"]["angular_radius"] = light.angular_radius;
    add_punctual(name, "directional", light.irradiance, std::numeric_limits<double>::infinity(),
                 standing_at(Vec3d(0), light.direction), std::move(more));
  }

  void add_light(const std::string&, const AmbientLight& light) {
    ambient_ = ambient_.value_or(Rgb(0.0F)) + light.radiance;
  }

  void add_camera(const Camera& camera) {
    if (std::holds_alternative<PanoramicLens>(camera.lens) || std::holds_alternative<FisheyeLens>(camera.lens)) {
      warnings_.push_back(
          fmt::format("camera '{}' is left out: glTF has perspective and orthographic ones only", camera.name));
      return;
    }
    Json json = Json::object();
    if (!camera.name.empty()) json["name"] = camera.name;
    if (const auto* lens = std::get_if<PerspectiveLens>(&camera.lens)) {
      json["type"] = "perspective";
      json["perspective"] = {{"yfov", lens->vertical_fov}, {"znear", 0.01}};
    } else {
      const double half = std::get<OrthographicLens>(camera.lens).height / 2;
      const double far = std::max(1.0, 10 * scene_.bounds().diagonal());
      json["type"] = "orthographic";
      json["orthographic"] = {{"xmag", half}, {"ymag", half}, {"znear", 0}, {"zfar", far}};
    }
    Mat4d rigid = camera.to_world;
    for (int k = 0; k < 3; ++k) rigid[k] = Vec4d(normalize(Vec3d(rigid[k])), 0);
    Json node = Json::object();
    if (!camera.name.empty()) node["name"] = camera.name;
    node["camera"] = append("cameras", std::move(json));
    node["matrix"] = json_of(rigid);
    add_extras(node, camera.extras);
    add_node(std::move(node));
  }

  void add_scene_extras() {
    Json& scene = root_["scenes"][0];
    if (scene_.environment) {
      scene["extras"]["penumbra"]["environment"] = {{"radiance", json_of(scene_.environment->radiance)},
                                                    {"backdrop_only", scene_.environment->backdrop_only}};
      if (scene_.environment->image) warn("the environment's picture is left out; give it with --environment");
    }
    for (const std::uint32_t m : scene_.air) {
      scene["extras"]["penumbra"]["media"].push_back(json_of_medium(scene_.media[m]));
    }
    if (ambient_) scene["extras"]["penumbra"]["ambient"] = json_of(*ambient_);
    add_extras(scene, scene_.extras);
  }

  // The file.

  void add_buffer() {
    static constexpr std::array types{"", "SCALAR", "VEC2", "VEC3", "VEC4"};
    for (const GlbBinary::Accessor& a : binary_.accessors()) {
      Json json{{"bufferView", a.view},
                {"componentType", static_cast<int>(a.component)},
                {"count", a.count},
                {"type", types[static_cast<std::size_t>(a.width)]}};
      if (a.range) {
        json["min"] = json_of((*a.range)[0]);
        json["max"] = json_of((*a.range)[1]);
      }
      append("accessors", std::move(json));
    }
    for (const GlbBinary::View& v : binary_.views()) {
      Json json{{"buffer", 0}, {"byteOffset", v.offset}, {"byteLength", v.length}};
      if (v.target != GlbBinary::none) json["target"] = static_cast<int>(v.target);
      append("bufferViews", std::move(json));
    }
    if (!binary_.bytes().empty()) append("buffers", {{"byteLength", binary_.bytes().size()}});
    if (!lights_.empty()) root_["extensions"]["KHR_lights_punctual"]["lights"] = lights_;
    for (const std::string& name : extensions_) root_["extensionsUsed"].push_back(name);
  }

  void save(const std::filesystem::path& path) const {
    std::string json = root_.dump(-1, ' ', false, Json::error_handler_t::replace);
    json.resize((json.size() + 3) / 4 * 4, ' ');
    const std::span<const std::byte> binary = binary_.bytes();
    const std::size_t chunks = binary.empty() ? 20 + json.size() : 28 + json.size() + binary.size();
    if (chunks > std::numeric_limits<std::uint32_t>::max()) {
      throw FileError(path.string(), "", "a .glb ends at 4 GiB, which this scene is over; write fewer triangles");
    }
    OutputFile file(path);
    const auto words = [&](std::initializer_list<std::size_t> values) {
      std::vector<std::uint32_t> narrow;
      for (const std::size_t v : values) narrow.push_back(static_cast<std::uint32_t>(v));
      file.write(std::as_bytes(std::span(narrow)));
    };
    words({0x46546C67, 2, chunks, json.size(), 0x4E4F534A});  // "glTF", version, length; chunk "JSON"
    file.write(json);
    if (!binary.empty()) {
      words({binary.size(), 0x004E4942});  // chunk "BIN"
      file.write(binary);
    }
    file.commit();
  }

  const Scene& scene_;
  PlaneCut plane_cut_;
  std::optional<GltfLightmap> lightmap_;
  Json root_;
  GlbBinary binary_;
  Json lights_ = Json::array();
  std::optional<Rgb> ambient_;
  std::set<std::string> extensions_;
  std::vector<std::string> warnings_;
  std::vector<std::optional<std::size_t>> image_of_;
  std::map<std::uint32_t, std::size_t> mesh_of_;
  std::map<std::size_t, Json> shape_primitive_;
  std::map<std::pair<std::size_t, std::uint32_t>, std::size_t> shape_mesh_;
};

}  // namespace

std::vector<std::string> write_glb(const std::filesystem::path& path, const Scene& scene,
                                   const std::map<std::string, std::string>& notes,
                                   const std::optional<GltfLightmap>& lightmap) {
  validate(scene);
  GltfWriter writer(scene);
  writer.add_notes(notes);
  writer.set_lightmap(lightmap);
  writer.write(path);
  return writer.take_warnings();
}

}  // namespace penumbra
