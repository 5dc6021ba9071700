#include "studies/result_rows.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <fstream>

#include "studies/atomic_file.hpp"
#include "studies/directory_lock.hpp"
#include "studies/workers.hpp"

namespace stickslip {
namespace {

using nlohmann::json;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

class ResultRows : public testing::Test {
 protected:
  ResultRows() {
    std::filesystem::remove_all(directory_);
    std::filesystem::create_directories(directory_);
  }
  ~ResultRows() override { std::filesystem::remove_all(directory_); }

  void write(const std::string& text) { std::ofstream(directory_ / "results.jsonl", std::ios::binary) << text; }
  std::string content() { return read_file(directory_ / "results.jsonl"); }

  const std::filesystem::path directory_ =
      std::filesystem::path("result_rows_test") / testing::UnitTest::GetInstance()->current_test_info()->name();
  std::vector<std::string> notes_;
};

TEST_F(ResultRows, AreNoneInAnEmptyDirectory) {
  EXPECT_THAT(read_rows(directory_).rows, IsEmpty());
  EXPECT_THAT(resume_rows(directory_, {"a"}, notes_), IsEmpty());
  EXPECT_THAT(notes_, IsEmpty());
}

TEST_F(ResultRows, AreLeftAloneWhereTheyAreSound) {
  write("{\"id\":\"b\"}\n{\"id\":\"a\"}\n");
  const auto rows = resume_rows(directory_, {"a", "b"}, notes_);
  EXPECT_EQ(rows.size(), 2u);
  EXPECT_THAT(notes_, IsEmpty());
  EXPECT_EQ(content(), "{\"id\":\"b\"}\n{\"id\":\"a\"}\n");
}

TEST_F(ResultRows, LoseATornLastLineAndSayIt) {
  write("{\"id\":\"a\"}\n{\"id\":\"b\",\"sta");
  const auto rows = resume_rows(directory_, {"a", "b"}, notes_);
  EXPECT_EQ(rows.count("a"), 1u);
  EXPECT_EQ(rows.count("b"), 0u);
  EXPECT_THAT(notes_, ElementsAre("a torn last line (14 bytes) was dropped"));
  EXPECT_EQ(content(), "{\"id\":\"a\"}\n");
}

TEST_F(ResultRows, LoseATornFirstLine) {
  write("{\"id\":");
  EXPECT_THAT(resume_rows(directory_, {"a"}, notes_), IsEmpty());
  EXPECT_EQ(content(), "");
}

TEST_F(ResultRows, LoseDoublesAndLinesThatAreNoRows) {
  write("{\"id\":\"a\",\"n\":1}\nnonsense\n[1]\n{\"id\":7}\n{\"id\":\"a\",\"n\":2}\n");
  const auto rows = resume_rows(directory_, {"a"}, notes_);
  EXPECT_EQ(rows.at("a")["n"], 2);
  EXPECT_THAT(notes_, ElementsAre("3 unreadable line(s) were dropped; 1 double row(s) were dropped"));
  EXPECT_EQ(content(), "{\"id\":\"a\",\"n\":2}\n");
}

TEST_F(ResultRows, PutThoseOfAnotherStudyAside) {
  write("{\"id\":\"old\"}\n{\"id\":\"a\"}\n");
  EXPECT_EQ(resume_rows(directory_, {"a"}, notes_).size(), 1u);
  EXPECT_THAT(notes_, ElementsAre(HasSubstr("1 row(s) of another study")));
  EXPECT_EQ(read_file(directory_ / "results.stale.jsonl"), "{\"id\":\"old\"}\n");
  EXPECT_EQ(content(), "{\"id\":\"a\"}\n");
}

TEST_F(ResultRows, AreWrittenInTheOrderOfTheStudy) {
  write_rows(directory_, {"b", "c", "a"}, {{"a", {{"id", "a"}}}, {"b", {{"id", "b"}}}});
  EXPECT_EQ(content(), "{\"id\":\"b\"}\n{\"id\":\"a\"}\n");
}

TEST_F(ResultRows, RememberEachTimedRun) {
  append_timing(directory_, "a", 2, {{"total", 1.5}});
  append_timing(directory_, "a", 1, {{"total", 2.5}});
  std::ofstream(directory_ / "timings.jsonl", std::ios::app) << "{\"id\":\"a\",\"rou";  // torn
  const auto timings = read_timings(directory_);
  ASSERT_EQ(timings.at("a").size(), 2u);
  EXPECT_EQ(timings.at("a").at(1)["total"], 2.5);
}

TEST_F(ResultRows, BelongToOneProcessAtATime) {
  const DirectoryLock lock(directory_);
  // Another process tells what it met; with two jobs each piece runs in a child, which does not inherit the lock.
  run_in_processes(
      2, 2,
      [&](std::size_t) -> std::string {
        try {
          const DirectoryLock other(directory_);
        } catch (const DirectoryInUse& error) {
          return error.what();
        }
        return "not locked";
      },
      [&](std::size_t, const std::string& text) {
        EXPECT_THAT(text, HasSubstr("another stickslip writes here (process " + std::to_string(::getpid()) + ")"));
      });
}

TEST_F(ResultRows, AreFreeAgainAfterTheLock) {
  { const DirectoryLock lock(directory_); }
  EXPECT_NO_THROW(DirectoryLock{directory_});
}

}  // namespace
}  // namespace stickslip
