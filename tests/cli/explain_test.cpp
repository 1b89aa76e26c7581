// `penumbra explain`: the rays behind a pixel, for people and for programs.

#include <gtest/gtest.h>

#include <algorithm>

#include "cli/program.h"
#include "cli/small_scenes.h"

namespace penumbra::test {
namespace {

const std::vector<std::string> glass_ball{"explain", "builtin:whitted", "--pixel", "400,330"};

Outcome explain(std::vector<std::string> more) {
  std::vector<std::string> arguments = glass_ball;
  arguments.insert(arguments.end(), more.begin(), more.end());
  return penumbra(arguments);
}

TEST(ExplainTest, TellsTheTreeInALineARay) {
  const Outcome run = explain({});
  ASSERT_EQ(run.code, 0) << run.err;
  EXPECT_EQ(run.err, "");
  EXPECT_EQ(run.out.rfind("pixel 400,330 of builtin:whitted: ", 0), 0U) << run.out;
  for (const char* part : {"\n0 primary: ", "glass ball (front)", "\n  1 reflection: ", "refraction: ", "shadow: ",
                           "to the light 'key light'", "too little energy left", "the environment"}) {
    EXPECT_NE(run.out.find(part), std::string::npos) << part << " not in\n" << run.out;
  }
}

// Every hit sends on or absorbs all that arrives, and the rays' own light adds up to the pixel.
TEST(ExplainTest, TheReportKeepsEnergy) {
  const Outcome run = explain({"--json", "-q"});
  ASSERT_EQ(run.code, 0) << run.err;
  const auto report = run.report();
  const auto& rays = report.at("rays");
  ASSERT_GT(rays.size(), 5U);
  for (std::size_t i = 0; i < rays.size(); ++i) {
    EXPECT_EQ(rays[i].at("parent").is_null(), i == 0);
    if (!rays[i].contains("split")) continue;
    for (std::size_t band = 0; band < 3; ++band) {
      double sum = 0;
      for (const auto& [part, share] : rays[i].at("split").items()) sum += share.at(band).get<double>();
      EXPECT_NEAR(sum, 1, 1e-6);
    }
  }
  for (std::size_t band = 0; band < 3; ++band) {
    EXPECT_NEAR(rays[0].at("radiance").at(band).get<double>(), report.at("radiance").at(band).get<double>(), 1e-4);
  }
}

TEST(ExplainTest, WritesDrawingsWhole) {
  const Workshop workshop;
  for (const auto& [name, begins, ends] : {std::tuple{"tree.svg", "<svg ", "</svg>\n"},
                                           {"tree.dot", "digraph rays {", "}\n"},
                                           {"tree.json", "[", "]\n"},
                                           {"tree.txt", "0 primary", "\n"}}) {
    const Outcome run = explain({"-o", workshop.path(name)});
    ASSERT_EQ(run.code, 0) << run.err;
    EXPECT_EQ(run.out, "");
    const std::string text = read_text(workshop.path(name));
    EXPECT_EQ(text.rfind(begins, 0), 0U) << name;
    EXPECT_TRUE(text.ends_with(ends)) << name;
  }
  EXPECT_EQ(workshop.contents().size(), 4U);
  // One line a ray of the drawing, and one of the list.
  const std::string svg = read_text(workshop.path("tree.svg"));
  EXPECT_NE(svg.find("glass ball (front)"), std::string::npos);
  EXPECT_NE(svg.find("stroke-dasharray"), std::string::npos);
}

// The notes' example: 66 % reflected and 50 % scattered make 116 %.
TEST(EnergyTest, MaterialsThatWouldSendOnMoreThanArrivesAreRefusedOrScaled) {
  const Workshop workshop;
  const std::string mtl = workshop.file("bright.mtl", "newmtl too much\nKd 0.5 0.1 0.1\nKs 0.66 0.66 0.66\nillum 3\n");
  const std::string scene =
      workshop.file("bright.obj", "mtllib bright.mtl\nusemtl too much\nv 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
  const std::string out = workshop.path("a.png");
  const Outcome refused = penumbra({"render", scene, "-q", "--size", "4x4", "-o", out});
  EXPECT_EQ(refused.code, 2);
  for (const char* part : {"too much", "116 %", "--fix-energy"}) {
    EXPECT_NE(refused.err.find(part), std::string::npos) << refused.err;
  }
  const Outcome fixed = penumbra({"render", scene, "--size", "4x4", "-o", out, "--fix-energy"});
  EXPECT_EQ(fixed.code, 0) << fixed.err;
  EXPECT_NE(fixed.err.find("scaled to 100 %"), std::string::npos) << fixed.err;
}

}  // namespace
}  // namespace penumbra::test
