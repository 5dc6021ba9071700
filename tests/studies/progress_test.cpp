#include "studies/io/progress.hpp"

#include <gtest/gtest.h>

#include <algorithm>
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

TEST_F(Progresses, APieceThatTakesLongIsShownOnABar) {
  Progress progress(out_, Progress::Style::bar, "steps", 4, clock());
  progress.advance();
  pass(4);
  progress.tick();
  EXPECT_EQ(out_.str().find("in the present one"), std::string::npos);
  pass(8);
  progress.tick();
  EXPECT_NE(out_.str().find("1/4 done, 3 left, 12 s elapsed, about 36 s to go, 12 s in the present one"),
            std::string::npos)
      << out_.str();
}

TEST_F(Progresses, APieceThatTakesLongGetsALineOfALogAtTwiceTheTimeOfTheLast) {
  Progress progress(out_, Progress::Style::lines, "steps", 40, clock());
  for (int second = 0; second < 50; ++second) {
    pass(1);
    progress.tick();
  }
  const std::vector<std::string> written = lines(out_.str());
  ASSERT_EQ(written.size(), 3u);  // after 10, 20 and 40 s
  EXPECT_EQ(written[0], "steps: 0 %: 0 of 40 done, 40 left, 10 s elapsed, 10 s in the present one");
  EXPECT_EQ(written[2], "steps: 0 %: 0 of 40 done, 40 left, 40 s elapsed, 40 s in the present one");
  progress.advance();
  for (int second = 0; second < 10; ++second) {
    pass(1);
    progress.tick();
  }
  EXPECT_EQ(lines(out_.str()).size(), 4u);  // the next piece begins anew
}

TEST_F(Progresses, SaysNothingAtFirstIfItIsToBeQuiet) {
  for (const auto style : {Progress::Style::bar, Progress::Style::lines}) {
    Progress progress(out_, style, "steps", 10, clock(), std::chrono::seconds(2));
    pass(1);
    for (int step = 0; step < 5; ++step) progress.advance();
    progress.tick();
    EXPECT_EQ(out_.str(), "");
  }
  Progress progress(out_, Progress::Style::bar, "steps", 10, clock(), std::chrono::seconds(2));
  pass(3);
  progress.tick();
  EXPECT_NE(out_.str().find("0/10 done"), std::string::npos);
}

TEST_F(Progresses, ATickerRedrawsABarWhileAPieceGoesOn) {
  Progress progress(out_, Progress::Style::bar, "steps", 4);
  {
    const Ticker ticker(progress);
    std::this_thread::sleep_for(std::chrono::milliseconds(1300));  // two ticks, and slack for a busy machine
  }
  const std::string text = out_.str();
  EXPECT_GE(std::count(text.begin(), text.end(), '\r'), 2);  // the first draws it
}

}  // namespace
}  // namespace stickslip
