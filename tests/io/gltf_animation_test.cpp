// Nodes that move, meshes that morph and skins, against positions worked out by hand.

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "io/gltf_builder.h"
#include "penumbra/file/file_error.h"

namespace penumbra::test {
namespace {

using std::numbers::pi;

const std::vector<float> triangle = {0, 0, 0, 1, 0, 0, 0, 1, 0};

std::size_t show_triangle(GltfBuilder& builder) {
  const auto positions = builder.add_accessor(triangle, "VEC3", gltf_float);
  builder.show({{"attributes", {{"POSITION", positions}}}});
  return builder.json["nodes"].size() - 1;
}

/// Where corner `corner` of instance `instance` is in the world.
Vec3d corner_of(const Scene& scene, std::size_t instance = 0, std::size_t corner = 0) {
  const Instance& i = scene.instances.at(instance);
  return transform_point(i.to_world, scene.meshes[i.mesh].positions.at(corner));
}

void expect_near(const Vec3d& a, const Vec3d& b, double tolerance = 1e-6) {
  EXPECT_LT(length(a - b), tolerance) << a.x << " " << a.y << " " << a.z << " against " << b.x << " " << b.y << " "
                                      << b.z;
}

std::vector<float> turn_about_z(double angle) {
  return {0, 0, static_cast<float>(std::sin(angle / 2)), static_cast<float>(std::cos(angle / 2))};
}

std::vector<float> joined(std::vector<float> a, const std::vector<float>& b) {
  a.insert(a.end(), b.begin(), b.end());
  return a;
}

TEST(GltfAnimation, IsAtRestUnlessATimeIsAsked) {
  GltfBuilder builder;
  const auto node = show_triangle(builder);
  builder.json["nodes"][node]["translation"] = {0, 0, 7};
  builder.animate(node, "translation", {1, 2}, {1, 0, 0, 3, 0, 0}, "VEC3");
  const LoadedScene rest = builder.read();
  expect_near(corner_of(rest.scene), {0, 0, 7});
  EXPECT_EQ(warnings_with(rest, "animations are not played"), 1);
  const LoadedScene played = builder.read({.time = 1.25});
  expect_near(corner_of(played.scene), {1.5, 0, 0});
  EXPECT_TRUE(played.warnings.empty());
  EXPECT_TRUE(played.scene.instances[0].motion.empty());
  expect_near(corner_of(builder.read({.time = -3}).scene), {1, 0, 0});
  expect_near(corner_of(builder.read({.time = 9}).scene), {3, 0, 0});
}

TEST(GltfAnimation, StepsAndCubicsFollowTheSpecification) {
  GltfBuilder stepped;
  stepped.animate(show_triangle(stepped), "translation", {0, 1, 2}, {1, 0, 0, 2, 0, 0, 3, 0, 0}, "VEC3", "STEP");
  expect_near(corner_of(stepped.read({.time = 0.99}).scene), {1, 0, 0});
  expect_near(corner_of(stepped.read({.time = 1.0}).scene), {2, 0, 0});

  // Keys and tangents of x = t^3 - t over [0, 2]: a cubic is met everywhere.
  const auto x = [](double t) { return static_cast<float>(t * t * t - t); };
  const auto slope = [](double t) { return static_cast<float>(3 * t * t - 1); };
  GltfBuilder cubic;
  cubic.animate(show_triangle(cubic), "translation", {0, 2},
                {slope(0), 0, 0, x(0), 0, 0, slope(0), 0, 0, slope(2), 0, 0, x(2), 0, 0, slope(2), 0, 0}, "VEC3",
                "CUBICSPLINE");
  for (const double t : {0.0, 0.3, 1.0, 1.7, 2.0}) {
    expect_near(corner_of(cubic.read({.time = t}).scene), {static_cast<double>(x(t)), 0, 0}, 1e-5);
  }
}

TEST(GltfAnimation, RotationsTurnEvenlyTheShorterWay) {
  GltfBuilder builder;
  const auto node = show_triangle(builder);
  std::vector<float> to = turn_about_z(2.0);
  for (float& q : to) q = -q;  // the same rotation
  builder.animate(node, "rotation", {0, 1}, joined(turn_about_z(0.4), to), "VEC4");
  for (const double t : {0.0, 0.25, 0.8, 1.0}) {
    const double angle = 0.4 + 1.6 * t;
    expect_near(corner_of(builder.read({.time = t}).scene, 0, 1), {std::cos(angle), std::sin(angle), 0});
  }
}

TEST(GltfAnimation, ChildrenMoveWithTheirParents) {
  GltfBuilder builder;
  const auto node = show_triangle(builder);
  builder.json["nodes"][node]["translation"] = {2, 0, 0};
  const auto parent = builder.add("nodes", {{"children", {node}}});
  builder.json["scenes"][0]["nodes"] = {parent};
  builder.animate(parent, "rotation", {0, 1}, joined(turn_about_z(0), turn_about_z(pi / 2)), "VEC4");
  expect_near(corner_of(builder.read({.time = 1}).scene), {0, 2, 0});
  expect_near(corner_of(builder.read({.time = 0.5}).scene), {std::sqrt(2), std::sqrt(2), 0});
}

TEST(GltfAnimation, IsChosenByNameOrIndex) {
  GltfBuilder builder;
  const auto node = show_triangle(builder);
  builder.animate(node, "translation", {0, 1}, {0, 0, 0, 1, 0, 0}, "VEC3");
  nlohmann::json second = builder.json["animations"][0];
  builder.json["animations"][0]["name"] = "walk";
  second["name"] = "stand";
  second["channels"] = nlohmann::json::array();
  builder.json["animations"].push_back(second);
  expect_near(corner_of(builder.read({.time = 1}).scene), {1, 0, 0});
  expect_near(corner_of(builder.read({.animation = "walk", .time = 1}).scene), {1, 0, 0});
  expect_near(corner_of(builder.read({.animation = "stand", .time = 1}).scene), {0, 0, 0});
  expect_near(corner_of(builder.read({.animation = "1", .time = 1}).scene), {0, 0, 0});
  try {
    (void)builder.read({.animation = "run", .time = 1});
    FAIL();
  } catch (const FileError& error) {
    EXPECT_NE(std::string(error.what()).find("has no animation 'run'; it has 0 'walk', 1 'stand'"), std::string::npos)
        << error.what();
  }
}

TEST(GltfAnimation, BrokenOnesAreRefusedInOneSentence) {
  const auto refused = [](const auto& change, const char* words) {
    GltfBuilder builder;
    const auto node = show_triangle(builder);
    builder.animate(node, "translation", {0, 1}, {0, 0, 0, 1, 0, 0}, "VEC3");
    change(builder);
    EXPECT_NO_THROW((void)builder.read());  // not played, not read
    try {
      (void)builder.read({.time = 0.5});
      ADD_FAILURE() << words;
    } catch (const FileError& error) {
      EXPECT_NE(std::string(error.what()).find(words), std::string::npos) << error.what();
    }
  };
  refused([](GltfBuilder& b) { b.json["animations"][0]["channels"][0]["sampler"] = 7; }, "sampler 7");
  refused([](GltfBuilder& b) { b.json["animations"][0]["samplers"][0]["input"] = 70; }, "accessor");
  refused([](GltfBuilder& b) { b.json["animations"][0]["channels"][0].erase("target"); }, "no target");
  refused([](GltfBuilder& b) { b.json["animations"][0]["channels"][0]["target"]["path"] = "rotation"; },
          "6 numbers of rotation for 2 keys");
  refused([](GltfBuilder& b) { b.animate(0, "scale", {1, 0}, {1, 1, 1, 1, 1, 1}, "VEC3"); }, "do not increase");
  refused([](GltfBuilder& b) { b.animate(0, "rotation", {0, 1}, {0, 0, 0, 0, 0, 0, 0, 0}, "VEC4"); }, "quaternion");
}

TEST(GltfMorph, WeightsComeFromTheMeshTheNodeOrTheAnimation) {
  GltfBuilder builder;
  const auto positions = builder.add_accessor(triangle, "VEC3", gltf_float);
  const auto up = builder.add_accessor<float>({0, 0, 1, 0, 0, 1, 0, 0, 1}, "VEC3", gltf_float);
  const auto right = builder.add_accessor<float>({2, 0, 0, 0, 0, 0, 0, 0, 0}, "VEC3", gltf_float);
  const auto mesh = builder.show(
      {{"attributes", {{"POSITION", positions}}}, {"targets", {{{"POSITION", up}}, {{"POSITION", right}}}}});
  expect_near(corner_of(builder.read().scene), {0, 0, 0});
  builder.json["meshes"][mesh]["weights"] = {0.5, 0};
  expect_near(corner_of(builder.read().scene), {0, 0, 0.5});
  builder.json["nodes"][0]["weights"] = {1, 0.25};
  expect_near(corner_of(builder.read().scene), {0.5, 0, 1});
  expect_near(corner_of(builder.read().scene, 0, 1), {1, 0, 1});
  builder.animate(0, "weights", {0, 1}, {0, 0, 0, 1}, "SCALAR");
  expect_near(corner_of(builder.read({.time = 0.75}).scene), {1.5, 0, 0});
  // A second node without weights keeps the mesh's own.
  builder.show_node({{"mesh", mesh}});
  const Scene two = builder.read({.time = 0.75}).scene;
  expect_near(corner_of(two, 0), {1.5, 0, 0});
  expect_near(corner_of(two, 1), {0, 0, 0.5});
}

// glTF's sample "SimpleMorph" and others displace by sparse accessors without a view.
TEST(GltfMorph, TakesSparseTargets) {
  GltfBuilder builder;
  const auto positions = builder.add_accessor(triangle, "VEC3", gltf_float);
  const auto indices = builder.add_view(GltfBuilder::packed<std::uint8_t>({2}));
  const auto values = builder.add_view(GltfBuilder::packed<float>({0, 0, 3}));
  const auto sparse = builder.add("accessors", {{"componentType", gltf_float},
                                                {"count", 3},
                                                {"type", "VEC3"},
                                                {"sparse",
                                                 {{"count", 1},
                                                  {"indices", {{"bufferView", indices}, {"componentType", gltf_uint8}}},
                                                  {"values", {{"bufferView", values}}}}}});
  const auto mesh = builder.show({{"attributes", {{"POSITION", positions}}}, {"targets", {{{"POSITION", sparse}}}}});
  builder.json["meshes"][mesh]["weights"] = {0.5};
  const Scene scene = builder.read().scene;
  expect_near(corner_of(scene, 0, 0), {0, 0, 0});
  expect_near(corner_of(scene, 0, 2), {0, 1, 1.5});
}

/// A strip of two squares along y whose lower end hangs on joint 0 and whose upper end on joint 1, a metre up.
struct Bar {
  GltfBuilder builder;
  std::size_t lower = 0, upper = 0, node = 0;

  Bar() {
    const auto positions =
        builder.add_accessor<float>({0, 0, 0, 1, 0, 0, 0, 1, 0, 1, 1, 0, 0, 2, 0, 1, 2, 0}, "VEC3", gltf_float);
    std::vector<float> up;
    for (int i = 0; i < 6; ++i) up.insert(up.end(), {1, 0, 0});
    const auto normals = builder.add_accessor(up, "VEC3", gltf_float);
    const auto joints = builder.add_accessor<std::uint8_t>(
        {0, 1, 0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1, 0, 0}, "VEC4", gltf_uint8);
    const auto weights = builder.add_accessor<float>(
        {1, 0, 0, 0, 1, 0, 0, 0, 0.5F, 0.5F, 0, 0, 0.5F, 0.5F, 0, 0, 0, 1, 0, 0, 0, 1, 0, 0}, "VEC4", gltf_float);
    const auto indices =
        builder.add_accessor<std::uint16_t>({0, 1, 3, 0, 3, 2, 2, 3, 5, 2, 5, 4}, "SCALAR", gltf_uint16);
    const auto mesh = builder.add(
        "meshes", {{"primitives",
                    {{{"attributes",
                       {{"POSITION", positions}, {"NORMAL", normals}, {"JOINTS_0", joints}, {"WEIGHTS_0", weights}}},
                      {"indices", indices}}}}});
    upper = builder.add("nodes", {{"translation", {0, 1, 0}}});
    lower = builder.add("nodes", {{"children", {upper}}});
    std::vector<float> bind;
    for (const float down : {0.0F, -1.0F}) {
      bind.insert(bind.end(), {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, down, 0, 1});
    }
    const auto matrices = builder.add_accessor(bind, "MAT4", gltf_float);
    builder.json["skins"] = {{{"joints", {lower, upper}}, {"inverseBindMatrices", matrices}}};
    builder.json["scenes"][0]["nodes"].push_back(lower);
    // A skinned mesh takes no notice of its own node's place.
    node = builder.show_node({{"mesh", mesh}, {"skin", 0}, {"translation", {50, 60, 70}}});
  }
};

TEST(GltfSkin, AtRestIsWhereTheJointsAre) {
  const Scene straight = Bar().builder.read().scene;
  expect_near(corner_of(straight, 0, 0), {0, 0, 0});
  expect_near(corner_of(straight, 0, 5), {1, 2, 0});
  Bar moved;
  moved.builder.json["nodes"][moved.lower]["translation"] = {3, 0, 0};
  expect_near(corner_of(moved.builder.read().scene, 0, 5), {4, 2, 0});
}

TEST(GltfSkin, BendsByLinearBlending) {
  Bar bar;
  bar.builder.animate(bar.upper, "rotation", {0, 1}, joined(turn_about_z(0), turn_about_z(pi / 2)), "VEC4");
  const Scene scene = bar.builder.read({.time = 1}).scene;
  const Mesh& mesh = scene.meshes[scene.instances[0].mesh];
  expect_near(corner_of(scene, 0, 0), {0, 0, 0});
  // (1, 2) stands (1, 1) from the upper joint; a quarter turn takes it to (-1, 1).
  expect_near(corner_of(scene, 0, 5), {-1, 2, 0});
  // (1, 1) half by rest, half by the turn: ((1, 1) + (0, 2)) / 2.
  expect_near(corner_of(scene, 0, 3), {0.5, 1.5, 0});
  expect_near(Vec3d(mesh.normals[0]), {1, 0, 0});
  expect_near(Vec3d(mesh.normals[5]), {0, 1, 0});
  expect_near(Vec3d(mesh.normals[3]), {std::sqrt(0.5), std::sqrt(0.5), 0});
}

TEST(GltfSkin, WrongOnesAreRefusedInOneSentence) {
  const auto refused = [](const auto& change, const char* words) {
    Bar bar;
    change(bar.builder.json);
    try {
      (void)bar.builder.read();
      ADD_FAILURE() << words;
    } catch (const FileError& error) {
      EXPECT_NE(std::string(error.what()).find(words), std::string::npos) << error.what();
    }
  };
  refused([](nlohmann::json& j) { j["skins"][0]["joints"] = nlohmann::json::array(); }, "no joints");
  refused([](nlohmann::json& j) { j["skins"][0]["joints"] = {0, 99}; }, "node 99");
  refused([](nlohmann::json& j) { j["skins"][0]["joints"] = {0}; }, "hangs on joint 1");
  refused([](nlohmann::json& j) { j["skins"][0]["inverseBindMatrices"] = 0; }, "inverseBindMatrices");
  refused([](nlohmann::json& j) { j["nodes"][2]["skin"] = 4; }, "skin 4");
}

TEST(GltfShutter, ObjectsAndCamerasGetTheirWay) {
  GltfBuilder builder;
  const auto node = show_triangle(builder);
  builder.animate(node, "translation", {0, 1}, {0, 0, 0, 4, 0, 0}, "VEC3");
  builder.add("cameras", {{"type", "perspective"}, {"perspective", {{"yfov", 0.7}, {"znear", 0.1}}}});
  const auto eye = builder.show_node({{"camera", 0}});
  builder.animate(eye, "rotation", {0, 1}, joined(turn_about_z(0), turn_about_z(pi / 2)), "VEC4");
  const auto still = show_triangle(builder);
  (void)still;
  const Scene scene = builder.read({.shutter = Shutter{0.25, 0.75}}).scene;
  const Motion& straight = scene.instances[0].motion;
  ASSERT_EQ(straight.size(), 2U);  // an even way needs no steps between
  expect_near(Vec3d(placement_at(straight, 0)[3]), {1, 0, 0});
  expect_near(Vec3d(placement_at(straight, 1)[3]), {3, 0, 0});
  expect_near(Vec3d(scene.instances[0].to_world[3]), {2, 0, 0});
  EXPECT_TRUE(scene.instances[1].motion.empty());
  const Motion& turning = scene.cameras[0].motion;
  ASSERT_GT(turning.size(), 8U);
  for (const double t : {0.0, 0.1, 0.37, 0.92, 1.0}) {
    const double angle = pi / 2 * (0.25 + 0.5 * t);
    expect_near(Vec3d(placement_at(turning, t)[0]), {std::cos(angle), std::sin(angle), 0}, 1e-5);
  }
}

TEST(GltfShutter, LampsThatMoveStandStillAndAreTold) {
  GltfBuilder builder;
  const auto node = show_triangle(builder);
  builder.json["materials"] = {{{"emissiveFactor", {1, 1, 1}}}};
  builder.json["meshes"][0]["primitives"][0]["material"] = 0;
  builder.animate(node, "translation", {0, 1}, {0, 0, 0, 4, 0, 0}, "VEC3");
  const LoadedScene loaded = builder.read({.shutter = Shutter{0, 1}});
  EXPECT_TRUE(loaded.scene.instances[0].motion.empty());
  expect_near(corner_of(loaded.scene), {2, 0, 0});
  EXPECT_EQ(warnings_with(loaded, "lights that move stand still"), 1);
}

TEST(GltfScenes, AreChosenByNameOrIndex) {
  GltfBuilder builder;
  show_triangle(builder);
  const auto positions = builder.add_accessor(cube_positions, "VEC3", gltf_float);
  const auto indices = builder.add_accessor(cube_indices, "SCALAR", gltf_uint32);
  const auto cube =
      builder.add("meshes", {{"primitives", {{{"attributes", {{"POSITION", positions}}}, {"indices", indices}}}}});
  const auto node = builder.add("nodes", {{"mesh", cube}});
  builder.json["scenes"].push_back({{"name", "the cube"}, {"nodes", {node}}});
  EXPECT_EQ(builder.read().scene.triangle_count(), 1U);
  EXPECT_EQ(builder.read({.scene = "1"}).scene.triangle_count(), 12U);
  EXPECT_EQ(builder.read({.scene = "the cube"}).scene.triangle_count(), 12U);
  EXPECT_THROW((void)builder.read({.scene = "2"}), FileError);
  EXPECT_THROW((void)builder.read({.scene = "cellar"}), FileError);
}

}  // namespace
}  // namespace penumbra::test
