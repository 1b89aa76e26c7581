#include "penumbra/radiosity/leaks/leaks.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>

#include "penumbra/scene/builtin_scenes.h"
#include "penumbra/scene/lint.h"

namespace penumbra {
namespace {

/// A scene put together corner by corner; each face an object of its own or all one.
class Workpiece {
 public:
  Workpiece() {
    scene_.materials.resize(1);
    scene_.materials[0].emission = Rgb(1.0F);
  }

  Workpiece& face(const std::vector<Vec3d>& corners, const std::string& name = "shell") {
    Mesh mesh;
    mesh.name = name;
    mesh.positions = corners;
    mesh.face_offsets = {0, static_cast<std::uint32_t>(corners.size())};
    for (std::uint32_t k = 0; k < corners.size(); ++k) mesh.face_vertices.push_back(k);
    for (std::uint32_t k = 2; k < corners.size(); ++k) {
      mesh.triangles.push_back({0, k - 1, k});
      mesh.face_of_triangle.push_back(0);
    }
    scene_.meshes.push_back(std::move(mesh));
    scene_.instances.push_back(
        {.name = name, .mesh = static_cast<std::uint32_t>(scene_.meshes.size() - 1), .to_world = Mat4d(1.0)});
    return *this;
  }

  [[nodiscard]] const Scene& scene() const { return scene_; }
  Scene& scene() { return scene_; }

 private:
  Scene scene_;
};

using Quad = std::array<Vec3d, 4>;

/// The six sides of a cube of `size` metres, seen from inside.
std::vector<Quad> cube_sides(double size) {
  const auto p = [&](double x, double y, double z) { return size * Vec3d(x, y, z); };
  return {Quad{p(0, 0, 0), p(0, 0, 1), p(1, 0, 1), p(1, 0, 0)},   // floor
          Quad{p(0, 1, 0), p(1, 1, 0), p(1, 1, 1), p(0, 1, 1)},   // ceiling
          Quad{p(0, 0, 0), p(0, 1, 0), p(0, 1, 1), p(0, 0, 1)},   // x = 0
          Quad{p(1, 0, 0), p(1, 0, 1), p(1, 1, 1), p(1, 1, 0)},   // x = 1
          Quad{p(0, 0, 0), p(1, 0, 0), p(1, 1, 0), p(0, 1, 0)},   // z = 0
          Quad{p(0, 0, 1), p(0, 1, 1), p(1, 1, 1), p(1, 0, 1)}};  // z = 1
}

const std::array<const char*, 6> side_names{"floor", "ceiling", "left", "right", "back", "front"};

Workpiece cube_room(double size, const std::function<void(std::vector<Quad>&)>& change = {}) {
  std::vector<Quad> sides = cube_sides(size);
  if (change) change(sides);
  Workpiece room;
  for (std::size_t k = 0; k < sides.size(); ++k) room.face({sides[k].begin(), sides[k].end()}, side_names[k]);
  return room;
}

std::vector<FindingKind> kinds(const std::vector<Finding>& findings) {
  std::vector<FindingKind> all;
  for (const Finding& f : findings) {
    if (!f.deliberate) all.push_back(f.kind);
  }
  return all;
}

TEST(Leaks, AClosedRoomIsClean) { EXPECT_TRUE(find_leaks(cube_room(3).scene()).empty()); }

TEST(Leaks, AMillimetreHoleIsReportedWithItsPlace) {
  for (const Vec2d at : {Vec2d(1.7, 0.4), Vec2d(2.999 / 2, 1.2), Vec2d(0.01, 2.9)}) {
    // The floor as a frame of four around a square of 1 mm.
    const double x0 = at.x, x1 = at.x + 0.001, z0 = at.y, z1 = at.y + 0.001;
    Workpiece room;
    const auto sides = cube_sides(3);
    for (std::size_t k = 1; k < 6; ++k) room.face({sides[k].begin(), sides[k].end()}, side_names[k]);
    const auto plate = [&](double a, double b, double c, double d) {
      room.face({{a, 0, c}, {a, 0, d}, {b, 0, d}, {b, 0, c}}, "floor");
    };
    plate(0, x0, 0, 3);
    plate(x1, 3, 0, 3);
    plate(x0, x1, 0, z0);
    plate(x0, x1, z1, 3);
    const std::vector<Finding> found = find_leaks(room.scene());
    ASSERT_EQ(kinds(found), std::vector{FindingKind::hole}) << at.x << "," << at.y;
    EXPECT_NEAR(found[0].position.x, at.x + 0.0005, 1e-4);
    EXPECT_NEAR(found[0].position.y, 0, 1e-12);
    EXPECT_NEAR(found[0].position.z, at.y + 0.0005, 1e-4);
    EXPECT_EQ(found[0].object, "floor");
    EXPECT_NEAR(found[0].size, std::sqrt(2.0) * 0.001, 1e-6);
  }
}

TEST(Leaks, AMissingTriangleIsAHole) {
  Workpiece room;
  const auto sides = cube_sides(1);
  for (std::size_t k = 1; k < 6; ++k) room.face({sides[k].begin(), sides[k].end()}, side_names[k]);
  room.face({sides[0][0], sides[0][1], sides[0][2]}, "floor");
  const std::vector<Finding> found = find_leaks(room.scene());
  ASSERT_EQ(kinds(found), std::vector{FindingKind::hole});
  EXPECT_GT(found[0].position.x, 0.5);  // in the half that is not there
  EXPECT_LT(found[0].position.z, 0.5);
}

TEST(Leaks, AMissingWallIsAnOpenSideUnlessACameraLooksThroughIt) {
  Workpiece room;
  const auto sides = cube_sides(1);
  for (std::size_t k = 0; k < 5; ++k) room.face({sides[k].begin(), sides[k].end()}, side_names[k]);
  ASSERT_EQ(kinds(find_leaks(room.scene())), std::vector{FindingKind::open_side});
  EXPECT_LT(length(find_leaks(room.scene())[0].position - Vec3d(0.5, 0.5, 1)), 1e-12);
  Camera camera;  // looks along -z
  camera.to_world[3] = Vec4d(0.5, 0.5, 3, 1);
  room.scene().cameras.push_back(camera);
  EXPECT_TRUE(kinds(find_leaks(room.scene())).empty());
  EXPECT_EQ(find_leaks(room.scene()).size(), 1U);
}

TEST(Leaks, ACrackBetweenWallsTellsItsWidth) {
  for (const double gap : {1e-5, 1e-3, 5e-3}) {
    const Workpiece room = cube_room(3, [&](std::vector<Quad>& s) {
      for (Vec3d& p : s[3]) p.x += gap;  // the right wall stands away from its four neighbours
    });
    const std::vector<Finding> found = find_leaks(room.scene());
    ASSERT_FALSE(found.empty());
    for (const Finding& f : found) {
      EXPECT_EQ(f.kind, FindingKind::crack) << f.sentence;
      EXPECT_NEAR(f.size, gap, 1e-6 * gap + 1e-12);
      EXPECT_NEAR(f.position.x, 3 + gap / 2, gap);
    }
  }
}

TEST(Leaks, ARoundingErrorIsNoCrack) {
  const Workpiece room = cube_room(3, [&](std::vector<Quad>& s) {
    for (Vec3d& p : s[3]) p.x += 3e-7;  // an ulp of single precision
  });
  EXPECT_TRUE(find_leaks(room.scene()).empty());
}

TEST(Leaks, AWallThatStopsShortOfTheFloorIsACrack) {
  const Workpiece room = cube_room(3, [&](std::vector<Quad>& s) {
    for (Vec3d& p : s[3]) p.y = std::max(p.y, 0.002);
    for (Vec3d& p : s[0]) p.x = p.x > 1 ? 3.5 : p.x;  // the floor goes on below it
  });
  const std::vector<Finding> found = find_leaks(room.scene());
  ASSERT_FALSE(found.empty());
  EXPECT_TRUE(std::any_of(found.begin(), found.end(), [](const Finding& f) {
    return f.kind == FindingKind::crack && std::abs(f.size - 0.002) < 1e-9 && f.position.y < 0.002;
  }));
}

TEST(Leaks, CornersOnAnEdgeAreClosedAndBesideItAGap) {
  for (const double beside : {0.0, 1e-3}) {
    // The ceiling's edge at x = 0 is one; the left wall below it is two quads whose common corner lies beside it.
    Workpiece room;
    const auto sides = cube_sides(1);
    for (const std::size_t k : {0U, 1U, 3U, 4U, 5U}) room.face({sides[k].begin(), sides[k].end()}, side_names[k]);
    const Vec3d corner(0, 1 - beside, 0.4);
    room.face({{0, 0, 0}, {0, 1, 0}, corner, {0, 0, 0.4}}, "left");
    room.face({{0, 0, 0.4}, corner, {0, 1, 1}, {0, 0, 1}}, "left");
    const std::vector<Finding> found = find_leaks(room.scene());
    if (beside == 0) {
      EXPECT_TRUE(found.empty());
      continue;
    }
    ASSERT_FALSE(found.empty());
    const Finding& f = found[0];
    EXPECT_EQ(f.kind, FindingKind::t_junction) << f.sentence;
    EXPECT_NEAR(f.size, beside, 0.25 * beside);
    EXPECT_LT(length(f.position - corner), 0.1);
  }
}

TEST(Leaks, TheFlippedOneOfSixWallsIsNamed) {
  const Workpiece room = cube_room(2, [](std::vector<Quad>& s) { std::reverse(s[4].begin(), s[4].end()); });
  const std::vector<Finding> found = find_leaks(room.scene());
  ASSERT_FALSE(found.empty());
  for (const Finding& f : found) {
    EXPECT_EQ(f.kind, FindingKind::flipped);
    EXPECT_EQ(f.object, "back") << f.sentence;
  }
}

TEST(Leaks, DuplicatesAndOverlapsAreToldApartAndTwinsAreNot) {
  const Quad floor = cube_sides(2)[0];
  Workpiece twice = cube_room(2);
  twice.face({floor[1], floor[2], floor[3], floor[0]}, "again");
  std::vector<Finding> found = find_leaks(twice.scene());
  EXPECT_NE(std::find_if(found.begin(), found.end(), [](auto& f) { return f.kind == FindingKind::duplicate; }),
            found.end());

  Workpiece rug = cube_room(2);
  rug.face({{0.5, 0, 0.5}, {0.5, 0, 1.5}, {1.5, 0, 1.5}, {1.5, 0, 0.5}}, "rug");
  found = find_leaks(rug.scene());
  ASSERT_EQ(kinds(found), std::vector{FindingKind::overlap});
  EXPECT_LT(length(found[0].position - Vec3d(1, 0, 1)), 1e-9);

  Workpiece plate = cube_room(2);
  plate.face({{0.5, 1, 0.5}, {0.5, 1, 1.5}, {1.5, 1, 1.5}, {1.5, 1, 0.5}}, "up");
  plate.face({{1.5, 1, 0.5}, {1.5, 1, 1.5}, {0.5, 1, 1.5}, {0.5, 1, 0.5}}, "down");
  EXPECT_TRUE(find_leaks(plate.scene()).empty());
}

TEST(Leaks, SheetsLampsBelowCeilingsAndBoxesOnFloorsAreClean) {
  for (const char* name : {"cornell-box", "furnace", "box345", "city?facets=500"}) {
    EXPECT_TRUE(kinds(find_leaks(make_builtin_scene(name))).empty()) << name;
  }
  Workpiece box = cube_room(3);
  for (const Quad& side : cube_sides(1)) {
    std::vector<Vec3d> corners(side.rbegin(), side.rend());  // seen from outside
    for (Vec3d& p : corners) p += Vec3d(1, 0, 1);
    if (corners[0].y + corners[1].y + corners[2].y > 0) box.face(corners, "box");  // without a bottom
  }
  EXPECT_TRUE(find_leaks(box.scene()).empty());
}

TEST(Leaks, ThreadedFindingsAreTheSame) {
  const Workpiece room = cube_room(3, [](std::vector<Quad>& s) {
    for (Vec3d& p : s[3]) p.x += 1e-3;
  });
  std::vector<std::string> said[2];
  for (auto& sentences : said) {
    for (const Finding& f : find_leaks(room.scene())) sentences.push_back(f.sentence);
  }
  EXPECT_EQ(said[0], said[1]);
}

TEST(Lint, SaysWhatIsOddAboutMaterialsLightTrianglesAndSize) {
  EXPECT_TRUE(lint(cube_room(3).scene()).empty());

  Workpiece bright = cube_room(3);
  bright.scene().materials[0].base_colour = Rgb(0.6F, 0.5F, 0.4F);
  bright.scene().materials[0].mirror = Rgb(0.5F, 0.4F, 0.4F);
  EXPECT_EQ(kinds(lint(bright.scene())), std::vector{FindingKind::reflectance});
  bright.scene().materials[0].mirror = Rgb(0.4F);
  EXPECT_TRUE(lint(bright.scene()).empty());

  Workpiece dark = cube_room(3);
  dark.scene().materials[0].emission = Rgb(0.0F);
  EXPECT_EQ(kinds(lint(dark.scene())), std::vector{FindingKind::no_light});

  Workpiece sliver = cube_room(3);
  sliver.face({{1, 1, 1}, {2, 1, 1}, {1.5, 1, 1}}, "sliver");
  const std::vector<Finding> flat = lint(sliver.scene());
  ASSERT_EQ(kinds(flat), std::vector{FindingKind::degenerate});
  EXPECT_EQ(flat[0].object, "sliver");

  EXPECT_EQ(kinds(lint(cube_room(1e-3).scene())), std::vector{FindingKind::scale});
  EXPECT_EQ(kinds(lint(cube_room(1e5).scene())), std::vector{FindingKind::scale});
}

}  // namespace
}  // namespace penumbra
