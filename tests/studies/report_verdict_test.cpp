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
  EXPECT_THAT(
      verdict,
      HasSubstr("<p class=\"reason\">Response within 1&nbsp;%: <b>Monolithic AL</b> is cheapest: work 12 (10 "
                "factorisations + 20 back-solves at 0.1 each), 20&nbsp;s. Penalty (stiffness=1000, 1e5 or 1e7) takes "
                "work 16.8 (14 + 28), 28&nbsp;s. "));
  EXPECT_THAT(verdict,
              HasSubstr("<p class=\"reason\">Derivative within 1&nbsp;%: <b>Monolithic AL</b> is cheapest: work "
                        "12.1 (10 factorisations + 21 back-solves at 0.1 each), 20&nbsp;s. "));
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
  EXPECT_THAT(verdict, HasSubstr("work 1.2 (1 factorisation + 2 back-solves at 0.1 each)"));
}

/// Where the first accuracy is out of reach of all, the next that some run reaches is spoken of.
TEST_F(ReportVerdict, SpeaksOfTheFirstAccuracyThatIsReached) {
  json about = description();
  about["accuracy"] = {0.1, 1e-6};
  const std::string verdict =
      verdict_of(about, {cell("penalty", {{"stiffness", 10.0}}, 3e-3, 5), cell("uzawa_al", json::object(), 0.2, 5)});
  EXPECT_THAT(verdict, AllOf(HasSubstr("Response within 10&nbsp;%: <b>Penalty"),
                             HasSubstr("Uzawa AL does not get there (best 20&nbsp;%).")));
}

TEST_F(ReportVerdict, NamesWhoMissesTheFirstAccuracy) {
  const std::vector<json> cells = {cell("penalty", {{"stiffness", 10.0}}, 0.02, 10),
                                   cell("uzawa_al", json::object(), 0.03, 10),
                                   cell("monolithic_al", json::object(), 0, 10)};
  EXPECT_THAT(verdict_of(description(), cells),
              HasSubstr("Penalty does not get there (best 2&nbsp;%). Uzawa AL does not "
                        "get there (best 3&nbsp;%)."));
  EXPECT_THAT(verdict_of(description(), three_methods()), Not(HasSubstr("not get there")));
}

/// What a sweep does not reach is out of reach of what was swept, not of the method.
TEST_F(ReportVerdict, SaysInWhichRangeAMethodMisses) {
  std::vector<json> cells = {cell("monolithic_al", json::object(), 0, 10)};
  for (const double stiffness : {1.0, 10.0, 100.0})
    cells.push_back(cell("penalty", {{"stiffness", stiffness}}, 1 / stiffness, 10));
  json about = description();
  about["accuracy"] = {1e-4};
  EXPECT_THAT(verdict_of(about, cells),
              HasSubstr("Penalty does not get there within the swept stiffness 1 to 100 (best 1&nbsp;%)."));
  for (std::size_t i = 1; i < cells.size(); ++i) cells[i]["status"] = "cap";
  EXPECT_THAT(verdict_of(about, cells), HasSubstr("within the swept stiffness 1 to 100 (no run converged)."));
}

/// Sentences and table say of which variant of the scene they are.
TEST_F(ReportVerdict, NamesItsVariant) {
  const std::string verdict = verdict_of(description(), recorded::in_two_scenes(three_methods()));
  EXPECT_THAT(verdict, AllOf(HasSubstr("Response within 1&nbsp;% at friction = 0.3: "),
                             HasSubstr("Derivative within 1&nbsp;% at friction = 0.3: "),
                             HasSubstr("on the same mesh (friction = 0.3).")));
  EXPECT_THAT(page(), AllOf(HasSubstr(">What accuracy costs: friction = 0.3</h3>"),
                            HasSubstr(">The solution: friction = 0.3</h2>")));
}

/// How far seconds spread is said where a timing pass measured it.
TEST_F(ReportVerdict, ShowsTheSpreadOfTimings) {
  auto cells = three_methods();
  EXPECT_THAT(verdict_of(description(), cells), Not(HasSubstr("median")));
  cells.back()["cost"]["timing"] = {{"repeat", 3}, {"median", {{"total", 22.5}, {"sensitivity", 0.5}}}};
  const std::string verdict = verdict_of(description(), cells);
  EXPECT_THAT(row(verdict, "Monolithic AL")[0], HasSubstr("20–22 s"));
  EXPECT_THAT(verdict, HasSubstr("times: least–median"));
  EXPECT_THAT(page(), HasSubstr("\"spread\":\"median\""));  // a line from each point in the charts against seconds
}

TEST_F(ReportVerdict, SaysWhatBesidesTheMethodErrs) {
  json about = description();
  const auto verdict_against = [&](const json& reference) {
    about["reference"] = json::array({reference});
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
  EXPECT_THAT(verdict, AllOf(HasSubstr("a tie (work within 5 %): <b>Penalty (stiffness=1e5)</b>, work 12 (10"),
                             HasSubstr("20&nbsp;s; <b>Monolithic AL</b>, work 12 (10 + 20), 20&nbsp;s.")));
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
  EXPECT_THAT(verdict, HasSubstr("<b>Uzawa AL anderson (scale=10 or 100)</b> is cheapest"));
  EXPECT_THAT(verdict, HasSubstr("Uzawa AL acceleration=none (scale=10 or 100) takes work 48 (40 + 80)"));
}

TEST_F(ReportVerdict, NamesTheFasterWhereTheClockDisagrees) {
  std::vector<json> cells = {cell("penalty", {{"stiffness", 1e5}}, 1e-5, 14),
                             cell("monolithic_al", json::object(), 0, 10)};
  cells[0]["cost"]["seconds"]["total"] = 5;
  const std::string verdict = verdict_of(description(), cells);
  EXPECT_THAT(row(verdict, "Penalty")[0], HasSubstr("&#9670;"));
  EXPECT_THAT(row(verdict, "Monolithic AL")[0], HasSubstr("&#9733;"));
  EXPECT_THAT(row(verdict, "Monolithic AL")[0], Not(HasSubstr("&#9670;")));
}

TEST_F(ReportVerdict, NamesAllThatAreAboutAsFast) {
  std::vector<json> cells = {cell("penalty", {{"stiffness", 1e5}}, 1e-9, 14), cell("uzawa_al", json::object(), 0, 16),
                             cell("monolithic_al", json::object(), 0, 10)};
  cells[0]["cost"]["seconds"]["total"] = 5;
  cells[1]["cost"]["seconds"]["total"] = 6;
  const std::string near = verdict_of(description(), cells);
  EXPECT_THAT(row(near, "Penalty")[0], HasSubstr("&#9670;"));
  EXPECT_THAT(row(near, "Uzawa AL")[0], HasSubstr("&#9670;"));
  cells[1]["cost"]["seconds"]["total"] = 7;
  EXPECT_THAT(row(verdict_of(description(), cells), "Uzawa AL")[0], Not(HasSubstr("&#9670;")));
  cells[2]["cost"]["seconds"]["total"] = 6;
  EXPECT_THAT(verdict_of(description(), cells), Not(HasSubstr("&#9670;")));
}

/// Of two of least work one may take far longer.
TEST_F(ReportVerdict, NamesTheFasterOfThoseOfLeastWork) {
  std::vector<json> cells = {cell("penalty", {{"stiffness", 1e5}}, 1e-5, 10),
                             cell("monolithic_al", json::object(), 0, 10)};
  cells[0]["cost"]["seconds"]["total"] = 1;
  const std::string verdict = verdict_of(description(), cells);
  EXPECT_THAT(row(verdict, "Penalty")[0], AllOf(HasSubstr("&#9733;"), HasSubstr("&#9670;")));
  EXPECT_THAT(row(verdict, "Monolithic AL")[0], AllOf(HasSubstr("&#9733;"), Not(HasSubstr("&#9670;"))));
}

TEST_F(ReportVerdict, NamesTheLeastWorkFirstAndThenWhatIsNearIt) {
  std::vector<json> cells = {cell("penalty", {{"stiffness", 1e5}}, 1e-5, 10),
                             cell("monolithic_al", json::object(), 0, 10)};
  cells[0]["cost"]["counts"]["backsolves"] = 21;
  EXPECT_THAT(verdict_of(description(), cells),
              AllOf(HasSubstr("a tie (work within 5 %): <b>Monolithic AL</b>, work 12 (10 "),
                    HasSubstr("; <b>Penalty (stiffness=1e5)</b>, work 12 (10 + 21), 20&nbsp;s."),
                    HasSubstr("&#9733; least work, up to 5 %</caption>")));
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
  EXPECT_THAT(page_of(2), HasSubstr("\"height\":200.0"));
  EXPECT_THAT(page_of(6), testing::AllOf(HasSubstr("\"height\":160.0"), Not(HasSubstr("\"height\":200.0"))));
}

TEST_F(ReportVerdict, ComesFirstOnThePage) {
  record(description(), three_methods());
  const std::string text = recorded::without_scripts(page());
  EXPECT_LT(text.find("is cheapest"), text.find("What accuracy costs"));
  EXPECT_LT(text.find("class=\"verdict\""), text.find("id=\"findings\""));
  EXPECT_LT(text.find("What accuracy costs"), text.find("class=\"verdict\""));
  EXPECT_LT(text.find("id=\"findings\""), text.find("id=\"reading\""));
}

}  // namespace
}  // namespace stickslip
