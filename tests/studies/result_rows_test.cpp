#include "studies/io/result_rows.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <fstream>
#include <utility>

#include "studies/io/atomic_file.hpp"
#include "studies/io/directory_lock.hpp"
#include "studies/io/input_fault.hpp"
#include "studies/io/output_folder.hpp"
#include "studies/sweep/workers.hpp"
#include "tests/studies/temporary_folder.hpp"

namespace stickslip {
namespace {

using nlohmann::json;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

class ResultRows : public InOwnFolder {
 protected:
  /// A line that the program wrote.
  static std::string line(const json& row) { return sealed(row).dump() + "\n"; }
  /// As a study left it, and somebody edited it.
  void write(const std::string& text) {
    const auto file = folder_ / "results.jsonl";
    if (!std::filesystem::exists(file)) write_output(file, "", Sums::of_each_line);
    std::ofstream(file, std::ios::binary) << text;
  }
  std::string content() { return read_file(folder_ / "results.jsonl"); }

  const json a = {{"id", "a"}, {"status", "cap"}}, b = {{"id", "b"}, {"status", "cap"}};
  std::vector<std::string> notes_;
};

TEST_F(ResultRows, AreNoneInAnEmptyDirectory) {
  EXPECT_THAT(read_rows(folder_).rows, IsEmpty());
  EXPECT_THAT(resume_rows(folder_, {"a"}, notes_), IsEmpty());
  EXPECT_THAT(notes_, IsEmpty());
}

TEST_F(ResultRows, AreLeftAloneWhereTheyAreSound) {
  write(line(b) + line(a));
  const auto rows = resume_rows(folder_, {"a", "b"}, notes_);
  EXPECT_EQ(rows.size(), 2u);
  EXPECT_THAT(notes_, IsEmpty());
  EXPECT_EQ(content(), line(b) + line(a));
}

TEST_F(ResultRows, LoseATornLastLineAndSayIt) {
  write(line(a) + "{\"id\":\"b\",\"sta");
  const auto rows = resume_rows(folder_, {"a", "b"}, notes_);
  EXPECT_EQ(rows.count("a"), 1u);
  EXPECT_EQ(rows.count("b"), 0u);
  EXPECT_THAT(notes_, ElementsAre("a torn last line (14 bytes) was dropped"));
  EXPECT_EQ(content(), line(a));
}

TEST_F(ResultRows, LoseATornFirstLine) {
  write("{\"id\":");
  EXPECT_THAT(resume_rows(folder_, {"a"}, notes_), IsEmpty());
  EXPECT_EQ(content(), "");
}

TEST_F(ResultRows, LoseDoublesAndLinesThatAreNoRows) {
  const json first = {{"id", "a"}, {"n", 1}, {"status", "cap"}}, second = {{"id", "a"}, {"n", 2}, {"status", "cap"}};
  write(line(first) + "nonsense\n[1]\n{\"id\":7}\n" + line(second));
  const auto rows = resume_rows(folder_, {"a"}, notes_);
  EXPECT_EQ(rows.at("a")["n"], 2);
  EXPECT_THAT(notes_, ElementsAre("line 2 is no row and was dropped: it is not JSON; line 3 is no row and was dropped: "
                                  "it is an array; line 4 is no row and was dropped: it has no \"status\"; "
                                  "1 double row(s) were dropped"));
  EXPECT_EQ(content(), line(second));
  EXPECT_EQ(read_file(folder_ / "results.stale.jsonl"), "nonsense\n[1]\n{\"id\":7}\n");  // nothing is lost
}

/// A cell whose row is damaged is run again.
TEST_F(ResultRows, LoseWhatTheProgramDoesNotWrite) {
  for (const auto& [row, fault] : std::vector<std::pair<std::string, std::string>>{
           {R"({"id":"a"})", R"(it has no "status")"},
           {R"({"id":"a","status":7})", "/status is 7; must be a text"},
           {R"({"id":"a","status":"cap","label":5})", "/label is 5; must be a text"},
           {R"({"id":"a","status":"cap","errors":5})", "/errors is 5; must be an object"},
           {R"({"id":"a","status":"cap","errors":{"kkt":[]}})", "/errors/kkt is []; must be an object"},
           {R"({"id":"a","status":"cap","refine":0.5})", "/refine is 0.5; must be a whole number"}}) {
    write(row + "\n");
    const auto stored = read_rows(folder_);
    EXPECT_THAT(stored.rows, IsEmpty()) << row;
    EXPECT_EQ(stored.faults(), "line 1 is no row and was dropped: " + fault);
  }
}

TEST_F(ResultRows, GoWithRecordsThatAreWholeOrNamed) {
  EXPECT_NO_THROW(check_records(folder_));
  const auto fault = [&](const std::string& name, const std::string& text) {
    std::ofstream(folder_ / name) << text;
    try {
      check_records(folder_);
    } catch (const InputFault& error) {
      return std::string(error.what());
    }
    return std::string();
  };
  EXPECT_EQ(fault("study.json", R"({"program": "1", "cells": ["a"]})"), "");
  EXPECT_EQ(fault("picture.json", "{}"), "");
  EXPECT_THAT(fault("picture.json", "{\"a\":\n1"), HasSubstr("picture.json:2:2: is not JSON"));
  EXPECT_THAT(fault("picture.json", "7"), HasSubstr("picture.json:1:1: is 7; must be an object"));
  EXPECT_THAT(fault("study.json", ""), HasSubstr("study.json:1:1: is empty; must be a JSON object"));
  EXPECT_THAT(fault("study.json", "{\n\"cells\": 5}"), HasSubstr("study.json:2:10: /cells: is 5; must be a list"));
  EXPECT_THAT(fault("study.json", "{\"program\": 5}"), HasSubstr("study.json:1:13: /program: is 5; must be a text"));
}

TEST_F(ResultRows, PutThoseOfAnotherStudyAside) {
  const json old = {{"id", "old"}, {"status", "cap"}};
  write(line(old) + line(a));
  EXPECT_EQ(resume_rows(folder_, {"a"}, notes_).size(), 1u);
  EXPECT_THAT(notes_, ElementsAre(HasSubstr("1 row(s) of another study")));
  EXPECT_EQ(read_file(folder_ / "results.stale.jsonl"), line(old));
  EXPECT_EQ(content(), line(a));
}

TEST_F(ResultRows, AreWrittenInTheOrderOfTheStudy) {
  write_rows(folder_, {"b", "c", "a"},
             {{"a", {{"id", "a"}, {"status", "cap"}}}, {"b", {{"id", "b"}, {"status", "cap"}}}});
  EXPECT_EQ(content(), line(b) + line(a));
}

/// A number that changed on the disk, or a part that went missing, is noticed, wherever it is.
TEST_F(ResultRows, AreKnownByTheirChecksum) {
  const json row = {{"id", "a"},
                    {"status", "converged"},
                    {"responses", {{"press", 1.25}, {"tiny", 4e-310}, {"whole", 7}, {"none", nullptr}}},
                    {"provenance", {{"git", "abc"}}}};
  const std::string sound = line(row);
  write(sound);
  EXPECT_EQ(read_rows(folder_).rows.size(), 1u);
  EXPECT_THAT(read_rows(folder_).unsealed, IsEmpty());
  int noticed = 0, changes = 0;
  for (std::size_t i = 0; i + 1 < sound.size(); ++i) {
    std::string damaged = sound;
    damaged[i] = damaged[i] == '3' ? '4' : '3';
    write(damaged);
    const auto stored = read_rows(folder_);
    ++changes;
    noticed += stored.rows.empty() || !stored.unsealed.empty();
    EXPECT_TRUE(resume_rows(folder_, {"a"}, notes_).empty()) << damaged;
  }
  EXPECT_EQ(noticed, changes);
}

/// Another program may write the same numbers in other words.
TEST_F(ResultRows, KeepTheirChecksumInOtherWords) {
  write(sealed({{"id", "a"}, {"status", "converged"}, {"n", 1e-5}}).dump(-1, ' ', true) + "\n");
  std::string text = content();
  text.replace(text.find("1e-05"), 5, "0.00001");
  write(text);
  EXPECT_TRUE(read_rows(folder_).sound());
}

TEST_F(ResultRows, AreRunAnewWithoutAChecksum) {
  write(a.dump() + "\n" + line(b));
  EXPECT_EQ(read_rows(folder_).rows.size(), 2u);
  const auto rows = resume_rows(folder_, {"a", "b"}, notes_);
  EXPECT_EQ(rows.count("a"), 0u);
  EXPECT_EQ(rows.count("b"), 1u);
  EXPECT_THAT(notes_, ElementsAre("1 row(s) without a checksum were dropped"));
  EXPECT_EQ(read_file(folder_ / "results.stale.jsonl"), a.dump() + "\n");
}

TEST_F(ResultRows, LeaveOutTimedRunsThatAreDamaged) {
  append_timing(folder_, "a", 1, {{"total", 2.5}});
  const std::string sound = read_file(folder_ / "timings.jsonl");
  for (const std::string& damaged :
       {std::string("{}"), std::string("[1]"), std::string("{\"id\":\"a\",\"round\":2,\"seconds\":{\"total\":1}}"),
        std::string("{\"id\":\"a\",\"round\":2,\"seconds\":\"x\"}"), std::string("nonsense \xff")})
    append_line(folder_ / "timings.jsonl", damaged);
  int count = 0;
  EXPECT_EQ(read_timings(folder_, &count).at("a").size(), 1u);
  EXPECT_EQ(count, 5);
}

TEST_F(ResultRows, RememberEachTimedRun) {
  append_timing(folder_, "a", 2, {{"total", 1.5}});
  append_timing(folder_, "a", 1, {{"total", 2.5}});
  std::ofstream(folder_ / "timings.jsonl", std::ios::app) << "{\"id\":\"a\",\"rou";  // torn
  const auto timings = read_timings(folder_);
  ASSERT_EQ(timings.at("a").size(), 2u);
  EXPECT_EQ(timings.at("a").at(1)["total"], 2.5);
}

TEST_F(ResultRows, BelongToOneProcessAtATime) {
  const DirectoryLock lock(folder_);
  // Another process tells what it met; with two jobs each piece runs in a child, which does not inherit the lock.
  run_in_processes(
      2, 2,
      [&](std::size_t) -> std::string {
        try {
          const DirectoryLock other(folder_);
        } catch (const DirectoryInUse& error) {
          return error.what();
        }
        return "not locked";
      },
      [&](std::size_t, const std::string& text) {
        EXPECT_THAT(text, HasSubstr("another stickslip writes here (process " + std::to_string(::getpid()) + ")"));
      },
      [](std::size_t, const Loss& loss) { ADD_FAILURE() << loss.words; });
}

TEST_F(ResultRows, AreLostWithTheirDirectoryWithAWord) {
  const DirectoryLock lock(folder_);
  EXPECT_NO_THROW(lock.check());
  std::filesystem::remove_all(folder_);
  EXPECT_THROW(lock.check(), InputFault);
  std::filesystem::create_directories(folder_);  // another one of the same name
  std::ofstream(folder_ / ".lock") << "";
  EXPECT_THROW(lock.check(), InputFault);
}

TEST_F(ResultRows, AreFreeAgainAfterTheLock) {
  { const DirectoryLock lock(folder_); }
  EXPECT_NO_THROW(DirectoryLock{folder_});
}

}  // namespace
}  // namespace stickslip
