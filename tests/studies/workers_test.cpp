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

void none_lost(std::size_t i, int signal) { ADD_FAILURE() << "piece " << i << ", signal " << signal; }

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

TEST(Workers, AreProcessesOfTheirOwnUnlessThereIsOneJob) {
  std::set<std::string> processes;
  const auto process = [](std::size_t) { return std::to_string(::getpid()); };
  const auto take = [&](std::size_t, const std::string& text) { processes.insert(text); };
  run_in_processes(1, 3, process, take, none_lost);
  EXPECT_THAT(processes, testing::ElementsAre(std::to_string(::getpid())));
  processes.clear();
  run_in_processes(2, 3, process, take, none_lost);
  EXPECT_EQ(processes.count(std::to_string(::getpid())), 0u);
}

TEST(Workers, HandOnWhatAPieceThrows) {
  const auto work = [](std::size_t i) -> std::string {
    if (i == 3) throw std::runtime_error("piece three\nis bad");
    return "";
  };
  EXPECT_THAT(message_of(1, work), HasSubstr("piece three"));
  EXPECT_EQ(message_of(2, work), "piece three is bad");
}

/// The kernel kills a process where memory runs out: one piece is lost, and it is known which.
TEST(Workers, GoOnWithoutThePieceOfAProcessThatWasKilled) {
  const auto work = [](std::size_t i) -> std::string {
    if (i == 5 || i == 11) ::kill(::getpid(), i == 5 ? SIGKILL : SIGSEGV);
    return "done";
  };
  for (const int jobs : {2, 5}) {
    std::map<std::size_t, int> lost;
    std::set<std::size_t> finished;
    run_in_processes(
        jobs, 20, work, [&](std::size_t i, const std::string&) { finished.insert(i); },
        [&](std::size_t i, int signal) { lost[i] = signal; });
    EXPECT_EQ(lost, (std::map<std::size_t, int>{{5, SIGKILL}, {11, SIGSEGV}}));
    EXPECT_EQ(finished.size(), 18u);
  }
}

}  // namespace
}  // namespace stickslip
