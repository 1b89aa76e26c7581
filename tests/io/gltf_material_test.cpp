#include "penumbra/io/gltf_material.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numbers>
#include <variant>

#include "io/gltf_builder.h"
#include "penumbra/image/image_io.h"
#include "penumbra/io/gltf_light.h"

namespace penumbra::test {
namespace {

/// A scene of one triangle with that material.
GltfBuilder triangle_of(nlohmann::json material) {
  GltfBuilder builder;
  builder.add("materials", std::move(material));
  builder.show(
      {{"attributes", {{"POSITION", builder.add_accessor<float>({0, 0, 0, 1, 0, 0, 0, 1, 0}, "VEC3", gltf_float)}}},
       {"material", 0}});
  return builder;
}

Material read_material(const nlohmann::json& material) { return triangle_of(material).read().scene.materials.at(0); }

/// A 2 x 1 picture: red, then half green.
std::string small_png() {
  const auto png = encode_png({.width = 2, .height = 1, .channels = 3, .data = {255, 0, 0, 0, 128, 0}});
  return {reinterpret_cast<const char*>(png.data()), png.size()};
}

/// Adds texture 0 with an image in the binary chunk.
void add_texture(GltfBuilder& builder, std::string_view image = small_png()) {
  builder.add("images", {{"bufferView", builder.add_view(image)}, {"mimeType", "image/png"}, {"name", "stripes"}});
  builder.add("textures", {{"source", 0}});
}

TEST(GltfMaterial, DefaultsAreThoseOfGltf) {
  for (const bool with_empty_material : {true, false}) {
    auto builder = triangle_of(nlohmann::json::object());
    if (!with_empty_material) {
      builder.json.erase("materials");
      builder.json["meshes"][0]["primitives"][0].erase("material");
    }
    const auto scene = builder.read().scene;
    ASSERT_EQ(scene.materials.size(), 1U);
    const Material& m = scene.materials[scene.meshes[0].material_of(0)];
    EXPECT_EQ(m.base_colour, Rgb(1));
    EXPECT_EQ(m.metallic, 1);
    EXPECT_EQ(m.roughness, 1);
    EXPECT_EQ(m.alpha, 1);
    EXPECT_EQ(m.ior, 1.5F);
    EXPECT_EQ(m.specular, 1);
    EXPECT_EQ(m.emission, Rgb(0));
    EXPECT_EQ(m.alpha_mode, AlphaMode::opaque);
    EXPECT_FALSE(m.double_sided || m.unlit || m.thin_walled);
  }
}

TEST(GltfMaterial, FactorsAndModes) {
  const Material m =
      read_material({{"name", "paint"},
                     {"pbrMetallicRoughness",
                      {{"baseColorFactor", {0.25, 0.5, 0.75, 0.125}}, {"metallicFactor", 0}, {"roughnessFactor", 0.5}}},
                     {"alphaMode", "MASK"},
                     {"alphaCutoff", 0.75},
                     {"doubleSided", true},
                     {"extensions", {{"KHR_materials_unlit", nlohmann::json::object()}}}});
  EXPECT_EQ(m.name, "paint");
  EXPECT_EQ(m.base_colour, Rgb(0.25F, 0.5F, 0.75F));
  EXPECT_EQ(m.alpha, 0.125F);
  EXPECT_EQ(m.metallic, 0);
  EXPECT_EQ(m.roughness, 0.5F);
  EXPECT_EQ(m.alpha_mode, AlphaMode::mask);
  EXPECT_EQ(m.alpha_cutoff, 0.75F);
  EXPECT_TRUE(m.double_sided);
  EXPECT_TRUE(m.unlit);
  EXPECT_EQ(read_material({{"alphaMode", "BLEND"}}).alpha_mode, AlphaMode::blend);
}

TEST(GltfMaterial, EmissionIsFactorTimesStrength) {
  const Material m = read_material({{"emissiveFactor", {1, 0.5, 0.25}},
                                    {"extensions", {{"KHR_materials_emissive_strength", {{"emissiveStrength", 20}}}}}});
  EXPECT_EQ(m.emission, Rgb(20, 10, 5));
  EXPECT_TRUE(m.emits());
}

TEST(GltfMaterial, SpecularAndIor) {
  const Material m =
      read_material({{"extensions",
                      {{"KHR_materials_ior", {{"ior", 1.75}}},
                       {"KHR_materials_specular", {{"specularFactor", 0}, {"specularColorFactor", {0.5, 2, 1}}}}}}});
  EXPECT_EQ(m.ior, 1.75F);
  EXPECT_EQ(m.specular, 0);
  EXPECT_EQ(m.specular_colour, Rgb(0.5F, 2, 1));
  EXPECT_EQ(read_material({{"extensions", {{"KHR_materials_ior", {{"ior", 0}}}}}}).ior, 0);
}

TEST(GltfMaterial, TransmissionWithoutAVolumeIsThin) {
  const nlohmann::json glass = {{"KHR_materials_transmission", {{"transmissionFactor", 0.75}}}};
  EXPECT_TRUE(read_material({{"extensions", glass}}).thin_walled);
  auto flat = glass;
  flat["KHR_materials_volume"] = {{"thicknessFactor", 0}};
  EXPECT_TRUE(read_material({{"extensions", flat}}).thin_walled);
  auto solid = glass;
  solid["KHR_materials_volume"] = {
      {"thicknessFactor", 0.1}, {"attenuationColor", {0.5, 0.25, 1}}, {"attenuationDistance", 2}};
  const Material m = read_material({{"extensions", solid}});
  EXPECT_FALSE(m.thin_walled);
  EXPECT_EQ(m.transmission, 0.75F);
  EXPECT_EQ(m.attenuation_colour, Rgb(0.5F, 0.25F, 1));
  EXPECT_EQ(m.attenuation_distance, 2);
  solid["KHR_materials_volume"].erase("attenuationDistance");
  EXPECT_TRUE(std::isinf(read_material({{"extensions", solid}}).attenuation_distance));
}

TEST(GltfMaterial, ValuesOutsideTheirRangeAreClampedWithOneWarning) {
  const auto loaded = triangle_of({{"pbrMetallicRoughness", {{"metallicFactor", 3}, {"roughnessFactor", -1}}}}).read();
  EXPECT_EQ(loaded.scene.materials[0].metallic, 1);
  EXPECT_EQ(loaded.scene.materials[0].roughness, 0);
  EXPECT_EQ(warnings_with(loaded, "clamped (2 cases, the first in material 0"), 1);
}

TEST(GltfMaterial, ExtrasOfPenumbra) {
  const Material m = read_material(
      {{"extras",
        {{"penumbra", {{"mirror", {0.5, 0.25, 1}}, {"checker", {{"colour", {1, 0.5, 0}}, {"size", 2.5}}}}}}}});
  EXPECT_EQ(m.mirror, Rgb(0.5F, 0.25F, 1));
  ASSERT_TRUE(m.checker_colour);
  EXPECT_EQ(*m.checker_colour, Rgb(1, 0.5F, 0));
  EXPECT_EQ(m.checker_size, 2.5F);
  EXPECT_EQ(read_material({{"extras", "of another program"}}).mirror, Rgb(0));
}

TEST(GltfTexture, TexelsSamplerAndTransform) {
  auto builder = triangle_of(
      {{"pbrMetallicRoughness",
        {{"baseColorTexture",
          {{"index", 0},
           {"texCoord", 0},
           {"extensions",
            {{"KHR_texture_transform", {{"offset", {0.25, 0.5}}, {"scale", {2, 3}}, {"texCoord", 1}}}}}}}}}});
  add_texture(builder);
  builder.json["textures"][0]["sampler"] = 0;
  builder.json["samplers"] = {{{"wrapS", 33071}, {"wrapT", 33648}, {"magFilter", 9728}}};
  const auto scene = builder.read().scene;
  ASSERT_EQ(scene.images.size(), 1U);
  EXPECT_EQ(scene.images[0].name, "stripes");
  EXPECT_EQ(scene.images[0].width, 2);
  const auto& texels = std::get<std::vector<std::uint8_t>>(scene.images[0].texels);
  EXPECT_EQ(texels[0], 255);
  EXPECT_EQ(texels[static_cast<std::size_t>(scene.images[0].channels) + 1], 128) << "texels stay as they are stored";
  ASSERT_EQ(scene.textures.size(), 1U);
  EXPECT_EQ(scene.textures[0].wrap_u, Wrap::clamp);
  EXPECT_EQ(scene.textures[0].wrap_v, Wrap::mirror);
  EXPECT_EQ(scene.textures[0].filter, TexelFilter::nearest);
  const auto ref = scene.materials[0].base_colour_texture;
  ASSERT_TRUE(ref);
  EXPECT_EQ(ref->uv_set, 1U) << "the extension's texCoord counts";
  EXPECT_EQ(ref->transform * Vec3f(1, 1, 1), Vec3f(2.25F, 3.5F, 1));
}

TEST(GltfTexture, RotationMeetsTheExampleOfTheExtension) {
  // KHR_texture_transform: offset (0, 1), a quarter turn and scale 1/2 use "only the lower left quadrant of the source
  // image, rotated clockwise 90 degrees". v runs downwards, so that quadrant is u 0 to 1/2, v 1/2 to 1.
  auto builder =
      triangle_of({{"emissiveFactor", {1, 1, 1}},
                   {"emissiveTexture",
                    {{"index", 0},
                     {"extensions",
                      {{"KHR_texture_transform",
                        {{"offset", {0, 1}}, {"rotation", std::numbers::pi / 2}, {"scale", {0.5, 0.5}}}}}}}}});
  add_texture(builder);
  const Mat3f m = builder.read().scene.materials[0].emission_texture->transform;
  const auto moved = [&](float u, float v) { return Vec2f(m * Vec3f(u, v, 1)); };
  // Turned clockwise, the picture's lower left corner comes to the upper left.
  EXPECT_LT(glm::length(moved(0, 0) - Vec2f(0, 1)), 1e-6F);
  EXPECT_LT(glm::length(moved(1, 0) - Vec2f(0, 0.5F)), 1e-6F);
  EXPECT_LT(glm::length(moved(0, 1) - Vec2f(0.5F, 1)), 1e-6F);
  EXPECT_LT(glm::length(moved(1, 1) - Vec2f(0.5F, 0.5F)), 1e-6F);
}

TEST(GltfTexture, SharedImagesAreDecodedOnceAndUnusedOnesNot) {
  auto builder = triangle_of({{"pbrMetallicRoughness", {{"baseColorTexture", {{"index", 0}}}}},
                              {"normalTexture", {{"index", 1}, {"scale", 0.5}}},
                              {"emissiveTexture", {{"index", 0}}},
                              {"occlusionTexture", {{"index", 2}}}});
  add_texture(builder);
  builder.add("textures", {{"source", 0}});
  builder.add("textures", {{"source", 1}});
  builder.add("images", {{"bufferView", builder.add_view("no picture, but nobody looks")}});
  const auto loaded = builder.read();
  EXPECT_EQ(loaded.scene.images.size(), 1U);
  EXPECT_EQ(loaded.scene.textures.size(), 2U);
  EXPECT_EQ(loaded.scene.materials[0].normal_scale, 0.5F);
  EXPECT_TRUE(loaded.warnings.empty());
}

TEST(GltfTexture, WebpSourceGoesFirst) {
  auto builder = triangle_of({{"pbrMetallicRoughness", {{"baseColorTexture", {{"index", 0}}}}}});
  add_texture(builder);
  builder.json["images"].insert(builder.json["images"].begin(), {{"uri", "missing.jpg"}});
  builder.json["textures"][0]["extensions"] = {{"EXT_texture_webp", {{"source", 1}}}};
  const auto loaded = builder.read();
  EXPECT_EQ(loaded.scene.images.size(), 1U);
  EXPECT_TRUE(loaded.warnings.empty());
}

TEST(GltfTexture, AnUnreadableImageLeavesTheFactorsAndIsOneWarning) {
  for (const char* image : {"this is no image", "\x89PNG\r\n\x1a\n", ""}) {
    auto builder = triangle_of(
        {{"pbrMetallicRoughness", {{"baseColorFactor", {0.5, 0.5, 0.5, 1}}, {"baseColorTexture", {{"index", 0}}}}},
         {"emissiveFactor", {1, 1, 1}},
         {"emissiveTexture", {{"index", 0}}}});
    add_texture(builder, image);
    const auto loaded = builder.read();
    EXPECT_TRUE(loaded.scene.images.empty());
    EXPECT_FALSE(loaded.scene.materials[0].base_colour_texture);
    EXPECT_EQ(loaded.scene.materials[0].base_colour, Rgb(0.5F));
    EXPECT_FALSE(loaded.scene.materials[0].emits()) << "a lamp behind a lost mask must not shine everywhere";
    EXPECT_EQ(warnings_with(loaded, "image 0"), 1);
    EXPECT_EQ(loaded.warnings.size(), 1U);
  }
}

TEST(GltfTexture, AMissingImageFileIsAWarningThatNamesIt) {
  auto builder = triangle_of({{"normalTexture", {{"index", 0}}}});
  builder.json["textures"] = {{{"source", 0}}};
  builder.json["images"] = {{{"uri", "bricks.png"}}};
  EXPECT_EQ(warnings_with(builder.read(), "bricks.png"), 1);
  builder.json["images"] = {{{"uri", "../../bricks.png"}}};
  EXPECT_EQ(warnings_with(builder.read(), "leaves the folder"), 1);
}

/// A scene of one light that hangs on a node.
Light read_light(const nlohmann::json& light, nlohmann::json node = nlohmann::json::object()) {
  GltfBuilder builder;
  builder.json["extensions"]["KHR_lights_punctual"]["lights"] = {light};
  node["extensions"]["KHR_lights_punctual"]["light"] = 0;
  builder.show_node(node);
  return builder.read().scene.lights.at(0);
}

TEST(GltfLight, PhotometricValuesAreDividedByTheLumensOfAWatt) {
  const auto point =
      read_light({{"type", "point"}, {"intensity", 683}, {"color", {1, 0.5, 0}}, {"range", 4}, {"name", "bulb"}},
                 {{"translation", {1, 2, 3}}});
  EXPECT_EQ(point.name, "bulb");
  const auto& kind = std::get<PointLight>(point.kind);
  EXPECT_EQ(kind.intensity, Rgb(1, 0.5F, 0));
  EXPECT_EQ(kind.position, Vec3d(1, 2, 3));
  EXPECT_EQ(kind.range, 4);
  EXPECT_TRUE(kind.inverse_square);
  const auto plain = read_light({{"type", "point"}});
  EXPECT_FLOAT_EQ(std::get<PointLight>(plain.kind).intensity.x, 1.0F / 683.0F);
  EXPECT_TRUE(std::isinf(std::get<PointLight>(plain.kind).range));
  const auto classical = read_light({{"type", "point"}, {"extras", {{"penumbra", {{"falloff", "none"}}}}}});
  EXPECT_FALSE(std::get<PointLight>(classical.kind).inverse_square);
}

TEST(GltfLight, SpotAndSunShineAlongTheirNode) {
  const double half = std::sqrt(0.5);
  // A turn of -90 degrees about x takes -z to -y; scale changes no light.
  const nlohmann::json down = {{"rotation", {-half, 0, 0, half}}, {"scale", {3, 3, 3}}, {"name", "down"}};
  const auto spot = read_light(
      {{"type", "spot"}, {"intensity", 1366}, {"spot", {{"innerConeAngle", 0.25}, {"outerConeAngle", 0.5}}}}, down);
  EXPECT_EQ(spot.name, "down");
  const auto& cone = std::get<SpotLight>(spot.kind);
  EXPECT_LT(length(cone.direction - Vec3d(0, -1, 0)), 1e-15);
  EXPECT_EQ(cone.intensity, Rgb(2));
  EXPECT_EQ(cone.inner_angle, 0.25);
  EXPECT_EQ(cone.outer_angle, 0.5);
  const auto sun = read_light({{"type", "directional"}, {"intensity", 68300}}, down);
  EXPECT_LT(length(std::get<DirectionalLight>(sun.kind).direction - Vec3d(0, -1, 0)), 1e-15);
  EXPECT_FLOAT_EQ(std::get<DirectionalLight>(sun.kind).irradiance.x, 100);
  const auto plain = read_light({{"type", "spot"}, {"spot", nlohmann::json::object()}});
  EXPECT_EQ(std::get<SpotLight>(plain.kind).inner_angle, 0);
  EXPECT_EQ(std::get<SpotLight>(plain.kind).outer_angle, std::numbers::pi / 4);
}

TEST(GltfScene, ExtrasHoldEnvironmentAndAmbientLight) {
  GltfBuilder builder;
  builder.json["scenes"][0]["extras"] = {
      {"penumbra",
       {{"environment", {{"radiance", {0.25, 0.5, 1}}, {"backdrop_only", true}}}, {"ambient", {0.5, 0, 0}}}}};
  const auto scene = builder.read().scene;
  ASSERT_TRUE(scene.environment);
  EXPECT_EQ(scene.environment->radiance, Rgb(0.25F, 0.5F, 1));
  EXPECT_TRUE(scene.environment->backdrop_only);
  ASSERT_EQ(scene.lights.size(), 1U);
  EXPECT_EQ(std::get<AmbientLight>(scene.lights[0].kind).radiance, Rgb(0.5F, 0, 0));
  EXPECT_FALSE(GltfBuilder{}.read().scene.environment);
}

TEST(GltfCamera, LensAndPlace) {
  GltfBuilder builder;
  builder.add("cameras", {{"type", "perspective"},
                          {"name", "eye"},
                          {"perspective", {{"yfov", 0.75}, {"znear", 0.1}, {"aspectRatio", 2}}}});
  builder.add("cameras",
              {{"type", "orthographic"}, {"orthographic", {{"ymag", 3}, {"xmag", 4}, {"znear", 0}, {"zfar", 9}}}});
  builder.show_node({{"camera", 0}, {"translation", {0, 1, 5}}, {"scale", {2, 2, 2}}});
  builder.show_node({{"camera", 1}, {"name", "plan"}, {"rotation", {0, 1, 0, 0}}});
  const auto cameras = builder.read().scene.cameras;
  ASSERT_EQ(cameras.size(), 2U);
  EXPECT_EQ(cameras[0].name, "eye");
  EXPECT_EQ(std::get<PerspectiveLens>(cameras[0].lens).vertical_fov, 0.75);
  const Ray ahead = cameras[0].ray(0.5, 0.5, 1.5);
  EXPECT_LT(length(ahead.origin - Vec3d(0, 1, 5)) + length(ahead.direction - Vec3d(0, 0, -1)), 1e-15);
  EXPECT_EQ(cameras[0].to_world[0], Vec4d(1, 0, 0, 0)) << "a camera does not take its node's scale";
  EXPECT_EQ(cameras[1].name, "plan");
  EXPECT_EQ(std::get<OrthographicLens>(cameras[1].lens).height, 6);
  EXPECT_LT(length(cameras[1].ray(0.5, 0.5, 1).direction - Vec3d(0, 0, 1)), 1e-15);
}

}  // namespace
}  // namespace penumbra::test
