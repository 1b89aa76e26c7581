#include "penumbra/file/output_file.h"

#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <string>

#include "penumbra/file/file_error.h"
#include "penumbra/file/input_file.h"

namespace penumbra {
namespace {

class FolderTest : public testing::Test {
 protected:
  FolderTest()
      : folder_(std::filesystem::path(testing::TempDir()) /
                ("penumbra-file-" + std::to_string(::getpid()) + "-" +
                 testing::UnitTest::GetInstance()->current_test_info()->name())) {
    std::filesystem::create_directories(folder_);
  }
  ~FolderTest() override { std::filesystem::remove_all(folder_); }

  [[nodiscard]] std::string text_of(const char* name) const {
    const auto bytes = read_file(folder_ / name);
    return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
  }

  template <class Action>
  static std::string sentence_of(Action action) {
    try {
      action();
    } catch (const FileError& error) {
      return error.what();
    }
    return "no FileError";
  }

  std::filesystem::path folder_;
};

using OutputFileTest = FolderTest;
using InputFileTest = FolderTest;

TEST_F(OutputFileTest, NothingStandsUnderTheFinalNameUntilCommit) {
  OutputFile file(folder_ / "a.txt");
  file.write("half ");
  EXPECT_FALSE(std::filesystem::exists(folder_ / "a.txt"));
  EXPECT_TRUE(std::filesystem::exists(file.partial_path()));
  EXPECT_EQ(file.partial_path().parent_path(), folder_);
  file.write("whole");
  file.commit();
  EXPECT_EQ(text_of("a.txt"), "half whole");
  EXPECT_FALSE(std::filesystem::exists(file.partial_path()));
}

TEST_F(OutputFileTest, DestroyedUncommittedItLeavesNothing) {
  {
    OutputFile file(folder_ / "a.txt");
    file.write("half");
  }
  EXPECT_TRUE(std::filesystem::is_empty(folder_));
}

TEST_F(OutputFileTest, AnUncommittedWriterKeepsTheOldFile) {
  std::ofstream(folder_ / "a.txt") << "old";
  {
    OutputFile file(folder_ / "a.txt");
    file.write("new");
  }
  EXPECT_EQ(text_of("a.txt"), "old");
  OutputFile file(folder_ / "a.txt");
  file.write("new");
  file.commit();
  EXPECT_EQ(text_of("a.txt"), "new");
}

TEST_F(OutputFileTest, AMissingFolderIsNamedWithItsRemedy) {
  const auto path = folder_ / "none" / "a.txt";
  EXPECT_EQ(
      sentence_of([&] { const OutputFile file(path); }),
      path.string() + ": cannot be created: there is no folder " + (folder_ / "none").string() + "; make it first");
}

TEST_F(OutputFileTest, AFolderIsNoFile) {
  EXPECT_EQ(sentence_of([&] { const OutputFile file(folder_); }),
            folder_.string() + ": is a directory; name a file to write");
}

TEST_F(InputFileTest, ReadsTheWholeFile) {
  std::string text;
  for (int i = 0; i < 400000; ++i) text += std::to_string(i);  // more than one block
  std::ofstream(folder_ / "a.txt", std::ios::binary) << text;
  EXPECT_EQ(text_of("a.txt"), text);
  std::ofstream(folder_ / "empty.txt");
  EXPECT_TRUE(read_file(folder_ / "empty.txt").empty());
}

TEST_F(InputFileTest, RefusalsNameTheFile) {
  EXPECT_EQ(sentence_of([&] { static_cast<void>(read_file(folder_)); }),
            folder_.string() + ": is a directory; name a file in it");
  EXPECT_EQ(sentence_of([&] { static_cast<void>(read_file(folder_ / "none")); }),
            (folder_ / "none").string() + ": no such file; check the path and its spelling");
  std::ofstream(folder_ / "a.txt") << "12345";
  EXPECT_EQ(sentence_of([&] { static_cast<void>(read_file(folder_ / "a.txt", 4)); }),
            (folder_ / "a.txt").string() + ": is larger than 4 bytes, the most that is read");
  EXPECT_EQ(read_file(folder_ / "a.txt", 5).size(), 5U);
}

TEST(FileErrorTest, IsOneSentenceOfFilePlaceAndRemedy) {
  const FileError with_place("a.obj", "line 3", "is wrong; mend it");
  EXPECT_STREQ(with_place.what(), "a.obj: line 3: is wrong; mend it");
  EXPECT_EQ(with_place.path(), "a.obj");
  EXPECT_EQ(with_place.place(), "line 3");
  EXPECT_STREQ(FileError("a.obj", "", "is wrong").what(), "a.obj: is wrong");
}

}  // namespace
}  // namespace penumbra
