/// Numbers and names of a report, and its tables.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "studies/io/atomic_file.hpp"
#include "studies/report/html.hpp"
#include "studies/report/labels.hpp"
#include "studies/report/records.hpp"
#include "tests/studies/recorded_study.hpp"

namespace stickslip {
namespace {

using nlohmann::json;
using recorded::cell;
using recorded::description;
using recorded::three_methods;
using testing::AllOf;
using testing::HasSubstr;
using testing::Not;

class ReportNumbers : public recorded::StudyOnDisk {};

/// (page_test.py holds the script of the page to the same list.)
TEST(ReportText, WritesNumbersInOneStyle) {
  for (const json& row : json::parse(read_file(STICKSLIP_SOURCE_DIR "/tests/studies/numerals.json")))
    EXPECT_EQ(with_power(report::number(row[0], row[1])), row[2].get<std::string>()) << row;
  EXPECT_EQ(report::number(-2.5e-6), "-2.5e-6");
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
  EXPECT_NEAR(s.ratio.at(""), 0.1, 1e-14);
  EXPECT_NEAR(s.cells[0].work, 14 + 2.8, 1e-12);
  EXPECT_NEAR(s.cells[0].sensitivity_work, 14 + 2.9, 1e-12);
  EXPECT_NEAR(s.cells[0].seconds, 28 - 0.1, 1e-12);
}

TEST(ReportText, KeepsSmallNumbersOnOneLine) {
  EXPECT_EQ(report::escape_sentence("a <1.3e-05"), "a &lt;<span class=\"number\">1.3e-5</span>");
  EXPECT_EQ(report::in_plain_words("converged_at_roundoff"), "converged at roundoff");
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
  EXPECT_EQ(report::take_out_constant_columns(table), "The same in every row: cutbacks 0.");
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

TEST_F(ReportNumbers, NamesWhatVariesByAsMuchOfItsPlaceAsTellsItApart) {
  auto cells = three_methods();
  for (auto& c : cells)
    c["vary"] = {{"/contacts/sole/friction", 0.1}, {"/contacts/heel/friction", 0.2}, {"/bodies/a/size/0", 3}};
  record(description(), cells);
  EXPECT_EQ(study().main_variant, "size/0 = 3, heel/friction = 0.2, sole/friction = 0.1");
}

}  // namespace
}  // namespace stickslip
