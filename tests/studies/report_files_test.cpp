/// Drawings that need no script, and the files beside the report.
#include <gmock/gmock.h>

#include <fstream>
#include <set>
#include <sstream>

#include "studies/io/other_program.hpp"
#include "studies/io/output_folder.hpp"
#include "studies/report/charts.hpp"
#include "studies/report/cone_picture.hpp"
#include "studies/report/figure_files.hpp"
#include "studies/report/plot.hpp"
#include "studies/report/report.hpp"
#include "tests/studies/recorded_study.hpp"

namespace stickslip {
namespace {

using recorded::cell;
using recorded::description;
using recorded::in_two_scenes;
using recorded::json;
using recorded::three_methods;
using recorded::with_failure;
using testing::AllOf;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::Not;

class ReportFiles : public recorded::StudyOnDisk {
 protected:
  std::string file(const std::string& name) {
    std::ifstream in(directory_ / "figures" / name, std::ios::binary);
    return {std::istreambuf_iterator<char>(in), {}};
  }
};

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

TEST_F(ReportFiles, EveryFigureIsAFileInThreeFormats) {
  record(description(), in_two_scenes(with_failure()));
  page();
  std::set<std::string> stems;
  for (const auto& entry : std::filesystem::directory_iterator(directory_ / "figures"))
    if (entry.path().extension() == ".svg") stems.insert(entry.path().stem().string());
  EXPECT_TRUE(stems.count("windows-stiffness"));
  EXPECT_TRUE(stems.count("profiles-data-profile"));
  for (const auto& stem : stems) {
    const std::string svg = file(stem + ".svg");
    EXPECT_THAT(svg, testing::StartsWith("<?xml")) << stem;
    EXPECT_THAT(svg, HasSubstr("<title>")) << stem;
    EXPECT_THAT(svg, HasSubstr("<desc>")) << stem;
    EXPECT_THAT(svg, Not(HasSubstr("var(--"))) << stem << ": a file has no page to take its colours from";
    EXPECT_THAT(svg, Not(HasSubstr("nan"))) << stem;
    EXPECT_THAT(file(stem + ".pgf"), testing::EndsWith("\\endgroup%\n")) << stem;
  }
  EXPECT_THAT(file("windows-stiffness.csv"),
              testing::StartsWith("series,status,automatic,error,iterations,iterations_over_least,option_value\r\n"
                                  "Penalty,converged,false,0.001,"));
}

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
  drawing.text(20, 60, "é, φ and Ω; σ ≤ 2", {});
  drawing.line(0, 0, 200, 100, {"ink", "", 2, {4, 2}});
  const std::string pgf = drawing.pgf();
  EXPECT_THAT(pgf, HasSubstr("é, \\(\\varphi\\) and \\(\\Omega\\); \\(\\sigma\\) \\(\\leq\\) 2}"));
  EXPECT_THAT(pgf, HasSubstr("\\sT{D55E00}{right,}{20}{60}{12}{50 \\% of \\{a\\_b\\}}%\n"));
  EXPECT_THAT(pgf, HasSubstr("\\sB\\sM{0}{100}%\n\\sL{200}{0}%\n\\sS{"));
  EXPECT_THAT(pgf, HasSubstr("\\pgfsetdash{{4\\stickslipunit}{2\\stickslipunit}}{0pt}"));
}

/// As wide as the line, and below 120 mm laid out for one column.
TEST(ReportDrawing, PgfIsAsWideAsTheLine) {
  report::Drawing wide(640, 100, "wide", ""), narrow(320, 100, "narrow", "");
  EXPECT_THAT(wide.pgf(), AllOf(HasSubstr("\\stickslipunit=\\linewidth\\divide\\stickslipunit by 640%"),
                                Not(HasSubstr("\\ifdim"))));
  const std::string both = wide.pgf(&narrow);
  EXPECT_LT(both.find("\\ifdim\\linewidth<120mm"), both.find("by 320%"));
  EXPECT_LT(both.find("by 320%"), both.find("\\else"));
  EXPECT_LT(both.find("\\else"), both.find("by 640%"));
}

TEST(ReportDrawing, PgfRaisesPowers) {
  EXPECT_EQ(report::tex_text("2·10⁻¹⁵ & 10³"), "2·10\\textsuperscript{-15} \\& 10\\textsuperscript{3}");
}

/// A reader of the file alone knows which option the values at the ends are of, and what was chosen on the page.
TEST_F(ReportFiles, ChartsCarryWhatTheyNeed) {
  record(description(), in_two_scenes(three_methods()));
  const auto figure = report::work_precision(study(), report::Against::same_mesh, report::Of::responses);
  const std::string svg = report::draw_plot(*figure, figure->charts.front())->inline_svg();
  EXPECT_THAT(svg, HasSubstr(">Penalty, stiffness<"));
  EXPECT_THAT(svg, HasSubstr("Scene: friction = 0.3."));
  EXPECT_THAT(report::to_csv(figure->rows), HasSubstr(",option,"));
}

/// A long title is in lines that fit into a column.
TEST_F(ReportFiles, TitlesOfNarrowChartsStayInside) {
  record(description(), three_methods());
  auto figure = report::work_precision(study(), report::Against::same_mesh, report::Of::responses);
  figure->charts.front().x.title = "penalty stiffness or AL scale (multiple of the local nodal stiffness)";
  const auto svg = [&](double width) {
    return report::draw_plot(*figure, figure->charts.front(), width)->inline_svg();
  };
  EXPECT_THAT(svg(report::two_columns),
              HasSubstr(">penalty stiffness or AL scale (multiple of the local nodal stiffness)<"));
  EXPECT_THAT(svg(report::one_column), HasSubstr(">penalty stiffness or AL scale (multiple of the local<"));
  EXPECT_THAT(svg(report::one_column), HasSubstr(">nodal stiffness)<"));
}

/// The value at the end of one line stands on no other line where it has another place.
TEST_F(ReportFiles, ValuesAtTheEndsOfLinesStandBesideLines) {
  report::Figure figure;
  figure.series = {{"a", "#0072B2", "circle", {1, 0}, 60}, {"b", "#D55E00", "square", {1, 0}, 60}};
  const auto row = [&](const char* series, double x, double y, const char* setting) {
    figure.rows.push_back(
        {{"series", series}, {"line", series}, {"x", x}, {"y", y}, {"order", x}, {"setting", setting}});
  };
  row("a", 0, 0, "left");
  row("a", 10, 10, "right");
  row("b", 10.2, 11, "up");  // steep, and close to the right of the end of a
  row("b", 10.6, 0, "down");
  report::Chart chart{.title = "", .x = {.field = "x", .title = "x"}, .y = {"y", "y"}, .tooltip = {}};
  chart.words = {"series", "setting"};
  const std::string svg = report::draw_plot(figure, chart)->inline_svg();
  const auto place_of = [&](const std::string& word) {
    const auto end = svg.find(">" + word + "<"), from = svg.rfind("x=\"", end);
    return std::stod(svg.substr(from + 3));
  };
  EXPECT_LT(place_of("right"), report::Axis(0, 10.6, false, 74, 620)(10)) << "left of the end, as b is right of it";
}

/// Its cross is near the last run that converged, whose value it would else seem to have.
TEST_F(ReportFiles, ARunThatFailedHasItsValue) {
  report::Figure figure;
  figure.series = {{"a", "#0072B2", "circle", {1, 0}, 60}};
  for (const auto& [x, setting, failed] : {std::tuple{0.0, "1", false}, {5.0, "1e9", false}, {5.2, "1e10", true}})
    figure.rows.push_back(
        {{"series", "a"}, {"line", "a"}, {"x", x}, {"y", x}, {"order", x}, {"setting", setting}, {"failed", failed}});
  report::Chart chart{.title = "", .x = {.field = "x", .title = "x"}, .y = {"y", "y"}, .tooltip = {}};
  chart.words = {"series", "setting"};
  EXPECT_THAT(report::draw_plot(figure, chart)->inline_svg(), HasSubstr(">1e10 fails<"));
}

/// Names stand side by side below a chart, which leaves three quarters of the height or more to the curves.
TEST_F(ReportFiles, LegendsTakeLessThanAQuarterOfTheHeight) {
  auto cells = three_methods();
  for (const double scale : {1.0, 10.0, 100.0})
    for (const double tolerance : {1e-4, 1e-8})
      cells.push_back(recorded::cell("uzawa_al", {{"scale", scale}, {"tolerance", tolerance}}, tolerance, 20));
  record(description(), cells);
  page();
  const std::string svg = file("first.svg");
  const double height = std::stod(svg.substr(svg.find("height=\"") + 8));
  EXPECT_LT(height - 336, height / 4);  // the title of the axis is at 336
}

TEST_F(ReportFiles, TicksArePowersOfTen) {
  record(description(), three_methods());
  page();
  EXPECT_THAT(file("first.svg"), AllOf(HasSubstr(">10⁻⁶<"), Not(HasSubstr(">1e-6<"))));
}

TEST_F(ReportFiles, FiguresHoldWhatThePagesChartsShow) {
  record(description(), three_methods());
  page();
  const std::string work = file("enforcement-responses-against-work-factorisations.svg");
  EXPECT_THAT(work, HasSubstr(">exactly 0<"));
  for (const char* words :
       {">1000<", ">1e9<", ">1e-4<", ">1e-8<", ">Penalty, stiffness<", ">Uzawa AL, tolerance<", ">Monolithic AL<"})
    EXPECT_THAT(work, HasSubstr(words));
  EXPECT_THAT(file("error-stiffness-responses.svg"), HasSubstr(">slope -1<"));
}

TEST(ReportAxis, DoesNotMagnifyRounding) {
  const report::Axis rounding(5.23428663391, 5.23428663392, false, 0, 300), change(5.23, 5.24, false, 0, 300);
  EXPECT_LE(rounding.ticks().front(), 3);
  EXPECT_GE(rounding.ticks().back(), 7);
  EXPECT_GT(change.ticks().front(), 5.2);
  const report::Axis seventh_digit(5.234286, 5.234287, false, 0, 300);  // a page has six
  EXPECT_LE(seventh_digit.ticks().front(), 3);
  const report::Axis nothing(0, 0, false, 0, 300);
  EXPECT_EQ(nothing.ticks().front(), -1);
}

TEST(ReportAxis, OfWhatIsCountedHasWholeTicks) {
  const report::Axis levels(0, 2, false, 0, 100);
  EXPECT_THAT(levels.ticks(1), ElementsAre(0, 1, 2));
}

TEST_F(ReportFiles, LabelsOfTicksDiffer) {
  auto cells = three_methods();
  for (auto& c : cells)
    c["steps"] = {{{"time", 0.5}, {"responses", {{"press", 5.234}}}},
                  {{"time", 1}, {"responses", {{"press", 5.2345}}}}};
  record(description(), cells);
  const auto figure = report::response_histories(study());
  const std::string svg = report::draw_plot(*figure, figure->charts.front())->inline_svg();
  EXPECT_THAT(svg, testing::AllOf(HasSubstr(">5.2342<"), HasSubstr(">5.2344<")));
}

TEST(ReportAxis, HasNoRoomBelowABound) {
  const report::Axis open(1, 30, true, 0, 100), bounded(1, 30, true, 0, 100, true), narrow(1, 2, true, 0, 100, true);
  EXPECT_GT(open(1), 0);
  EXPECT_EQ(bounded(1), 0);
  EXPECT_EQ(narrow(1), 0);
  EXPECT_LT(narrow(10), 100);
}

/// The same bytes each time, and none that nobody asked for.
TEST_F(ReportFiles, PdfsAreMadeOnRequest) {
  if (!output_of({"rsvg-convert", "--version"}, {})) GTEST_SKIP() << "rsvg-convert is not here: librsvg2-bin";
  record(description(), three_methods());
  page();
  const std::string name = "error-stiffness-responses.pdf";
  EXPECT_EQ(file(name), "");
  write_report(directory_, Pdfs::added);
  const std::string pdf = file(name);
  EXPECT_THAT(pdf, testing::StartsWith("%PDF-"));
  EXPECT_LT(pdf.size(), 100'000u);
  write_report(directory_, Pdfs::added);
  EXPECT_EQ(file(name), pdf);
  page();
  EXPECT_EQ(file(name), "");
}

/// A response whose name stands at an axis, as a reader finds it in the PDF.
TEST_F(ReportFiles, PdfsHoldAccentsAndGreekLetters) {
  if (!output_of({"rsvg-convert", "--version"}, {})) GTEST_SKIP() << "rsvg-convert is not here: librsvg2-bin";
  if (!output_of({"pdftotext", "-v"}, {})) GTEST_SKIP() << "pdftotext is not here: poppler-utils";
  const std::string name = "Kraft é φ";
  auto cells = three_methods();
  for (auto& c : cells)
    c["steps"] = {{{"time", 0.5}, {"responses", {{name, 1}}}}, {{"time", 1}, {"responses", {{name, 2}}}}};
  record(description(), cells);
  write_report(directory_, Pdfs::added);
  const auto text = output_of(
      {"pdftotext", (directory_ / "figures" / "response-histories-response-over-time.pdf").string(), "-"}, {});
  EXPECT_THAT(text.value_or(""), HasSubstr(name));
}

TEST(OtherPrograms, AreRunWithoutAShell) {
  EXPECT_EQ(output_of({"printenv", "STICKSLIP_TEST"}, {{"STICKSLIP_TEST", "$HOME; a b"}}), "$HOME; a b\n");
  EXPECT_EQ(output_of({"false"}, {}), std::nullopt);
  EXPECT_EQ(output_of({"no-program-of-this-name"}, {}), std::nullopt);
}

TEST_F(ReportFiles, FiguresOfAFormerReportDoNotStay) {
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

TEST_F(ReportFiles, ACsvHoldsEveryPointOfItsChart) {
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
