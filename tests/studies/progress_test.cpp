#include "studies/io/progress.hpp"

#include <gtest/gtest.h>

#include <sstream>
#include <thread>
#include <vector>

namespace stickslip {
namespace {

/// A clock that is set by hand.
class Progresses : public testing::Test {
 protected:
  Progress::Clock clock() {
    return [this] { return now_; };
  }
  void pass(double seconds) {
    now_ += std::chrono::duration_cast<std::chrono::steady_clock::duration>(std::chrono::duration<double>(seconds));
  }
  static std::vector<std::string> lines(const std::string& text) {
    std::vector<std::string> out;
    std::istringstream stream(text);
    for (std::string line; std::getline(stream, line);) out.push_back(line);
    return out;
  }

  std::chrono::steady_clock::time_point now_;
  std::ostringstream out_;
};

TEST(FormatDuration, ReadsNaturallyFromSecondsToDays) {
  EXPECT_EQ(format_duration(0), "0.0 s");
  EXPECT_EQ(format_duration(8.26), "8.3 s");
  EXPECT_EQ(format_duration(9.96), "10 s");
  EXPECT_EQ(format_duration(59.7), "1 min 00 s");
  EXPECT_EQ(format_duration(125), "2 min 05 s");
  EXPECT_EQ(format_duration(3599.6), "1 h 00 min");
  EXPECT_EQ(format_duration(90000), "25 h 00 min");
}

TEST(EstimateRemaining, TakesTheRestToCostWhatTheDoneDid) {
  EXPECT_DOUBLE_EQ(estimate_remaining({.done = 10, .total = 40, .elapsed = 20}), 60);
  EXPECT_DOUBLE_EQ(estimate_remaining({.done = 40, .total = 40, .elapsed = 20}), 0);
  EXPECT_LT(estimate_remaining({.done = 0, .total = 40, .elapsed = 20}), 0);
  EXPECT_DOUBLE_EQ(estimate_remaining({.done = 30, .total = 40, .elapsed = 20, .earlier = 28}), 100);
  EXPECT_LT(estimate_remaining({.done = 30, .total = 40, .elapsed = 20, .earlier = 30}), 0);
}

TEST(ProgressBar, ShowsDoneLeftElapsedAndEstimate) {
  EXPECT_EQ(progress_bar({.done = 12, .total = 40, .elapsed = 30}),
            "[######..............] 12/40 done, 28 left, 30 s elapsed, about 1 min 10 s to go");
  EXPECT_EQ(progress_bar({.done = 0, .total = 40, .elapsed = 0}),
            "[....................] 0/40 done, 40 left, 0.0 s elapsed");
}

TEST(ProgressBar, IsFullOnlyWhenAllIsDone) {
  EXPECT_EQ(progress_bar({.done = 999, .total = 1000, .elapsed = 1}).find('.'), 20u);
  EXPECT_EQ(progress_bar({.done = 1000, .total = 1000, .elapsed = 1}).substr(0, 22), "[####################]");
}

TEST(ProgressLine, ShowsTheSameForALog) {
  EXPECT_EQ(progress_line({.done = 12, .total = 40, .elapsed = 30}),
            "30 %: 12 of 40 done, 28 left, 30 s elapsed, about 1 min 10 s to go");
}

TEST(ProgressLine, NothingToDoIsAllDone) {
  EXPECT_EQ(progress_line({.done = 0, .total = 0, .elapsed = 0}), "100 %: 0 of 0 done, 0 left, 0.0 s elapsed");
}

TEST_F(Progresses, ALogGetsOneLineForEachTenPercent) {
  {
    Progress progress(out_, Progress::Style::lines, "hertz", 1000, clock());
    for (int i = 0; i < 1000; ++i) {
      pass(0.1);
      progress.advance();
    }
  }
  const std::vector<std::string> told = lines(out_.str());
  ASSERT_EQ(told.size(), 10u);
  EXPECT_EQ(told.front(), "hertz: 10 %: 100 of 1000 done, 900 left, 10 s elapsed, about 1 min 30 s to go");
  EXPECT_EQ(told.back(), "hertz: 100 %: 1000 of 1000 done, 0 left, 1 min 40 s elapsed");
  EXPECT_EQ(out_.str().find('\r'), std::string::npos);
}

TEST_F(Progresses, ALogOfFewPiecesGetsALineForEach) {
  Progress progress(out_, Progress::Style::lines, "few", 3, clock());
  for (int i = 0; i < 3; ++i) progress.advance();
  EXPECT_EQ(lines(out_.str()).size(), 3u);
}

TEST_F(Progresses, TheEstimateRestsOnThePiecesOfThisRun) {
  Progress progress(out_, Progress::Style::lines, "resumed", 10, clock());
  progress.skip(8);
  pass(60);
  progress.advance();
  EXPECT_EQ(lines(out_.str()),
            (std::vector<std::string>{"resumed: 80 %: 8 of 10 done, 2 left, 0.0 s elapsed",
                                      "resumed: 90 %: 9 of 10 done, 1 left, 1 min 00 s elapsed, about 1 min 00 s to "
                                      "go"}));
}

TEST_F(Progresses, ABarIsRedrawnInPlaceAtMostTenTimesASecond) {
  {
    Progress progress(out_, Progress::Style::bar, "hertz", 1000, clock());
    for (int i = 0; i < 1000; ++i) {
      pass(0.001);
      progress.advance();
    }
  }
  const std::string text = out_.str();
  const auto drawn = std::count(text.begin(), text.end(), '\r');
  // One second of work: the first one, one each tenth of a second, and the last; the clock's rounding may cost one.
  EXPECT_GE(drawn, 10);
  EXPECT_LE(drawn, 12);
  EXPECT_EQ(std::count(text.begin(), text.end(), '\n'), 1);
  EXPECT_EQ(text.back(), '\n');
  EXPECT_NE(text.find("1000/1000 done, 0 left"), std::string::npos);
}

TEST_F(Progresses, ANoteStandsOnALineOfItsOwnAndTheBarFollows) {
  Progress progress(out_, Progress::Style::bar, "hertz", 4, clock());
  progress.note("cell 3: singular");
  const std::string text = out_.str();
  const std::size_t note = text.find("\rcell 3: singular\x1b[K\n");
  ASSERT_NE(note, std::string::npos);
  EXPECT_NE(text.find("hertz [", note), std::string::npos);
}

TEST_F(Progresses, CountsWhatSeveralThreadsDo) {
  Progress progress(out_, Progress::Style::lines, "threads", 4000, clock());
  {
    std::vector<std::jthread> workers;
    for (int i = 0; i < 4; ++i) {
      workers.emplace_back([&progress] {
        for (int j = 0; j < 1000; ++j) progress.advance();
      });
    }
  }
  const std::vector<std::string> told = lines(out_.str());
  ASSERT_EQ(told.size(), 10u);
  EXPECT_NE(told.back().find("4000 of 4000 done, 0 left"), std::string::npos);
}

}  // namespace
}  // namespace stickslip
