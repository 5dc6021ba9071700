#include "studies/sweep/timing.hpp"

#include <gtest/gtest.h>

#include <map>
#include <nlohmann/json.hpp>

namespace stickslip {
namespace {

using nlohmann::json;

TEST(Timing, RunsEachCellOnceARoundTogetherWithThoseOfItsKey) {
  const auto plan = timing_plan({"a", "a", "a", "b", "b"}, 2);
  std::vector<std::pair<std::size_t, int>> runs;
  for (const auto& run : plan) runs.emplace_back(run.cell, run.round);
  const std::vector<std::pair<std::size_t, int>> expected = {{0, 1}, {1, 1}, {2, 1}, {2, 2}, {1, 2},
                                                             {0, 2}, {3, 1}, {4, 1}, {4, 2}, {3, 2}};
  EXPECT_EQ(runs, expected);
}

/// A machine that slows down steadily: the mean place of a cell in the plan is what drift adds to it.
TEST(Timing, FavoursNoCellWhileTheMachineDrifts) {
  const auto plan = timing_plan({"a", "a", "a", "a"}, 4);
  std::map<std::size_t, double> place;
  for (std::size_t i = 0; i < plan.size(); ++i) place[plan[i].cell] += static_cast<double>(i);
  for (const auto& [cell, sum] : place) EXPECT_EQ(sum, place[0]) << cell;  // sums of whole numbers: exact
}

TEST(Timing, IsNothingWithoutRounds) { EXPECT_TRUE(timing_plan({"a", "b"}, 0).empty()); }

TEST(Timing, TakesTheLeastAndTheMedianOfEachKindOfSeconds) {
  const std::vector<json> runs = {
      {{"total", 3.0}, {"setup", 0.1}}, {{"total", 1.0}, {"setup", 0.4}}, {{"total", 2.0}, {"setup", 0.3}}};
  EXPECT_EQ(least_seconds(runs), (json{{"total", 1.0}, {"setup", 0.1}}));
  EXPECT_EQ(median_seconds(runs), (json{{"total", 2.0}, {"setup", 0.3}}));
  EXPECT_EQ(median_seconds({runs[0], runs[1]}).at("total"), 2.0);
}

}  // namespace
}  // namespace stickslip
