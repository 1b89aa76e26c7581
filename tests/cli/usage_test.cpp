// Bad usage ends with exit code 2 and one sentence that says what to do.

#include <gtest/gtest.h>

#include <algorithm>
#include <sstream>

#include "cli/program.h"
#include "cli/small_scenes.h"

namespace penumbra::test {
namespace {

/// Expects exit code 2, silence on standard output, and one line on standard error that holds every part.
void expect_refused(const Outcome& run, const std::vector<std::string>& parts) {
  EXPECT_EQ(run.code, 2) << run.err;
  EXPECT_EQ(run.out, "");
  EXPECT_EQ(std::count(run.err.begin(), run.err.end(), '\n'), 1) << run.err;
  EXPECT_EQ(run.err.rfind("penumbra: ", 0), 0U) << run.err;
  for (const std::string& part : parts)
    EXPECT_NE(run.err.find(part), std::string::npos) << part << " not in: " << run.err;
}

struct BadUsage {
  const char* name;
  std::vector<std::string> arguments;  ///< OUT stands for a picture in a folder of the test's own
  std::vector<std::string> says;
};

class UsageTest : public testing::TestWithParam<BadUsage> {};

TEST_P(UsageTest, IsRefusedInOneSentenceThatNamesTheRemedy) {
  const Workshop workshop;
  std::vector<std::string> arguments = GetParam().arguments;
  for (std::string& argument : arguments) {
    if (argument.rfind("OUT", 0) == 0) argument = workshop.path("picture" + argument.substr(3));
  }
  expect_refused(penumbra(arguments), GetParam().says);
  EXPECT_TRUE(workshop.contents().empty());
}

const std::string box = "builtin:cornell-box";

const BadUsage bad_usages[] = {
    {"UnknownCommand", {"rendr"}, {"rendr", "did you mean render?"}},
    {"UnknownOption", {"render", box, "-o", "OUT.png", "--sppp", "4"}, {"--sppp", "did you mean --spp?"}},
    {"UnknownOptionBeforeScene", {"render", "--sppp", "4", box, "-o", "OUT.png"}, {"--sppp", "did you mean --spp?"}},
    {"UnknownOptionWithEquals", {"render", box, "-o", "OUT.png", "--sise=4x4"}, {"--sise", "did you mean --size?"}},
    {"FocusWithoutLens", {"render", box, "-o", "OUT.png", "--focus", "2"}, {"--focus", "--f-number N"}},
    {"LensOfAPanorama",
     {"render", box, "-o", "OUT.png", "--projection", "panorama", "--f-number", "2"},
     {"--f-number", "panorama"}},
    {"FovOfAPanorama",
     {"render", box, "-o", "OUT.png", "--projection", "panorama", "--fov", "50"},
     {"--fov", "sees everything"}},
    {"FewBlades",
     {"render", box, "-o", "OUT.png", "--f-number", "2", "--aperture", "blades:2"},
     {"blades:N", "3 to 64", "blades:2"}},
    {"NoiseWithoutSamples",
     {"render", box, "-o", "OUT.png", "--noise", "0.1", "--spp", "8"},
     {"--noise", "--spp to 32"}},
    {"ContrastOfPaths",
     {"render", box, "-o", "OUT.png", "--integrator", "path", "--edge-contrast", "0.1"},
     {"--edge-contrast", "path", "--noise"}},
    {"ContrastAndNoise",
     {"render", box, "-o", "OUT.png", "--edge-contrast", "0.1", "--noise", "0.1", "--spp", "64"},
     {"--edge-contrast and --noise", "leave one away"}},
    {"ContrastTooStrong", {"render", box, "-o", "OUT.png", "--edge-contrast", "1"}, {"--edge-contrast", "below 1"}},
    {"NoiseTooLoud", {"render", box, "-o", "OUT.png", "--noise", "1.5"}, {"--noise", "below 1", "1.5"}},
    {"ExplainNoPixel", {"explain", box}, {"--pixel X,Y"}},
    {"ExplainOutside", {"explain", box, "--pixel", "4,9", "--size", "8x8"}, {"--pixel 4,9", "8x8"}},
    {"ExplainHalfAPixel", {"explain", box, "--pixel", "4.5,2"}, {"--pixel", "4.5,2"}},
    {"ExplainAsPicture", {"explain", box, "--pixel", "4,2", "-o", "OUT.png"}, {".svg", ".json", ".dot"}},
    {"FarOption", {"render", box, "-o", "OUT.png", "--zzzzzzzz"}, {"--zzzzzzzz", "penumbra render --help"}},
    {"LaterOption", {"render", box, "-o", "OUT.png", "--denoise"}, {"unknown option --denoise"}},
    {"ExtraArgument", {"render", box, "second.glb", "-o", "OUT.png"}, {"second.glb", "too many"}},
    {"NoScene", {"render", "-o", "OUT.png"}, {"SCENE"}},
    {"NoOutput", {"render", box}, {"-o"}},
    {"OptionWithoutValue", {"render", box, "-o", "OUT.png", "--spp"}, {"--spp", "value"}},
    {"WrongExtension", {"render", box, "-o", "OUT.jpg"}, {".jpg", ".png", ".exr", ".hdr"}},
    {"NoExtension", {"render", box, "-o", "OUT"}, {".png", ".exr", ".hdr"}},
    {"NoFolder", {"render", box, "-o", "OUT/none/a.png"}, {"picture/none", "make it first"}},
    {"SizeZero", {"render", box, "-o", "OUT.png", "--size", "0x0"}, {"--size", "0x0", "800x600"}},
    {"SizeHuge", {"render", box, "-o", "OUT.png", "--size", "1e9x1e9"}, {"--size", "1e9x1e9", "32768"}},
    {"SizeOverLimit", {"render", box, "-o", "OUT.png", "--size", "32769x1"}, {"--size", "32768"}},
    {"SizeNegative", {"render", box, "-o", "OUT.png", "--size", "-4x4"}, {"--size", "-4x4"}},
    {"SizeOneNumber", {"render", box, "-o", "OUT.png", "--size", "800"}, {"--size", "'800'"}},
    {"SamplesZero", {"render", box, "-o", "OUT.png", "--spp", "0"}, {"--spp", "'0'"}},
    {"SamplesWord", {"render", box, "-o", "OUT.png", "--spp", "many"}, {"--spp", "'many'"}},
    {"SamplesOverflow", {"render", box, "-o", "OUT.png", "--spp", "99999999999999999999"}, {"--spp"}},
    {"ThreadsZero", {"render", box, "-o", "OUT.png", "--threads", "0"}, {"--threads", "from 1"}},
    {"UnknownIntegrator", {"render", box, "-o", "OUT.png", "--integrator", "pth"}, {"pth", "did you mean path?"}},
    {"UnknownLayerShown", {"render", box, "-o", "OUT.png", "--show", "ray"}, {"--show", "did you mean rays?"}},
    {"NoiseTargetOfParticles",
     {"render", box, "-o", "OUT.png", "--integrator", "light", "--noise", "0.1"},
     {"--noise", "light"}},
    {"FilterOfParticles",
     {"render", box, "-o", "OUT.png", "--integrator", "light", "--filter", "tent"},
     {"--filter", "light"}},
    {"LensOfParticles",
     {"render", box, "-o", "OUT.png", "--integrator", "light", "--f-number", "2"},
     {"--f-number", "perspective"}},
    {"UnknownFilter", {"render", box, "-o", "OUT.png", "--filter", "gauss"}, {"--filter", "gaussian"}},
    {"UnknownLayer", {"render", box, "-o", "OUT.exr", "--aov", "normal,dept"}, {"dept", "did you mean depth?"}},
    {"LayersInPng", {"render", box, "-o", "OUT.png", "--aov", "normal"}, {"--aov", ".exr"}},
    {"LayersInHdr", {"render", box, "-o", "OUT.hdr", "--aov", "normal"}, {"--aov", ".exr"}},
    {"CurveForScreenInExr", {"render", box, "-o", "OUT.exr", "--tonemap", "srgb"}, {"--tonemap srgb", ".exr"}},
    {"OpaqueShadowsInPath",
     {"render", box, "-o", "OUT.png", "--integrator", "path", "--opaque-shadows"},
     {"--opaque-shadows", "path"}},
    {"ShadowRaysOfThePathTracer",
     {"render", box, "-o", "OUT.png", "--integrator", "path", "--shadow-samples", "8"},
     {"--shadow-samples", "path"}},
    {"ExactShadowsOfTwoPass",
     {"render", box, "-o", "OUT.png", "--integrator", "two-pass", "--exact-shadows"},
     {"--exact-shadows", "two-pass"}},
    {"ShadowRaysEverywhereWithoutANumber",
     {"render", box, "-o", "OUT.png", "--shadow-samples-everywhere"},
     {"--shadow-samples-everywhere", "--shadow-samples N"}},
    {"DepthInAppel",
     {"render", box, "-o", "OUT.png", "--integrator", "appel", "--max-depth", "3"},
     {"--max-depth", "appel"}},
    {"RegionOutside", {"render", box, "-o", "OUT.png", "--size", "8x8", "--region", "4,4,9,8"}, {"--region", "8x8"}},
    {"RegionEmpty", {"render", box, "-o", "OUT.png", "--size", "8x8", "--region", "4,4,4,8"}, {"--region"}},
    {"RegionOfThree", {"render", box, "-o", "OUT.png", "--region", "1,2,3"}, {"--region", "1,2,3"}},
    {"EyeAlone", {"render", box, "-o", "OUT.png", "--eye", "0,0,4"}, {"--eye", "--look-at"}},
    {"EyeOnTarget", {"render", box, "-o", "OUT.png", "--eye", "0,0,4", "--look-at", "0,0,4"}, {"same point"}},
    {"EyeNotANumber", {"render", box, "-o", "OUT.png", "--eye", "0,nan,4", "--look-at", "0,0,0"}, {"--eye", "nan"}},
    {"EyeAndCamera",
     {"render", box, "-o", "OUT.png", "--eye", "0,0,4", "--look-at", "0,0,0", "--camera", "0"},
     {"--camera", "--eye"}},
    {"UpAlongView",
     {"render", box, "-o", "OUT.png", "--eye", "0,0,4", "--look-at", "0,0,0", "--up", "0,0,1"},
     {"--up"}},
    {"FovOutOfRange", {"render", box, "-o", "OUT.png", "--fov", "180"}, {"--fov", "180"}},
    {"ExposureInfinite", {"render", box, "-o", "OUT.png", "--exposure", "inf"}, {"--exposure", "inf"}},
    {"TimeLimitZero", {"render", box, "-o", "OUT.png", "--time-limit", "0"}, {"--time-limit"}},
    {"UnitOfBuiltin", {"render", box, "-o", "OUT.png", "--unit", "cm"}, {"--unit", "metres"}},
    {"UnknownUnit", {"render", "a.obj", "-o", "OUT.png", "--unit", "ft"}, {"--unit", "mm, cm, m, in"}},
    {"PhotometricBuiltin", {"render", box, "-o", "OUT.png", "--photometric"}, {"--photometric"}},
    {"EnvironmentOfTwo", {"render", box, "-o", "OUT.png", "--environment", "1,2"}, {"--environment", "1,2"}},
    {"EnvironmentNegative", {"render", box, "-o", "OUT.png", "--environment", "1,-2,3"}, {"--environment", "-2"}},
    {"EnvironmentMissing", {"render", box, "-o", "OUT.png", "--environment", "none.hdr"}, {"none.hdr"}},
    {"UnknownBuiltin", {"render", "builtin:cornel-box", "-o", "OUT.png"}, {"cornel-box", "cornell-box"}},
    {"UnknownParameter", {"render", "builtin:atrium?triangels=1000", "-o", "OUT.png"}, {"triangels"}},
    {"MissingScene", {"render", "none.glb", "-o", "OUT.png"}, {"none.glb"}},
    {"UnknownSceneFormat", {"render", "scene.blend", "-o", "OUT.png"}, {"scene.blend", ".glb", ".obj"}},
    {"TimeOfABuiltin", {"render", box, "-o", "OUT.png", "--time", "1"}, {"--time", "only glTF"}},
    {"SceneOfAnObj", {"check", "a.obj", "--scene", "1"}, {"--scene", "only glTF"}},
    {"ShutterOfAnObj", {"render", "a.obj", "-o", "OUT.png", "--shutter", "0,1"}, {"--shutter", "only glTF"}},
    {"ShutterReversed", {"render", "a.glb", "-o", "OUT.png", "--shutter", "1,0"}, {"--shutter", "earlier one first"}},
    {"ShutterAndTime",
     {"render", "a.glb", "-o", "OUT.png", "--shutter", "0,1", "--time", "1"},
     {"--time and --shutter", "leave one away"}},
    {"AnimationAtRest", {"render", "a.glb", "-o", "OUT.png", "--animation", "run"}, {"--animation", "--time T"}},
    {"ShutterOfASolution",
     {"render", "a.glb", "-o", "OUT.png", "--integrator", "two-pass", "--shutter", "0,1"},
     {"--shutter", "two-pass", "--time"}},
    {"ShutterOfLight",
     {"render", "a.glb", "-o", "OUT.png", "--integrator", "light", "--shutter", "0,1"},
     {"--shutter", "light", "--time"}},
    {"ShutterOfExactShadows",
     {"render", "a.glb", "-o", "OUT.png", "--exact-shadows", "--shutter", "0,1"},
     {"--shutter", "--exact-shadows"}},
    {"ShutterOfABake", {"bake", "a.glb", "-o", "OUT.glb", "--shutter", "0,1"}, {"unknown option --shutter"}},
    {"CausticsOfWhitted", {"render", box, "-o", "OUT.png", "--no-caustics"}, {"--no-caustics", "whitted", "has none"}},
    {"CausticsOfLight",
     {"render", box, "-o", "OUT.png", "--integrator", "light", "--no-caustics"},
     {"--no-caustics", "particles"}},
    {"CausticsOfASolution",
     {"render", box, "-o", "OUT.png", "--integrator", "two-pass", "--solution", "s.npz", "--no-caustics"},
     {"--no-caustics", "--solution"}},
    {"CompareOne", {"compare", "a.exr"}, {"two pictures"}},
    {"CompareMissing", {"compare", "none-a.exr", "none-b.exr"}, {"none-a.exr"}},
    {"CompareLimit", {"compare", "a.exr", "b.exr", "--max-rmse", "-1"}, {"--max-rmse"}},
    {"SceneUnnamed", {"scene"}, {"--list"}},
    {"SceneUnknown", {"scene", "whited", "-o", "OUT.glb"}, {"whited", "whitted"}},
    {"SceneNoOutput", {"scene", "whitted"}, {"-o"}},
    {"SceneAsObj", {"scene", "whitted", "-o", "OUT.obj"}, {".glb"}},
    {"StatsNoFolder", {"render", box, "-o", "OUT.png", "--stats", "OUT/none/s.json"}, {"none", "make it first"}},
    {"StatsOverPicture", {"render", box, "-o", "OUT.png", "--stats", "OUT.png"}, {"--stats"}},
};

INSTANTIATE_TEST_SUITE_P(Corpus, UsageTest, testing::ValuesIn(bad_usages),
                         [](const auto& test) { return std::string(test.param.name); });

TEST(CameraTest, AnUnknownOneIsAnsweredByTheListOfThoseThereAre) {
  const Workshop workshop;
  const Outcome run =
      penumbra({"render", two_cameras(workshop), "-o", workshop.path("a.png"), "--camera", "top", "-q"});
  expect_refused(run, {"top", "0 'front'", "1 'side'"});
}

TEST(CameraTest, AnIndexBeyondTheLastIsRefused) {
  const Workshop workshop;
  const Outcome run = penumbra({"render", two_cameras(workshop), "-o", workshop.path("a.png"), "--camera", "2", "-q"});
  expect_refused(run, {"--camera 2", "0 'front'"});
}

TEST(HelpTest, WithoutArgumentsShowsTheCommands) {
  const Outcome run = penumbra(std::vector<std::string>{});
  EXPECT_EQ(run.code, 0);
  for (const char* name : {"render", "compare", "scene"}) EXPECT_NE(run.out.find(name), std::string::npos);
  EXPECT_EQ(run.err, "");
}

TEST(HelpTest, VersionIsPrinted) {
  const Outcome run = penumbra({"--version"});
  EXPECT_EQ(run.code, 0);
  EXPECT_EQ(run.out.rfind("penumbra ", 0), 0U);
}

/// What the command's help says after its last headline.
std::vector<std::string> examples_of(const std::string& help) {
  std::vector<std::string> lines;
  std::istringstream text(help.substr(help.find("\nExamples\n") + 10));
  for (std::string line; std::getline(text, line);) lines.push_back(line);
  return lines;
}

TEST(HelpTest, EachCommandEndsWithTwoExamples) {
  for (const std::string name : {"render", "compare", "scene"}) {
    const Outcome run = penumbra({name, "--help"});
    EXPECT_EQ(run.code, 0);
    const auto examples = examples_of(run.out);
    EXPECT_EQ(examples.size(), 2U) << run.out;
    for (const std::string& line : examples) EXPECT_EQ(line.rfind("  penumbra " + name, 0), 0U) << line;
  }
}

TEST(HelpTest, RenderDocumentsEveryOptionOfTheContract) {
  const std::string help = penumbra({"render", "--help"}).out;
  for (const char* option : {"--output",
                             "--integrator",
                             "--size",
                             "--camera",
                             "--eye",
                             "--look-at",
                             "--fov",
                             "--spp",
                             "--filter",
                             "--max-depth",
                             "--min-throughput",
                             "--region",
                             "--exposure",
                             "--tonemap",
                             "--time-limit",
                             "--aov",
                             "--opaque-shadows",
                             "--threads",
                             "--seed",
                             "--quiet",
                             "--stats",
                             "--json",
                             "--progress",
                             "--unit",
                             "--up",
                             "--environment",
                             "--sides",
                             "--photometric"}) {
    EXPECT_NE(help.find(option), std::string::npos) << option;
  }
}

}  // namespace
}  // namespace penumbra::test
