/// Responses and derivatives over time, and forces along displacements.
#include <gmock/gmock.h>

#include <cmath>
#include <set>

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
                   {"sensitivities",
                    {{"u", {{"mu", -1}, {"N", nullptr}}},
                     {"grip", {{"mu", std::cos(t) > 0 ? -10 : 10}, {"N", 0}}},
                     {"press", {{"mu", 0}, {"N", 1}}}}},
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
  ASSERT_EQ(figure->charts.size(), 2u);
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

TEST_F(ReportHistories, WithoutALoopBeginWithTheForceThatChangesAndSpeakOfNoMemory) {
  json steps = json::array();
  for (int n = 1; n <= 10; ++n)  // the grip grows with the way, the press shakes by rounding in one run alone
    steps.push_back(
        {{"time", n}, {"responses", {{"u", n}, {"grip", 3 * n}, {"a_press", 10}}}, {"history", json::array()}});
  json kinds = picture_with_kinds();
  kinds["responses"] = {{"u", "displacement"}, {"grip", "contact_force"}, {"a_press", "contact_force"}};
  auto cells = three_methods();
  for (auto& c : cells) c["steps"] = steps;
  cells[3]["steps"][4]["responses"]["a_press"] = 10.0000001;  // the most accurate of its method, shown at first
  record(description(), cells, kinds);
  const auto figure = report::response_histories(study());
  ASSERT_TRUE(figure);
  EXPECT_THAT(choice(*figure, "response")->chosen, testing::ElementsAre("grip"));
  EXPECT_THAT(choice(*figure, "path")->chosen, testing::ElementsAre("grip against u"));
  EXPECT_THAT(figure->text, Not(HasSubstr("memory")));
  record_steps(to_and_fro(40));
  EXPECT_THAT(report::response_histories(study())->text, HasSubstr("friction's memory"));
}

TEST_F(ReportHistories, DoNotBeginWithAForceThatIsRoundingBesideAnother) {
  json steps = json::array();
  for (int n = 1; n <= 10; ++n)
    steps.push_back({{"time", n},
                     {"responses", {{"grip", n % 2 == 0 ? 6e-14 : -2e-14}, {"press", 300 + n}}},
                     {"history", json::array()}});
  record_steps(steps);
  EXPECT_THAT(choice(*report::response_histories(study()), "response")->chosen, testing::ElementsAre("press"));
}

TEST_F(ReportHistories, SpeakOfMemoryOnlyWhereAPathClosesAboveRounding) {
  json open_path = json::array();
  for (int n = 1; n <= 10; ++n)  // bent, and never back where it was
    open_path.push_back(
        {{"time", n}, {"responses", {{"u", n}, {"grip", n * n}, {"press", 10}}}, {"history", json::array()}});
  record_steps(open_path);
  EXPECT_THAT(report::response_histories(study())->text, Not(HasSubstr("memory")));
  json steps = to_and_fro(40);
  for (auto& step : steps) {
    json& grip = step["responses"]["grip"];
    grip = 10 + 1e-12 * grip.get<double>();
  }
  record_steps(steps);
  EXPECT_THAT(report::response_histories(study())->text, Not(HasSubstr("memory")));
}

/// A force that stays draws a level line along every displacement.
TEST_F(ReportHistories, BeginWithWhatChangesAndFoldThePathOfAForceThatStays) {
  json steps = json::array();
  for (int n = 1; n <= 10; ++n)
    steps.push_back(
        {{"time", n}, {"responses", {{"u", n}, {"grip", 3 + 1e-8 * n}, {"press", 10}}}, {"history", json::array()}});
  record_steps(steps);
  const auto figure = report::response_histories(study());
  EXPECT_THAT(choice(*figure, "response")->chosen, testing::ElementsAre("u"));
  EXPECT_TRUE(figure->charts[1].folded);
  EXPECT_THAT(figure->text, HasSubstr("The curves of u lie on each other: the runs shown at first differ by 0 of"));
  record_steps(to_and_fro(40));
  EXPECT_FALSE(report::response_histories(study())->charts[1].folded);
}

/// Where loads are found by arc length, time goes back past a limit point.
TEST_F(ReportHistories, OfAPathByArcLengthBeginWithTheDisplacement) {
  json steps = to_and_fro(40);
  for (std::size_t n = 0; n < steps.size(); ++n) steps[n]["time"] = n < 20 ? n : 40 - n;
  record_steps(steps);
  const auto figure = report::response_histories(study());
  EXPECT_THAT(choice(*figure, "response")->chosen, testing::ElementsAre("u"));
  EXPECT_THAT(report::draw_plot(*figure, figure->charts[0])->inline_svg(), HasSubstr(">time, which scales the load<"));
}

TEST_F(ReportHistories, OfDerivativesDoNotBeginWithRounding) {
  json steps = to_and_fro(40);
  for (std::size_t n = 0; n < steps.size(); ++n)
    steps[n]["sensitivities"] = {{"grip", {{"E", n % 2 == 0 ? 1e-18 : -1e-18}, {"mu", 5}}},
                                 {"u", {{"E", 1e-6}, {"mu", 1}}}};
  record_steps(steps);
  EXPECT_THAT(choice(*report::derivative_histories(study(), "grip"), "response")->chosen,
              testing::ElementsAre("d grip / d mu"));
}

TEST_F(ReportHistories, NameTheChosenResponsesOnTheAxes) {
  record_steps(to_and_fro(40));
  const auto figure = report::response_histories(study());
  const std::string over_time = report::draw_plot(*figure, figure->charts[0])->inline_svg(),
                    path = report::draw_plot(*figure, figure->charts[1])->inline_svg();
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
  EXPECT_EQ(figure->charts.size(), 1u);
}

TEST_F(ReportHistories, DrawEachDerivativeOverTimeAndThatWithMostToSeeFirst) {
  record_steps(to_and_fro(40));
  const auto figure = report::derivative_histories(study(), "grip");
  ASSERT_TRUE(figure);
  ASSERT_TRUE(choice(*figure, "response"));
  EXPECT_THAT(choice(*figure, "response")->chosen, testing::ElementsAre("d grip / d mu"));  // d grip / d N stays 0
  EXPECT_THAT(choice(*figure, "response")->options,
              testing::UnorderedElementsAre("d grip / d mu", "d grip / d N", "d press / d mu", "d press / d N",
                                            "d u / d mu"));  // d u / d N is nowhere a number
  std::map<std::string, int> points;
  for (const auto& row : figure->rows)
    if (row["response"] == "d grip / d mu") {
      EXPECT_EQ(std::abs(row["value"].get<double>()), 10);
      ++points[row["label"]];
    }
  EXPECT_EQ(points.size(), 7u);
  for (const auto& [label, n] : points) EXPECT_EQ(n, 40) << label;
  EXPECT_THAT(report::draw_plot(*figure, figure->charts[0])->inline_svg(), HasSubstr(">d grip / d mu<"));
}

TEST_F(ReportHistories, OfDerivativesBeginWithTheResponseThatIsShown) {
  record_steps(to_and_fro(40));
  EXPECT_THAT(choice(*report::derivative_histories(study(), "press"), "response")->chosen.front(),
              testing::StartsWith("d press"));
  EXPECT_EQ(choice(*report::derivative_histories(study(), ""), "response")->chosen.front(), "d grip / d mu");
}

TEST_F(ReportHistories, ShowGivenDerivativesAtTheEnd) {
  json about = description();
  about["reference"] = {{{"values", {{"grip", -2.5}, {"grip/mu", 7}, {"other/mu", 1}}}}};
  record_steps(to_and_fro(40), about);
  const auto figure = report::derivative_histories(study(), "grip");
  std::vector<json> given;
  for (const auto& row : figure->rows)
    if (row["series"] == "given value") given.push_back(row);
  ASSERT_EQ(given.size(), 1u);
  EXPECT_EQ(given[0]["response"], "d grip / d mu");
  EXPECT_EQ(given[0]["time"], 40);
  EXPECT_EQ(given[0]["value"], 7);
}

TEST_F(ReportHistories, OfManyDerivativesShowSomeAndSaySo) {
  json steps = to_and_fro(400);
  for (auto& step : steps)
    for (int p = 0; p < 100; ++p) step["sensitivities"]["u"]["p" + std::to_string(p)] = p;
  record_steps(steps);
  const auto figure = report::derivative_histories(study(), "grip");
  ASSERT_TRUE(figure);
  EXPECT_LT(figure->rows.size(), 40'000u);
  EXPECT_THAT(figure->text, HasSubstr("of 106 derivatives"));
}

TEST_F(ReportHistories, OfDerivativesNeedTwoStepsWithDerivatives) {
  record_steps(to_and_fro(1));
  EXPECT_FALSE(report::derivative_histories(study(), ""));
  json steps = to_and_fro(10);
  for (auto& step : steps) step.erase("sensitivities");  // adjoint mode, and rows of older programs
  record_steps(steps);
  EXPECT_FALSE(report::derivative_histories(study(), ""));
}

/// A solution of another program has a curve among those of the methods, and a line among the certificates; it is no
/// setting that could be the cheapest.
TEST_F(ReportHistories, ShowSolutionsOfOtherProgramsBesideTheMethods) {
  auto cells = three_methods();
  for (auto& c : cells) {
    c["steps"] = to_and_fro(8);
    c["certificate"] = {{"holds", true},   {"law", "cone"}, {"value", 1e-9},
                        {"allowed", 1e-6}, {"time", 1},     {"where", "x"}};
  }
  json peer = {{"id", "p"},
               {"label", "GetFEM"},
               {"peer", {{"name", "GetFEM"}, {"file", "g.json"}}},
               {"knobs", json::object()},
               {"vary", json::object()},
               {"refine", 0},
               {"status", "inaccurate"},
               {"errors", {{"enforcement", {{"response:u", 0.25}}}}},
               {"steps", to_and_fro(8)}};
  peer["certificate"] = {{"holds", false},  {"law", "supports"}, {"value", 1},
                         {"allowed", 1e-8}, {"time", 3},         {"where", "y"}};
  cells.push_back(peer);
  record(description(), cells, picture_with_kinds());
  const auto found = study();
  EXPECT_EQ(found.cells.size(), cells.size() - 1);
  const auto figure = report::response_histories(found);
  ASSERT_TRUE(figure);
  std::set<std::string> colors;
  for (const auto& series : figure->series) colors.insert(series.color);
  EXPECT_EQ(colors.size(), figure->series.size());
  EXPECT_EQ(figure->series.back().name, "GetFEM [inaccurate]");
  const std::string whole = page();
  EXPECT_THAT(whole, HasSubstr("id=\"certificates\""));
  EXPECT_THAT(whole, HasSubstr("does not hold"));
  record(description(), three_methods(), picture_with_kinds());
  EXPECT_THAT(page(), Not(HasSubstr("id=\"certificates\"")));
}

TEST_F(ReportHistories, ComeFirstUnderTheSolution) {
  record_steps(to_and_fro(40));
  const std::string text = page();
  const auto place = [&](const char* words) { return text.find(words); };
  EXPECT_LT(place("<h2 id=\"solution\">"), place("id=\"response-histories\""));
  EXPECT_LT(place("id=\"response-histories\""), place("id=\"derivative-histories\""));
  EXPECT_LT(place("id=\"derivative-histories\""), place("id=\"tractions\""));
  EXPECT_LT(place("id=\"tractions\""), place("<h2 id=\"responses\">"));
}

}  // namespace
}  // namespace stickslip
