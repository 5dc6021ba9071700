#include "studies/io/atomic_file.hpp"

#include <gtest/gtest.h>
#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

#include <chrono>
#include <fstream>
#include <stdexcept>
#include <system_error>

#include "studies/io/input_fault.hpp"

namespace stickslip {
namespace {

namespace fs = std::filesystem;

class AtomicFile : public testing::Test {
 protected:
  void SetUp() override {
    std::string pattern = (fs::temp_directory_path() / "stickslip_XXXXXX").string();
    ASSERT_NE(::mkdtemp(pattern.data()), nullptr);
    folder_ = pattern;
  }
  void TearDown() override { fs::remove_all(folder_); }

  std::size_t files() const {
    return static_cast<std::size_t>(std::distance(fs::directory_iterator(folder_), fs::directory_iterator()));
  }

  fs::path folder_;
};

TEST_F(AtomicFile, ReplacesTheOldContentAndLeavesNothingBeside) {
  const fs::path path = folder_ / "result.json";
  write_file_atomically(path, "a long first content\n");
  write_file_atomically(path, "second");
  EXPECT_EQ(read_file(path), "second");
  EXPECT_EQ(files(), 1u);
}

TEST_F(AtomicFile, KeepsEveryByte) {
  const std::string content("\0\n\r\xff end", 8);
  write_file_atomically(folder_ / "bytes", content);
  EXPECT_EQ(read_file(folder_ / "bytes"), content);
}

TEST_F(AtomicFile, MakesMissingFolders) {
  write_file_atomically(folder_ / "a" / "b" / "file", "x");
  append_line(folder_ / "c" / "d" / "lines", "y");
  EXPECT_EQ(read_file(folder_ / "a" / "b" / "file"), "x");
  EXPECT_EQ(read_file(folder_ / "c" / "d" / "lines"), "y\n");
}

TEST_F(AtomicFile, LeavesTheTargetAndNoTemporaryFileWhereItCannotBeReplaced) {
  const fs::path target = folder_ / "folder";
  fs::create_directories(target / "occupied");
  EXPECT_THROW(write_file_atomically(target, "x"), std::system_error);
  EXPECT_TRUE(fs::is_directory(target / "occupied"));
  EXPECT_EQ(files(), 1u);
}

TEST_F(AtomicFile, NamesThePathThatCannotBeOpened) {
  write_file_atomically(folder_ / "file", "");
  try {
    append_line(folder_ / "file" / "below", "x");
    FAIL() << "a file is no folder";
  } catch (const std::system_error& error) {
    EXPECT_NE(std::string(error.what()).find("file"), std::string::npos) << error.what();
  }
}

TEST_F(AtomicFile, AReaderNeverSeesHalfOfAFile) {
  const fs::path path = folder_ / "swapped";
  const std::string a(1 << 16, 'a'), b(1 << 18, 'b');
  write_file_atomically(path, a);
  const pid_t writer = ::fork();
  ASSERT_GE(writer, 0);
  if (writer == 0) {
    for (;;) {
      write_file_atomically(path, b);
      write_file_atomically(path, a);
    }
  }
  std::size_t torn = 0, seen_b = 0;
  // Twenty swaps take milliseconds; the limit is for a disk that is slow to synchronise.
  const auto limit = std::chrono::steady_clock::now() + std::chrono::seconds(20);
  while (seen_b < 20 && std::chrono::steady_clock::now() < limit) {
    const std::string content = read_file(path);
    if (content == b) ++seen_b;
    if (content != a && content != b) ++torn;
  }
  ::kill(writer, SIGKILL);
  ::waitpid(writer, nullptr, 0);
  EXPECT_EQ(torn, 0u);
  EXPECT_GT(seen_b, 0u);
  const std::string last = read_file(path);
  EXPECT_TRUE(last == a || last == b) << "a killed writer left " << last.size() << " bytes";
}

TEST_F(AtomicFile, AppendedLinesComeBackInOrder) {
  const fs::path path = folder_ / "results.jsonl";
  append_line(path, R"({"id":"1"})");
  append_line(path, "");
  append_line(path, R"({"id":"3"})");
  EXPECT_EQ(read_lines(path), (std::vector<std::string>{R"({"id":"1"})", "", R"({"id":"3"})"}));
}

TEST_F(AtomicFile, ADirectoryIsMadeReadyOrRefused) {
  const fs::path directory = folder_ / "new" / "results", file = folder_ / "file";
  prepare_directory(directory, {"a.json"}, {"figures"});
  EXPECT_TRUE(fs::is_directory(directory / "figures"));
  std::ofstream(file) << "text";
  fs::create_directories(directory / "b.json");
  std::ofstream(directory / "plots") << "text";
  const auto refused = [](const fs::path& at, const std::string& file_in, const std::string& folder_in) {
    try {
      prepare_directory(at, {file_in}, {folder_in});
    } catch (const InputFault& fault) {
      return std::string(fault.what());
    }
    return std::string();
  };
  EXPECT_EQ(refused(file, "a", "b"), file.string() + ": is a file; must be a directory, or a name that is free");
  EXPECT_EQ(refused(file / "in", "a", "b"), (file / "in").string() + ": cannot be made: Not a directory");
  EXPECT_EQ(refused(folder_ / std::string(300, 'x'), "a", "b").substr((folder_ / "").string().size() + 300),
            ": cannot be made: File name too long");
  EXPECT_EQ(refused(directory, "b.json", "figures"),
            (directory / "b.json").string() + ": is a directory; the file of this name goes there");
  EXPECT_EQ(refused(directory, "a.json", "plots"),
            (directory / "plots").string() + ": is a file; must be a directory, or a name that is free");
}

TEST_F(AtomicFile, WhatAKilledProcessLeftIsRemovedBeforeTheNextOneWrites) {
  const pid_t gone = ::fork();
  if (gone == 0) ::_exit(0);
  ::waitpid(gone, nullptr, 0);
  const fs::path stale = folder_ / ("a.vtu." + std::to_string(gone) + ".part"),
                 own = folder_ / ("a.vtu." + std::to_string(::getpid()) + ".part"), foreign = folder_ / "a.part";
  for (const auto& path : {stale, own, foreign}) std::ofstream(path) << "half";
  prepare_directory(folder_, {});
  EXPECT_FALSE(fs::exists(stale));
  EXPECT_TRUE(fs::exists(own));
  EXPECT_TRUE(fs::exists(foreign));
}

TEST_F(AtomicFile, ALineOfAFileThatIsNotThereIsNone) { EXPECT_TRUE(read_lines(folder_ / "absent").empty()); }

TEST_F(AtomicFile, ATornLastLineIsNotReadAndIsCutOffByTheNextAppend) {
  const fs::path path = folder_ / "results.jsonl";
  // Longer than one block of the search for the last newline.
  const std::string torn(10000, 'x');
  append_line(path, "whole");
  std::ofstream(path, std::ios::app) << torn;
  EXPECT_EQ(read_lines(path), std::vector<std::string>{"whole"});
  append_line(path, "next");
  EXPECT_EQ(read_file(path), "whole\nnext\n");
}

TEST_F(AtomicFile, AFileThatIsOneTornLineStartsAnew) {
  const fs::path path = folder_ / "results.jsonl";
  std::ofstream(path) << "torn";
  append_line(path, "first");
  EXPECT_EQ(read_file(path), "first\n");
}

TEST_F(AtomicFile, ALineWithANewlineIsRefused) {
  EXPECT_THROW(append_line(folder_ / "lines", "a\nb"), std::invalid_argument);
  EXPECT_FALSE(fs::exists(folder_ / "lines"));
}

TEST_F(AtomicFile, ReadingWhatIsNotAFileFails) {
  EXPECT_THROW(read_file(folder_ / "absent"), std::system_error);
  EXPECT_THROW(read_file(folder_), std::system_error);
}

}  // namespace
}  // namespace stickslip
