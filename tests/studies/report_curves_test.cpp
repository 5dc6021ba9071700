/// The rows and curves of the charts of a report.
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <map>
#include <nlohmann/json.hpp>
#include <set>
#include <string>
#include <tuple>
#include <vector>

#include "studies/report/charts.hpp"
#include "studies/report/labels.hpp"
#include "studies/report/records.hpp"
#include "tests/studies/recorded_study.hpp"
#include "tests/studies/report_page.hpp"
#include "tests/support/largest.hpp"

namespace stickslip {
namespace {

using nlohmann::json;
using recorded::cell;
using recorded::description;
using recorded::picture;
using recorded::three_methods;
using recorded::without_scripts;
using report::Against;
using report::Of;
using testing::AllOf;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::Not;

class ReportCurves : public recorded::StudyOnDisk {};

TEST_F(ReportCurves, GivesEachMethodAMarkerOfItsOwn) {
  std::vector<json> cells;
  for (const double scale : {1, 10, 100, 1000})
    for (const double tolerance : {1e-4, 1e-8})
      cells.push_back(cell("uzawa_al", {{"scale", scale}, {"tolerance", tolerance}}, tolerance, 10));
  for (const auto& c : three_methods())
    if (!c["method"].contains("uzawa_al")) cells.push_back(c);
  record(description(), cells);
  const auto figure = report::work_precision(study(), Against::same_mesh, Of::responses);
  std::set<std::string> shapes;
  std::set<std::vector<int>> dashes;  // of one method
  for (const auto& series : figure->series) {
    shapes.insert(series.shape);
    if (series.name.starts_with("Uzawa")) dashes.insert(series.dash);
  }
  EXPECT_EQ(figure->series.size(), 6u);
  EXPECT_EQ(shapes.size(), 6u);  // in grey the marker is all that tells
  EXPECT_EQ(dashes.size(), 4u);  // but where curves run beside one another
}

TEST_F(ReportCurves, DrawsErrorsOfExactlyZeroBelowAllOthersAndNamesThem) {
  record(description(), three_methods());
  const auto figure = report::work_precision(study(), Against::same_mesh, Of::responses);
  ASSERT_TRUE(figure);
  double least = 1;
  for (const auto& row : figure->rows)
    if (!row["zero"].get<bool>()) least = smaller(least, row["shown"].get<double>());
  int zeros = 0;
  for (const auto& row : figure->rows)
    if (row["zero"].get<bool>()) {
      ++zeros;
      EXPECT_EQ(row["error"], 0);
      EXPECT_GT(row["shown"], 0);
      EXPECT_LT(row["shown"], least);
    }
  EXPECT_EQ(zeros, 1);
}

TEST_F(ReportCurves, WithoutFrictionHasNoMeasuresOfIt) {
  auto cells = three_methods();
  for (auto& c : cells) c["errors"]["kkt"]["slip_direction"] = 0;
  json smooth = picture();
  for (auto& point : smooth["contact"]) point["state"] = "closed";
  record(description(), cells, smooth);
  EXPECT_TRUE(report::is_frictionless(study()));
  const auto figure = report::work_precision(study(), Against::coulomb, Of::responses);
  for (const auto& row : figure->rows) EXPECT_NE(row["quantity"], "slip direction");
  EXPECT_THAT(without_scripts(page()), AllOf(Not(HasSubstr("creep")), Not(HasSubstr("Coulomb"))));
  record(description(), cells, picture());
  EXPECT_FALSE(report::is_frictionless(study()));
  EXPECT_THAT(without_scripts(page()), AllOf(HasSubstr("penetrate and creep"), HasSubstr("Coulomb&#39;s law")));
}

TEST_F(ReportCurves, JoinsOneCurveAMethodAlongItsSweptKnob) {
  record(description(), three_methods());
  const auto s = study();
  EXPECT_EQ(report::running_knob(s, "penalty"), "stiffness");
  EXPECT_EQ(report::running_knob(s, "uzawa_al"), "tolerance");
  EXPECT_EQ(report::running_knob(s, "monolithic_al"), "");
  const auto figure = report::work_precision(s, Against::same_mesh, Of::responses);
  std::vector<std::string> names;
  for (const auto& series : figure->series) names.push_back(series.name);
  EXPECT_THAT(names, testing::ElementsAre("Penalty", "Uzawa AL", "Monolithic AL"));
  std::set<std::string> colors, shapes;
  for (const auto& series : figure->series) {
    colors.insert(series.color);
    shapes.insert(series.shape);
  }
  EXPECT_EQ(colors.size(), 3u);
  EXPECT_EQ(shapes.size(), 3u);  // apart in grey too
}

TEST_F(ReportCurves, RowsHoldWhatTheirWorkIsMadeOf) {
  record(description(), three_methods());
  for (const Of of : {Of::responses, Of::sensitivities}) {
    const auto figure = report::work_precision(study(), Against::same_mesh, of);
    for (const json& row : figure->rows) {
      const double counts = row["factorizations"], weighed = row["backsolves"], r = row["r"];
      EXPECT_NEAR(r, 0.1, 1e-15);
      EXPECT_DOUBLE_EQ(row["work"], counts + r * weighed);
    }
  }
}

TEST_F(ReportCurves, KeepsOtherKnobsApartAsCurvesOfTheirOwn) {
  std::vector<json> cells;
  for (const double scale : {1, 10})
    for (const double tolerance : {1e-4, 1e-8})
      cells.push_back(cell("uzawa_al", {{"scale", scale}, {"tolerance", tolerance}}, tolerance, 10));
  record(description(), cells);
  const auto figure = report::work_precision(study(), Against::same_mesh, Of::responses);
  ASSERT_EQ(figure->series.size(), 2u);
  EXPECT_EQ(figure->series[0].name, "Uzawa AL scale=1");
  EXPECT_THAT(figure->text, HasSubstr("Uzawa AL along tolerance"));
  EXPECT_NE(figure->series[0].color, figure->series[1].color);  // shades of the method's
  EXPECT_NE(figure->series[0].shape, figure->series[1].shape);
}

TEST_F(ReportCurves, DrawsMethodsWithoutTheKnobAsLevelLines) {
  record(description(), three_methods());
  const auto figure = report::error_against_knob(study(), {"stiffness"});
  ASSERT_TRUE(figure);
  std::set<double> ends;
  for (const auto& row : figure->rows)
    if (row.value("family", "") == "monolithic_al") ends.insert(row["option_value"].get<double>());
  EXPECT_THAT(ends, testing::ElementsAre(1e3, 1e9));
}

TEST_F(ReportCurves, DrawsAGuideOfSlopeMinusOneBesideThePenalty) {
  record(description(), three_methods());
  const auto figure = report::error_against_knob(study(), {"stiffness"});
  std::vector<std::pair<double, double>> guide;
  for (const auto& row : figure->rows)
    if (row.value("guide", false) && row["panel"] == "responses") guide.emplace_back(row["option_value"], row["error"]);
  ASSERT_EQ(guide.size(), 2u);
  // Error times stiffness is constant along it; both are products of few factors, so a few roundings apart at most.
  EXPECT_NEAR(guide[0].first * guide[0].second / (guide[1].first * guide[1].second), 1, 1e-14);
}

TEST_F(ReportCurves, DrawsNoGuideWhoseEndIsNoNumber) {
  std::vector<json> cells = three_methods();
  cells.push_back(cell("penalty", {{"stiffness", 5e-324}}, 1, 3));
  record(description(), cells);
  const auto figure = report::error_against_knob(study(), {"stiffness"});
  ASSERT_TRUE(figure);
  for (const auto& row : figure->rows) {
    EXPECT_TRUE(std::isfinite(row["error"].get<double>())) << row;
    EXPECT_FALSE(row.value("guide", false)) << row;
  }
}

TEST_F(ReportCurves, KeepsTheGuideBelowACurveThatDoesNotFollowIt) {
  std::vector<json> cells;
  for (const auto& [stiffness, error] : {std::pair{1, 1.18}, std::pair{10, 0.838}, std::pair{100, 0.0242}})
    cells.push_back(cell("penalty", {{"stiffness", stiffness}}, error, 10));
  record(description(), cells);
  const auto figure = report::error_against_knob(study(), {"stiffness"});
  for (const auto& row : figure->rows)
    if (row.value("guide", false) && row["panel"] == "responses" && row["option_value"] == 100) {
      EXPECT_LT(row["error"], 0.0242 / 2);
    }
}

/// A penalty without a stiffness has the automatic one, 1e3, and its place on the curve is there.
TEST_F(ReportCurves, PutsTheDefaultOfAnOptionWhereItsValueIs) {
  auto cells = three_methods();
  auto plain = cell("penalty", json::object(), 1e-3, 14);
  plain["method"] = {{"penalty", {{"stiffness", "auto"}, {"newton", {{"tolerance", 1e-10}}}}}};
  auto automatic = cell("penalty", {{"stiffness", "auto"}}, 1e-3, 14);
  cells.push_back(plain);
  cells.push_back(automatic);
  record(description(), cells);
  const auto s = study();
  for (const std::size_t i : {cells.size() - 2, cells.size() - 1})
    EXPECT_EQ(report::find_knob(s.cells[i], "stiffness")->value, 1e3);
  EXPECT_EQ(report::find_knob(s.cells.back(), "stiffness")->text, "auto");
  const auto figure = report::work_precision(s, Against::same_mesh, Of::responses);
  for (const auto& row : figure->rows)
    EXPECT_GE(row["order"].get<double>(), row["family"] == "penalty" ? 1e3 : 0) << row;
}

/// Options of other names are looked up as they were used.
TEST_F(ReportCurves, PutsATighterToleranceBesideTheOneThatIsTheDefault) {
  auto loose = cell("uzawa_al", {{"tolerance", 1e-4}}, 1e-5, 20),
       tight = cell("uzawa_al", {{"tolerance", 1e-9}}, 0, 40);
  auto plain = cell("uzawa_al", json::object(), 1e-7, 30);
  plain["method"] = {{"uzawa_al", {{"tolerance", 1e-6}}}};
  record(description(), {loose, tight, plain});
  EXPECT_EQ(report::find_knob(study().cells[2], "tolerance")->value, 1e-6);
}

TEST_F(ReportCurves, TreatsAnAbsoluteStiffnessAsAKnobOfItsOwn) {
  record(description(), {cell("penalty", {{"stiffness", {{"absolute", 1e3}}}}, 1e-3, 5),
                         cell("penalty", {{"stiffness", {{"absolute", 1e4}}}}, 1e-4, 5),
                         cell("penalty", {{"stiffness", "auto"}}, 1e-2, 5)});
  const auto s = study();
  EXPECT_THAT(report::knob_names(s), testing::ElementsAre("stiffness (absolute)"));
  EXPECT_EQ(report::series_of(s.cells[0], "stiffness (absolute)"), "Penalty");
  EXPECT_TRUE(report::error_against_knob(s, {"stiffness (absolute)"}));
}

TEST_F(ReportCurves, ShowsFirstTheSceneWhereMostRunsConverged) {
  auto cells = three_methods();
  for (auto& c : cells) c["vary"] = {{"/contacts/sole/friction", 0.1}};
  auto more = three_methods();
  for (auto& c : more) c["vary"] = {{"/contacts/sole/friction", 0.3}};
  more[0]["status"] = "cycle";
  cells.insert(cells.end(), more.begin(), more.end());
  record(description(), cells);
  EXPECT_EQ(study().main_variant, "friction = 0.1");
  EXPECT_THAT(page(), HasSubstr("Which setting works where"));
}

TEST_F(ReportCurves, JoinsMeshLevelsWhereThereAreSeveral) {
  auto cells = three_methods();
  record(description(), cells);
  EXPECT_FALSE(report::mesh_convergence(study()));
  auto finer = three_methods();
  for (auto& c : finer) c["refine"] = 1;
  cells.insert(cells.end(), finer.begin(), finer.end());
  record(description(), cells);
  const auto figure = report::mesh_convergence(study());
  ASSERT_TRUE(figure);
  std::map<std::string, std::set<double>> levels;
  for (const auto& row : figure->rows)
    if (row["panel"] == "seconds") levels[row["line"]].insert(row["level"].get<double>());
  EXPECT_EQ(levels.size(), 7u);
  for (const auto& [line, found] : levels) EXPECT_EQ(found.size(), 2u) << line;
}

/// Curves that lie on each other are one, which says of how many runs it is and how near they are.
TEST_F(ReportCurves, DrawsRunsThatAreAlikeOnEveryMeshAsOneCurve) {
  std::vector<json> cells;
  for (const int level : {0, 1}) {
    const double finer = level == 0 ? 1 : 0.25;
    auto on_mesh = three_methods();
    for (std::size_t i = 0; i < on_mesh.size(); ++i) {
      on_mesh[i]["refine"] = level;
      on_mesh[i]["errors"]["discretization"]["response:press"] = finer * (i == 0 ? 0.5 : i == 1 ? 0.0102 : 0.01);
    }
    cells.insert(cells.end(), on_mesh.begin(), on_mesh.end());
  }
  record(description(), cells);
  const auto figure = report::mesh_convergence(study());
  ASSERT_TRUE(figure);
  std::map<std::string, std::set<double>> errors;
  for (const auto& row : figure->rows)
    if (row["panel"] == "level") errors[row["line"]].insert(row["error"].get<double>());
  const std::map<std::string, std::set<double>> expected = {{"Penalty stiffness=1000", {0.125, 0.5}},
                                                            {"6 runs, within 2 %", {0.0025, 0.01}}};
  EXPECT_EQ(errors, expected);
}

TEST_F(ReportCurves, DrawsTractionsWithPressurePositiveAndTheClosedForm) {
  json study_json = description();
  study_json["analytic"] = {
      {"name", "hertz_line"},
      {"curves", {{"sole", {{"s", {0, 1, 2}}, {"normal", {0, -2, -1}}, {"tangential", {0, 0, 0}}}}}}};
  record(study_json, three_methods());
  const auto figure = report::tractions(study());
  ASSERT_TRUE(figure);
  EXPECT_EQ(figure->series.front().name, "closed form");
  for (const auto& row : figure->rows)
    if (row["panel"] == "pressure") {
      EXPECT_GE(row["value"], 0);
    }
  double largest = 0;  // distance of the softest penalty, whose pressure at the middle is off by 1e-3 of 2
  for (const auto& row : figure->rows)
    if (row["panel"] == "difference") largest = larger(largest, row["value"].get<double>());
  EXPECT_NEAR(largest, 0.5e-3, 1e-15);  // a difference of numbers near 2
}

TEST_F(ReportCurves, CountsDifferencesOfTractionsBelowRoundingAsNone) {
  auto cells = three_methods();
  json& tangential = cells[0]["interface"]["sole"]["tangential"];
  cells[0]["interface"]["sole"]["normal"] = cells.back()["interface"]["sole"]["normal"];
  tangential[0] = 1e-18;  // of a largest of 0.3; the point is open
  cells[0]["interface"]["sole"]["normal"][0] = -1e-18;
  record(description(), cells);
  const auto figure = report::tractions(study());
  ASSERT_TRUE(figure);
  int points = 0;
  for (const auto& row : figure->rows)
    if (row["panel"] == "difference" && row["label"] == "Penalty stiffness=1000") {
      EXPECT_EQ(row["value"], 0);
      ++points;
    }
  EXPECT_EQ(points, 3);
}

TEST_F(ReportCurves, ShowsTheHistoryOfTheHardestStep) {
  auto cells = three_methods();
  json steps = json::array();
  for (const int length : {2, 5, 3}) {
    json step = {{"time", length}, {"history", json::array()}};
    for (int i = 0; i < length; ++i) step["history"].push_back({{"residual", std::pow(10.0, -i)}});
    steps.push_back(step);
  }
  cells[0]["steps"] = steps;
  cells[1]["steps"] = steps;
  cells[1]["status"] = "cap";  // of a failed run, the last
  record(description(), cells);
  const auto figure = report::convergence_histories(study());
  std::map<std::string, int> iterations;
  for (const auto& row : figure->rows) ++iterations[row["label"]];
  EXPECT_EQ(iterations.at("Penalty stiffness=1000"), 5);
  EXPECT_EQ(iterations.at("Penalty stiffness=1e5"), 3);
  EXPECT_THAT(figure->text, HasSubstr("They are step 1, t = 1 ("));
  EXPECT_THAT(figure->text, HasSubstr("; step 2, t = 5 (1 run); step 3, t = 3 (1 run)."));
}

/// Meshes that are varied are a series by their unknowns; what varies beside them is chosen.
TEST_F(ReportCurves, ShowsTheErrorOfMeshesThatAreVaried) {
  std::vector<json> cells;
  for (const auto& [mesh, unknowns, error] : {std::tuple{"coarse.msh", 100, 0.04}, {"fine.msh", 400, 0.01}})
    for (const double friction : {0.1, 0.2}) {
      json row = cell("monolithic_al", json::object(), 0, 3);
      row["id"] = fmt::format("{} {}", mesh, friction);
      row["vary"] = {{"/bodies/a/mesh/gmsh", mesh}, {"/contacts/c/friction", friction}};
      row["size"]["displacements"] = unknowns;
      row["errors"]["discretization"] = {{"response:press", error}};
      cells.push_back(row);
    }
  json study = description();
  study["vary"] = {{"meshes", {{"/bodies/a/mesh/gmsh", {"coarse.msh", "fine.msh"}}, {"/time/steps", {1, 2}}}},
                   {"/contacts/c/friction", {0.1, 0.2}}};
  record(study, cells);
  const auto figure = report::mesh_convergence(this->study());
  ASSERT_TRUE(figure);
  std::map<std::string, std::vector<double>> of;
  for (const auto& row : figure->rows)
    if (row["panel"] == "level" && row["quantity"] == "press")
      of[row["scene"]].insert(of[row["scene"]].end(), {row["level"], row["error"]});
  EXPECT_THAT(of.at("friction = 0.1"), ElementsAre(100, 0.04, 400, 0.01));
  EXPECT_EQ(of.size(), 2u);
}

/// The last iterate stands at the number that the table of steps gives.
TEST_F(ReportCurves, CountsTheIterationsOfAHistoryAsTheStepTableDoes) {
  auto cells = three_methods();
  const auto step = [](int newton, const std::vector<int>& augmentations) {
    json step = {{"time", 1}, {"newton", newton}, {"history", json::array()}};
    for (const int augmentation : augmentations)
      step["history"].push_back({{"residual", 0.1}, {"augmentation", augmentation}});
    return json::array({step});
  };
  cells[0]["steps"] = step(2, {0, 0, 0});           // a guess and two iterations
  cells[1]["steps"] = step(3, {0, 0, 0});           // the first was a prediction
  cells[2]["steps"] = step(3, {1, 1, 1, 2, 2, 3});  // three solves, of which the last had nothing to do
  record(description(), cells);
  std::map<std::string, std::vector<int>> counts;
  const auto figure = report::convergence_histories(study());
  for (const auto& row : figure->rows) counts[row["label"]].push_back(row["iteration"]);
  EXPECT_THAT(counts.at("Penalty stiffness=1000"), ElementsAre(0, 1, 2));
  EXPECT_THAT(counts.at("Penalty stiffness=1e5"), ElementsAre(1, 2, 3));
  EXPECT_THAT(counts.at("Penalty stiffness=1e7"), ElementsAre(0, 1, 2, 2, 3, 3));
}

}  // namespace
}  // namespace stickslip
