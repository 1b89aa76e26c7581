#include "penumbra/io/vs3_reader.h"

#include <gtest/gtest.h>

#include <numeric>
#include <string>
#include <vector>

#include "io/temporary_file.h"
#include "penumbra/file/file_error.h"
#include "penumbra/math/polygon.h"
#include "penumbra/math/rng.h"
#include "test_paths.h"

namespace penumbra {
namespace {

using test::TemporaryFile;

const std::string square =
    "T a square\nF 3\nV 1 0 0 0\nV 2 1 0 0\nV 3 1 1 0\nV 4 0 1 0\nS 1 1 2 3 4 0 0 0.25 floor\nE\n";

LoadedPolygonModel read_text(const std::string& text, double unit = 1) {
  const TemporaryFile file(text, ".vs3");
  return read_vs3(file.path(), unit);
}

// The message of the FileError that the text provokes, or "" when it is read.
std::string complaint(const std::string& text) {
  try {
    (void)read_text(text);
  } catch (const FileError& error) {
    return error.place() + ": " + error.what();
  }
  return "";
}

std::vector<Vec3d> corners(const PolygonModel& model, std::size_t p) {
  std::vector<Vec3d> out;
  for (const auto c : model.polygons[p].corners) out.push_back(model.vertices[c]);
  return out;
}

double area(const PolygonModel& model, std::size_t p) { return polygon_area(corners(model, p)); }

TEST(Vs3Reader, ReadsTheSquare) {
  const auto loaded = read_text(square);
  const auto& model = loaded.model;
  EXPECT_EQ(model.title, "a square");
  ASSERT_EQ(model.polygons.size(), 1U);
  EXPECT_EQ(model.polygons[0].name, "floor");
  EXPECT_EQ(model.polygons[0].place, "line 7");
  EXPECT_DOUBLE_EQ(model.polygons[0].reflectance, 0.75);
  EXPECT_DOUBLE_EQ(area(model, 0), 1);
  EXPECT_DOUBLE_EQ(polygon_normal(corners(model, 0)).z, 1);
  EXPECT_TRUE(loaded.warnings.empty());
}

TEST(Vs3Reader, ScalesByTheUnit) { EXPECT_NEAR(area(read_text(square, 1e-3).model, 0), 1e-6, 1e-18); }

TEST(Vs3Reader, TheFacetCubeClosesAndHoldsATwoSidedPlate) {
  const auto model = read_vs3(PENUMBRA_TEST_DATA "/view3d/facet.vs3").model;
  ASSERT_EQ(model.polygons.size(), 8U);
  Vec3d closure(0);  // the vector areas of a closed surface cancel; so do a plate's two sides
  for (std::size_t p = 0; p < 8; ++p) closure += newell_vector(corners(model, p));
  EXPECT_LT(length(closure), 1e-15);
  EXPECT_DOUBLE_EQ(area(model, 6), 0.25);
  EXPECT_DOUBLE_EQ(area(model, 7), 0.25);
}

TEST(Vs3Reader, TheLRoomsCombinedSurfacesPointToTheirFirst) {
  const auto model = read_vs3(PENUMBRA_TEST_DATA "/view3d/l_room.vs3").model;
  ASSERT_EQ(model.polygons.size(), 12U);
  EXPECT_EQ(model.polygons[8].combines_with, 6U);
  EXPECT_EQ(model.polygons[9].combines_with, 6U);
  EXPECT_EQ(model.polygons[10].combines_with, 7U);
  EXPECT_FALSE(model.polygons[6].combines_with);
}

TEST(Vs3Reader, BoxWithTwoCubesHasItsArea) {
  const auto model = read_vs3(PENUMBRA_TEST_DATA "/view3d/box345_AB1.0.vs3").model;
  ASSERT_EQ(model.polygons.size(), 106U);
  double sum = 0;
  for (std::size_t p = 0; p < model.polygons.size(); ++p) sum += area(model, p);
  EXPECT_NEAR(sum, 2 * (12 + 15 + 20) + 2 * 6, 1e-12);
}

// The L-room in both formats: the same surfaces, whatever corner each begins with.
TEST(Vs3Reader, PlanesFormatAgreesWithVerticesFormat) {
  const std::string planes =
      "T L-room\nC encl=1\nF 3a\n! # s base cmb emit name\n"
      "S 1 R 0 0 0.9 srf-1\n 3 0 0 0 90  3 3\n"
      "S 2 R 0 0 0.9 srf-2\n 3 1 0 270 90 1 3\n"
      "S 3 r 0 0 0.9 srf-3\n 1 1 0 180 90 2 3\n"
      "S 4 R 0 0 0.9 srf-4\n 1 3 0 270 90 2 3\n"
      "S 5 R 0 0 0.9 srf-5\n 0 3 0 180 90 1 3\n"
      "S 6 R 0 0 0.9 srf-6\n 0 0 0  90 90 3 3\n"
      "S 7 Q 0 0 0.9 srf-7\n 3 0 3 0 180\n 2 0 3 0 3 1 2 1\n"
      "S 8 Q 0 0 0.9 srf-8\n 0 0 0 180 0 0 0 1 0 1 1 0 1\n"
      "S 9 Q 0 7 0.9 srf-7b\n 3 0 3 0 180\n 2 1 3 1 3 3 2 3\n"
      "S 10 Q 0 7 0.9 srf-7c\n 3 0 3 0 180\n 0 0 2 0 2 1 0 1\n"
      "S 11 Q 0 8 0.9 srf-8b\n 0 0 0 180. 0.\n 0 1 1 1 1 3 0 3\n"
      "S 12 q 0 8 0.9 srf-8c\n 0 0 0 180. 0.\n 1 0 3 0 3 1 1 1\nEnd of data\n";
  const auto a = read_text(planes).model;
  const auto b = read_vs3(PENUMBRA_TEST_DATA "/view3d/l_room.vs3").model;
  ASSERT_EQ(a.polygons.size(), b.polygons.size());
  for (std::size_t p = 0; p < a.polygons.size(); ++p) {
    EXPECT_EQ(a.polygons[p].name, b.polygons[p].name);
    EXPECT_LT(length(polygon_centroid(corners(a, p)) - polygon_centroid(corners(b, p))), 1e-12) << p;
    EXPECT_LT(length(newell_vector(corners(a, p)) - newell_vector(corners(b, p))), 1e-12) << p;
  }
}

TEST(Vs3Reader, TiltZeroLooksUpAndAzimuthRunsClockwiseFromNorth) {
  const auto normal_of = [](const std::string& azimuth, const std::string& tilt) {
    const auto model = read_text("F 3a\nS 1 R 0 0 1 n\n0 0 0 " + azimuth + " " + tilt + " 2 3\nE\n").model;
    return polygon_normal(corners(model, 0));
  };
  EXPECT_LT(length(normal_of("0", "0") - Vec3d(0, 0, 1)), 1e-15);
  EXPECT_LT(length(normal_of("0", "90") - Vec3d(0, 1, 0)), 1e-15);
  EXPECT_LT(length(normal_of("90", "90") - Vec3d(1, 0, 0)), 1e-15);
  EXPECT_LT(length(normal_of("90", "45") - normalize(Vec3d(1, 0, 1))), 1e-15);
}

TEST(Vs3Reader, TakesEveryKindOfLine) {
  const auto loaded = read_text(
      "! a comment\n/ another\nt Title here\nc eps=1e-4, emit=1\nf 3\nv 1 +0 0. 0\nv 2,1,0,0\r\nv 3 1 1 0\nv 4 0 1 0 ! "
      "corner\n"
      "s 1 1 2 3 4 0 0 0.9 base\ns 2 1 2 3 0 1 0 0.5 window\nn 3 4 3 2 1 1 0 .5 hole\nm 4 3 2 1 0 1 0 .5 mask\n"
      "o 5 1 2 3 4\n* S nonsense after the end\n");
  const auto& polygons = loaded.model.polygons;
  ASSERT_EQ(polygons.size(), 5U);
  EXPECT_EQ(polygons[1].base, 0U);
  EXPECT_EQ(polygons[1].corners.size(), 3U);
  EXPECT_EQ(polygons[2].role, PolygonRole::masks);
  EXPECT_EQ(polygons[3].role, PolygonRole::covers);
  EXPECT_EQ(polygons[4].role, PolygonRole::obstructs);
  ASSERT_EQ(loaded.warnings.size(), 1U);
  EXPECT_NE(loaded.warnings[0].find("emit=1"), std::string::npos);
}

TEST(Vs3Reader, ASubsurfaceMayLieOnALaterObstruction) {
  const auto model =
      read_text("F 3\nV 1 0 0 0\nV 2 1 0 0\nV 3 1 1 0\nV 4 0 1 0\nS 1 1 2 3 0 2 0 1 pane\nO 2 1 2 3 4\nE\n").model;
  EXPECT_EQ(model.polygons[0].base, 1U);
}

struct Malformed {
  const char* text;
  const char* place;
  const char* says;
};

TEST(Vs3Reader, NamesTheLineOfEveryMistake) {
  const std::string head = "F 3\nV 1 0 0 0\nV 2 1 0 0\nV 3 1 1 0\n";
  const Malformed cases[] = {
      {"Q 1 2 3\nE\n", "line 5", "unknown keyword 'Q'"},
      {"WALL 1\nE\n", "line 5", "unknown keyword 'WALL'"},
      {"S 1 1 2\nE\n", "line 5", "corner 3 of surface 1 is missing"},
      {"S 1 1 2 9 0 0 0 1 a\nE\n", "line 5", "vertex 9"},
      {"S 1 1 2 3 0 0 0\nE\n", "line 5", "emissivity"},
      {"S 1 1 2 3 0 0 0 1.5 a\nE\n", "line 5", "from 0 to 1"},
      {"S 1 1 2 3 0 0 0 nan a\nE\n", "line 5", "finite"},
      {"V 4 0 x 0\nE\n", "line 5", "y of vertex 4 should be a number but is 'x'"},
      {"V 4 0 inf 0\nE\n", "line 5", "finite"},
      {"V 3 0 0 0\nE\n", "line 5", "vertex 3 was given before"},
      {"S 1 1 2 3 0 0 0 1 a\nS 1 1 2 3 0 0 0 1 b\nE\n", "line 6", "surface 1 was given before"},
      {"S 1 1 2 3 0 7 0 1 a\nE\n", "line 5", "surface 7, which does not exist"},
      {"S 1 1 2 3 0 1 0 1 a\nE\n", "line 5", "before"},
      {"S 1 1 2 3 0 0 0 1 a\nS 2 1 2 3 0 0 1 1 b\nS 3 1 2 3 0 0 2 1 c\nE\n", "line 7", "itself combined"},
      {"N 1 1 2 3 0 0 0 1 a\nE\n", "line 5", "needs a base"},
      {"M 1 1 2 3 0 2 0 1 a\nO 2 1 2 3 0\nE\n", "line 5", "of kind S"},
      {"F 3\nE\n", "line 5", "before"},
      {"S 1 1 2 3 0 0 0 1 a\n", "line 6", "End of data"},
      {"E\n", "line 5", "no surface"},
  };
  for (const auto& bad : cases) {
    const std::string said = complaint(head + bad.text);
    EXPECT_EQ(said.rfind(std::string(bad.place) + ":", 0), 0U) << bad.text << " gave " << said;
    EXPECT_NE(said.find(bad.says), std::string::npos) << bad.text << " gave " << said;
  }
  EXPECT_NE(complaint("V 1 0 0 0\nE\n").find("F 3"), std::string::npos);
  EXPECT_NE(complaint("F 2\nE\n").find("'2'"), std::string::npos);
  EXPECT_NE(complaint("F 3a\nS 1 X 0 0 1 a\nE\n").find("R, Q or T"), std::string::npos);
  EXPECT_NE(complaint("F 3a\nS 1 R 0 0 1 a\n0 0 0 0 90 3\nE\n").find("the height of surface 1"), std::string::npos);
  EXPECT_NE(complaint("").find("End of data"), std::string::npos);
  EXPECT_THROW((void)read_vs3("/no/such/file.vs3"), FileError);
}

// However short it is cut, a file is refused: its last line is missing.
TEST(Vs3Reader, RefusesEveryTruncation) {
  const std::string whole = test::file_bytes(PENUMBRA_TEST_DATA "/view3d/facet.vs3");
  const std::size_t end = whole.find("End");
  for (std::size_t size = 0; size <= end; ++size) {
    EXPECT_NE(complaint(whole.substr(0, size)), "") << "cut to " << size;
  }
}

// Random bytes in a good file: it is read or refused with a place, never anything else.
TEST(Vs3Reader, SurvivesCorruption) {
  const std::string whole = test::file_bytes(PENUMBRA_TEST_DATA "/view3d/l_room.vs3");
  int refused = 0;
  for (std::uint64_t round = 0; round < 2000; ++round) {
    CounterRng rng(round);
    std::string bytes = whole;
    for (std::uint64_t hits = 1 + rng.next_bits() % 4; hits > 0; --hits) {
      bytes[rng.next_bits() % bytes.size()] = static_cast<char>(rng.next_bits());
    }
    const std::string said = complaint(bytes);
    if (said.empty()) continue;
    EXPECT_EQ(said.rfind("line ", 0), 0U) << said;
    ++refused;
  }
  EXPECT_GT(refused, 500);
}

}  // namespace
}  // namespace penumbra
