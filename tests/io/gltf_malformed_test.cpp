#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>
#include <cstdint>
#include <map>
#include <numeric>
#include <string>
#include <vector>

#include "io/gltf_builder.h"
#include "penumbra/file/file_error.h"
#include "penumbra/image/image_io.h"
#include "penumbra/io/gltf_reader.h"
#include "penumbra/math/rng.h"
#include "test_paths.h"

namespace penumbra::test {
namespace {

struct Expected {
  std::string place;
  std::string words;
};

// File of tests/data/gltf_bad, the place that its error must name, and words that must tell what is wrong.
const std::map<std::string, Expected> corpus = {
    {"cut_in_header.glb", {"", "cut off within its header"}},
    {"cut_in_chunk.glb", {"byte 8", "568 bytes but the file has 300"}},
    {"wrong_magic.glb", {"byte 0", "no binary glTF"}},
    {"version_1.glb", {"byte 4", "version 1"}},
    {"length_4g.glb", {"byte 8", "4294967295"}},
    {"chunk_4g.glb", {"byte 12", "4294967280"}},
    {"first_chunk_binary.glb", {"byte 12", "first chunk is not JSON"}},
    {"no_chunk.glb", {"byte 12", "first chunk is not JSON"}},
    {"no_binary_chunk.glb", {"buffer 0", "no binary chunk"}},
    {"empty.gltf", {"line 1, column 1", "not valid JSON"}},
    {"not_json.gltf", {"line 1, column 1", "not valid JSON"}},
    {"cut_json.gltf", {"line 1, column 201", "unexpected end of input"}},
    {"bad_utf8.gltf", {"line 1, column 40", "UTF-8"}},
    {"number_overflow.gltf", {"line 1, column 40", "1e999"}},
    {"nested_arrays.gltf", {"", "nested deeper than 128"}},
    {"nested_objects.gltf", {"", "nested deeper than 128"}},
    {"root_is_array.gltf", {"", "must be an object but is an array"}},
    {"no_asset.gltf", {"", "no asset"}},
    {"version_3.gltf", {"asset", "'3.0'"}},
    {"min_version.gltf", {"asset", "2.1"}},
    {"required_extension.gltf", {"extensionsRequired", "ACME_teapots"}},
    {"nodes_is_object.gltf", {"", "nodes must be an array"}},
    {"meshes_is_number.gltf", {"", "meshes must be an array"}},
    {"node_is_string.gltf", {"node 0", "must be an object but is a string"}},
    {"name_is_number.gltf", {"node 0", "name must be a string"}},
    {"translation_short.gltf", {"node 0", "translation must hold 3 numbers but holds 2"}},
    {"translation_text.gltf", {"node 0", "element 2 is a string"}},
    {"mesh_negative.gltf", {"node 0", "at least 0 but is -1"}},
    {"mesh_fraction.gltf", {"node 0", "whole number"}},
    {"missing_bin.gltf", {"buffer 0", "not_there.bin is not there"}},
    {"bin_is_folder.gltf", {"buffer 0", "no ordinary file"}},
    {"uri_absolute.gltf", {"buffer 0", "absolute path"}},
    {"uri_parent.gltf", {"buffer 0", "leaves the folder"}},
    {"uri_parent_inside.gltf", {"buffer 0", "leaves the folder"}},
    {"uri_parent_encoded.gltf", {"buffer 0", "leaves the folder"}},
    {"uri_http.gltf", {"buffer 0", "scheme"}},
    {"uri_file.gltf", {"buffer 0", "scheme"}},
    {"uri_drive.gltf", {"buffer 0", "drive"}},
    {"uri_nul.gltf", {"buffer 0", "names no file"}},
    {"base64_wrong_character.gltf", {"buffer 0", "position 2"}},
    {"base64_cut.gltf", {"buffer 0", "base64 data are cut off"}},
    {"data_uri_without_comma.gltf", {"buffer 0", "no comma"}},
    {"buffer_longer_than_data.gltf", {"buffer 0", "4000000000 but only 42"}},
    {"buffer_without_length.gltf", {"buffer 0", "no byteLength"}},
    {"view_names_no_buffer.gltf", {"bufferView 0", "buffer 1"}},
    {"view_beyond_buffer.gltf", {"bufferView 1", "36 to 43"}},
    {"view_offset_overflows.gltf", {"bufferView 1", "beyond its buffer"}},
    {"view_length_negative.gltf", {"bufferView 0", "-1"}},
    {"stride_too_small.gltf", {"accessor 0", "byteStride of 4"}},
    {"stride_huge.gltf", {"bufferView 0", "byteStride of 1099511627776"}},
    {"accessor_count_one_too_many.gltf", {"accessor 0", "4 elements reach beyond"}},
    {"accessor_count_4g.gltf", {"accessor 0", "4294967295 elements reach beyond"}},
    {"accessor_count_huge.gltf", {"accessor 0", "9007199254740992"}},
    {"accessor_count_negative.gltf", {"accessor 0", "at least 0 but is -3"}},
    {"accessor_count_text.gltf", {"accessor 0", "count must be a whole number but is a string"}},
    {"accessor_without_count.gltf", {"accessor 0", "no count"}},
    {"accessor_offset_beyond.gltf", {"accessor 0", "reach beyond"}},
    {"accessor_component_type.gltf", {"accessor 0", "5124"}},
    {"accessor_type.gltf", {"accessor 0", "VEC2"}},
    {"accessor_matrix.gltf", {"accessor 0", "matrices"}},
    {"accessor_zeros_4g.gltf", {"accessor 0", "512 MiB"}},
    {"accessor_names_no_view.gltf", {"accessor 0", "bufferView 2"}},
    {"sparse_beyond_accessor.gltf", {"accessor 0, sparse, indices", "index 3"}},
    {"sparse_count_4g.gltf", {"accessor 0, sparse", "4294967295 of only 3"}},
    {"sparse_count_beyond_view.gltf", {"accessor 0, sparse, indices", "beyond their bufferView"}},
    {"sparse_without_values.gltf", {"accessor 0, sparse", "values"}},
    {"index_beyond_vertices.gltf", {"mesh 0, primitive 0", "index 3 (element 2 of accessor 1)"}},
    {"index_all_bits.gltf", {"mesh 0, primitive 0", "index 65535"}},
    {"indices_are_floats.gltf", {"mesh 0, primitive 0", "no unsigned scalars"}},
    {"indices_missing.gltf", {"mesh 0, primitive 0", "accessor 99"}},
    {"position_missing.gltf", {"mesh 0, primitive 0", "accessor 99"}},
    {"position_scalar.gltf", {"mesh 0, primitive 0", "POSITION has 1 components"}},
    {"position_nan.gltf", {"mesh 0, primitive 0", "vertex 1 (accessor 0) is not a finite number"}},
    {"position_infinite.gltf", {"mesh 0, primitive 0", "vertex 1 (accessor 0) is not a finite number"}},
    {"normal_too_few.gltf", {"mesh 0, primitive 0", "NORMAL has 2 elements but its POSITION has 3"}},
    {"attributes_is_array.gltf", {"mesh 0, primitive 0", "attributes must be an object"}},
    {"attributes_missing.gltf", {"mesh 0, primitive 0", "no attributes"}},
    {"mode_9.gltf", {"mesh 0, primitive 0", "mode 9"}},
    {"mesh_without_primitives.gltf", {"mesh 0", "no primitives"}},
    {"mesh_missing.gltf", {"node 0", "mesh 1"}},
    {"material_missing.gltf", {"mesh 0, primitive 0", "material 0"}},
    {"draco_nonsense.gltf", {"mesh 0, primitive 0, extensions, KHR_draco_mesh_compression", "Draco data"}},
    {"draco_empty.gltf", {"mesh 0, primitive 0, extensions, KHR_draco_mesh_compression", "no Draco header"}},
    {"draco_claims_4g.gltf", {"mesh 0, primitive 0, extensions, KHR_draco_mesh_compression", "claim 4294967295"}},
    {"draco_sequential_claims_4g.gltf", {"mesh 0, primitive 0, extensions, KHR_draco_mesh_compression", "claim"}},
    {"node_own_child.gltf", {"node 0", "own ancestor"}},
    {"node_cycle.gltf", {"node 1", "own ancestor"}},
    {"node_cycle_below_scene.gltf", {"node 0", "own ancestor"}},
    {"node_two_parents.gltf", {"node 1", "node 2, is also a child of node 0"}},
    {"node_child_missing.gltf", {"node 0", "child 5"}},
    {"scene_root_is_child.gltf", {"scene 0", "child of node 0"}},
    {"scene_root_twice.gltf", {"scene 0", "twice"}},
    {"scene_root_missing.gltf", {"scene 0", "node 1"}},
    {"scene_missing.gltf", {"", "scene 4"}},
    {"matrix_short.gltf", {"node 0", "16 numbers"}},
    {"matrix_projective.gltf", {"node 0", "affine"}},
    {"rotation_zero.gltf", {"node 0", "quaternion"}},
    {"transform_overflows.gltf", {"node 1", "not finite"}},
    {"texture_missing.gltf", {"material 0, pbrMetallicRoughness, baseColorTexture", "texture 0"}},
    {"texture_names_no_image.gltf", {"texture 0", "image 2"}},
    {"alpha_mode.gltf", {"material 0", "alphaMode"}},
    {"base_colour_text.gltf", {"material 0, pbrMetallicRoughness", "baseColorFactor"}},
    {"attenuation_distance.gltf", {"material 0, extensions, KHR_materials_volume", "attenuationDistance"}},
    {"light_missing.gltf", {"node 0, extensions, KHR_lights_punctual", "light 0"}},
    {"light_type.gltf", {"light 0", "point, spot and directional"}},
    {"light_negative.gltf", {"light 0", "negative"}},
    {"spot_without_cone.gltf", {"light 0", "spot object"}},
    {"spot_cone_inverted.gltf", {"light 0, spot", "innerConeAngle < outerConeAngle"}},
    {"camera_type.gltf", {"camera 0", "perspective nor orthographic"}},
    {"camera_fov.gltf", {"camera 0, perspective", "yfov"}},
    {"camera_missing.gltf", {"node 0", "camera 0"}},
};

const std::filesystem::path corpus_folder = std::filesystem::path(PENUMBRA_TEST_DATA) / "gltf_bad";

TEST(GltfMalformed, EveryFileOfTheCorpusSaysWhatIsWrongAndWhere) {
  for (const auto& [name, expected] : corpus) {
    const auto path = corpus_folder / name;
    ASSERT_TRUE(std::filesystem::exists(path)) << name;
    const auto start = std::chrono::steady_clock::now();
    try {
      (void)read_gltf(path);
      ADD_FAILURE() << name << " was read without error";
    } catch (const FileError& error) {
      const std::string message = error.what();
      EXPECT_EQ(error.path(), path.string());
      EXPECT_EQ(error.place(), expected.place) << message;
      EXPECT_TRUE(message.starts_with(path.string() + ": ")) << message;
      EXPECT_NE(message.find(expected.words), std::string::npos) << message;
      EXPECT_EQ(message.find('\n'), std::string::npos) << message;
      EXPECT_LT(message.size(), path.string().size() + 300) << message;
    }
    EXPECT_LT(std::chrono::steady_clock::now() - start, std::chrono::seconds(2)) << name;
  }
}

TEST(GltfMalformed, TheCorpusIsListedWhole) {
  for (const auto& entry : std::filesystem::directory_iterator(corpus_folder)) {
    const auto extension = entry.path().extension();
    if (extension != ".gltf" && extension != ".glb") continue;
    EXPECT_TRUE(corpus.contains(entry.path().filename().string())) << entry.path();
  }
}

TEST(GltfMalformed, MissingFilesAndFoldersAreErrors) {
  EXPECT_THROW((void)read_gltf("no/such/scene.glb"), FileError);
  EXPECT_THROW((void)read_gltf(corpus_folder), FileError);
}

TEST(GltfMalformed, AMillionLevelsOfNestingEndEarly) {
  const TemporaryFile file(std::string(1000000, '['), ".gltf");
  EXPECT_THROW((void)read_gltf(file.path()), FileError);
}

TEST(GltfMalformed, ManyPrimitivesOfTheSameAccessorsCannotFillTheMemory) {
  // Ten thousand triangles 40,000 times over, in a few megabytes.
  GltfBuilder builder;
  const nlohmann::json primitive = {
      {"attributes", {{"POSITION", builder.add_accessor(cube_positions, "VEC3", gltf_float)}}},
      {"indices", builder.add_accessor(std::vector<std::uint8_t>(30000, 1), "SCALAR", gltf_uint8)}};
  nlohmann::json primitives;
  for (int i = 0; i < 40000; ++i) primitives.push_back(primitive);
  builder.add("meshes", {{"primitives", primitives}});
  builder.show_node({{"mesh", 0}});
  try {
    (void)builder.read();
    FAIL() << "400 million triangles were read from nothing";
  } catch (const FileError& error) {
    EXPECT_EQ(error.place(), "mesh 0");
  }
}

/// What the reader says of a file that asks for the same data again and again.
std::string refusal_of_work(const GltfBuilder& builder, const ReadOptions& options = {}) {
  try {
    (void)builder.read(options);
  } catch (const FileError& error) {
    return std::string(error.what()).find("again and again") != std::string::npos ? error.place() : error.what();
  }
  return "it was read";
}

/// A triangle of the first three among so many vertices.
nlohmann::json one_of_many_vertices(GltfBuilder& builder, std::size_t vertices) {
  return {{"attributes", {{"POSITION", builder.add_accessor(std::vector<float>(3 * vertices, 1), "VEC3", gltf_float)}}},
          {"indices", builder.add_accessor(std::vector<std::uint8_t>{0, 1, 2}, "SCALAR", gltf_uint8)}};
}

TEST(GltfMalformed, TheSameMeshCannotBeBentForEver) {
  GltfBuilder builder;
  nlohmann::json primitive = one_of_many_vertices(builder, 10000);
  primitive["targets"] = std::vector<nlohmann::json>(5000, {{"POSITION", 0}});
  builder.add("meshes", {{"primitives", {primitive}}, {"weights", std::vector<int>(5000, 1)}});
  builder.show_node({{"mesh", 0}});
  EXPECT_EQ(refusal_of_work(builder), "mesh 0, primitive 0");
}

TEST(GltfMalformed, TheSameSkinCannotBeHungForEver) {
  GltfBuilder builder;
  const auto mesh = builder.add("meshes", {{"primitives", {one_of_many_vertices(builder, 3)}}});
  std::vector<int> joints(8000);
  std::iota(joints.begin(), joints.end(), 0);
  builder.add("skins", {{"joints", joints}});
  for (std::size_t n = 0; n < joints.size(); ++n) builder.show_node({{"mesh", mesh}, {"skin", 0}});
  EXPECT_NE(refusal_of_work(builder).find("node "), std::string::npos) << refusal_of_work(builder);
}

TEST(GltfMalformed, TheSameKeysCannotMoveNodesForEver) {
  GltfBuilder builder;
  std::vector<float> times(20000);
  std::iota(times.begin(), times.end(), 0.0F);
  builder.show(one_of_many_vertices(builder, 3));
  builder.animate(0, "translation", times, std::vector<float>(60000, 1), "VEC3");
  nlohmann::json& channels = builder.json["animations"][0]["channels"];
  for (std::size_t n = 1; n < 2000; ++n) {
    channels.push_back({{"sampler", 0}, {"target", {{"node", n}, {"path", "translation"}}}});
  }
  EXPECT_EQ(refusal_of_work(builder, {.time = 1}), "animation 0, sampler 0");
}

TEST(GltfMalformed, AChainOfMovingNodesEnds) {
  GltfBuilder builder;
  const auto mesh = builder.add("meshes", {{"primitives", {one_of_many_vertices(builder, 3)}}});
  constexpr std::size_t length = 6000;
  builder.show_node({{"mesh", mesh}, {"children", {1}}});
  for (std::size_t n = 1; n < length; ++n) {
    builder.add("nodes", {{"mesh", mesh}});
    if (n + 1 < length) builder.json["nodes"][n]["children"] = {n + 1};
  }
  builder.animate(0, "translation", {0, 1}, {0, 0, 0, 1, 0, 0}, "VEC3");
  EXPECT_NE(refusal_of_work(builder, {.shutter = Shutter{0, 1}}).find("node "), std::string::npos);
  EXPECT_EQ(refusal_of_work(builder, {.time = 1}), "it was read");
}

TEST(GltfMalformed, AThousandUnknownExtensionsAreAFewSentences) {
  GltfBuilder builder;
  builder.show(one_of_many_vertices(builder, 3));
  for (int i = 0; i < 1000; ++i) builder.json["extensionsUsed"].push_back("EXT_" + std::to_string(i));
  const LoadedScene loaded = builder.read();
  EXPECT_LT(loaded.warnings.size(), 30U);
  EXPECT_NE(loaded.warnings[0].find("EXT_0 "), std::string::npos) << loaded.warnings[0];
}

/// A file with something of everything: materials, a picture, lights, a camera, sparse and strided accessors.
GltfBuilder rich_scene() {
  GltfBuilder builder;
  const auto png = encode_png({.width = 2, .height = 2, .channels = 3, .data = std::vector<std::uint8_t>(12, 99)});
  builder.add("images", {{"bufferView", builder.add_view({reinterpret_cast<const char*>(png.data()), png.size()})}});
  builder.add("samplers", {{"wrapS", 33071}});
  builder.add("textures", {{"source", 0}, {"sampler", 0}});
  builder.add("materials", {{"pbrMetallicRoughness", {{"baseColorTexture", {{"index", 0}}}, {"metallicFactor", 0.5}}},
                            {"emissiveFactor", {1, 1, 1}},
                            {"extensions",
                             {{"KHR_materials_transmission", {{"transmissionFactor", 1}}},
                              {"KHR_materials_volume", {{"thicknessFactor", 1}, {"attenuationDistance", 3}}}}}});
  const auto position = builder.add_accessor(cube_positions, "VEC3", gltf_float);
  builder.json["accessors"][position]["sparse"] = {
      {"count", 1},
      {"indices", {{"bufferView", builder.add_view(std::string("\1", 1))}, {"componentType", gltf_uint8}}},
      {"values", {{"bufferView", builder.add_view(GltfBuilder::packed<float>({1, 0, 0.5}))}}}};
  builder.show({{"attributes",
                 {{"POSITION", position},
                  {"TEXCOORD_0", builder.add_accessor(std::vector<std::uint8_t>(16, 77), "VEC2", gltf_uint8, true)}}},
                {"indices", builder.add_accessor(std::vector<std::uint16_t>(cube_indices.begin(), cube_indices.end()),
                                                 "SCALAR", gltf_uint16)},
                {"material", 0}});
  builder.add("cameras", {{"type", "perspective"}, {"perspective", {{"yfov", 0.75}}}});
  builder.json["extensions"]["KHR_lights_punctual"]["lights"] = {
      {{"type", "spot"}, {"spot", {{"outerConeAngle", 0.5}}}}};
  builder.show_node(
      {{"camera", 0}, {"translation", {1, 2, 3}}, {"extensions", {{"KHR_lights_punctual", {{"light", 0}}}}}});
  builder.json["nodes"][1]["children"] = {2};
  builder.json["nodes"].push_back({{"mesh", 0}, {"rotation", {0, 0, 0, 1}}});
  return builder;
}

/// Reads bytes as a .glb; whatever they are, it is a scene or a FileError. Returns whether it was a scene.
bool reads(const std::string& bytes) {
  const TemporaryFile file(bytes, ".glb");
  try {
    (void)read_gltf(file.path());
    return true;
  } catch (const FileError&) {
    return false;
  }
}

TEST(GltfMalformed, DamagedBytesGiveASceneOrAnError) {
  const std::string good = rich_scene().glb();
  ASSERT_TRUE(reads(good));
  CounterRng random(1979);
  int scenes = 0;
  for (int trial = 0; trial < 3000; ++trial) {
    std::string bytes = good;
    const auto flips = 1 + random.next_bits() % 3;
    for (std::uint64_t i = 0; i < flips; ++i) {
      const std::size_t at = random.next_bits() % bytes.size();
      // Digits for digits keep the JSON whole, so that damage reaches what stands behind it.
      const bool digit = bytes[at] >= '0' && bytes[at] <= '9';
      bytes[at] = digit ? static_cast<char>('0' + random.next_bits() % 10) : static_cast<char>(random.next_bits());
    }
    if (trial % 10 == 0) bytes.resize(random.next_bits() % bytes.size());
    scenes += reads(bytes) ? 1 : 0;
  }
  EXPECT_GT(scenes, 100);
  EXPECT_LT(scenes, 2900);
}

TEST(GltfMalformed, DamagedNumbersGiveASceneOrAnError) {
  // Every number of the JSON in turn becomes one that is at the edge of something.
  const GltfBuilder builder = rich_scene();
  const auto flat = builder.json.flatten();
  int scenes = 0;
  int errors = 0;
  for (const auto& [pointer, value] : flat.items()) {
    for (const nlohmann::json& edge :
         std::vector<nlohmann::json>{-1, 0, 1, 3, 255, 4294967295U, 9007199254740993, 1e300, 0.5, nullptr, "text",
                                     nlohmann::json::array(), nlohmann::json::object()}) {
      GltfBuilder changed = builder;
      changed.json[nlohmann::json::json_pointer(pointer)] = edge;
      (reads(changed.glb()) ? scenes : errors) += 1;
    }
  }
  EXPECT_GT(scenes, 50);
  EXPECT_GT(errors, 500);
}

}  // namespace
}  // namespace penumbra::test
