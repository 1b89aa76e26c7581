#include "penumbra/io/gltf_writer.h"

#include <gtest/gtest.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <filesystem>
#include <map>
#include <nlohmann/json.hpp>
#include <numbers>

#include "penumbra/file/file_error.h"
#include "penumbra/io/gltf_reader.h"
#include "penumbra/math/transform.h"
#include "penumbra/scene/builtin_scenes.h"
#include "temporary_file.h"

namespace penumbra {
namespace {

using nlohmann::json;

/// A .glb taken apart by its specification, not by our reader.
struct Glb {
  json root;
  std::string binary;

  [[nodiscard]] const json& view_of(const json& accessor) const {
    return root["bufferViews"][accessor["bufferView"].get<std::size_t>()];
  }
  /// The accessor's components, whatever their type.
  [[nodiscard]] std::vector<double> values(std::size_t index) const {
    const json& accessor = root["accessors"][index];
    static const std::map<std::string, std::size_t> widths{{"SCALAR", 1}, {"VEC2", 2}, {"VEC3", 3}, {"VEC4", 4}};
    const std::size_t count = accessor["count"].get<std::size_t>() * widths.at(accessor["type"]);
    const std::size_t offset = view_of(accessor)["byteOffset"];
    const int type = accessor["componentType"];
    std::vector<double> made;
    for (std::size_t i = 0; i < count; ++i) {
      if (type == 5126) made.push_back(static_cast<double>(at<float>(offset + 4 * i)));
      if (type == 5125) made.push_back(at<std::uint32_t>(offset + 4 * i));
      if (type == 5123) made.push_back(at<std::uint16_t>(offset + 2 * i));
    }
    return made;
  }
  template <class T>
  [[nodiscard]] T at(std::size_t offset) const {
    T value{};
    if (offset + sizeof(T) > binary.size()) throw std::out_of_range("beyond the binary chunk");
    std::memcpy(&value, binary.data() + offset, sizeof(T));
    return value;
  }
};

Glb parse_glb(const std::string& bytes) {
  const Glb raw{{}, bytes};
  EXPECT_EQ(bytes.substr(0, 4), "glTF");
  EXPECT_EQ(raw.at<std::uint32_t>(4), 2U);
  EXPECT_EQ(raw.at<std::uint32_t>(8), bytes.size());
  const std::size_t json_size = raw.at<std::uint32_t>(12);
  EXPECT_EQ(json_size % 4, 0U);
  EXPECT_EQ(bytes.substr(16, 4), "JSON");
  Glb glb{json::parse(bytes.substr(20, json_size)), {}};
  if (bytes.size() > 20 + json_size) {
    const std::size_t binary_size = raw.at<std::uint32_t>(20 + json_size);
    EXPECT_EQ(binary_size % 4, 0U);
    EXPECT_EQ(bytes.substr(24 + json_size, 4), std::string("BIN\0", 4));
    EXPECT_EQ(bytes.size(), 28 + json_size + binary_size);
    glb.binary = bytes.substr(28 + json_size);
  }
  return glb;
}

struct Written {
  Glb glb;
  LoadedScene back;
  std::vector<std::string> warnings;
};

Written written(const Scene& scene) {
  const test::TemporaryFile file("", ".glb");
  Written result;
  result.warnings = write_glb(file.path(), scene);
  result.glb = parse_glb(test::file_bytes(file.path()));
  result.back = read_gltf(file.path());
  return result;
}

bool mentions(const std::vector<std::string>& warnings, std::string_view words) {
  return std::ranges::any_of(warnings, [&](const std::string& w) { return w.find(words) != std::string::npos; });
}

Material plain(const std::string& name) {
  Material material;
  material.name = name;
  return material;
}

Scene one_triangle(Material material) {
  Scene scene;
  scene.materials = {std::move(material)};
  Mesh mesh;
  mesh.name = "triangle";
  mesh.positions = {{0, 0, 0}, {1, 0, 0}, {0, 2, 0}};
  mesh.triangles = {{0, 1, 2}};
  scene.meshes = {mesh};
  scene.instances = {{.name = "triangle"}};
  return scene;
}

Material material_back(const Material& material) { return written(one_triangle(material)).back.scene.materials.at(0); }

/// World-space area vector of each instance summed over its triangles, and area, by object name.
std::map<std::string, std::pair<Vec3d, double>> areas(const Scene& scene) {
  std::map<std::string, std::pair<Vec3d, double>> sums;
  for (const Instance& instance : scene.instances) {
    const Mesh& mesh = scene.meshes[instance.mesh];
    auto& [vector, area] = sums.try_emplace(instance.name, Vec3d(0), 0.0).first->second;
    for (const Mesh::Triangle& t : mesh.triangles) {
      const Vec3d a = transform_point(instance.to_world, mesh.positions[t[0]]);
      const Vec3d b = transform_point(instance.to_world, mesh.positions[t[1]]);
      const Vec3d c = transform_point(instance.to_world, mesh.positions[t[2]]);
      const double side = is_mirroring(instance.to_world) ? -1 : 1;
      vector += side * 0.5 * cross(b - a, c - a);
      area += 0.5 * length(cross(b - a, c - a));
    }
  }
  return sums;
}

void expect_near(const Rgb& a, const Rgb& b, float tolerance = 1e-6F) {
  for (int k = 0; k < 3; ++k) EXPECT_NEAR(a[k], b[k], tolerance * std::max(1.0F, std::abs(b[k])));
}

TEST(GltfWriter, EveryBuiltinSceneIsASoundGlb) {
  for (const BuiltinScene& listed : builtin_scenes()) {
    SCOPED_TRACE(listed.name);
    const Glb glb = written(make_builtin_scene(listed.name)).glb;
    EXPECT_EQ(glb.root["asset"]["version"], "2.0");
    ASSERT_EQ(glb.root["buffers"].size(), 1U);
    EXPECT_LE(glb.root["buffers"][0]["byteLength"].get<std::size_t>(), glb.binary.size());
    for (const json& view : glb.root["bufferViews"]) {
      EXPECT_EQ(view["byteOffset"].get<std::size_t>() % 4, 0U);
      EXPECT_LE(view["byteOffset"].get<std::size_t>() + view["byteLength"].get<std::size_t>(), glb.binary.size());
    }
    for (const json& mesh : glb.root["meshes"]) {
      for (const json& primitive : mesh["primitives"]) {
        const json& position = glb.root["accessors"][primitive["attributes"]["POSITION"].get<std::size_t>()];
        const std::vector<double> p = glb.values(primitive["attributes"]["POSITION"]);
        for (std::size_t k = 0; k < 3; ++k) {
          double least = p[k], greatest = p[k];
          for (std::size_t i = k; i < p.size(); i += 3) {
            least = std::min(least, p[i]);
            greatest = std::max(greatest, p[i]);
          }
          EXPECT_EQ(position["min"][k].get<double>(), least);
          EXPECT_EQ(position["max"][k].get<double>(), greatest);
        }
        const std::vector<double> indices = glb.values(primitive["indices"]);
        EXPECT_EQ(indices.size() % 3, 0U);
        const int type = glb.root["accessors"][primitive["indices"].get<std::size_t>()]["componentType"];
        const double greatest = *std::ranges::max_element(indices);
        EXPECT_LT(greatest, position["count"].get<double>());
        EXPECT_LT(greatest, type == 5123 ? 65535.0 : 4294967295.0);
        if (primitive["attributes"].contains("NORMAL")) {
          const std::vector<double> n = glb.values(primitive["attributes"]["NORMAL"]);
          for (std::size_t i = 0; i < n.size(); i += 3) ASSERT_NEAR(std::hypot(n[i], n[i + 1], n[i + 2]), 1, 1e-6);
        }
      }
    }
  }
}

TEST(GltfWriter, MeshesComeBackWhereTheyWere) {
  for (const char* name : {"cornell-box", "furnace", "box345", "atrium"}) {
    SCOPED_TRACE(name);
    const Scene scene = make_builtin_scene(name);
    const Written result = written(scene);
    EXPECT_EQ(result.back.scene.triangle_count(), scene.triangle_count());
    const auto before = areas(scene), after = areas(result.back.scene);
    ASSERT_EQ(before.size(), after.size());
    for (const auto& [object, sums] : before) {
      ASSERT_TRUE(after.contains(object)) << object;
      EXPECT_NEAR(after.at(object).second, sums.second, 1e-5 * sums.second)
          << object;  // floats of metres beside bars of centimetres
      EXPECT_LT(length(after.at(object).first - sums.first), 1e-5 * sums.second) << object;
    }
    const Camera& camera = result.back.scene.cameras.at(0);
    EXPECT_EQ(camera.name, "camera");
    const Ray a = scene.cameras[0].ray(0.1, 0.8, 1.5), b = camera.ray(0.1, 0.8, 1.5);
    EXPECT_LT(length(a.origin - b.origin), 1e-12);
    EXPECT_LT(length(a.direction - b.direction), 1e-12);
  }
}

TEST(GltfWriter, TheWhittedSceneKeepsWhatGltfCannotSay) {
  const Scene scene = make_builtin_scene("whitted");
  const Written result = written(scene);
  const Scene& back = result.back.scene;
  EXPECT_TRUE(mentions(result.warnings, "'checkered floor' without end"));
  EXPECT_EQ(back.object_count(), scene.object_count());
  ASSERT_EQ(back.materials.size(), scene.materials.size());
  for (std::size_t m = 0; m < scene.materials.size(); ++m) {
    EXPECT_EQ(back.materials[m].mirror, scene.materials[m].mirror);
    EXPECT_EQ(back.materials[m].checker_colour, scene.materials[m].checker_colour);
    EXPECT_EQ(back.materials[m].specular, scene.materials[m].specular);
    EXPECT_EQ(back.materials[m].base_colour, scene.materials[m].base_colour);
    EXPECT_EQ(back.materials[m].thin_walled, scene.materials[m].thin_walled);
  }
  int points = 0, ambients = 0;
  for (const Light& light : back.lights) {
    if (const auto* point = std::get_if<PointLight>(&light.kind)) {
      ++points;
      EXPECT_FALSE(point->inverse_square);
      expect_near(point->intensity, Rgb(light.name == "key light" ? 0.9F : 0.5F));
    }
    if (const auto* ambient = std::get_if<AmbientLight>(&light.kind)) {
      ++ambients;
      EXPECT_EQ(ambient->radiance, Rgb(0.1F));
    }
  }
  EXPECT_EQ(points, 2);
  EXPECT_EQ(ambients, 1);
  ASSERT_TRUE(back.environment);
  EXPECT_TRUE(back.environment->backdrop_only);
  EXPECT_EQ(back.environment->radiance, scene.environment->radiance);
}

TEST(GltfWriter, FortyMarblesShareOneSphereOfTriangles) {
  const Glb glb = written(make_builtin_scene("whitted")).glb;
  std::map<std::size_t, int> used;
  for (const json& mesh : glb.root["meshes"])
    ++used[mesh["primitives"][0]["attributes"]["POSITION"].get<std::size_t>()];
  EXPECT_EQ(used.size(), 2U);  // sphere and square
  EXPECT_LT(glb.binary.size(), 200000U);
}

TEST(GltfWriter, MaterialsComeBack) {
  Material m = plain("everything");
  m.base_colour = {0.1F, 0.2F, 0.3F};
  m.alpha = 0.4F;
  m.alpha_mode = AlphaMode::mask;
  m.alpha_cutoff = 0.25F;
  m.metallic = 0.35F;
  m.roughness = 0.15F;
  m.specular = 0.6F;
  m.specular_colour = {0.9F, 0.8F, 2.0F};
  m.ior = 1.33F;
  m.transmission = 0.7F;
  m.attenuation_colour = {0.5F, 0.6F, 0.7F};
  m.attenuation_distance = 0.02F;
  m.mirror = {0.1F, 0.05F, 0.01F};
  m.emission = {17.0F, 12.0F, 4.0F};
  m.double_sided = true;
  const Material back = material_back(m);
  EXPECT_EQ(back.name, m.name);
  EXPECT_EQ(back.base_colour, m.base_colour);
  EXPECT_EQ(back.alpha, m.alpha);
  EXPECT_EQ(back.alpha_mode, m.alpha_mode);
  EXPECT_EQ(back.alpha_cutoff, m.alpha_cutoff);
  EXPECT_EQ(back.metallic, m.metallic);
  EXPECT_EQ(back.roughness, m.roughness);
  EXPECT_EQ(back.specular, m.specular);
  EXPECT_EQ(back.specular_colour, m.specular_colour);
  EXPECT_EQ(back.ior, m.ior);
  EXPECT_EQ(back.transmission, m.transmission);
  EXPECT_FALSE(back.thin_walled);
  EXPECT_EQ(back.attenuation_colour, m.attenuation_colour);
  EXPECT_EQ(back.attenuation_distance, m.attenuation_distance);
  EXPECT_EQ(back.mirror, m.mirror);
  expect_near(back.emission, m.emission);
  EXPECT_TRUE(back.double_sided);
}

TEST(GltfWriter, MaterialsAtTheirLimitsComeBack) {
  Material thin = plain("pane");
  thin.transmission = 1;
  thin.thin_walled = true;
  EXPECT_TRUE(material_back(thin).thin_walled);
  Material lambert = plain("matt");
  lambert.specular = 0;
  EXPECT_EQ(material_back(lambert).specular, 0);
  Material full = plain("ior 0");
  full.ior = 0;
  EXPECT_EQ(material_back(full).ior, 0);
  Material faint = plain("faint");
  faint.emission = Rgb(0.25F, 0, 0);
  EXPECT_EQ(material_back(faint).emission, faint.emission);
  Material unlit = plain("unlit");
  unlit.unlit = true;
  unlit.alpha_mode = AlphaMode::blend;
  EXPECT_TRUE(material_back(unlit).unlit);
  EXPECT_EQ(material_back(unlit).alpha_mode, AlphaMode::blend);
}

TEST(GltfWriter, OnlyWhatIsUsedIsDeclared) {
  const Glb glb = written(one_triangle(plain("standard"))).glb;
  EXPECT_FALSE(glb.root.contains("extensionsUsed"));
  EXPECT_FALSE(glb.root["materials"][0].contains("extensions"));
  const Glb box = written(make_builtin_scene("cornell-box")).glb;
  EXPECT_EQ(box.root["extensionsUsed"], json({"KHR_materials_emissive_strength", "KHR_materials_specular"}));
}

TEST(GltfWriter, TexturesComeBackWithTheirTransforms) {
  Material m = plain("textured");
  const auto degrees = [](double d) { return d * std::numbers::pi / 180; };
  const auto c = static_cast<float>(std::cos(degrees(30))), s = static_cast<float>(std::sin(degrees(30)));
  // Scale 2 by 3, turned by 30 degrees, moved.
  const Mat3f transform(Vec3f(2 * c, -2 * s, 0), Vec3f(3 * s, 3 * c, 0), Vec3f(0.25F, -0.5F, 1));
  m.base_colour_texture = TextureRef{.texture = 0, .uv_set = 1, .transform = transform};
  m.normal_texture = TextureRef{.texture = 1};
  m.normal_scale = 0.5F;
  m.emission = Rgb(1);
  m.emission_texture = TextureRef{.texture = 2};
  Scene scene = one_triangle(m);
  scene.images = {{.name = "picture",
                   .width = 2,
                   .height = 1,
                   .channels = 3,
                   .texels = std::vector<std::uint8_t>{255, 0, 10, 20, 128, 7}}};
  scene.textures = {{.image = 0, .wrap_u = Wrap::mirror, .wrap_v = Wrap::clamp, .filter = TexelFilter::nearest},
                    {.image = 0, .mipmaps = false},
                    {.image = 0}};
  const Scene back = written(scene).back.scene;
  ASSERT_TRUE(back.materials[0].base_colour_texture && back.materials[0].normal_texture);
  const TextureRef& ref = *back.materials[0].base_colour_texture;
  EXPECT_EQ(ref.uv_set, 1U);
  for (int column = 0; column < 3; ++column) {
    for (int row = 0; row < 3; ++row) EXPECT_NEAR(ref.transform[column][row], transform[column][row], 1e-6F);
  }
  EXPECT_EQ(back.materials[0].normal_scale, 0.5F);
  const Texture& texture = back.textures[ref.texture];
  EXPECT_EQ(texture.wrap_u, Wrap::mirror);
  EXPECT_EQ(texture.wrap_v, Wrap::clamp);
  EXPECT_EQ(texture.filter, TexelFilter::nearest);
  EXPECT_FALSE(back.textures[back.materials[0].normal_texture->texture].mipmaps);
  ASSERT_TRUE(back.materials[0].emission_texture);
  EXPECT_TRUE(back.textures[back.materials[0].emission_texture->texture].mipmaps);
  ASSERT_EQ(back.images.size(), 1U);
  EXPECT_EQ(back.images[0].texels, scene.images[0].texels);
  ASSERT_FALSE(back.meshes[0].uv[1].empty()) << "sets that the material reads are there, and none is left out";
  ASSERT_FALSE(back.meshes[0].uv[0].empty());
}

TEST(GltfWriter, FloatTexturesAreRoundedWithAWarning) {
  Material m = plain("bright");
  m.base_colour_texture = TextureRef{};
  Scene scene = one_triangle(m);
  scene.images = {{.name = "sky", .width = 1, .height = 1, .channels = 3, .texels = std::vector<float>{0, 4, 0.25F}}};
  scene.textures = {Texture{}};
  const Written result = written(scene);
  EXPECT_TRUE(mentions(result.warnings, "'sky' is kept in 8 bits"));
  const auto& texels = std::get<std::vector<std::uint8_t>>(result.back.scene.images[0].texels);
  EXPECT_EQ(texels, (std::vector<std::uint8_t>{0, 255, 137}));  // linear 0.25 is 0.5371 in sRGB
}

TEST(GltfWriter, VertexAttributesComeBack) {
  Scene scene = one_triangle(plain("plain"));
  Mesh& mesh = scene.meshes[0];
  mesh.normals = {{0, 0, 1}, {0.6F, 0, 0.8F}, {0, 0, 1}};
  mesh.tangents = {{1, 0, 0, 1}, {0, 1, 0, -1}, {1, 0, 0, 1}};
  mesh.uv[0] = {{0, 0}, {1, 0.5F}, {0.25F, 2}};
  mesh.colours = {{1, 0, 0, 1}, {0, 0.5F, 0, 0.25F}, {0, 0, 1, 1}};
  const Scene read = written(scene).back.scene;
  const Mesh& back = read.meshes.at(0);
  EXPECT_EQ(back.positions, mesh.positions);
  EXPECT_EQ(back.triangles, mesh.triangles);
  EXPECT_EQ(back.normals, mesh.normals);
  EXPECT_EQ(back.tangents, mesh.tangents);
  EXPECT_EQ(back.uv[0], mesh.uv[0]);
  EXPECT_EQ(back.colours, mesh.colours);
}

TEST(GltfWriter, MeshesBeyond16BitsAndOfSeveralMaterials) {
  Scene scene;
  scene.materials = {plain("even"), plain("odd")};
  Mesh mesh;
  mesh.name = "strip";
  mesh.materials.clear();
  constexpr std::uint32_t count = 70000;
  for (std::uint32_t i = 0; i < count + 2; ++i) mesh.positions.emplace_back(i / 2, i % 2, 0);
  for (std::uint32_t i = 0; i < count; ++i) {
    mesh.triangles.push_back(i % 2 == 0 ? Mesh::Triangle{i, i + 2, i + 1} : Mesh::Triangle{i, i + 1, i + 2});
    mesh.materials.push_back(i < 69990 ? 0 : 1);
  }
  scene.meshes = {mesh};
  scene.instances = {{.name = "strip"}};
  const Written result = written(scene);
  const json& primitives = result.glb.root["meshes"][0]["primitives"];
  ASSERT_EQ(primitives.size(), 2U);
  const auto type = [&](std::size_t p) -> int {
    return result.glb.root["accessors"][primitives[p]["indices"].get<std::size_t>()]["componentType"];
  };
  EXPECT_EQ(type(0), 5125);
  EXPECT_EQ(type(1), 5123) << "a part keeps only its own vertices";
  EXPECT_EQ(result.back.scene.triangle_count(), count);
  EXPECT_NEAR(areas(result.back.scene)["strip"].first.z, count / 2.0, 1e-6);
}

TEST(GltfWriter, InstancesShareTheirMeshAndShearedOnesAreWorkedIn) {
  Scene scene = one_triangle(plain("plain"));
  scene.meshes[0].normals = {{0, 0, 1}, {0, 0, 1}, {0, 0, 1}};
  const Mat4d turned = look_at({1, 2, 3}, {0, 5, -1}, {0, 1, 0});
  Mat4d mirrored(1.0), sheared(1.0), sheared_mirror(1.0);
  mirrored[0][0] = -1;
  sheared[1][0] = 0.5;
  sheared_mirror[1][0] = 0.5;
  sheared_mirror[2][2] = -1;
  scene.instances = {{.name = "a"},
                     {.name = "b", .to_world = turned},
                     {.name = "c", .to_world = mirrored},
                     {.name = "d", .to_world = sheared},
                     {.name = "e", .to_world = sheared_mirror}};
  const Written result = written(scene);
  EXPECT_EQ(result.glb.root["meshes"].size(), 3U);
  const auto before = areas(scene), after = areas(result.back.scene);
  for (const auto& [name, sums] : before) {
    EXPECT_LT(length(after.at(name).first - sums.first), 1e-6) << name;
  }
}

TEST(GltfWriter, LightsComeBack) {
  Scene scene = one_triangle(plain("plain"));
  const Vec3d direction = normalize(Vec3d(1, -2, 0.5));
  scene.lights = {{"bulb", PointLight{.position = {1, 2, 3}, .intensity = {10, 5, 0}, .range = 7}},
                  {"spot", SpotLight{.position = {-1, 0, 2},
                                     .direction = direction,
                                     .intensity = Rgb(3),
                                     .inner_angle = 0.2,
                                     .outer_angle = 0.6}},
                  {"sun", DirectionalLight{.direction = direction, .irradiance = {1, 0.9F, 0.8F}}},
                  {"dark", PointLight{.intensity = Rgb(0.0F)}}};
  const Scene back = written(scene).back.scene;
  ASSERT_EQ(back.lights.size(), 4U);
  const auto& bulb = std::get<PointLight>(back.lights[0].kind);
  EXPECT_EQ(back.lights[0].name, "bulb");
  EXPECT_EQ(bulb.position, Vec3d(1, 2, 3));
  expect_near(bulb.intensity, {10, 5, 0});
  EXPECT_EQ(bulb.range, 7);
  EXPECT_TRUE(bulb.inverse_square);
  const auto& spot = std::get<SpotLight>(back.lights[1].kind);
  EXPECT_LT(length(spot.direction - direction), 1e-12);
  EXPECT_NEAR(spot.inner_angle, 0.2, 1e-12);
  EXPECT_NEAR(spot.outer_angle, 0.6, 1e-12);
  EXPECT_TRUE(std::isinf(spot.range));
  const auto& sun = std::get<DirectionalLight>(back.lights[2].kind);
  EXPECT_LT(length(sun.direction - direction), 1e-12);
  expect_near(sun.irradiance, {1, 0.9F, 0.8F});
  EXPECT_EQ(std::get<PointLight>(back.lights[3].kind).intensity, Rgb(0.0F));
}

TEST(GltfWriter, CamerasOfBothKindsComeBack) {
  Scene scene = one_triangle(plain("plain"));
  const Mat4d eye = look_at({3, 1, 4}, {1, 5, 9}, {0, 1, 0});
  scene.cameras = {{.name = "plan", .to_world = eye, .lens = OrthographicLens{2.5}},
                   {.name = "wide", .to_world = eye, .lens = PerspectiveLens{1.75}}};
  const Scene back = written(scene).back.scene;
  ASSERT_EQ(back.cameras.size(), 2U);
  EXPECT_NEAR(std::get<OrthographicLens>(back.cameras[0].lens).height, 2.5, 1e-12);
  EXPECT_NEAR(std::get<PerspectiveLens>(back.cameras[1].lens).vertical_fov, 1.75, 1e-12);
  EXPECT_EQ(back.cameras[0].name, "plan");
  EXPECT_LT(length(back.cameras[1].ray(0.3, 0.3, 1).direction - scene.cameras[1].ray(0.3, 0.3, 1).direction), 1e-12);
}

TEST(GltfWriter, ExactShapesBecomeTrianglesOnTheirSurface) {
  Scene scene;
  scene.materials = {plain("plain")};
  const Sphere sphere{{1, 2, 3}, 0.5};
  const Disk disk{{-1, 0, 0}, normalize(Vec3d(1, 1, 0)), 2};
  const Cylinder cylinder{{0, 0, 0}, {0, 3, 4}, 0.25};
  scene.shapes = {
      {"sphere", sphere, 0}, {"disk", disk, 0}, {"cylinder", cylinder, 0}, {"plane", Plane{{0, -1, 0}, {0, 1, 0}}, 0}};
  const Scene back = written(scene).back.scene;
  ASSERT_EQ(back.instances.size(), 4U);
  const auto sums = areas(back);
  EXPECT_NEAR(sums.at("sphere").second, 4 * std::numbers::pi * 0.25, 0.01);
  EXPECT_LT(length(sums.at("sphere").first), 1e-6) << "closed";
  EXPECT_NEAR(dot(sums.at("disk").first, disk.normal), 4 * std::numbers::pi, 0.03);
  EXPECT_NEAR(sums.at("cylinder").second, 2 * std::numbers::pi * 0.25 * 5, 0.01);
  EXPECT_GT(sums.at("plane").first.y, 100.0 * 100.0 - 1e-3);
  for (const Instance& instance : back.instances) {
    const Mesh& mesh = back.meshes[instance.mesh];
    const Mat3d turn = normal_matrix(instance.to_world);
    for (std::size_t v = 0; v < mesh.positions.size(); ++v) {
      const Vec3d p = transform_point(instance.to_world, mesh.positions[v]);
      const Vec3d n = normalize(turn * Vec3d(mesh.normals[v]));
      if (instance.name == "sphere") {
        EXPECT_NEAR(length(p - sphere.centre), sphere.radius, 1e-6);
        EXPECT_LT(length(n - (p - sphere.centre) / sphere.radius), 1e-6) << "normals point outwards";
      } else if (instance.name == "cylinder") {
        const Vec3d axis = normalize(cylinder.top - cylinder.base);
        const Vec3d out = p - dot(p, axis) * axis;
        EXPECT_NEAR(length(out), cylinder.radius, 1e-6);
        EXPECT_LT(length(n - out / cylinder.radius), 1e-6);
      } else if (instance.name == "plane") {
        EXPECT_NEAR(p.y, -1, 1e-9);
      }
    }
    // The triangles' own fronts agree with the normals.
    for (const Mesh::Triangle& t : mesh.triangles) {
      const Vec3d front =
          cross(mesh.positions[t[1]] - mesh.positions[t[0]], mesh.positions[t[2]] - mesh.positions[t[0]]);
      EXPECT_GT(dot(front, Vec3d(mesh.normals[t[0]])), 0);
    }
  }
}

TEST(GltfWriter, AnOutputThatCannotBeMadeIsRefusedAndLeavesNothing) {
  EXPECT_THROW((void)write_glb("/nowhere/at/all.glb", one_triangle(plain("plain"))), FileError);
  Scene wrong = one_triangle(plain("plain"));
  wrong.meshes[0].triangles[0][2] = 9;
  const auto path =
      std::filesystem::path(testing::TempDir()) / ("penumbra-wrong-" + std::to_string(::getpid()) + ".glb");
  EXPECT_THROW((void)write_glb(path, wrong), std::invalid_argument);
  EXPECT_FALSE(std::filesystem::exists(path));
}

TEST(GltfWriter, AnEmptySceneIsStillAFile) {
  const test::TemporaryFile file("", ".glb");
  EXPECT_NO_THROW((void)write_glb(file.path(), Scene{}));
  const Glb glb = parse_glb(test::file_bytes(file.path()));
  EXPECT_EQ(glb.root["scenes"].size(), 1U);
}

// What other programs keep in extras outlives reading and writing; what is ours stands beside it.
TEST(GltfWriter, ExtrasOfTheInputAreKept) {
  json gltf = {
      {"asset", {{"version", "2.0"}}},
      {"scene", 0},
      {"scenes", {{{"nodes", {0, 1, 2}}, {"extras", {{"shop", "lamps"}, {"penumbra", {{"ambient", {1, 1, 1}}}}}}}}},
      {"nodes",
       {{{"mesh", 0}, {"extras", {{"id", 7}, {"tags", {"a", 2.5, true, nullptr}}}}},
        {{"camera", 0}, {"extras", "just text"}},
        {{"extensions", {{"KHR_lights_punctual", {{"light", 0}}}}}, {"extras", {{"bulb", "E27"}}}}}},
      {"cameras", {{{"type", "perspective"}, {"perspective", {{"yfov", 0.7}, {"znear", 0.1}}}}}},
      {"extensionsUsed", {"KHR_lights_punctual"}},
      {"extensions", {{"KHR_lights_punctual", {{"lights", {{{"type", "point"}}}}}}}},
      {"materials", {{{"extras", {{"paint", 12}, {"penumbra", {{"mirror", {0.5, 0.5, 0.5}}}}}}}}},
      {"meshes", {{{"primitives", {{{"attributes", {{"POSITION", 0}}}, {"material", 0}}}}, {"extras", {{"lod", 0}}}}}},
      {"accessors", {{{"componentType", 5126}, {"count", 3}, {"type", "VEC3"}}}}};
  const test::TemporaryFile file(gltf.dump(), ".gltf");
  const Glb out = written(read_gltf(file.path()).scene).glb;
  EXPECT_EQ(out.root["nodes"][0]["extras"], gltf["nodes"][0]["extras"]);
  EXPECT_EQ(out.root["meshes"][0]["extras"], gltf["meshes"][0]["extras"]);
  EXPECT_EQ(out.root["materials"][0]["extras"], gltf["materials"][0]["extras"]);
  EXPECT_EQ(out.root["scenes"][0]["extras"]["shop"], "lamps");
  EXPECT_EQ(out.root["scenes"][0]["extras"]["penumbra"]["ambient"], json({1, 1, 1}));
  int lights = 0, cameras = 0;
  for (const json& node : out.root["nodes"]) {
    if (node.contains("camera")) cameras += node["extras"] == "just text" ? 1 : 0;
    if (node.contains("extensions")) lights += node["extras"]["bulb"] == "E27" ? 1 : 0;
  }
  EXPECT_EQ(lights, 1);
  EXPECT_EQ(cameras, 1);
}

}  // namespace
}  // namespace penumbra
