/// The numbers of a report: headline, tables and the rows of its charts.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <nlohmann/json.hpp>
#include <set>

#include "studies/report/charts.hpp"
#include "studies/report/headline.hpp"
#include "studies/report/html.hpp"
#include "studies/report/labels.hpp"
#include "studies/report/records.hpp"
#include "studies/report/report.hpp"
#include "tests/studies/recorded_study.hpp"
#include "tests/studies/report_page.hpp"
#include "tests/support/largest.hpp"

namespace stickslip {
namespace {

using nlohmann::json;
using recorded::all_of;
using recorded::cell;
using recorded::description;
using recorded::picture;
using recorded::three_methods;
using recorded::without_scripts;
using report::Against;
using report::Of;
using testing::AllOf;
using testing::HasSubstr;
using testing::Not;

class ReportNumbers : public recorded::StudyOnDisk {};

/// On which side of their points the words of the chart against work stand.
std::map<std::string, std::string> sides_of_words(const report::Figure& figure) {
  std::map<std::string, std::string> out;
  for (const auto& row : figure.rows)
    if (row.contains("tag_work")) out[row["tag_work"]] = row["tag_work_at"];
  return out;
}

TEST(ReportText, WritesNumbersInOneStyle) {
  const std::vector<std::pair<double, const char*>> shown = {
      {0, "0"},         {1e7, "1e7"},           {10000000000.0, "1e10"}, {1234.5, "1234"}, {9999.7, "1e4"},
      {0.001, "0.001"}, {1e-4, "1e-4"},         {-2.5e-6, "-2.5e-6"},    {0.3, "0.3"},     {1.5e4, "1.5e4"},
      {100, "100"},     {0.00123456, "0.00123"}};
  for (const auto& [value, text] : shown) EXPECT_EQ(report::number(value), text);
  EXPECT_EQ(report::number(INFINITY), "");
  EXPECT_EQ(report::exact_number(1.0 / 3), "0.3333333333333333");
  EXPECT_EQ(report::exact_number(1e7 + 1), "1.0000001e7");
  EXPECT_EQ(report::whole(123456), "123456");
}

TEST(ReportText, PutsTheNumbersOfALabelInThatStyle) {
  EXPECT_EQ(report::with_exact_numbers("penalty stiffness=10000000000.0 ratio=0.25"),
            "penalty stiffness=1e10 ratio=0.25");
  EXPECT_EQ(report::with_exact_numbers("uzawa_al acceleration=none  tolerance=1e-08"),
            "uzawa_al acceleration=none  tolerance=1e-8");
  EXPECT_EQ(report::with_exact_numbers("a=b=1e+06 =x b=inf"), "a=b=1e6 =x b=inf");
  EXPECT_EQ(report::with_exact_numbers("stiffness={\"absolute\":2400.0}"), "stiffness={\"absolute\":2400.0}");
}

TEST_F(ReportNumbers, WeighsBackSolvesByTheirMeasuredCost) {
  record(description(), three_methods());
  const auto s = study();
  // 14 factorisations and 28 back-solves at a tenth each: exact but for the rounding of these few sums.
  EXPECT_NEAR(s.ratio.at(0), 0.1, 1e-14);
  EXPECT_NEAR(s.cells[0].work, 14 + 2.8, 1e-12);
  EXPECT_NEAR(s.cells[0].sensitivity_work, 14 + 2.9, 1e-12);
  EXPECT_NEAR(s.cells[0].seconds, 28 - 0.1, 1e-12);
}

TEST_F(ReportNumbers, HeadlineSaysHowThePenaltysErrorFallsAndLeavesTheCheapestToTheVerdict) {
  record(description(), three_methods());
  const std::string text = all_of(report::headline(study()));
  EXPECT_THAT(text, HasSubstr("Penalty's error falls as stiffness to the power -1 down to 1e-9 at stiffness 1e9."));
  EXPECT_THAT(text, Not(HasSubstr("factorisations")));
}

TEST_F(ReportNumbers, HeadlineSaysForWhichSceneThePenaltysErrorFallsAndWhereItFails) {
  auto cells = three_methods();
  for (auto& c : cells) c["vary"] = {{"friction", 1}};
  auto others = three_methods();
  for (auto& c : others) c["vary"] = {{"friction", 0.3}};
  others[3]["status"] = "cap";
  cells.insert(cells.begin(), others.begin(), others.end());
  record(description(), cells);
  EXPECT_THAT(all_of(report::headline(study())),
              HasSubstr("Penalty's error for friction = 1 falls as stiffness to the power -1 down to 1e-9 at stiffness "
                        "1e9. It fails at 1e9 (cap) for friction = 0.3."));
}

TEST_F(ReportNumbers, NamesWhatTheDiscretisationErrorIsAgainst) {
  json study_json = description();
  const json method = {{"method", {{"monolithic_al", json::object()}}}}, fine = {{"overkill", {{"refine", 2}}}};
  const json closed = {{"analytic", "hertz_line"}}, given = {{"values", {{"press", 9.9}}}};
  for (const auto& [references, words] :
       {std::pair{json{method, closed}, "the closed form"}, std::pair{json{method, fine}, "the finer mesh"},
        std::pair{json{given}, "the given values"}, std::pair{json{closed, fine}, "the references"}}) {
    study_json["reference"] = references;
    record(study_json, three_methods());
    EXPECT_EQ(report::discretization_reference(study()), words);
    const auto figure = report::work_precision(study(), Against::discretization, Of::responses);
    EXPECT_EQ(figure->title, std::string("Responses: error against ") + words);
    EXPECT_THAT(all_of(report::headline(study())),
                HasSubstr(std::string("Against ") + words + " the run that enforces contact best"));
    EXPECT_THAT(page(), HasSubstr(std::string("response error to ") + words));
  }
}

TEST_F(ReportNumbers, HeadlineSaysWhatTheDistanceFromAReferenceIs) {
  auto cells = three_methods();
  json told = description();
  const auto said = [&](const json& reference) {
    told["reference"] = {reference};
    record(told, cells);
    return all_of(report::headline(study()));
  };
  EXPECT_THAT(said({{"analytic", "hertz_line"}}), HasSubstr("1 % in its worst response: that is mesh and steps, and"));
  EXPECT_THAT(said({{"overkill", {{"refine", 1}}}}), HasSubstr("worst response: that is the mesh, and"));
  EXPECT_THAT(said({{"values", {{"press", 1}}}}), HasSubstr("that is mesh, steps or the references themselves, and"));
  for (auto& c : cells) c["errors"]["discretization"]["response:press"] = 4e-16;
  EXPECT_THAT(said({{"analytic", "hertz_line"}}),
              AllOf(HasSubstr("off by 4e-16 in its worst response, which is rounding."), Not(HasSubstr("that is"))));
}

/// A run that is nearer by accident does not tell what the mesh is off by: the verdict does not name it either.
TEST_F(ReportNumbers, HeadlineTakesTheMeshsErrorOfTheRunThatEnforcesContactBest) {
  auto cells = three_methods();
  cells[0]["errors"]["discretization"]["response:press"] = 1e-5;
  record(description(), cells);
  EXPECT_THAT(all_of(report::headline(study())), HasSubstr("is off by 1 % in its worst response"));
  EXPECT_EQ(report::own_error(study(), Of::responses), 0.01);
}

TEST_F(ReportNumbers, FoldsAwayWhatIsExactForMostRuns) {
  auto cells = three_methods();
  for (auto& c : cells) c["errors"]["discretization"]["response:press"] = 1e-15;
  cells[0]["errors"]["discretization"]["response:press"] = 0.5;
  record(description(), cells);
  EXPECT_EQ(report::work_precision(study(), Against::discretization, Of::responses)->folded,
            "6 of 7 runs are exact to rounding");
  for (std::size_t i = 0; i < 4; ++i)
    cells[i]["errors"]["discretization"]["response:press"] = cells[i]["errors"]["enforcement"]["response:press"];
  record(description(), cells);
  EXPECT_EQ(report::work_precision(study(), Against::discretization, Of::responses)->folded,
            "4 of 7 runs are off by what they enforce contact with, as above, 3 exact to rounding");
}

TEST(ReportText, KeepsSmallNumbersOnOneLine) {
  EXPECT_EQ(report::escape_sentence("a <1.3e-05"), "a &lt;<span class=\"number\">1.3e-5</span>");
  EXPECT_EQ(report::in_plain_words("converged_at_roundoff"), "converged at roundoff");
}

/// The KKT measures are no errors: nothing may be called accurate by them.
TEST_F(ReportNumbers, OfAStudyWithoutReferencesSaysThatNoErrorWasMeasured) {
  auto cells = three_methods();
  for (auto& c : cells)
    for (const char* kind : {"enforcement", "discretization"}) c["errors"][kind] = json::object();
  record(description(), cells);
  EXPECT_THAT(all_of(report::headline(study())), HasSubstr("No error was measured"));
  const std::string html = without_scripts(page());
  EXPECT_THAT(html, AllOf(Not(HasSubstr("accurate enough")), Not(HasSubstr("within 1e-6")), Not(HasSubstr("Profiles")),
                          Not(HasSubstr("class=\"failed\""))));
  record(description(), three_methods());
  EXPECT_THAT(all_of(report::headline(study())), Not(HasSubstr("No error was measured")));
}

TEST_F(ReportNumbers, OfAMergedStudySaysWhatTheCommandWas) {
  json merged = description();
  merged["command"] = "stickslip merge p1 p2 -o m";
  merged["cells"] = {"none"};
  record(merged, three_methods());
  const std::string html = without_scripts(page());
  EXPECT_THAT(html, AllOf(HasSubstr("joined by:</p><pre>stickslip merge p1 p2 -o m"), HasSubstr("and merge again"),
                          Not(HasSubstr("This repeats the study")), Not(HasSubstr("the command at the end"))));
}

TEST_F(ReportNumbers, LeavesOutOfNamesWhatTellsNoRunsApart) {
  std::vector<json> cells;
  for (const char* acceleration : {"none", "anderson"})
    for (const double scale : {1, 10})
      cells.push_back(cell("uzawa_al", {{"acceleration", acceleration}, {"limit", 50}, {"scale", scale}}, 1e-5, 10));
  cells.push_back(cell("uzawa_al", {{"scale", 1}}, 1e-5, 10));
  for (auto& c : cells) c["knobs"].erase("limit");  // given, but not swept
  record(description(), cells);
  const auto s = study();
  EXPECT_THAT(s.shared, testing::ElementsAre("Uzawa AL limit=50"));
  // The last would be "uzawa_al scale=1.0" twice without the acceleration.
  EXPECT_THAT(s.cells[0].label, AllOf(HasSubstr("acceleration"), HasSubstr("scale"), Not(HasSubstr("limit"))));
  EXPECT_THAT(page(), HasSubstr("tells none apart: Uzawa AL limit=50"));
}

/// A switch that all names have is told where it is not as usual; a word that no other option has stands alone.
TEST_F(ReportNumbers, NamesOfRunsAreShortAndSayWhatTheyLeaveOut) {
  std::vector<json> cells;
  const auto add = [&](const std::string& label) {
    cells.push_back(cell("uzawa_al", {{"scale", 1}}, 1e-5, 10));
    cells.back()["label"] = "uzawa_al " + label;
  };
  const auto labels = [&] {
    record(description(), cells);
    std::vector<std::string> out;
    for (const auto& c : study().cells) out.push_back(c.label);
    return out;
  };
  for (const char* options :
       {"acceleration=none adapt=false scale=100", "acceleration=anderson adapt=false scale=10", "adapt=true scale=10",
        "acceleration=anderson adapt=false sensitivity=oversized scale=10"})
    add(options);
  EXPECT_THAT(labels(), testing::ElementsAre("Uzawa AL acceleration=none scale=100", "Uzawa AL anderson scale=10",
                                             "Uzawa AL adapt=true scale=10", "Uzawa AL anderson oversized scale=10"));
  EXPECT_THAT(study().understood, testing::ElementsAre("Uzawa AL adapt=false"));
  EXPECT_THAT(page(), HasSubstr("Where not named: adapt=false."));
  EXPECT_EQ(report::series_of(study().cells[3], "acceleration"), "Uzawa AL oversized scale=10");
  EXPECT_EQ(report::series_of(study().cells[3], "scale"), "Uzawa AL anderson oversized");
  add("cone=anderson scale=10");  // the word is of two options, and these names do not have the switch
  add("cone=frozen scale=10");
  EXPECT_EQ(labels()[1], "Uzawa AL acceleration=anderson adapt=false scale=10");
  EXPECT_THAT(study().understood, testing::IsEmpty());
}

TEST_F(ReportNumbers, GivesEachMethodAMarkerOfItsOwn) {
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

TEST_F(ReportNumbers, KeepsErrorsAndCostsInTablesOfTheirOwn) {
  record(description(), three_methods());
  const std::string html = page();
  const std::size_t errors = html.find("<caption>All runs: errors"), costs = html.find("<caption>All runs: costs");
  ASSERT_LT(errors, costs);
  EXPECT_THAT(html.substr(errors, costs - errors), AllOf(HasSubstr("KKT"), Not(HasSubstr(">seconds<"))));
  EXPECT_THAT(html.substr(costs), HasSubstr(">seconds<"));
}

TEST_F(ReportNumbers, KeepsLongMessagesOutOfTheTableOfAllRuns) {
  auto cells = three_methods();
  cells[0]["message"] = "a long story";
  record(description(), cells);
  const std::string html = page();
  EXPECT_GT(html.find("<td>a long story</td>"), html.find("Messages of the runs"));
}

TEST_F(ReportNumbers, SaysOfTheSceneWhatHoldsForEveryMethod) {
  json study_json = description();
  study_json["explain"] = "unknowns: 10 displacements, 4 multipliers\nmethod: {\"penalty\":{}}\nsimulated:\n";
  record(study_json, three_methods());
  EXPECT_THAT(page(), AllOf(HasSubstr("unknowns: 10 displacements\nsimulated:"), Not(HasSubstr("method: {"))));
}

TEST_F(ReportNumbers, TablesSayOnceWhatHoldsInEveryRow) {
  report::Table table{{"method", "cutbacks", "error"}, {{"a", "0", "1"}, {"b", "0", "2"}}, {}};
  EXPECT_EQ(report::take_out_constant_columns(table), "In every row: cutbacks 0.");
  EXPECT_THAT(table.header, testing::ElementsAre("method", "error"));
  EXPECT_THAT(table.rows[1], testing::ElementsAre("b", "2"));
}

TEST_F(ReportNumbers, HeadsOfNumbersStandOverThem) {
  const std::string html =
      report::to_html({{"method", "error", "status"}, {{"a", "1", "2"}, {"b", "", "cap"}}, {}}, "");
  EXPECT_THAT(html, AllOf(HasSubstr("<th scope=\"col\">method</th>"), HasSubstr("class=\"n\">error</th>"),
                          HasSubstr("<th scope=\"col\">status</th>")));
}

/// No table is wider than a sheet of paper: six numbers a run.
TEST_F(ReportNumbers, ValuesAreATableForEachResponse) {
  auto cells = three_methods();
  double value = 0;
  for (auto& c : cells) {
    c["responses"]["pull"] = c["responses"]["press"] = ++value;
    for (int p = 0; p < 8; ++p) c["sensitivities"]["press"]["p" + std::to_string(p)] = ++value;
  }
  record(description(), cells);
  const std::string html = page();
  const auto tables = [&](const std::string& caption) {
    int n = 0;
    for (auto at = html.find("<caption>" + caption); at != std::string::npos;
         at = html.find("<caption>" + caption, at + 1))
      ++n;
    return n;
  };
  EXPECT_EQ(tables("Last step: press<"), 2);
  EXPECT_EQ(tables("Last step: pull<"), 1);
}

TEST_F(ReportNumbers, HeadlineSeesRoundingLiftThePenaltysError) {
  auto cells = three_methods();
  cells.push_back(cell("penalty", {{"stiffness", 1e12}}, 3e-4, 14));
  record(description(), cells);
  EXPECT_THAT(all_of(report::headline(study())), HasSubstr("and rises again beyond it, to 3e-4 at 1e12"));
}

TEST_F(ReportNumbers, DrawsErrorsOfExactlyZeroBelowAllOthersAndNamesThem) {
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
  EXPECT_THAT(page(), HasSubstr("exactly 0"));
}

/// Two lines end at one point: the second has its name at its beginning, left of a point that stands far right.
TEST_F(ReportNumbers, NamesALineAtItsOtherEndWhereAnotherNameStands) {
  std::vector<json> cells;
  for (const int scale : {1, 10})
    for (const double tolerance : {1e-4, 1e-8}) {
      const int factorizations = tolerance == 1e-4 ? 10 : scale == 1 ? 12 : 40;
      cells.push_back(cell("uzawa_al", {{"scale", scale}, {"tolerance", tolerance}}, tolerance, factorizations));
    }
  record(description(), cells);
  const auto side = sides_of_words(*report::work_precision(study(), Against::same_mesh, Of::responses));
  EXPECT_TRUE(side.count("Uzawa AL scale=1, 1e-4"));
  EXPECT_FALSE(side.count("Uzawa AL scale=10, 1e-4"));
  ASSERT_TRUE(side.count("Uzawa AL scale=10, 1e-8"));
  EXPECT_THAT(side.at("Uzawa AL scale=10, 1e-8"), testing::StartsWith("left"));
}

/// On its right stand the markers of another curve.
TEST_F(ReportNumbers, NamesNoLineAcrossMarkersOfAnother) {
  std::vector<json> cells = {cell("uzawa_al", json::object(), 1e-4, 100)};
  for (const int stiffness : {1, 2, 3}) cells.push_back(cell("penalty", {{"stiffness", stiffness}}, 1e-4, 105));
  for (const std::size_t i : {1u, 2u, 3u}) {
    cells[i]["cost"]["counts"]["factorizations"] = 100 + 20 * i;
    cells[i]["errors"]["enforcement"]["response:press"] = 1e-4 * (1 + 0.1 * static_cast<double>(i));
  }
  record(description(), cells);
  const auto side = sides_of_words(*report::work_precision(study(), Against::same_mesh, Of::responses));
  ASSERT_TRUE(side.count("Uzawa AL"));
  EXPECT_NE(side.at("Uzawa AL"), "right");
}

TEST_F(ReportNumbers, WithoutFrictionHasNoMeasuresOfIt) {
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

TEST_F(ReportNumbers, JoinsOneCurveAMethodAlongItsSweptKnob) {
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

TEST_F(ReportNumbers, KeepsOtherKnobsApartAsCurvesOfTheirOwn) {
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

TEST_F(ReportNumbers, DrawsMethodsWithoutTheKnobAsLevelLines) {
  record(description(), three_methods());
  const auto figure = report::error_against_knob(study(), {"stiffness"});
  ASSERT_TRUE(figure);
  std::set<double> ends;
  for (const auto& row : figure->rows)
    if (row.value("family", "") == "monolithic_al") ends.insert(row["option_value"].get<double>());
  EXPECT_THAT(ends, testing::ElementsAre(1e3, 1e9));
}

TEST_F(ReportNumbers, DrawsAGuideOfSlopeMinusOneBesideThePenalty) {
  record(description(), three_methods());
  const auto figure = report::error_against_knob(study(), {"stiffness"});
  std::vector<std::pair<double, double>> guide;
  for (const auto& row : figure->rows)
    if (row.value("guide", false) && row["panel"] == "responses") guide.emplace_back(row["option_value"], row["error"]);
  ASSERT_EQ(guide.size(), 2u);
  // Error times stiffness is constant along it; both are products of few factors, so a few roundings apart at most.
  EXPECT_NEAR(guide[0].first * guide[0].second / (guide[1].first * guide[1].second), 1, 1e-14);
}

/// A penalty without a stiffness has the automatic one, 1e3, and its place on the curve is there.
TEST_F(ReportNumbers, PutsTheDefaultOfAnOptionWhereItsValueIs) {
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
TEST_F(ReportNumbers, PutsATighterToleranceBesideTheOneThatIsTheDefault) {
  auto loose = cell("uzawa_al", {{"tolerance", 1e-4}}, 1e-5, 20),
       tight = cell("uzawa_al", {{"tolerance", 1e-9}}, 0, 40);
  auto plain = cell("uzawa_al", json::object(), 1e-7, 30);
  plain["method"] = {{"uzawa_al", {{"tolerance", 1e-6}}}};
  record(description(), {loose, tight, plain});
  EXPECT_EQ(report::find_knob(study().cells[2], "tolerance")->value, 1e-6);
}

TEST_F(ReportNumbers, TreatsAnAbsoluteStiffnessAsAKnobOfItsOwn) {
  record(description(), {cell("penalty", {{"stiffness", {{"absolute", 1e3}}}}, 1e-3, 5),
                         cell("penalty", {{"stiffness", {{"absolute", 1e4}}}}, 1e-4, 5),
                         cell("penalty", {{"stiffness", "auto"}}, 1e-2, 5)});
  const auto s = study();
  EXPECT_THAT(report::knob_names(s), testing::ElementsAre("stiffness (absolute)"));
  EXPECT_EQ(report::series_of(s.cells[0], "stiffness (absolute)"), "Penalty");
  EXPECT_TRUE(report::error_against_knob(s, {"stiffness (absolute)"}));
}

TEST_F(ReportNumbers, ShowsFirstTheSceneWhereMostRunsConverged) {
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

TEST_F(ReportNumbers, NamesWhatVariesByAsMuchOfItsPlaceAsTellsItApart) {
  auto cells = three_methods();
  for (auto& c : cells)
    c["vary"] = {{"/contacts/sole/friction", 0.1}, {"/contacts/heel/friction", 0.2}, {"/bodies/a/size/0", 3}};
  record(description(), cells);
  EXPECT_EQ(study().main_variant, "size/0 = 3, heel/friction = 0.2, sole/friction = 0.1");
}

TEST_F(ReportNumbers, JoinsMeshLevelsWhereThereAreSeveral) {
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
TEST_F(ReportNumbers, DrawsRunsThatAreAlikeOnEveryMeshAsOneCurve) {
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

TEST_F(ReportNumbers, DrawsTractionsWithPressurePositiveAndTheClosedForm) {
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

TEST_F(ReportNumbers, CountsDifferencesOfTractionsBelowRoundingAsNone) {
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

TEST_F(ReportNumbers, ShowsTheHistoryOfTheHardestStep) {
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
}

}  // namespace
}  // namespace stickslip
