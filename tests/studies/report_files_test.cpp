/// Drawings that need no script, and the files beside the report.
#include <gmock/gmock.h>

#include <fstream>
#include <set>
#include <sstream>

#include "studies/io/output_folder.hpp"
#include "studies/report/charts.hpp"
#include "studies/report/cone_picture.hpp"
#include "studies/report/embedded.hpp"
#include "studies/report/figure_files.hpp"
#include "studies/report/font_subset.hpp"
#include "studies/report/plot.hpp"
#include "tests/studies/recorded_study.hpp"
#include "tests/support/largest.hpp"

namespace stickslip {
namespace {

using recorded::cell;
using recorded::description;
using recorded::json;
using recorded::three_methods;
using report::Contestant;
using report::Of;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::Not;

class ReportCharts : public recorded::StudyOnDisk {
 protected:
  std::string file(const std::string& name) {
    std::ifstream in(directory_ / "figures" / name, std::ios::binary);
    return {std::istreambuf_iterator<char>(in), {}};
  }
};

/// The three methods; penalty at 1e3 as the default, and failed at 1e7.
std::vector<json> with_failure() {
  auto cells = three_methods();
  cells[0]["default"] = true;
  cells[2]["status"] = "not_finite";
  return cells;
}

/// The same runs again in a second scene.
std::vector<json> in_two_scenes(std::vector<json> cells) {
  auto all = cells;
  for (auto& c : cells) {
    c["id"] = c["id"].get<std::string>() + "-again";
    c["vary"] = {{"/contacts/sole/friction", 0.3}};
    all.push_back(c);
  }
  return all;
}

// --- robustness windows --------------------------------------------------------------------------------------------

TEST_F(ReportCharts, WindowsEndWhereARunFailed) {
  record(description(), with_failure());
  const auto plate = report::robustness_windows(study(), {"stiffness"});
  ASSERT_TRUE(plate);
  ASSERT_EQ(plate->table.rows.size(), 1u);
  EXPECT_THAT(plate->table.rows[0], ElementsAre("Penalty", "4", "1000 to 1e5, 1e9", "1e7 (not_finite)"));
}

TEST_F(ReportCharts, WindowsAreOneForEachSettingAndScene) {
  auto cells = three_methods();
  for (auto& c : cells) c["vary"] = {{"/contacts/sole/friction", 0.1}};
  auto more = three_methods();
  for (auto& c : more) c["vary"] = {{"/contacts/sole/friction", 0.3}};
  cells.insert(cells.end(), more.begin(), more.end());
  record(description(), cells);
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
  EXPECT_THAT(plate->table.header, ElementsAre("method", "contact", "time", "touch", "open"));
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

// --- axes and cones ------------------------------------------------------------------------------------------------

TEST(ReportAxis, SpansADecadeAtLeastAndLabelsIt) {
  const report::Axis axis(0.0111, 0.0112, true, 0, 100);
  EXPECT_LT(std::abs(axis(0.0112) - axis(0.0111)), 1);  // a hundredth of a decade is a hundredth of the axis
  EXPECT_GE(axis.ticks().size(), 3u);
  for (const double tick : axis.ticks()) {
    EXPECT_GE(axis(tick), 0);
    EXPECT_LE(axis(tick), 100);
  }
}

/// `steps` solutions that stick at one place, then as many that slip at another.
std::string cones_of(int steps) {
  report::ConePath path{"sole, point 0", 0.5, false, {}};
  for (int i = 0; i < 2 * steps; ++i) {
    const double tangential = i < steps ? 0.2 : 0.5;
    path.iterates.push_back({1, tangential, 1, tangential, true, 1.0 + i});
  }
  return report::draw_cones({path}, "cones").svg_file();
}

TEST(ReportCones, SayTheTimesOfTheFirstTheLastAndEachNewState) {
  const std::string svg = cones_of(10);
  EXPECT_THAT(svg, HasSubstr(">t = 1<"));
  EXPECT_THAT(svg, HasSubstr(">t = 11, 20<"));  // in one place
  EXPECT_THAT(svg, Not(HasSubstr(">t = 2<")));
}

TEST(ReportCones, HaveNumbersAlongBothAxes) {
  const std::string svg = cones_of(1);
  for (const char* tick : {">0<", ">0.4<", ">1<", ">-0.4<"}) EXPECT_THAT(svg, HasSubstr(tick));
}

// --- files ---------------------------------------------------------------------------------------------------------

TEST_F(ReportCharts, EveryFigureIsAFileInFourFormats) {
  record(description(), in_two_scenes(with_failure()));
  page();
  std::set<std::string> stems;
  for (const auto& entry : std::filesystem::directory_iterator(directory_ / "figures"))
    if (entry.path().extension() == ".svg") stems.insert(entry.path().stem().string());
  EXPECT_TRUE(stems.count("windows-stiffness"));
  EXPECT_TRUE(stems.count("profiles-data-profile"));
  for (const auto& stem : stems) {
    const std::string svg = file(stem + ".svg"), pdf = file(stem + ".pdf");
    EXPECT_THAT(svg, testing::StartsWith("<?xml")) << stem;
    EXPECT_THAT(svg, HasSubstr("<title>")) << stem;
    EXPECT_THAT(svg, HasSubstr("<desc>")) << stem;
    EXPECT_THAT(svg, Not(HasSubstr("var(--"))) << stem << ": a file has no page to take its colours from";
    EXPECT_THAT(svg, Not(HasSubstr("nan"))) << stem;
    EXPECT_THAT(pdf, testing::StartsWith("%PDF-1.4")) << stem;
    EXPECT_THAT(pdf, testing::EndsWith("%%EOF\n")) << stem;
    EXPECT_THAT(file(stem + ".pgf"), testing::EndsWith("\\end{pgfpicture}%\n\\endgroup%\n")) << stem;
  }
  EXPECT_THAT(file("windows-stiffness.csv"),
              testing::StartsWith("series,status,automatic,error,iterations,iterations_over_least,option_value\r\n"
                                  "Penalty,converged,false,0.001,"));
}

/// The places in the table at the end of a PDF are those of its objects: else a reader has to repair it.
TEST(ReportDrawing, APageHasItsPartsForNarrowScreens) {
  report::Drawing drawing(100, 50, "two rooms", "");
  drawing.text(1, 1, "a word");
  const std::string whole = drawing.inline_svg();
  EXPECT_THAT(whole, Not(HasSubstr("<use")));
  drawing.part(0, 0, 60, 50);
  drawing.part(60, 0, 40, 50);
  const std::string svg = drawing.inline_svg();
  EXPECT_THAT(svg, testing::AllOf(HasSubstr("<g id=\"two-rooms-all\">"), HasSubstr("viewBox=\"60 0 40 50\""),
                                  HasSubstr("<use href=\"#two-rooms-all\"/>")));
  EXPECT_EQ(svg.find("a word"), svg.rfind("a word"));  // drawn once, shown in each part
  EXPECT_THAT(drawing.svg_file(), Not(HasSubstr("<use")));
}

TEST(ReportDrawing, PgfHasItsTextsAsLatexSetsThem) {
  report::Drawing drawing(200, 100, "title", "description");
  drawing.text(20, 40, "50 % of {a_b}", {report::Anchor::end, 12, "#D55E00"});
  drawing.line(0, 0, 200, 100, {"ink", "", 2, {4, 2}});
  const std::string pgf = drawing.pgf();
  EXPECT_THAT(pgf, HasSubstr("\\pgftext[right,base,x=15bp,y=45bp]"));
  EXPECT_THAT(pgf, HasSubstr("50 \\% of \\{a\\_b\\}}"));
  EXPECT_THAT(pgf, HasSubstr("\\definecolor{stickslip}{HTML}{D55E00}"));
  EXPECT_THAT(pgf, HasSubstr("\\pgfpathmoveto{\\pgfpoint{0bp}{75bp}}%\n\\pgfpathlineto{\\pgfpoint{150bp}{0bp}}"));
  EXPECT_THAT(pgf, HasSubstr("\\pgfsetdash{{3bp}{1.5bp}}{0bp}"));
}

TEST_F(ReportCharts, FiguresHoldWhatThePagesChartsShow) {
  record(description(), three_methods());
  page();
  const std::string work = file("enforcement-responses-against-work-factorisations.svg");
  EXPECT_THAT(work, HasSubstr(">exactly 0<"));
  for (const char* option : {">1000<", ">Penalty, 1e9<", ">Uzawa AL, 1e-4<", ">1e-8<", ">Monolithic AL<"})
    EXPECT_THAT(work, HasSubstr(option));
  EXPECT_THAT(file("error-stiffness-responses.svg"), HasSubstr(">slope -1<"));
}

TEST(ReportAxis, DoesNotMagnifyRounding) {
  const report::Axis rounding(5.23428663391, 5.23428663392, false, 0, 100), change(5.23, 5.24, false, 0, 100);
  EXPECT_LE(rounding.ticks().front(), 3);
  EXPECT_GE(rounding.ticks().back(), 7);
  EXPECT_GT(change.ticks().front(), 5.2);
  const report::Axis seventh_digit(5.234286, 5.234287, false, 0, 100);  // a page has six
  EXPECT_LE(seventh_digit.ticks().front(), 3);
  const report::Axis nothing(0, 0, false, 0, 100);
  EXPECT_EQ(nothing.ticks().front(), -1);
}

TEST(ReportAxis, OfWhatIsCountedHasWholeTicks) {
  const report::Axis levels(0, 2, false, 0, 100);
  EXPECT_THAT(levels.ticks(1), ElementsAre(0, 1, 2));
}

TEST_F(ReportCharts, LabelsOfTicksDiffer) {
  auto cells = three_methods();
  for (auto& c : cells)
    c["steps"] = {{{"time", 0.5}, {"responses", {{"press", 5.234}}}},
                  {{"time", 1}, {"responses", {{"press", 5.2345}}}}};
  record(description(), cells);
  const auto figure = report::response_histories(study());
  const std::string svg = report::draw_plot(*figure, figure->panels.front())->inline_svg();
  EXPECT_THAT(svg, testing::AllOf(HasSubstr(">5.2342<"), HasSubstr(">5.2344<")));
}

TEST(ReportAxis, HasNoRoomBelowABound) {
  const report::Axis open(1, 30, true, 0, 100), bounded(1, 30, true, 0, 100, true), narrow(1, 2, true, 0, 100, true);
  EXPECT_GT(open(1), 0);
  EXPECT_EQ(bounded(1), 0);
  EXPECT_EQ(narrow(1), 0);
  EXPECT_LT(narrow(10), 100);
}

TEST_F(ReportCharts, PdfObjectsStandWhereItsTableSays) {
  record(description(), in_two_scenes(three_methods()));
  page();
  const std::string pdf = file("profiles-data-profile.pdf");
  const std::size_t start = pdf.rfind("startxref\n");
  ASSERT_NE(start, std::string::npos);
  std::istringstream table(pdf.substr(std::stoul(pdf.substr(start + 10))));
  std::string word, free_entry;
  std::size_t first = 0, count = 0;
  table >> word >> first >> count;
  EXPECT_EQ(word, "xref");
  std::getline(table, free_entry);
  std::getline(table, free_entry);
  ASSERT_GE(count, 7u);
  for (std::size_t i = 1; i < count; ++i) {
    std::size_t place = 0;
    std::string generation, kind;
    table >> place >> generation >> kind;
    EXPECT_EQ(pdf.substr(place, std::to_string(i).size() + 6), std::to_string(i) + " 0 obj");
  }
}

/// What a journal asks for. A PDF without its fonts names Helvetica alone.
TEST_F(ReportCharts, PdfsCarryTheirFonts) {
  if (report::embedded::upright_font().empty()) GTEST_SKIP() << "built without Liberation Sans";
  record(description(), three_methods());
  page();
  for (const auto& entry : std::filesystem::directory_iterator(directory_ / "figures")) {
    if (entry.path().extension() != ".pdf") continue;
    const std::string pdf = file(entry.path().filename());
    EXPECT_THAT(pdf, testing::AllOf(HasSubstr("/FontFile2 "), Not(HasSubstr("/Helvetica")))) << entry.path();
    EXPECT_LT(pdf.size(), 200'000u) << entry.path();
  }
}

/// Accents are made of two outlines, whose numbers change with the subset.
TEST(ReportFont, ASubsetHoldsItsCharactersAndIsSmall) {
  const auto font = report::embedded::upright_font();
  if (font.empty()) GTEST_SKIP() << "built without Liberation Sans";
  const auto subset = report::subset_of(font, {'A', '1', ' ', 0xE9});
  EXPECT_LT(subset.file.size(), 10'000u);
  EXPECT_EQ(subset.advances.at('A'), 667);  // as in Helvetica
  EXPECT_EQ(subset.advances.at('1'), 556);
  EXPECT_GT(subset.cap_height, 600);
  const auto again = report::subset_of(subset.file, {'A', 0xE9});  // it reads as a font itself
  EXPECT_EQ(again.advances.at(0xE9), subset.advances.at(0xE9));
  EXPECT_GT(again.advances.at(0xE9), 0);
}

TEST_F(ReportCharts, FiguresOfAFormerReportDoNotStay) {
  record(description(), three_methods());
  page();
  const auto folder = directory_ / "figures";
  write_output(folder / "old.svg", "<svg/>");
  for (const char* name : {"theirs.svg", "notes.txt"}) std::ofstream(folder / name) << "mine";
  page();
  EXPECT_FALSE(std::filesystem::exists(folder / "old.svg"));
  EXPECT_EQ(file("theirs.svg"), "mine");
  EXPECT_EQ(file("notes.txt"), "mine");
}

TEST(ReportCsv, QuotesWhatHoldsCommasQuotesOrLineBreaks) {
  EXPECT_EQ(report::to_csv({{{"a", "1,5"}, {"b", "say \"x\""}}, {{"a", "plain"}, {"b", "two\nlines"}}}),
            "a,b\r\n\"1,5\",\"say \"\"x\"\"\"\r\nplain,\"two\nlines\"\r\n");
}

TEST(ReportCsv, KeepsEveryBitOfANumberAndLeavesOutLooks) {
  EXPECT_EQ(report::to_csv({{{"a", 1.0 / 3}, {"label", "x"}, {"unmarked", true}}, {{"count", 7}}}),
            "label,a,count\r\nx,0.3333333333333333,\r\n,,7\r\n");
}

/// The columns of a CSV without quotes.
std::vector<std::vector<std::string>> cells_of(const std::string& csv) {
  std::vector<std::vector<std::string>> out;
  std::istringstream lines(csv);
  for (std::string line; std::getline(lines, line);) {
    out.emplace_back();
    std::istringstream cells(line.substr(0, line.find('\r')));
    for (std::string cell; std::getline(cells, cell, ',');) out.back().push_back(cell);
  }
  return out;
}

TEST_F(ReportCharts, ACsvHoldsEveryPointOfItsChart) {
  auto cells = three_methods();
  cells[0]["steps"][0]["history"][1]["residual"] = 1.0 / 3;
  record(description(), cells);
  page();
  const auto figure = report::convergence_histories(study());
  const auto csv = cells_of(file("histories.csv"));
  ASSERT_EQ(csv.size(), figure->rows.size() + 1);
  const auto column = std::find(csv[0].begin(), csv[0].end(), "error") - csv[0].begin();
  for (std::size_t i = 0; i < figure->rows.size(); ++i)
    EXPECT_EQ(std::stod(csv[i + 1].at(static_cast<std::size_t>(column))), figure->rows[i]["error"].get<double>());
  EXPECT_THAT(file("histories.csv"), HasSubstr("0.3333333333333333"));
}

}  // namespace
}  // namespace stickslip
