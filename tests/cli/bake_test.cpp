#include <gtest/gtest.h>

#include <csignal>
#include <sstream>

#include "cli/program.h"
#include "cli/small_scenes.h"

namespace penumbra::test {
namespace {

/// A .csv as columns by name.
struct Table {
  std::vector<std::string> names;
  std::vector<std::vector<std::string>> rows;

  explicit Table(const std::string& text) {
    std::istringstream lines(text);
    for (std::string line; std::getline(lines, line);) {
      if (line.starts_with("#")) continue;
      std::vector<std::string> words;
      std::istringstream cells(line);
      for (std::string word; std::getline(cells, word, ',');) words.push_back(word);
      names.empty() ? names = words : rows.emplace_back(words);
    }
  }
  [[nodiscard]] std::string at(std::size_t row, const std::string& name) const {
    for (std::size_t k = 0; k < names.size(); ++k) {
      if (names[k] == name) return rows[row][k];
    }
    return "";
  }
  [[nodiscard]] double number(std::size_t row, const std::string& name) const { return std::stod(at(row, name)); }
};

// rho = 0.5, E = pi: radiosity is 2 pi on every inner side.
const std::string furnace = "builtin:furnace?rho=0.5&emission=1";

TEST(BakeCommand, AFurnaceHasItsRadiosityByEverySolver) {
  const Workshop shop;
  for (const char* solver : {"direct", "jacobi", "gauss-seidel", "shooting", "progressive"}) {
    std::vector<std::string> words{"bake",   furnace,      "-o",  shop.path("f.csv"),   "--solver",
                                   solver,   "--elements", "200", "--factor-tolerance", "1e-5",
                                   "--json", "-q"};
    if (std::string(solver) != "direct") words.insert(words.end(), {"--tolerance", "1e-8"});
    if (std::string(solver) == "shooting" || std::string(solver) == "progressive") {
      words.insert(words.end(), {"--stop-at", "1"});
    }
    const Outcome run = penumbra(words);
    ASSERT_EQ(run.code, 0) << run.err;
    const Table table(read_text(shop.path("f.csv")));
    ASSERT_EQ(table.rows.size(), run.report()["elements"].get<std::size_t>());
    std::size_t lit = 0;
    for (std::size_t i = 0; i < table.rows.size(); ++i) {
      if (table.number(i, "irradiance_r") < 1e-6) continue;  // outer sides
      ++lit;
      for (const char* band : {"radiosity_r", "radiosity_g", "radiosity_b"}) {
        ASSERT_NEAR(table.number(i, band), 2 * 3.14159265358979, 1e-3) << solver;
      }
    }
    EXPECT_GE(lit, table.rows.size() / 4);
  }
}

TEST(BakeCommand, ReportHoldsWhatScriptsRead) {
  const Workshop shop;
  const Outcome run =
      penumbra({"bake", "builtin:cornell-box", "-o", shop.path("c.npz"), "--elements", "400", "--json"});
  ASSERT_EQ(run.code, 0) << run.err;
  const auto report = run.report();
  for (const char* key : {"elements", "links", "iterations", "residual", "unshot_fraction", "energy", "error_bound",
                          "seconds", "peak_rss_bytes", "partial"}) {
    EXPECT_TRUE(report.contains(key)) << key;
  }
  for (const char* key : {"load", "mesh", "form_factors", "solve", "gather", "write"}) {
    EXPECT_GE(report["seconds"][key].get<double>(), 0) << key;
  }
  const auto& energy = report["energy"];
  const double emitted = energy["emitted"].get<double>();
  EXPECT_NEAR(emitted, 3.14159265358979 * 0.13 * 0.105 * 33, 1e-4);  // pi L A of the lamp, summed over bands
  EXPECT_NEAR(energy["absorbed"].get<double>() + energy["escaped"].get<double>() + energy["unshot"].get<double>() +
                  energy["absorbed_by_backs"].get<double>(),
              emitted, 1e-6 * emitted);
  EXPECT_EQ(shop.contents(), std::vector<std::string>{"c.npz"});
}

TEST(BakeCommand, CsvHasTheColumnsOfTheContract) {
  const Workshop shop;
  ASSERT_EQ(penumbra({"bake", matt_square(shop, 2), "-o", shop.path("s.csv"), "--subdivide", "none", "-q"}).code, 0);
  const Table table(read_text(shop.path("s.csv")));
  const std::vector<std::string> expected{"cx",
                                          "cy",
                                          "cz",
                                          "nx",
                                          "ny",
                                          "nz",
                                          "area",
                                          "reflectance_r",
                                          "reflectance_g",
                                          "reflectance_b",
                                          "emission_r",
                                          "emission_g",
                                          "emission_b",
                                          "irradiance_r",
                                          "irradiance_g",
                                          "irradiance_b",
                                          "radiosity_r",
                                          "radiosity_g",
                                          "radiosity_b",
                                          "surface",
                                          "object",
                                          "side"};
  EXPECT_EQ(table.names, expected);
  ASSERT_EQ(table.rows.size(), 2U);
  EXPECT_EQ(table.at(0, "side"), "front");
  EXPECT_EQ(table.at(1, "side"), "back");
  EXPECT_NEAR(table.number(0, "emission_r"), 2 * 3.14159265358979, 1e-6);
  EXPECT_EQ(table.number(1, "emission_r"), 0);
  EXPECT_NEAR(table.number(0, "area"), 4, 1e-12);
  EXPECT_EQ(table.number(0, "nz"), 1);
}

TEST(BakeCommand, ASolutionReadBackIsTheSamePicture) {
  const Workshop shop;
  const std::vector<std::string> how{"--elements", "300", "-q"};
  std::vector<std::string> bake{"bake", "builtin:cornell-box", "-o", shop.path("c.npz")},
      fresh{"render", "builtin:cornell-box", "--integrator", "radiosity", "--size", "64x64", "-o", shop.path("a.exr")};
  bake.insert(bake.end(), how.begin(), how.end());
  fresh.insert(fresh.end(), how.begin(), how.end());
  ASSERT_EQ(penumbra(bake).code, 0);
  ASSERT_EQ(penumbra(fresh).code, 0);
  const Outcome read = penumbra({"render", "builtin:cornell-box", "--integrator", "radiosity", "--size", "64x64", "-o",
                                 shop.path("b.exr"), "--solution", shop.path("c.npz"), "-q"});
  ASSERT_EQ(read.code, 0) << read.err;
  EXPECT_EQ(penumbra({"compare", shop.path("a.exr"), shop.path("b.exr"), "--max-rmse", "1e-12"}).code, 0);
}

TEST(BakeCommand, MeshesAndGlbAreWritten) {
  const Workshop shop;
  for (const char* name : {"c.ply", "c.vtu", "c.glb"}) {
    const Outcome run = penumbra({"bake", "builtin:cornell-box", "-o", shop.path(name), "--elements", "200", "-q"});
    EXPECT_EQ(run.code, 0) << run.err;
  }
  EXPECT_EQ(read_text(shop.path("c.ply")).substr(0, 4), "ply\n");
  EXPECT_NE(read_text(shop.path("c.vtu")).find("radiosity red"), std::string::npos);
  EXPECT_EQ(read_text(shop.path("c.glb")).substr(0, 4), "glTF");
  const Outcome view = penumbra({"render", shop.path("c.glb"), "-o", shop.path("g.png"), "--size", "32x32", "--json"});
  EXPECT_EQ(view.code, 0) << view.err;
}

TEST(BakeCommand, DamagedSolutionsAreRefused) {
  const Workshop shop;
  ASSERT_EQ(penumbra({"bake", "builtin:cornell-box", "-o", shop.path("c.npz"), "--elements", "100", "-q"}).code, 0);
  const std::string whole = read_text(shop.path("c.npz"));
  for (const std::size_t size : {std::size_t{0}, std::size_t{100}, whole.size() / 2, whole.size() - 1}) {
    const std::string cut = shop.file("cut.npz", whole.substr(0, size));
    const Outcome run = penumbra({"render", "builtin:cornell-box", "--integrator", "radiosity", "--solution", cut, "-o",
                                  shop.path("p.png"), "--size", "16x16"});
    EXPECT_EQ(run.code, 2) << size;
    EXPECT_NE(run.err.find("cut.npz"), std::string::npos) << run.err;
  }
}

TEST(BakeCommand, OptionsThatDoNotApplyAreRefused) {
  const Workshop shop;
  const std::string out = shop.path("c.npz"), box = "builtin:cornell-box";
  const std::vector<std::vector<std::string>> refused{
      {"bake", box},
      {"bake", "-o", out},
      {"bake", box, "-o", shop.path("c.txt")},
      {"bake", box, "-o", out, "--profile", "vertex"},
      {"bake", box, "-o", out, "--exposure", "1"},
      {"bake", box, "-o", shop.path("c.glb"), "--profile", "lightmap", "--elements", "10"},
      {"bake", box, "-o", shop.path("c.glb"), "--profile", "lightmap", "--exposure", "1"},
      {"bake", box, "-o", shop.path("c.glb"), "--profile", "vertex", "--lightmap-size", "64"},
      {"bake", box, "-o", shop.path("c.glb"), "--lightmap-size", "64", "--texels-per-metre", "64"},
      {"bake", box, "-o", shop.path("c.glb"), "--lightmap-size", "62"},
      {"bake", box, "-o", shop.path("c.glb"), "--lightmap-size", "16"},
      {"bake", box, "-o", shop.path("c.glb"), "--texels-per-metre", "1e7"},
      {"bake", box, "-o", out, "--lightmap-size", "64"},
      {"bake", box, "-o", out, "--solver", "magic"},
      {"bake", box, "-o", out, "--solver", "direct", "--tolerance", "1e-3"},
      {"bake", box, "-o", out, "--solver", "jacobi", "--stop-at", "0.9"},
      {"bake", box, "-o", out, "--rays", "64"},
      {"bake", box, "-o", out, "--form-factors", "hemicube", "--factor-tolerance", "1e-3"},
      {"bake", box, "-o", out, "--subdivide", "none", "--elements", "10"},
      {"bake", box, "-o", out, "--elements", "10", "--element-size", "1"},
      {"bake", box, "-o", out, "--element-size", "0"},
      {"bake", box, "-o", shop.path("none/c.npz")},
      {"render", box, "-o", shop.path("p.png"), "--solver", "direct"},
      {"render", box, "-o", shop.path("p.png"), "--integrator", "radiosity", "--max-depth", "3"}};
  for (const auto& arguments : refused) {
    const Outcome run = penumbra(arguments);
    EXPECT_EQ(run.code, 2) << arguments.back();
    EXPECT_EQ(run.err.rfind("penumbra: ", 0), 0U) << run.err;
  }
  EXPECT_TRUE(shop.contents().empty());
}

TEST(BakeCommand, InterruptedItWritesAWholePartialSolution) {
  const Workshop shop;
  Running run({"bake", "builtin:cornell-box", "-o", shop.path("c.csv"), "--elements", "20000", "--progress", "json"});
  ASSERT_TRUE(run.says("form factors"));
  run.signal(SIGINT);
  const Outcome outcome = run.end();
  EXPECT_EQ(outcome.code, 130) << outcome.err;
  EXPECT_NE(outcome.err.find("partial"), std::string::npos);
  EXPECT_EQ(shop.contents(), std::vector<std::string>{"c.csv"});
  EXPECT_EQ(read_text(shop.path("c.csv")).rfind("# partial", 0), 0U);
}

TEST(BakeCommand, SnapshotsShowEachStage) {
  const Workshop shop;
  const Outcome run =
      penumbra({"bake", "builtin:cornell-box", "-o", shop.path("c.npz"), "--elements", "100", "--solver", "progressive",
                "--max-iterations", "3", "--snapshots", shop.path("s"), "--snapshot-meshes", "-q"});
  ASSERT_EQ(run.code, 0) << run.err;
  for (const char* name : {"s/stage-00001.png", "s/stage-00002.ply", "s/stage-00003.png"}) {
    EXPECT_FALSE(read_text(shop.path(name)).empty()) << name;
  }
  // Each bounce adds light.
  const Outcome apart = penumbra({"compare", shop.path("s/stage-00001.png"), shop.path("s/stage-00002.png"), "--json"});
  EXPECT_LT(apart.report()["mean_a"].get<double>(), apart.report()["mean_b"].get<double>());
  EXPECT_EQ(penumbra({"bake", "builtin:cornell-box", "-o", shop.path("d.npz"), "--snapshot-every", "2"}).code, 2);
}

// A room of 1 m with a lamp outside; its right wall stands `gap` metres away from the others.
std::string room_with_a_lamp_outside(const Workshop& shop, double gap) {
  std::ostringstream obj;
  obj.precision(17);
  (void)shop.file("r.mtl", "newmtl matt\nKd 0.5 0.5 0.5\nnewmtl lamp\nKd 0 0 0\nKe 1 1 1\n");
  obj << "mtllib r.mtl\nusemtl matt\no room\nv 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nv 0 0 1\nv 1 0 1\nv 1 1 1\nv 0 1 1\n"
         "f 1 2 3 4\nf 8 7 6 5\nf 1 5 6 2\nf 4 3 7 8\nf 1 4 8 5\n";
  for (const char* corner : {" 0 0", " 1 0", " 1 1", " 0 1"}) obj << "v " << 1 + gap << corner << "\n";
  obj << (gap == 0 ? "f 2 6 7 3\n" : "f 9 12 11 10\n") << "o lamp\nusemtl lamp\n";
  obj << "v 2 -0.5 -0.5\nv 2 -0.5 1.5\nv 2 1.5 1.5\nv 2 1.5 -0.5\nf 13 14 15 16\n";
  return shop.file("room.obj", obj.str());
}

struct Lit {
  double emitted = 0, inside = 0, outside = 0;  // W
};

Lit bake_room(double gap, const std::string& method) {
  const Workshop shop;
  std::vector<std::string> words{"bake",
                                 room_with_a_lamp_outside(shop, gap),
                                 "-o",
                                 shop.path("r.csv"),
                                 "--elements",
                                 "150",
                                 "--form-factors",
                                 method,
                                 "--json",
                                 "-q"};
  if (method == "ray-cast") words.insert(words.end(), {"--rays", "1024"});
  const Outcome run = penumbra(words);
  EXPECT_EQ(run.code, 0) << run.err;
  const Table table(read_text(shop.path("r.csv")));
  Lit lit{.emitted = run.report()["energy"]["emitted"].get<double>()};
  for (std::size_t i = 0; i < table.rows.size(); ++i) {
    if (table.at(i, "object") != "room") continue;
    // From the middle of the room the inner sides are seen from their front.
    double towards = 0;
    for (const char* axis : {"x", "y", "z"}) {
      towards += table.number(i, std::string("n") + axis) * (0.5 - table.number(i, std::string("c") + axis));
    }
    for (const char* band : {"irradiance_r", "irradiance_g", "irradiance_b"}) {
      (towards > 0 ? lit.inside : lit.outside) += table.number(i, "area") * table.number(i, band);
    }
  }
  EXPECT_GT(lit.outside, 0.01 * lit.emitted);
  return lit;
}

TEST(BakeCommand, LightOutsideStaysOutside) {
  for (const char* method : {"auto", "adaptive", "ray-cast"}) EXPECT_EQ(bake_room(0, method).inside, 0) << method;
}

TEST(BakeCommand, ATinyGapLetsNextToNothingIn) {
  for (const char* method : {"auto", "ray-cast"}) {
    const Lit lit = bake_room(1e-7, method);
    EXPECT_LE(lit.inside, 1e-6 * lit.emitted) << method;
  }
}

}  // namespace
}  // namespace penumbra::test
