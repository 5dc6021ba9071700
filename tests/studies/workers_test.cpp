#include "studies/sweep/workers.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <signal.h>
#include <unistd.h>

#include <map>
#include <set>
#include <stdexcept>

namespace stickslip {
namespace {

using testing::HasSubstr;

void none_lost(std::size_t i, const Loss& loss) { ADD_FAILURE() << "piece " << i << ": " << loss.words; }

std::string message_of(int jobs, const std::function<std::string(std::size_t)>& work) {
  try {
    run_in_processes(
        jobs, 8, work, [](std::size_t, const std::string&) {}, none_lost);
  } catch (const std::runtime_error& error) {
    return error.what();
  }
  return {};
}

TEST(Workers, DoEachPieceOnceWithAnyNumberOfJobs) {
  for (const int jobs : {1, 2, 3, 40}) {
    std::map<std::size_t, std::string> results;
    run_in_processes(
        jobs, 25, [](std::size_t i) { return std::string(i * 20000, 'x'); },  // beyond what a pipe takes at once
        [&](std::size_t i, const std::string& text) { EXPECT_TRUE(results.emplace(i, text).second) << i; }, none_lost);
    ASSERT_EQ(results.size(), 25u);
    for (const auto& [i, text] : results) EXPECT_EQ(text, std::string(i * 20000, 'x'));
  }
}

TEST(Workers, AreProcessesOfTheirOwn) {
  const auto process = [](std::size_t) { return std::to_string(::getpid()); };
  for (const int jobs : {1, 2}) {
    std::set<std::string> processes;
    const auto take = [&](std::size_t, const std::string& text) { processes.insert(text); };
    run_in_processes(jobs, 3, process, take, none_lost);
    EXPECT_EQ(processes.count(std::to_string(::getpid())), 0u);
    EXPECT_LE(processes.size(), static_cast<std::size_t>(jobs));
  }
}

TEST(Workers, HandOnWhatAPieceThrows) {
  const auto work = [](std::size_t i) -> std::string {
    if (i == 3) throw std::runtime_error("piece three\nis bad");
    return "";
  };
  EXPECT_THAT(message_of(1, work), HasSubstr("piece three"));
  EXPECT_EQ(message_of(2, work), "piece three is bad");
}

/// The kernel kills a process where memory runs out, and a crash or a library ends it: one piece is lost, and it is
/// known which.
TEST(Workers, GoOnWithoutThePieceOfAProcessThatEnded) {
  const auto work = [](std::size_t i) -> std::string {
    if (i == 5 || i == 11) ::kill(::getpid(), i == 5 ? SIGKILL : SIGSEGV);
    if (i == 12) ::_exit(7);  // as a library may
    return "done";
  };
  for (const int jobs : {1, 2, 5}) {
    std::map<std::size_t, int> lost;
    std::set<std::size_t> finished;
    run_in_processes(
        jobs, 20, work, [&](std::size_t i, const std::string&) { finished.insert(i); },
        [&](std::size_t i, const Loss& loss) {
          lost[i] = loss.signal;
          EXPECT_EQ(loss.from_outside, i == 5);
          EXPECT_THAT(loss.words, HasSubstr(i == 12 ? "exit code 7" : "ended by signal"));
        });
    EXPECT_EQ(lost, (std::map<std::size_t, int>{{5, SIGKILL}, {11, SIGSEGV}, {12, 0}}));
    EXPECT_EQ(finished.size(), 17u);
  }
}

}  // namespace
}  // namespace stickslip
