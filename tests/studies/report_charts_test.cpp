/// Where methods work, profiles and films: charts of all runs of a study.
#include <fmt/format.h>
#include <gmock/gmock.h>

#include "studies/io/atomic_file.hpp"
#include "studies/report/charts.hpp"
#include "studies/report/colors.hpp"
#include "studies/report/embedded.hpp"
#include "studies/report/html.hpp"
#include "tests/studies/recorded_study.hpp"
#include "tests/support/largest.hpp"

namespace stickslip::report_charts {
namespace {

using recorded::cell;
using recorded::description;
using recorded::in_two_scenes;
using recorded::json;
using recorded::three_methods;
using recorded::with_failure;
using report::Contestant;
using report::Of;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::Not;

class ReportCharts : public recorded::StudyOnDisk {};

// --- robustness windows --------------------------------------------------------------------------------------------

TEST_F(ReportCharts, WindowsEndWhereARunFailed) {
  record(description(), with_failure());
  const auto plate = report::robustness_windows(study(), {"stiffness"});
  ASSERT_TRUE(plate);
  ASSERT_EQ(plate->table.rows.size(), 1u);
  EXPECT_THAT(plate->table.rows[0], ElementsAre("Penalty", "4", "1000 to 1e5, 1e9", "1e7 (not_finite)"));
}

TEST_F(ReportCharts, WindowsAreOneForEachSettingAndScene) {
  record(description(), in_two_scenes(three_methods()));
  EXPECT_EQ(report::robustness_windows(study(), {"stiffness"})->table.rows.size(), 2u);
  EXPECT_EQ(report::robustness_windows(study(), {"tolerance"})->table.rows.size(), 2u);
  EXPECT_FALSE(report::robustness_windows(study(), {"scale"}));
}

/// The automatic choice stands at the value that it stands for. A soft penalty that takes fewer iterations errs more,
/// and is not what it is held against: 40 iterations at 1e3 and 1e5 stand beside 10 at 10, and beside 20 at 1e7.
TEST_F(ReportCharts, WindowsMarkTheAutomaticChoiceAndWhatItCosts) {
  std::vector<json> cells;
  for (const auto& [stiffness, error, iterations] :
       {std::tuple{10.0, 1e-1, 10}, {1e3, 1e-3, 40}, {1e5, 1e-5, 40}, {1e7, 1e-7, 20}, {1e9, 1e-9, 25}})
    cells.push_back(cell("penalty", {{"stiffness", stiffness}}, error, iterations));
  auto automatic = cell("penalty", {{"stiffness", "auto"}}, 1e-3, 30);
  automatic["method"] = {{"penalty", {{"stiffness", "auto"}}}};
  cells.push_back(automatic);
  record(description(), cells);
  const auto plate = report::robustness_windows(study(), {"stiffness"});
  ASSERT_TRUE(plate);
  EXPECT_EQ(plate->folded, "");
  EXPECT_EQ(plate->table.header.back(), "automatic choice");
  EXPECT_THAT(plate->table.rows[0],
              ElementsAre("Penalty", "6", "10 to 1e9", "", "1000, inside: 30 iterations, 1.50 of the least"));
  std::map<double, double> times;
  for (const auto& row : plate->rows) {
    if (row["automatic"])
      EXPECT_EQ(row["iterations_over_least"], 1.5);
    else
      times[row["option_value"]] = row["iterations_over_least"];
  }
  EXPECT_EQ(times, (std::map<double, double>{{10, 1}, {1e3, 2}, {1e5, 2}, {1e7, 1}, {1e9, 1.25}}));
  const std::string svg = plate->drawing.svg_file();
  EXPECT_THAT(svg, HasSubstr(">1.5<"));
  EXPECT_THAT(svg, HasSubstr(">automatic<"));
  EXPECT_THAT(svg, HasSubstr("1000 (automatic): converged, 30 iterations, 1.50 of the least"));
}

/// At the end of a window, beside a run that failed, the automatic choice is not inside.
TEST_F(ReportCharts, WindowsSayWhereTheAutomaticChoiceIsAtTheirEnd) {
  std::vector<json> cells;
  for (const double scale : {1.0, 100.0}) cells.push_back(cell("uzawa_al", {{"scale", scale}}, 1e-9, 10));
  cells.back()["status"] = "cap";
  auto automatic = cell("uzawa_al", {{"scale", "auto"}}, 1e-9, 10);
  automatic["method"] = {{"uzawa_al", {{"scale", "auto"}}}};
  automatic["automatic"] = 10;
  cells.push_back(automatic);
  record(description(), cells);
  const auto plate = report::robustness_windows(study(), {"scale"});
  ASSERT_TRUE(plate);
  EXPECT_EQ(plate->table.rows[0].back(), "10, not inside: 10 iterations, 1.00 of the least");
}

/// Narrow enough for a phone at its own size; wider where a name asks for it.
TEST_F(ReportCharts, WindowsAreReadableOnAPhone) {
  const auto width = [&] {
    const std::string svg = report::robustness_windows(study(), {"stiffness"})->drawing.inline_svg();
    return std::stod(svg.substr(svg.find("viewBox=\"0 0 ") + 13));
  };
  record(description(), with_failure());
  EXPECT_LE(width(), 375);  // what most phones have
  EXPECT_THAT(report::robustness_windows(study(), {"stiffness"})->drawing.inline_svg(), HasSubstr(" narrow\""));
  auto cells = with_failure();
  for (auto& c : cells) c["vary"] = {{"/contacts/sole/" + std::string(80, 'x'), 0.3}};
  record(description(), cells);
  EXPECT_GT(width(), report::text_width("Penalty, " + std::string(80, 'x') + " = 0.3", 11));
}

// --- settings and profiles -----------------------------------------------------------------------------------------

TEST_F(ReportCharts, TunedIsTheCheapestThatIsAccurateEnoughAndStrictTheMostAccurate) {
  auto cells = three_methods();
  cells[0]["default"] = true;
  record(description(), cells);
  const auto s = study();
  const auto all = report::contestants(s, {{"", 1e-4}}, Of::responses);
  std::map<std::pair<std::string, std::string>, const Contestant*> by_name;
  for (const auto& each : all) by_name[{each.family, name_of(each.setting)}] = &each;
  const auto stiffness = [&](const char* setting) {
    return by_name.at({"penalty", setting})->cells[0]->record["knobs"]["stiffness"].get<double>();
  };
  EXPECT_EQ(stiffness("default"), 1e3);  // misses the accuracy, and stays in the comparison
  EXPECT_FALSE(by_name.at({"penalty", "default"})->work(0, {{"", 1e-4}}, Of::responses));
  EXPECT_EQ(stiffness("tuned"), 1e5);  // as cheap as 1e7, and found first
  EXPECT_EQ(stiffness("strict"), 1e9);
  EXPECT_EQ(by_name.count({"uzawa_al", "default"}), 0u);  // not run
}

TEST_F(ReportCharts, ProfilesAreStaircasesOfSharesSolved) {
  record(description(), in_two_scenes(three_methods()));
  const auto figure = report::profiles(study(), Of::responses);
  ASSERT_TRUE(figure);
  // Accuracies 1e-2 ... 1e-10, all reached by the monolithic run, the last by it alone, and always for the least work.
  std::map<std::string, double> last, before;
  for (const auto& row : figure->rows) {
    if (row["panel"] != "factor") continue;
    const std::string name = row["series"];
    EXPECT_GE(row["share"].get<double>(), before[name]) << name;
    before[name] = last[name] = row["share"];
    EXPECT_GE(row["x"].get<double>(), 1);
  }
  EXPECT_EQ(last.at("Monolithic AL, tuned"), 1);
  EXPECT_EQ(last.at("Penalty, tuned"), 0.8);
  for (const auto& row : figure->rows)
    if (row["series"] == "Monolithic AL, tuned" && row["panel"] == "factor" && !row["unmarked"].get<bool>()) {
      EXPECT_EQ(row["x"], 1);
    }
}

TEST_F(ReportCharts, ThereAreNoProfilesOfASingleScene) {
  record(description(), three_methods());
  EXPECT_FALSE(report::profiles(study(), Of::responses));
}

TEST_F(ReportCharts, ProfilesKeepAMethodThatSolvesNothing) {
  auto cells = three_methods();
  for (auto& c : cells)
    if (c["method"].contains("uzawa_al")) c["status"] = "cap";
  record(description(), in_two_scenes(cells));
  const auto figure = report::profiles(study(), Of::responses);
  ASSERT_TRUE(figure);
  double most = -1;
  for (const auto& row : figure->rows)
    if (row["series"] == "Uzawa AL, tuned") most = larger(most, row["share"].get<double>());
  EXPECT_EQ(most, 0);
}

// --- the film ------------------------------------------------------------------------------------------------------

TEST_F(ReportCharts, FilmCountsStatesAtEveryStep) {
  auto cells = three_methods();
  for (auto& c : cells) c["film"] = {{"times", {0.5, 1}}, {"contacts", {{"sole", {"okk", "sko"}}}}};
  record(description(), cells);
  const auto plate = report::film_of_states(study());
  ASSERT_TRUE(plate);
  EXPECT_THAT(plate->table.header, ElementsAre("method", "contact", "time", "stick", "slip", "open"));
  EXPECT_THAT(plate->table.rows[0], ElementsAre("Penalty stiffness=1000", "sole", "0.5", "2", "0", "1"));
  EXPECT_THAT(plate->table.rows[1], ElementsAre("Penalty stiffness=1000", "sole", "1", "1", "1", "1"));
}

TEST_F(ReportCharts, FilmHasRoomForItsTimes) {
  auto cells = three_methods();
  for (auto& c : cells) c["film"] = {{"times", {0.0222, 1}}, {"contacts", {{"sole", {"okk", "sko"}}}}};
  record(description(), cells);
  const std::string svg = report::film_of_states(study())->drawing.inline_svg(), head = "<text x=\"";
  const auto text = svg.rfind(head, svg.find(">0.0222<"));  // which ends there
  EXPECT_GE(std::stod(svg.substr(text + head.size())), report::text_width("0.0222", 10));
}

TEST_F(ReportCharts, FilmShowsOnceWhatAllRunsAgreeOn) {
  auto cells = three_methods();
  for (auto& c : cells) c["film"] = {{"times", {0.5, 1}}, {"contacts", {{"sole", {"okk", "sko"}}}}};
  record(description(), cells);
  EXPECT_THAT(report::film_of_states(study())->text, HasSubstr("the same in the most accurate run of each method"));
  EXPECT_EQ(report::film_of_states(study())->table.rows.size(), 2u);
  cells.back()["film"]["contacts"]["sole"][1] = "kko";  // of the monolithic run
  record(description(), cells);
  EXPECT_THAT(report::film_of_states(study())->text, HasSubstr("Where two pictures differ"));
  EXPECT_GT(report::film_of_states(study())->table.rows.size(), 2u);
}

TEST_F(ReportCharts, FilmLeavesOutContactsThatNeverTouch) {
  auto cells = three_methods();
  for (auto& c : cells) c["film"] = {{"times", {1, 2}}, {"contacts", {{"sole", {"ok", "ks"}}, {"side", {"oo", "oo"}}}}};
  record(description(), cells);
  const auto plate = report::film_of_states(study());
  ASSERT_TRUE(plate);
  EXPECT_THAT(plate->text, HasSubstr("contacts that never touch are left out"));
  for (const auto& row : plate->rows) EXPECT_EQ(row["contact"], "sole");
  for (auto& c : cells) c["film"]["contacts"].erase("sole");  // else there would be nothing to see
  record(description(), cells);
  const auto open = report::film_of_states(study());
  ASSERT_TRUE(open);
  EXPECT_THAT(open->text, Not(HasSubstr("left out")));
}

TEST_F(ReportCharts, AFrictionlessFilmTouchesAndDoesNotSlip) {
  auto cells = three_methods();
  for (auto& c : cells) c["film"] = {{"times", {0.5, 1}}, {"contacts", {{"sole", {"occ", "cco"}}}}};
  record(description(), cells);
  const auto plate = report::film_of_states(study());
  EXPECT_THAT(plate->table.header, ElementsAre("method", "contact", "time", "touches", "open"));
  EXPECT_THAT(plate->drawing.inline_svg(), testing::AllOf(HasSubstr(">touches<"), Not(HasSubstr("slips"))));
}

TEST_F(ReportCharts, FilmIsFoldedWhereNoPointEverChanges) {
  auto cells = three_methods();
  for (auto& c : cells) c["film"] = {{"times", {0.5, 1}}, {"contacts", {{"sole", {"sss", "sss"}}}}};
  record(description(), cells);
  EXPECT_FALSE(report::film_of_states(study())->folded.empty());
  for (auto& c : cells) c["film"]["contacts"]["sole"][1] = "sso";
  record(description(), cells);
  EXPECT_TRUE(report::film_of_states(study())->folded.empty());
}

TEST_F(ReportCharts, ThereIsNoFilmOfOnePointOrOneStepOrOfABrokenRecord) {
  auto cells = three_methods();
  for (const json& film : {json{{"times", {1}}, {"contacts", {{"sole", {"okk"}}}}},
                           json{{"times", {0.5, 1}}, {"contacts", {{"sole", {"o", "k"}}}}},
                           json{{"times", {0.5, 1}}, {"contacts", {{"sole", {"ok", "k"}}}}}, json("film")}) {
    for (auto& c : cells) c["film"] = film;
    record(description(), cells);
    EXPECT_FALSE(report::film_of_states(study())) << film;
  }
}

/// Curves stand out from white paper and from dark paper, each further one of a method too.
TEST_F(ReportCharts, CurvesStandOutFromBothPapers) {
  std::vector<json> cells;
  for (const char* family : {"penalty", "uzawa_al", "monolithic_al", "fourth", "fifth", "sixth"})
    for (int option = 0; option < 6; ++option)
      for (const double tolerance : {1e-4, 1e-8}) {
        cells.push_back(cell(family, {{"option", option}, {"tolerance", tolerance}}, tolerance, 10 + option));
        cells.back()["label"] = fmt::format("{} option={} tolerance={}", family, option, tolerance);
      }
  record(description(), cells);
  const auto figure = report::work_precision(study(), report::Against::same_mesh, report::Of::responses);
  ASSERT_TRUE(figure);
  EXPECT_EQ(figure->series.size(), 36u);
  constexpr double of_graphics = 3;  // [WCAG 2.1, 1.4.11]
  for (const auto& series : figure->series) {
    EXPECT_GE(report::contrast(series.color, report::light_paper), of_graphics) << series.name;
    EXPECT_GE(report::contrast(report::on_dark(series.color), report::dark_paper), of_graphics) << series.name;
  }
  EXPECT_NEAR(report::contrast("#000000", "#ffffff"), 21, 1e-12);
  for (const std::string_view paper : {report::light_paper, report::dark_paper})
    EXPECT_NE(std::string(report::embedded::page_css()).find("--paper: " + std::string(paper)), std::string::npos);
}

TEST(ReportColors, AreThoseOfTheirCopies) {
  const std::string css = read_file(STICKSLIP_SOURCE_DIR "/studies/web/page.css");
  const std::string python = read_file(STICKSLIP_SOURCE_DIR "/studies/python/stickslip/plots.py");
  for (const auto& [method, color] : report::method_colors) {
    EXPECT_THAT(css, HasSubstr(fmt::format("--{}: {};", method, color)));
    EXPECT_THAT(python, HasSubstr(fmt::format("\"{}\": \"{}\"", method, color)));
  }
  for (const auto& [place, color] : {std::pair{".state.stick { fill: ", report::stick_color},
                                     {"--shear: ", report::slip_color},
                                     {"--closed: ", report::closed_color},
                                     {".state.open { fill: ", report::open_color}})
    EXPECT_THAT(css, HasSubstr(std::string(place) + color));
  EXPECT_THAT(read_file(STICKSLIP_SOURCE_DIR "/studies/web/picture.js"),
              HasSubstr(fmt::format("'{}'", fmt::join(report::stress_colors, "', '"))));
}

}  // namespace
}  // namespace stickslip::report_charts
