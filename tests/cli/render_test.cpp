// `penumbra render` as scripts see it: what it writes, prints and reports.

#include <gtest/gtest.h>
#include <sys/stat.h>

#include <algorithm>
#include <sstream>

#include "cli/program.h"
#include "cli/small_scenes.h"
#include "penumbra/image/image_io.h"
#include "test_paths.h"

namespace penumbra::test {
namespace {

const std::string box = "builtin:cornell-box";

/// Renders to an .exr of the workshop and reads it back; the run must succeed.
Image picture(const Workshop& workshop, std::vector<std::string> arguments, const std::string& name = "picture.exr") {
  arguments.insert(arguments.begin(), "render");
  arguments.insert(arguments.end(), {"-q", "-o", workshop.path(name)});
  const Outcome run = penumbra(arguments);
  EXPECT_EQ(run.code, 0) << run.err;
  EXPECT_EQ(run.err, "");
  return read_image(workshop.path(name));
}

/// An eye in front of the matt square, so near that the square fills the picture.
std::vector<std::string> close_up(const std::string& scene, std::vector<std::string> more = {}) {
  std::vector<std::string> arguments{scene, "--size", "4x4", "--eye", "0,0,1", "--look-at", "0,0,0", "--fov", "40"};
  arguments.insert(arguments.end(), more.begin(), more.end());
  return arguments;
}

TEST(RenderTest, QuietSaysNothingAndWritesThePicture) {
  const Workshop workshop;
  const Image image = picture(workshop, {box, "--size", "12x8", "--spp", "1"});
  EXPECT_EQ(image.width, 12);
  EXPECT_EQ(image.height, 8);
  EXPECT_EQ(workshop.contents(), std::vector<std::string>{"picture.exr"});
}

TEST(RenderTest, StandardOutputIsLeftToTheReport) {
  const Workshop workshop;
  const Outcome run = penumbra({"render", box, "--size", "8x8", "-o", workshop.path("a.png")});
  EXPECT_EQ(run.code, 0) << run.err;
  EXPECT_EQ(run.out, "");
  EXPECT_NE(run.err.find("a.png: 8x8"), std::string::npos) << run.err;
}

TEST(RenderTest, ReportHasTheContractsKeysAndItsSumsAgree) {
  const Workshop workshop;
  const Outcome run = penumbra({"render", box, "--size", "16x8", "--spp", "3", "--integrator", "path", "--threads", "2",
                                "--json", "-q", "--stats", workshop.path("stats.json"), "-o", workshop.path("a.exr")});
  ASSERT_EQ(run.code, 0) << run.err;
  const auto report = run.report();
  EXPECT_EQ(report, nlohmann::json::parse(read_text(workshop.path("stats.json"))));
  for (const char* stage : {"load", "build", "render", "write"})
    EXPECT_GE(report.at("seconds").at(stage).get<double>(), 0);
  const auto& rays = report.at("rays");
  EXPECT_EQ(rays.at("primary"), 16 * 8 * 3);
  std::uint64_t sum = 0;
  for (const char* kind : {"primary", "shadow", "reflection", "refraction", "diffuse"})
    sum += rays.at(kind).get<std::uint64_t>();
  EXPECT_EQ(rays.at("total"), sum);
  std::uint64_t by_depth = 0;
  for (const auto& count : report.at("rays_by_depth")) by_depth += count.get<std::uint64_t>();
  EXPECT_EQ(by_depth, sum);
  EXPECT_GT(report.at("rays_per_second").get<double>(), 0);
  EXPECT_GT(report.at("triangles").get<int>(), 0);
  EXPECT_EQ(report.at("threads"), 2);
  EXPECT_GT(report.at("peak_rss_bytes").get<std::int64_t>(), 1 << 20);
  EXPECT_EQ(report.at("image").at("width"), 16);
  EXPECT_EQ(report.at("image").at("height"), 8);
  EXPECT_EQ(report.at("image").at("spp_mean"), 3);
  EXPECT_EQ(report.at("partial"), false);
}

TEST(RenderTest, PictureCarriesCameraAndSettings) {
  const Workshop workshop;
  const auto metadata = picture(workshop, {box, "--size", "4x4", "--eye", "0.25,0.5,3", "--look-at", "0.25,0.5,0",
                                           "--fov", "30", "--seed", "7"})
                            .metadata;
  EXPECT_EQ(metadata.at("camera.eye"), "0.25 0.5 3");
  EXPECT_EQ(metadata.at("camera.direction"), "0 0 -1");
  EXPECT_NEAR(std::stod(metadata.at("camera.fov_degrees")), 30, 1e-12);
  EXPECT_EQ(metadata.at("integrator"), "whitted");
  EXPECT_EQ(metadata.at("seed"), "7");
  EXPECT_EQ(metadata.at("scene"), box);
  EXPECT_EQ(metadata.at("partial"), "false");
}

TEST(RenderTest, AMattSquareUnderAWhiteSkyShowsItsReflectance) {
  const Workshop workshop;
  const Image image = picture(workshop, close_up(matt_square(workshop), {"--integrator", "path", "--spp", "256"}));
  double mean = 0;
  for (const float value : image.data) mean += static_cast<double>(value) / static_cast<double>(image.data.size());
  EXPECT_NEAR(mean, 0.5, 0.01);  // rho L = 0.5 * 1
}

TEST(RenderTest, ASceneWithoutLightGetsOneWarning) {
  const Workshop workshop;
  const std::string scene = matt_square(workshop);
  const Outcome run = penumbra({"render", scene, "--size", "4x4", "-o", workshop.path("a.png")});
  EXPECT_EQ(run.code, 0);
  EXPECT_NE(run.err.find("warning: " + scene + ": has no light"), std::string::npos) << run.err;
  const Outcome lit =
      penumbra({"render", scene, "--size", "4x4", "-o", workshop.path("a.png"), "--environment", "1,1,1"});
  EXPECT_EQ(lit.err.find("warning"), std::string::npos) << lit.err;
}

TEST(RenderTest, RadianceIsLinearInTheEnvironment) {
  const Workshop workshop;
  const std::string scene = matt_square(workshop);
  const Image one =
      picture(workshop, close_up(scene, {"--integrator", "path", "--spp", "4", "--environment", "1,1,1"}));
  const Image other =
      picture(workshop, close_up(scene, {"--integrator", "path", "--spp", "4", "--environment", "2,0.5,0"}));
  for (int y = 0; y < 4; ++y) {
    for (int x = 0; x < 4; ++x) {
      EXPECT_NEAR(other.rgb(x, y).x, 2 * one.rgb(x, y).x, 1e-5);
      EXPECT_NEAR(other.rgb(x, y).y, 0.5 * one.rgb(x, y).y, 1e-5);
      EXPECT_EQ(other.rgb(x, y).z, 0);
    }
  }
}

TEST(RenderTest, AnEnvironmentPictureOfOneColourIsThatColour) {
  const Workshop workshop;
  const std::string scene = matt_square(workshop);
  Image sky(8, 4);
  for (int y = 0; y < 4; ++y) {
    for (int x = 0; x < 8; ++x) sky.set_rgb(x, y, {2.0F, 1.0F, 0.5F});
  }
  write_image(workshop.path("sky.exr"), sky);
  const auto mean = [](const Image& image, std::size_t channel) {
    double sum = 0;
    for (std::size_t i = channel; i < image.data.size(); i += 3) sum += static_cast<double>(image.data[i]) / 16;
    return sum;
  };
  const Image seen = picture(
      workshop, close_up(scene, {"--integrator", "path", "--spp", "256", "--environment", workshop.path("sky.exr")}));
  EXPECT_NEAR(mean(seen, 0), 1.0, 0.03);  // rho L in each band
  EXPECT_NEAR(mean(seen, 1), 0.5, 0.015);
  EXPECT_NEAR(mean(seen, 2), 0.25, 0.0075);
}

TEST(RenderTest, EmissionIsRadianceUnlessPhotometric) {
  const Workshop workshop;
  const std::string scene = matt_square(workshop, 683);
  const auto arguments = [&](std::vector<std::string> more) { return close_up(scene, std::move(more)); };
  EXPECT_NEAR(picture(workshop, arguments({"--integrator", "path"})).rgb(2, 2).x, 683, 1e-3);
  EXPECT_NEAR(picture(workshop, arguments({"--integrator", "path", "--photometric"})).rgb(2, 2).x, 1, 1e-6);
}

TEST(RenderTest, UnitScalesAnObj) {
  const Workshop workshop;
  const Image metres = picture(workshop, close_up(matt_square(workshop, 1, 0.1), {"--spp", "1"}));
  const Image centimetres = picture(workshop, close_up(matt_square(workshop, 1, 10), {"--spp", "1", "--unit", "cm"}));
  ASSERT_EQ(metres.data.size(), centimetres.data.size());
  for (std::size_t i = 0; i < metres.data.size(); ++i) EXPECT_NEAR(metres.data[i], centimetres.data[i], 1e-6);
}

TEST(RenderTest, AStopOfExposureDoublesEveryValue) {
  const Workshop workshop;
  const Image plain = picture(workshop, {box, "--size", "8x8"});
  const Image brighter = picture(workshop, {box, "--size", "8x8", "--exposure", "1"});
  for (std::size_t i = 0; i < plain.data.size(); ++i) EXPECT_EQ(brighter.data[i], 2 * plain.data[i]);
}

TEST(RenderTest, ARegionHoldsTheSamePixelsAsTheWholePicture) {
  const Workshop workshop;
  const Image whole = picture(workshop, {box, "--size", "32x32", "--spp", "2"});
  const Image part = picture(workshop, {box, "--size", "32x32", "--spp", "2", "--region", "8,4,24,20"});
  ASSERT_EQ(part.width, 32);
  for (int y = 4; y < 20; ++y) {
    for (int x = 8; x < 24; ++x) EXPECT_EQ(part.rgb(x, y), whole.rgb(x, y));
  }
  EXPECT_EQ(part.rgb(2, 2), Rgb(0.0F));
}

TEST(RenderTest, CamerasAnswerToNameAndIndex) {
  const Workshop workshop;
  const std::string scene = two_cameras(workshop);
  const Image by_default = picture(workshop, {scene, "--size", "16x16"});
  const Image first = picture(workshop, {scene, "--size", "16x16", "--camera", "0"});
  const Image side = picture(workshop, {scene, "--size", "16x16", "--camera", "side"});
  const Image second = picture(workshop, {scene, "--size", "16x16", "--camera", "1"});
  EXPECT_EQ(by_default.data, first.data);
  EXPECT_EQ(side.data, second.data);
  EXPECT_EQ(side.metadata.at("camera.name"), "side");
}

TEST(RenderTest, LayersAreNamedInTheExr) {
  const Workshop workshop;
  const Image image = picture(workshop, {box, "--size", "8x8", "--aov", "normal,depth"});
  const auto has = [&](const std::string& prefix) {
    return std::any_of(image.channels.begin(), image.channels.end(),
                       [&](const auto& c) { return c.rfind(prefix, 0) == 0; });
  };
  EXPECT_TRUE(has("normal."));
  EXPECT_TRUE(has("depth"));
  EXPECT_FALSE(has("albedo"));
}

TEST(RenderTest, ThreadedPicturesAreTheSameBits) {
  const Workshop workshop;
  for (const std::string integrator : {"appel", "whitted", "path"}) {
    const std::vector<std::string> arguments{box,     "--integrator", integrator, "--size",
                                             "40x30", "--spp",        "4",        "--threads"};
    const auto on = [&](const std::string& threads) {
      std::vector<std::string> all = arguments;
      all.push_back(threads);
      return picture(workshop, all).data;
    };
    const auto one = on("1");
    EXPECT_EQ(one, on("2")) << integrator;
    EXPECT_EQ(one, on("8")) << integrator;
  }
}

TEST(RenderTest, TheSeedChoosesTheNoise) {
  const Workshop workshop;
  const std::vector<std::string> arguments{box, "--integrator", "path", "--size", "8x8", "--spp", "4", "--seed"};
  const auto with = [&](const std::string& seed) {
    std::vector<std::string> all = arguments;
    all.push_back(seed);
    return picture(workshop, all).data;
  };
  const auto first = with("1");
  EXPECT_EQ(first, with("1"));
  EXPECT_NE(first, with("2"));
}

TEST(RenderTest, ATimeLimitEndsALongRenderWithWhatItHas) {
  const Workshop workshop;
  const Outcome run = penumbra({"render", box, "--integrator", "path", "--size", "64x64", "--spp", "10000000",
                                "--time-limit", "0.3", "--json", "-o", workshop.path("a.exr")});
  EXPECT_EQ(run.code, 0) << run.err;
  EXPECT_EQ(run.report().at("partial"), true);
  EXPECT_LT(run.report().at("seconds").at("render").get<double>(), 5);
  EXPECT_EQ(read_image(workshop.path("a.exr")).metadata.at("partial"), "true");
  EXPECT_NE(run.err.find("partial"), std::string::npos);
}

TEST(RenderTest, ProgressAsJsonIsAnObjectALine) {
  const Workshop workshop;
  const Outcome run =
      penumbra({"render", box, "--size", "32x32", "--progress", "json", "-q", "-o", workshop.path("a.png")});
  ASSERT_EQ(run.code, 0) << run.err;
  std::istringstream lines(run.err);
  int count = 0;
  for (std::string line; std::getline(lines, line); ++count) {
    const auto object = nlohmann::json::parse(line);
    EXPECT_TRUE(object.at("stage").is_string());
    EXPECT_GE(object.at("fraction").get<double>(), 0);
    EXPECT_LE(object.at("fraction").get<double>(), 1);
  }
  EXPECT_GE(count, 1);
}

TEST(RenderTest, AReportToAPipeLeavesThePipe) {
  const Workshop workshop;
  const std::string pipe = workshop.path("pipe");
  ASSERT_EQ(::mkfifo(pipe.c_str(), 0600), 0);
  const Outcome run =
      command({"/bin/sh", "-c", "cat \"$2\" & \"$0\" render \"$1\" --size 4x4 -q --stats \"$2\" -o \"$3\"; wait",
               PENUMBRA_PROGRAM, box, pipe, workshop.path("a.png")});
  EXPECT_EQ(run.code, 0) << run.err;
  EXPECT_TRUE(std::filesystem::is_fifo(pipe));
  EXPECT_EQ(run.report().at("command"), "render");
}

}  // namespace
}  // namespace penumbra::test
