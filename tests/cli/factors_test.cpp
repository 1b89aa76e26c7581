#include <gtest/gtest.h>

#include <cmath>
#include <csignal>
#include <fstream>
#include <iterator>
#include <sstream>
#include <string>

#include "program.h"
#include "test_paths.h"

namespace penumbra::test {
namespace {

const std::string data = PENUMBRA_TEST_DATA "/view3d/";

// Two unit squares that face each other at distance 1.
const std::string squares =
    "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nv 0 0 1\nv 1 0 1\nv 1 1 1\nv 0 1 1\no floor\nf 1 2 3 4\no roof\nf 8 7 6 5\n";

// The entry i,j of a .csv of factors.
double csv_factor(const std::string& text, int i, int j) {
  std::istringstream lines(text);
  const std::string wanted = std::to_string(i) + "," + std::to_string(j) + ",";
  for (std::string line; std::getline(lines, line);) {
    if (line.starts_with(wanted)) return std::stod(line.substr(line.rfind(',') + 1));
  }
  return 0;
}

std::string read(const std::string& path) {
  std::ifstream in(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), {}};
}

TEST(FactorsCommand, ReportHasTheAgreedKeys) {
  const Workshop shop;
  const Outcome run = penumbra({"factors", data + "facet.vs3", "-o", shop.path("f.npz"), "--json", "-q"});
  ASSERT_EQ(run.code, 0) << run.err;
  const auto report = run.report();
  for (const char* key :
       {"surfaces", "nonzeros", "dropped_sum_max", "reciprocity_error_max", "estimated_error_max", "peak_rss_bytes"}) {
    EXPECT_TRUE(report.contains(key)) << key;
  }
  for (const char* key : {"min", "max", "mean"}) EXPECT_NEAR(report["row_sum"][key].get<double>(), 1, 1e-4);
  for (const char* key : {"load", "factors", "write"}) EXPECT_GE(report["seconds"][key].get<double>(), 0);
  EXPECT_EQ(report["surfaces"], 8);
  EXPECT_EQ(shop.contents(), std::vector<std::string>{"f.npz"});
}

TEST(FactorsCommand, CombinesSubtractsAndNamesSurfaces) {
  const Workshop shop;
  ASSERT_EQ(penumbra({"factors", data + "l_room.vs3", "-o", shop.path("f.csv"), "--tolerance", "1e-6", "-q"}).code, 0);
  const std::string text = read(shop.path("f.csv"));
  EXPECT_NEAR(csv_factor(text, 0, 1), 0.113154415, 2e-6);  // the L-room's reference, surfaces 7 and 8 combined
  EXPECT_NEAR(csv_factor(text, 0, 6), 0.133016566, 2e-6);
  EXPECT_NE(text.find(",srf-7,"), std::string::npos);
  EXPECT_EQ(text.find("srf-7b"), std::string::npos);
}

TEST(FactorsCommand, AggregatesByObject) {
  const Workshop shop;
  const std::string two_triangles =
      "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nv 0 0 1\nv 1 0 1\nv 1 1 1\nv 0 1 1\no floor\nf 1 2 3\nf 1 3 4\no roof\nf 8 "
      "7 6 5\n";
  const std::string mesh = shop.file("m.obj", two_triangles);
  ASSERT_EQ(
      penumbra({"factors", mesh, "-o", shop.path("f.csv"), "--surfaces", "object", "--tolerance", "1e-7", "-q"}).code,
      0);
  EXPECT_NEAR(csv_factor(read(shop.path("f.csv")), 0, 1), 0.199824895698387, 1e-6);
  EXPECT_NEAR(csv_factor(read(shop.path("f.csv")), 1, 0), 0.199824895698387, 1e-6);
}

TEST(FactorsCommand, PairOfMeshesWithABlocker) {
  const Workshop shop;
  const std::string floor = shop.file("floor.obj", "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nf 1 2 3 4\n");
  const std::string roof = shop.file("roof.obj", "v 0 0 1\nv 1 0 1\nv 1 1 1\nv 0 1 1\nf 4 3 2 1\n");
  const std::string plate = shop.file("plate.obj", "v 0 0 0.5\nv 0.5 0 0.5\nv 0.5 0.5 0.5\nv 0 0.5 0.5\nf 1 2 3 4\n");
  const Outcome open = penumbra({"factors", "--from", floor, "--to", roof, "--json", "-q"});
  ASSERT_EQ(open.code, 0) << open.err;
  EXPECT_NEAR(open.report()["factor"].get<double>(), 0.199824895698387, 1e-9);
  const Outcome blocked =
      penumbra({"factors", "--from", floor, "--to", roof, "--blockers", plate, "--tolerance", "1e-6", "--json", "-q"});
  ASSERT_EQ(blocked.code, 0) << blocked.err;
  EXPECT_NEAR(blocked.report()["factor"].get<double>(), 0.1498686717737905, 2e-6);  // semi-analytic
  const Outcome printed = penumbra({"factors", "--from", floor, "--to", roof, "-q"});
  EXPECT_EQ(printed.out.rfind("F(floor to roof) = 0.19982", 0), 0U) << printed.out;
}

TEST(FactorsCommand, UnitsScaleLengthsAndLeaveFactors) {
  const Workshop shop;
  const std::string mesh = shop.file("m.obj", squares);
  ASSERT_EQ(penumbra({"factors", mesh, "-o", shop.path("f.csv"), "--unit", "mm", "-q"}).code, 0);
  const std::string text = read(shop.path("f.csv"));
  EXPECT_NE(text.find("e-06,"), std::string::npos) << text;  // areas of 1 mm^2
  EXPECT_NEAR(csv_factor(text, 0, 1), 0.199824895698387, 1e-5);
}

TEST(FactorsCommand, TheSameBytesFromMemoryAndFromDisk) {
  const Workshop shop;
  const std::string room = data + "box345_AB1.0.vs3";
  ASSERT_EQ(penumbra({"factors", room, "-o", shop.path("a.npz"), "-q"}).code, 0);
  ASSERT_EQ(penumbra({"factors", room, "-o", shop.path("b.npz"), "-q", "--max-memory", "1e5"}).code, 0);
  EXPECT_FALSE(read(shop.path("a.npz")).empty());
  EXPECT_TRUE(read(shop.path("a.npz")) == read(shop.path("b.npz")));
}

TEST(FactorsCommand, NormalisingSaysWhatItChanged) {
  const Workshop shop;
  const Outcome run = penumbra({"factors", data + "box345_AB1.0.vs3", "-o", shop.path("f.mtx"), "--method", "ray-cast",
                                "--rays", "256", "--normalize", "least-squares", "--json", "-q"});
  ASSERT_EQ(run.code, 0) << run.err;
  EXPECT_GT(run.report()["normalization"]["largest_change"].get<double>(), 0);
  EXPECT_NEAR(run.report()["row_sum"]["min"].get<double>(), 1, 1e-9);
  EXPECT_LT(run.report()["reciprocity_error_max"].get<double>(), 1e-12);
}

TEST(FactorsCommand, VtuShowsARowByName) {
  const Workshop shop;
  ASSERT_EQ(penumbra({"factors", data + "l_room.vs3", "-o", shop.path("f.vtu"), "--row", "srf-3", "-q"}).code, 0);
  EXPECT_NE(read(shop.path("f.vtu")).find("factor from srf-3"), std::string::npos);
  EXPECT_EQ(penumbra({"factors", data + "l_room.vs3", "-o", shop.path("f.vtu"), "--row", "none", "-q"}).code, 2);
}

TEST(FactorsCommand, BadMeshesEndWithTheirLine) {
  const Workshop shop;
  const std::string head = "F 3\nV 1 0 0 0\nV 2 1 0 0\nV 3 1 1 0\nV 4 0 1 0\n";
  const std::vector<std::pair<std::string, std::string>> cases{
      {"S 1 1 3 2 4 0 0 0.9 bow\nE\n", "line 6"},
      {"S 1 1 2 2 1 0 0 0.9 flat\nE\n", "line 6"},
      {"S 1 1 2 3 4 0 0 0.9 a\nS 2 2 3 4 1 0 0 0.9 twice\nE\n", "line 7"},
      {"S 1 1 2 3 4 0 0 0.9 a\nWINDOW 2\nE\n", "line 7"},
      {"S 1 1 2 3 4 0 0 0.9 a\nS 2 1 2", "line 7"},
      {"S 1 1 2 3 4 0 0 0.9 a\n", "line 7"}};
  for (const auto& [lines, place] : cases) {
    const std::string mesh = shop.file("bad.vs3", head + lines);
    const Outcome run = penumbra({"factors", mesh, "-o", shop.path("f.npz")});
    EXPECT_EQ(run.code, 2) << lines;
    EXPECT_NE(run.err.find(place), std::string::npos) << run.err;
  }
  const std::string obj = shop.file("bad.obj", "v 0 0 0\nv 1 0 0\nv 1 1 0\nf 1 2 3\nf 1 2 2\n");
  const Outcome run = penumbra({"factors", obj, "-o", shop.path("f.npz")});
  EXPECT_EQ(run.code, 2);
  EXPECT_NE(run.err.find("line 5"), std::string::npos) << run.err;
  EXPECT_EQ(shop.contents(), (std::vector<std::string>{"bad.obj", "bad.vs3"}));
}

TEST(FactorsCommand, TwoSidedPlatesAndBentPolygonsAreFine) {
  const Workshop shop;
  const std::string mesh = shop.file("m.vs3",
                                     "F 3\nV 1 0 0 0\nV 2 1 0 0\nV 3 1 1 0.3\nV 4 0 1 0\nV 5 0 0 2\nV 6 1 0 2\nV 7 1 1 "
                                     "2\nS 1 1 2 3 4 0 0 1 bent\nS 2 5 6 7 0 "
                                     "0 0 1 up\nS 3 7 6 5 0 0 0 1 down\nE\n");
  const Outcome run = penumbra({"factors", mesh, "-o", shop.path("f.csv")});
  EXPECT_EQ(run.code, 0) << run.err;
  const std::size_t first = run.err.find("not planar");
  EXPECT_NE(first, std::string::npos) << run.err;
  EXPECT_EQ(run.err.find("not planar", first + 1), std::string::npos);
}

TEST(FactorsCommand, OptionsThatDoNotApplyAreRefused) {
  const Workshop shop;
  const std::string mesh = shop.file("m.obj", squares), out = shop.path("f.npz");
  const std::vector<std::vector<std::string>> refused{
      {"factors", mesh, "-o", out, "--rays", "64"},
      {"factors", mesh, "-o", out, "--resolution", "64"},
      {"factors", mesh, "-o", out, "--method", "hemicube", "--tolerance", "1e-3"},
      {"factors", mesh, "-o", out, "--method", "hemicube", "--resolution", "63"},
      {"factors", mesh, "-o", out, "--method", "magic"},
      {"factors", mesh, "-o", out, "--tolerance", "0"},
      {"factors", mesh, "-o", out, "--row", "floor"},
      {"factors", mesh, "-o", shop.path("f.txt")},
      {"factors", mesh},
      {"factors", "-o", out},
      {"factors", "--from", mesh},
      {"factors", "--from", mesh, "--to", mesh, "-o", out},
      {"factors", mesh, "-o", out, "--blockers", mesh},
      {"factors", mesh, "-o", shop.path("none/f.npz")}};
  for (const auto& arguments : refused) {
    const Outcome run = penumbra(arguments);
    EXPECT_EQ(run.code, 2) << arguments.back();
    EXPECT_EQ(run.err.rfind("penumbra: ", 0), 0U) << run.err;
  }
  EXPECT_EQ(shop.contents(), std::vector<std::string>{"m.obj"});
}

TEST(FactorsCommand, InterruptedItWritesAWholePartialMatrix) {
  const Workshop shop;
  Running run({"factors", data + "box345_AB1.0.vs3", "-o", shop.path("f.npz"), "--method", "ray-cast", "--rays",
               "1048576", "--progress", "json"});
  ASSERT_TRUE(run.says("form factors"));
  run.signal(SIGINT);
  const Outcome outcome = run.end();
  EXPECT_EQ(outcome.code, 130) << outcome.err;
  EXPECT_NE(outcome.err.find("partial"), std::string::npos);
  EXPECT_EQ(shop.contents(), std::vector<std::string>{"f.npz"});
}

}  // namespace
}  // namespace penumbra::test
