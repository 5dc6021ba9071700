/// Who is the cheapest at which accuracy, on the first screen of a report.
#include <fmt/core.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "studies/report/verdict.hpp"
#include "tests/studies/recorded_study.hpp"
#include "tests/studies/report_page.hpp"

namespace stickslip {
namespace {

using nlohmann::json;
using recorded::cell;
using recorded::description;
using recorded::three_methods;
using testing::AllOf;
using testing::HasSubstr;
using testing::Not;

class ReportVerdict : public recorded::StudyOnDisk {
 protected:
  std::string verdict_of(const json& about, const std::vector<json>& cells) {
    record(about, cells);
    const auto verdict = report::verdict(study());
    return verdict.reason + verdict.table;
  }
};

/// The cells of the row of a method, whose name is of one or two words; tags dropped.
std::vector<std::string> row(const std::string& verdict, const std::string& method) {
  std::string head = "<th scope=\"row\"><span>" + method + "</span></th>";
  if (const auto blank = method.find(' '); blank != std::string::npos)
    head.replace(head.find(' ', head.find(method)), 1, "</span> <span>");
  const auto from = verdict.find(head);
  std::vector<std::string> cells;
  if (from == std::string::npos) return cells;
  const std::string text = verdict.substr(from, verdict.find("</tr>", from) - from);
  for (std::size_t at = text.find("<td"); at != std::string::npos; at = text.find("<td", at + 1)) {
    std::string cell = text.substr(at, text.find("</td>", at) - at), out;
    bool inside = false;
    for (const char c : cell) {
      if (c == '<') inside = true;
      if (!inside) out += c;
      if (c == '>') inside = false;
    }
    cells.push_back(out);
  }
  return cells;
}

// Works (a back-solve is a tenth of a factorisation): penalty 16.8 up to 1e7, 21.6 at 1e9; Uzawa 24 and 48;
// monolithic 12. The mesh itself is off by 0.01.
TEST_F(ReportVerdict, NamesTheCheapestSettingOfEachMethodAtEachAccuracy) {
  const std::string verdict = verdict_of(description(), three_methods());
  const auto penalty = row(verdict, "Penalty"), uzawa = row(verdict, "Uzawa AL"), exact = row(verdict, "Monolithic AL");
  ASSERT_EQ(penalty.size(), 7u);  // responses at 1 %, 1e-4, 1e-6 and the mesh's; derivatives at three
  EXPECT_THAT(penalty[0], HasSubstr("stiffness=1000"));
  EXPECT_THAT(penalty[0], HasSubstr("work 17"));
  EXPECT_THAT(penalty[1], HasSubstr("stiffness=1e5"));
  EXPECT_THAT(penalty[2], HasSubstr("stiffness=1e7"));
  EXPECT_THAT(penalty[3], HasSubstr("stiffness=1000"));
  EXPECT_THAT(uzawa[1], HasSubstr("tolerance=1e-4"));
  EXPECT_THAT(uzawa[2], AllOf(HasSubstr("tolerance=1e-8"), HasSubstr("work 48"), HasSubstr("80 s")));
  for (const auto& entry : exact) {
    EXPECT_THAT(entry, HasSubstr("work 12"));
    EXPECT_THAT(entry, HasSubstr("&#9733;"));
  }
  EXPECT_THAT(verdict, HasSubstr("own error of mesh, steps, references: <span>1 %</span>"));
  EXPECT_THAT(verdict,
              HasSubstr("<p class=\"reason\">Response to 1&nbsp;%: cheapest by <b>Monolithic AL</b> with 10 "
                        "factorisations and 20 back-solves; Penalty (stiffness=1000, 1e5 or 1e7) takes 14 and 28"));
  EXPECT_THAT(verdict, HasSubstr("<p class=\"reason\">Derivative to 1&nbsp;%: cheapest by <b>Monolithic AL</b> with "));
}

TEST_F(ReportVerdict, TakesTheAccuraciesOfTheStudy) {
  json about = description();
  about["accuracy"] = {1e-8, 0.05};
  const auto penalty = row(verdict_of(about, three_methods()), "Penalty");
  ASSERT_EQ(penalty.size(), 5u);
  EXPECT_THAT(penalty[0], HasSubstr("stiffness=1000"));  // the coarsest first
  EXPECT_THAT(penalty[1], HasSubstr("stiffness=1e9"));
}

TEST_F(ReportVerdict, SaysHowNearAMethodCame) {
  const std::vector<json> cells = {cell("penalty", {{"stiffness", 100.0}}, 1e-3, 10),
                                   cell("monolithic_al", json::object(), 0, 10)};
  const auto penalty = row(verdict_of(description(), cells), "Penalty");
  EXPECT_EQ(penalty[1], "best 0.1 %");
  auto failed = cells;
  failed[0]["status"] = "cycle";
  EXPECT_EQ(row(verdict_of(description(), failed), "Penalty")[1], "no run");
}

TEST_F(ReportVerdict, CountsInTheSingularToo) {
  const std::string verdict = verdict_of(description(), {cell("monolithic_al", json::object(), 1e-9, 1)});
  EXPECT_THAT(verdict, HasSubstr("1 factorisation and 2 back-solves"));
}

/// Where the first accuracy is out of reach of all, the next that some run reaches is spoken of.
TEST_F(ReportVerdict, SpeaksOfTheFirstAccuracyThatIsReached) {
  json about = description();
  about["accuracy"] = {0.1, 1e-6};
  const std::string verdict =
      verdict_of(about, {cell("penalty", {{"stiffness", 10.0}}, 3e-3, 5), cell("uzawa_al", json::object(), 0.2, 5)});
  EXPECT_THAT(verdict, AllOf(HasSubstr("Response to 10&nbsp;%: cheapest by"),
                             HasSubstr("Uzawa AL (best 20&nbsp;%) does not get there.")));
}

TEST_F(ReportVerdict, NamesWhoMissesTheFirstAccuracy) {
  const std::vector<json> cells = {cell("penalty", {{"stiffness", 10.0}}, 0.02, 10),
                                   cell("uzawa_al", json::object(), 0.03, 10),
                                   cell("monolithic_al", json::object(), 0, 10)};
  EXPECT_THAT(verdict_of(description(), cells), HasSubstr("back-solves. Penalty (best 2&nbsp;%) and Uzawa AL (best "
                                                          "3&nbsp;%) do not get there."));
  EXPECT_THAT(verdict_of(description(), three_methods()), Not(HasSubstr("not get there")));
}

TEST_F(ReportVerdict, SaysWhatBesidesTheMethodErrs) {
  json about = description();
  const auto verdict_against = [&](const json& reference) {
    about["reference"] = {reference};
    return verdict_of(about, three_methods());
  };
  EXPECT_THAT(verdict_against({{"overkill", {{"refine", 1}}}}), HasSubstr(">own error of mesh: <span>1 %</span>"));
  EXPECT_THAT(verdict_against({{"analytic", "hertz_line"}}), HasSubstr(">own error of mesh, steps: <span>1 %</span>"));
  about["mesh"] = {{"elements", 1}};
  EXPECT_THAT(verdict_against({{"analytic", "hertz_line"}}), HasSubstr(">own error of steps: <span>1 %</span>"));
}

/// A given value has so many digits, and no accuracy is asked for beyond them.
TEST_F(ReportVerdict, HasNoColumnForTheDigitsOfGivenValues) {
  auto cells = three_methods();
  for (auto& c : cells) c["errors"]["discretization"]["response:press"] = 2e-11;
  json about = description();
  about["reference"] = {{{"values", {{"press", 9.9}}}}};
  EXPECT_EQ(row(verdict_of(about, cells), "Penalty").size(), 6u);
  about["reference"] = {{{"analytic", "hertz_line"}}};
  EXPECT_EQ(row(verdict_of(about, cells), "Penalty").size(), 7u);
}

TEST_F(ReportVerdict, NamesBothWhereWorkIsTheSame) {
  const std::vector<json> cells = {cell("penalty", {{"stiffness", 1e5}}, 1e-5, 10),
                                   cell("monolithic_al", json::object(), 0, 10)};
  const std::string verdict = verdict_of(description(), cells);
  EXPECT_THAT(verdict, HasSubstr("<b>Penalty (stiffness=1e5)</b> and <b>Monolithic AL</b>"));
  EXPECT_THAT(row(verdict, "Penalty")[0], HasSubstr("&#9733;"));
}

TEST_F(ReportVerdict, NamesTheSettingsThatDoTheSameAndTheDefaultFirst) {
  std::vector<json> cells;
  for (const double scale : {0.1, 1.0, 10.0}) cells.push_back(cell("monolithic_al", {{"scale", scale}}, 0, 10));
  cells[1]["default"] = true;
  EXPECT_THAT(row(verdict_of(description(), cells), "Monolithic AL")[0], HasSubstr("scale=1, 0.1 or 10work"));
  for (const double scale : {1e2, 1e3}) cells.push_back(cell("monolithic_al", {{"scale", scale}}, 0, 10));
  EXPECT_THAT(row(verdict_of(description(), cells), "Monolithic AL")[0], HasSubstr("scale=1, 0.1 or 3 others"));
  cells.resize(3);
  cells[0]["cost"]["counts"]["factorizations"] = 9;
  EXPECT_THAT(row(verdict_of(description(), cells), "Monolithic AL")[0], HasSubstr("scale=0.1work"));
}

TEST_F(ReportVerdict, OfOneMethodComparesItsOptions) {
  std::vector<json> cells;
  for (const char* acceleration : {"none", "anderson"})
    for (const int scale : {1, 10, 100}) {
      const int factorizations = (std::string(acceleration) == "none" ? 40 : 10) + (scale == 1 ? 5 : 0);
      cells.push_back(cell("uzawa_al", {{"acceleration", acceleration}, {"scale", scale}}, 1e-9, factorizations));
      cells.back()["label"] = fmt::format("uzawa_al acceleration={} scale={}", acceleration, scale);
    }
  const std::string verdict = verdict_of(description(), cells);
  const std::string head = "<th scope=\"row\"><span>";  // the method, which is the same in each, heads their column
  EXPECT_THAT(verdict, testing::AllOf(HasSubstr("<th rowspan=\"2\">Uzawa AL</th>"),
                                      HasSubstr(head + "acceleration=none</span></th>"),
                                      HasSubstr(head + "anderson</span></th>")));
  EXPECT_THAT(verdict, HasSubstr("cheapest by <b>Uzawa AL anderson (scale=10 or 100)</b>"));
  EXPECT_THAT(verdict, HasSubstr("Uzawa AL acceleration=none (scale=10 or 100) takes 40 and 80"));
}

TEST_F(ReportVerdict, NamesTheFasterWhereTheClockDisagrees) {
  std::vector<json> cells = {cell("penalty", {{"stiffness", 1e5}}, 1e-5, 14),
                             cell("monolithic_al", json::object(), 0, 10)};
  cells[0]["cost"]["seconds"]["total"] = 5;
  const std::string verdict = verdict_of(description(), cells);
  EXPECT_THAT(verdict, HasSubstr("by the clock Penalty (4.9&nbsp;s) beats Monolithic AL (20&nbsp;s)"));
  EXPECT_THAT(row(verdict, "Penalty")[0], HasSubstr("fastest"));
  EXPECT_THAT(row(verdict, "Monolithic AL")[0], HasSubstr("&#9733;"));
  EXPECT_THAT(row(verdict, "Monolithic AL")[0], Not(HasSubstr("fastest")));
}

TEST_F(ReportVerdict, NamesAllThatAreAboutAsFast) {
  std::vector<json> cells = {cell("penalty", {{"stiffness", 1e5}}, 1e-9, 14), cell("uzawa_al", json::object(), 0, 16),
                             cell("monolithic_al", json::object(), 0, 10)};
  cells[0]["cost"]["seconds"]["total"] = 5;
  cells[1]["cost"]["seconds"]["total"] = 6;
  const std::string near = verdict_of(description(), cells);
  EXPECT_THAT(row(near, "Penalty")[0], HasSubstr("fastest"));
  EXPECT_THAT(row(near, "Uzawa AL")[0], HasSubstr("fastest"));
  EXPECT_THAT(near, HasSubstr("by the clock Penalty (5&nbsp;s) and Uzawa AL (6&nbsp;s) beat Monolithic AL ("));
  cells[1]["cost"]["seconds"]["total"] = 7;
  EXPECT_THAT(row(verdict_of(description(), cells), "Uzawa AL")[0], Not(HasSubstr("fastest")));
  cells[2]["cost"]["seconds"]["total"] = 6;
  EXPECT_THAT(verdict_of(description(), cells), AllOf(Not(HasSubstr("fastest")), Not(HasSubstr("by the clock"))));
}

/// Of two of least work one may take far longer.
TEST_F(ReportVerdict, NamesTheFasterOfThoseOfLeastWork) {
  std::vector<json> cells = {cell("penalty", {{"stiffness", 1e5}}, 1e-5, 10),
                             cell("monolithic_al", json::object(), 0, 10)};
  cells[0]["cost"]["seconds"]["total"] = 1;
  const std::string verdict = verdict_of(description(), cells);
  EXPECT_THAT(row(verdict, "Penalty")[0], AllOf(HasSubstr("&#9733;"), HasSubstr("fastest")));
  EXPECT_THAT(row(verdict, "Monolithic AL")[0], AllOf(HasSubstr("&#9733;"), Not(HasSubstr("fastest"))));
  EXPECT_THAT(verdict, HasSubstr("by the clock Penalty (1&nbsp;s) beats Monolithic AL ("));
}

TEST_F(ReportVerdict, NamesTheLeastWorkFirstAndThenWhatIsNearIt) {
  std::vector<json> cells = {cell("penalty", {{"stiffness", 1e5}}, 1e-5, 10),
                             cell("monolithic_al", json::object(), 0, 10)};
  cells[0]["cost"]["counts"]["backsolves"] = 21;
  EXPECT_THAT(verdict_of(description(), cells),
              AllOf(HasSubstr("cheapest by <b>Monolithic AL</b> with 10 factorisations and 20 back-solves; within 5 % "
                              "of that <b>Penalty (stiffness=1e5)</b> with 10 and 21."),
                    HasSubstr("&#9733; within 5 % of the least work</caption>")));
}

/// A back-solve is weighed as a tenth of a factorisation, by seconds and counts of all runs.
TEST_F(ReportVerdict, SaysTheWorkWhereCountsDoNotShowTheWinner) {
  std::vector<json> cells = {cell("penalty", {{"stiffness", 1e5}}, 1e-5, 11),
                             cell("monolithic_al", json::object(), 0, 10)};
  for (const std::size_t i : {0u, 1u}) {
    const int backsolves = i == 0 ? 20 : 90;
    cells[i]["cost"]["counts"]["backsolves"] = backsolves;
    cells[i]["cost"]["seconds"]["backsolve"] = 0.1 * backsolves;
  }
  EXPECT_THAT(verdict_of(description(), cells),
              HasSubstr("<b>Penalty (stiffness=1e5)</b> with 11 factorisations and 20 back-solves (work 13); "
                        "Monolithic AL takes 10 and 90 (work 19)"));
  cells[0]["cost"]["counts"]["factorizations"] = 10;
  EXPECT_THAT(verdict_of(description(), cells), Not(HasSubstr("(work")));
}

TEST_F(ReportVerdict, IsSilentWithoutErrors) {
  auto cells = three_methods();
  for (auto& c : cells) c["errors"] = json::object();
  EXPECT_EQ(verdict_of(description(), cells), "");
}

/// Where the responses of all runs err by rounding alone, their chart would order noise.
TEST_F(ReportVerdict, TheChartBesideItIsOfDerivativesWhereResponsesErrByRounding) {
  auto cells = three_methods();
  record(description(), cells);
  EXPECT_THAT(page(), HasSubstr("Error of the worst response."));
  for (auto& c : cells) {
    c["errors"]["enforcement"]["response:press"] = 1e-13;
    c["errors"]["enforcement"]["sensitivity:press/E"] = 1e-5;
  }
  record(description(), cells);
  EXPECT_THAT(page(), HasSubstr("Error of the worst derivative."));
}

/// A verdict of six rows is whole on the first screen, since the chart above it is lower.
TEST_F(ReportVerdict, OfManyRowsHasALowerChartBesideIt) {
  const auto page_of = [&](int options) {
    std::vector<json> cells;
    for (int i = 0; i < options; ++i)
      for (const int scale : {1, 10, 100}) {
        cells.push_back(cell("uzawa_al", {{"oversize", i}, {"scale", scale}}, 1e-5 / scale, 10 + scale));
        cells.back()["label"] = fmt::format("uzawa_al oversize={} scale={}", i, scale);
      }
    record(description(), cells);
    return page();
  };
  EXPECT_THAT(page_of(2), HasSubstr("\"height\":220.0"));
  EXPECT_THAT(page_of(6), testing::AllOf(HasSubstr("\"height\":180.0"), Not(HasSubstr("\"height\":220.0"))));
}

TEST_F(ReportVerdict, ComesFirstOnThePage) {
  record(description(), three_methods());
  const std::string text = recorded::without_scripts(page());
  EXPECT_LT(text.find("cheapest by"), text.find("What accuracy costs"));
  EXPECT_LT(text.find("class=\"verdict\""), text.find("id=\"findings\""));
  EXPECT_LT(text.find("What accuracy costs"), text.find("class=\"verdict\""));
  EXPECT_LT(text.find("id=\"findings\""), text.find("id=\"reading\""));
}

}  // namespace
}  // namespace stickslip
