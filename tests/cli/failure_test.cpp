// What happens when the machine or the user cuts a run short: the right exit code, and never half a file.

#include <gtest/gtest.h>

#include <csignal>

#include "cli/program.h"
#include "penumbra/image/image_io.h"
#include "test_paths.h"

namespace penumbra::test {
namespace {

const std::string box = "builtin:cornell-box";

std::vector<std::string> endless(const std::string& output) {
  return {"render", box,        "--integrator", "path", "--size",     "128x128",
          "--spp",  "10000000", "-o",           output, "--progress", "json"};
}

/// Interrupts an endless render once it draws.
Outcome interrupted(const std::string& output, int signal) {
  Running running(endless(output));
  EXPECT_TRUE(running.says("\"stage\":\"render\""));
  running.signal(signal);
  return running.end();
}

TEST(InterruptTest, KeepsThePictureSoFarAndSaysSo) {
  const Workshop workshop;
  const Outcome run = interrupted(workshop.path("a.exr"), SIGINT);
  EXPECT_EQ(run.code, 130);
  EXPECT_NE(run.err.find("partial"), std::string::npos) << run.err;
  const Image image = read_image(workshop.path("a.exr"));
  EXPECT_EQ(image.width, 128);
  EXPECT_EQ(image.metadata.at("partial"), "true");
  EXPECT_EQ(workshop.contents(), std::vector<std::string>{"a.exr"});
}

TEST(InterruptTest, APngIsWholeToo) {
  const Workshop workshop;
  EXPECT_EQ(interrupted(workshop.path("a.png"), SIGTERM).code, 130);
  EXPECT_EQ(read_image(workshop.path("a.png")).height, 128);
  EXPECT_NE(read_text(workshop.path("a.png")).find("partial"), std::string::npos);
}

TEST(InterruptTest, StatsSayPartial) {
  const Workshop workshop;
  std::vector<std::string> arguments = endless(workshop.path("a.exr"));
  arguments.insert(arguments.end(), {"--stats", workshop.path("stats.json")});
  Running running(arguments);
  ASSERT_TRUE(running.says("\"stage\":\"render\""));
  running.signal(SIGINT);
  EXPECT_EQ(running.end().code, 130);
  EXPECT_EQ(nlohmann::json::parse(read_text(workshop.path("stats.json"))).at("partial"), true);
}

/// Runs the program with files limited to `blocks` of 512 bytes, as a full disk would.
Outcome on_a_full_disk(int blocks, const std::vector<std::string>& arguments) {
  std::vector<std::string> words{"/bin/sh", "-c", "ulimit -f " + std::to_string(blocks) + "; exec \"$0\" \"$@\"",
                                 PENUMBRA_PROGRAM};
  words.insert(words.end(), arguments.begin(), arguments.end());
  return command(words);
}

TEST(FullDiskTest, EndsWithOneAndLeavesNothing) {
  for (const std::string extension : {".png", ".exr", ".hdr"}) {
    const Workshop workshop;
    const Outcome run =
        on_a_full_disk(2, {"render", box, "--size", "96x96", "-q", "-o", workshop.path("a" + extension)});
    EXPECT_EQ(run.code, 1) << extension << run.err;
    EXPECT_NE(run.err.find("a" + extension), std::string::npos) << run.err;
    EXPECT_TRUE(workshop.contents().empty()) << workshop.contents().front();
  }
}

TEST(FullDiskTest, OtherCommandsEndSoToo) {
  for (const std::string extension : {".npz", ".mtx", ".csv", ".vtu"}) {
    const Workshop workshop;
    const Outcome run = on_a_full_disk(2, {"factors", box, "-q", "-o", workshop.path("a" + extension)});
    EXPECT_EQ(run.code, 1) << extension << run.err;
    EXPECT_NE(run.err.find("a" + extension), std::string::npos) << run.err;
    EXPECT_TRUE(workshop.contents().empty()) << workshop.contents().front();
  }
  for (const std::string extension : {".npz", ".glb", ".ply"}) {
    const Workshop workshop;
    const Outcome run =
        on_a_full_disk(2, {"bake", box, "--subdivide", "none", "-q", "-o", workshop.path("a" + extension)});
    EXPECT_EQ(run.code, 1) << extension << run.err;
    EXPECT_NE(run.err.find("a" + extension), std::string::npos) << run.err;
    EXPECT_TRUE(workshop.contents().empty()) << workshop.contents().front();
  }
}

TEST(FullDiskTest, AnOlderPictureSurvives) {
  const Workshop workshop;
  const std::string path = workshop.file("a.png", "older");
  EXPECT_EQ(on_a_full_disk(2, {"render", box, "--size", "96x96", "-q", "-o", path}).code, 1);
  EXPECT_EQ(read_text(path), "older");
}

TEST(FullDiskTest, ASceneFileIsWholeOrAbsent) {
  const Workshop workshop;
  const Outcome run = on_a_full_disk(2, {"scene", "cornell-box", "-o", workshop.path("a.glb")});
  EXPECT_EQ(run.code, 1) << run.err;
  EXPECT_TRUE(workshop.contents().empty());
}

TEST(FullDiskTest, AFullStandardOutputIsAFailure) {
  const Outcome run = command({"/bin/sh", "-c", "exec \"$0\" scene --list >/dev/full", PENUMBRA_PROGRAM});
  EXPECT_EQ(run.code, 1);
  EXPECT_NE(run.err.find("standard output"), std::string::npos) << run.err;
}

TEST(FullDiskTest, AReaderThatLeftIsAFailureNotACrash) {
  const Outcome run =
      command({"/bin/sh", "-c", "{ sleep 0.2; \"$0\" render --help; echo $? >&2; } | true", PENUMBRA_PROGRAM});
  EXPECT_NE(run.err.find("standard output"), std::string::npos) << run.err;
  EXPECT_EQ(run.err.substr(run.err.size() - 2), "1\n");
}

/// The exit code of a render whose streams a shell redirects so, and the picture that it leaves.
Outcome redirected(const std::string& streams, const Workshop& workshop, const std::string& more = "") {
  return command({"/bin/sh", "-c",
                  "{ sleep 0.2; \"$0\" render " + box + " --size 8x8 --spp 1 --progress json -o \"$1\" " + more + " " +
                      streams + "; echo $? >\"$2\"; } 2>&1 | true; cat \"$2\"",
                  PENUMBRA_PROGRAM, workshop.path("a.png"), workshop.path("code")});
}

TEST(ClosedStreamTest, NobodyWhoListensToWarningsIsNoFailure) {
  for (const char* streams : {"", ">/dev/null", "2>&-", ">&- 2>&-", "<&- >&- 2>&-"}) {
    const Workshop workshop;
    EXPECT_EQ(redirected(streams, workshop).out, "0\n") << streams;
    EXPECT_EQ(read_image(workshop.path("a.png")).width, 8) << streams;
  }
}

TEST(ClosedStreamTest, AReportThatCannotBeWrittenIsAFailure) {
  const Workshop workshop;
  EXPECT_EQ(redirected(">&-", workshop, "--json").out, "1\n");
}

}  // namespace
}  // namespace penumbra::test
