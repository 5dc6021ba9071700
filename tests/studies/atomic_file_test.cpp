#include "studies/io/atomic_file.hpp"

#include <gtest/gtest.h>
#include <signal.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <chrono>
#include <fstream>
#include <stdexcept>
#include <system_error>

#include "tests/studies/temporary_folder.hpp"

namespace stickslip {
namespace {

namespace fs = std::filesystem;

class AtomicFile : public InOwnFolder {
 protected:
  std::size_t files() const {
    return static_cast<std::size_t>(std::distance(fs::directory_iterator(folder_), fs::directory_iterator()));
  }
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

TEST_F(AtomicFile, ALineThatTheDiskRefusesLeavesNothing) {
  const fs::path path = folder_ / "results.jsonl";
  append_line(path, "first");
  const pid_t child = ::fork();
  if (child == 0) {
    ::signal(SIGXFSZ, SIG_IGN);
    const rlimit small{8, 8};
    if (::setrlimit(RLIMIT_FSIZE, &small) != 0) ::_exit(1);
    try {
      append_line(path, "second");
    } catch (const std::system_error& error) {
      ::_exit(error.code() == std::errc::file_too_large ? 0 : 2);
    }
    ::_exit(3);
  }
  int status = -1;
  ASSERT_EQ(::waitpid(child, &status, 0), child);
  EXPECT_EQ(status, 0);
  EXPECT_EQ(read_file(path), "first\n");
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
