/// Responses over time and forces along displacements.
#include <gmock/gmock.h>

#include <cmath>

#include "studies/report/charts.hpp"
#include "studies/report/plot.hpp"
#include "tests/studies/recorded_study.hpp"
#include "tests/support/largest.hpp"

namespace stickslip {
namespace {

using recorded::description;
using recorded::json;
using recorded::picture;
using recorded::three_methods;
using testing::HasSubstr;
using testing::Not;

/// `u` goes to and fro, `grip` opposes its direction, `press` stays.
json to_and_fro(int steps) {
  json out = json::array();
  for (int n = 0; n < steps; ++n) {
    const double t = 2 * std::acos(-1.0) * n / steps;
    out.push_back({{"time", n + 1},
                   {"responses", {{"u", std::sin(t)}, {"grip", std::cos(t) > 0 ? -3 : 3}, {"press", 10}}},
                   {"history", json::array()}});
  }
  return out;
}

json picture_with_kinds() {
  json out = picture();
  out["responses"] = {{"u", "displacement"}, {"grip", "contact_force"}, {"press", "contact_force"}};
  return out;
}

class ReportHistories : public recorded::StudyOnDisk {
 protected:
  void record_steps(const json& steps, json about = description()) {
    auto cells = three_methods();
    for (auto& c : cells) c["steps"] = steps;
    record(about, cells, picture_with_kinds());
  }
  const report::Choice* choice(const report::Figure& figure, const std::string& field) {
    for (const auto& each : figure.choices)
      if (each.field == field) return &each;
    return nullptr;
  }
};

TEST_F(ReportHistories, DrawEachForceAlongEachDisplacementAndTheLoopFirst) {
  record_steps(to_and_fro(40));
  const auto figure = report::response_histories(study());
  ASSERT_TRUE(figure);
  ASSERT_EQ(figure->panels.size(), 2u);
  ASSERT_TRUE(choice(*figure, "path"));
  EXPECT_THAT(choice(*figure, "path")->options, testing::UnorderedElementsAre("grip against u", "press against u"));
  EXPECT_THAT(choice(*figure, "path")->chosen, testing::ElementsAre("grip against u"));  // press draws a line
  EXPECT_THAT(choice(*figure, "response")->chosen, testing::ElementsAre("grip"));
  std::map<std::string, int> points;
  for (const auto& row : figure->rows)
    if (row.value("path", "") == "grip against u") {
      EXPECT_EQ(std::abs(row["value"].get<double>()), 3);
      ++points[row["label"]];
    }
  EXPECT_EQ(points.size(), 7u);
  for (const auto& [label, n] : points) EXPECT_EQ(n, 40) << label;
}

TEST_F(ReportHistories, NameTheChosenResponsesOnTheAxes) {
  record_steps(to_and_fro(40));
  const auto figure = report::response_histories(study());
  const std::string over_time = report::draw_plot(*figure, figure->panels[0])->inline_svg(),
                    path = report::draw_plot(*figure, figure->panels[1])->inline_svg();
  EXPECT_THAT(over_time, testing::AllOf(HasSubstr(">time<"), HasSubstr(">grip<")));
  EXPECT_THAT(path, testing::AllOf(HasSubstr(">u<"), HasSubstr(">grip<"), Not(HasSubstr("{"))));
}

TEST_F(ReportHistories, ShowWhatTheStudyGivesAsExactAtTheEnd) {
  json about = description();
  about["reference"] = {{{"values", {{"grip", -2.5}, {"grip/mu", 7}, {"other", 1}}}}};
  record_steps(to_and_fro(40), about);
  const auto figure = report::response_histories(study());
  int given = 0;
  for (const auto& row : figure->rows)
    if (row["series"] == "given value") {
      ++given;
      EXPECT_EQ(row["response"], "grip");
      EXPECT_EQ(row["time"], 40);
      EXPECT_EQ(row["value"], -2.5);
    }
  EXPECT_EQ(given, 1);
}

TEST_F(ReportHistories, OfLongRunsKeepTheLastStepAndStayLight) {
  record_steps(to_and_fro(5000));
  const auto figure = report::response_histories(study());
  ASSERT_TRUE(figure);
  EXPECT_LT(figure->rows.size(), 20'000u);
  double last = 0;
  for (const auto& row : figure->rows)
    if (row["panel"] == "time") last = larger(last, row["time"].get<double>());
  EXPECT_EQ(last, 5000);
}

TEST_F(ReportHistories, NeedTwoStepsWithResponses) {
  record_steps(to_and_fro(1));
  EXPECT_FALSE(report::response_histories(study()));
  record(description(), three_methods(), picture_with_kinds());  // as older programs recorded them
  EXPECT_FALSE(report::response_histories(study()));
}

TEST_F(ReportHistories, WithoutKindsDrawNoPath) {
  auto cells = three_methods();
  for (auto& c : cells) c["steps"] = to_and_fro(10);
  record(description(), cells);
  const auto figure = report::response_histories(study());
  ASSERT_TRUE(figure);
  EXPECT_EQ(figure->panels.size(), 1u);
}

TEST_F(ReportHistories, ComeFirstUnderTheSolution) {
  record_steps(to_and_fro(40));
  const std::string text = page();
  const auto place = [&](const char* words) { return text.find(words); };
  EXPECT_LT(place("<h2 id=\"solution\">"), place("id=\"response-histories\""));
  EXPECT_LT(place("id=\"response-histories\""), place("id=\"tractions\""));
  EXPECT_LT(place("id=\"tractions\""), place("<h2 id=\"responses\">"));
}

}  // namespace
}  // namespace stickslip
