#include "studies/report/report.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <fstream>
#include <nlohmann/json.hpp>
#include <set>

#include "studies/app/compare_studies.hpp"
#include "studies/io/atomic_file.hpp"
#include "studies/io/result_rows.hpp"
#include "studies/report/charts.hpp"
#include "studies/report/disagreement.hpp"
#include "studies/report/headline.hpp"
#include "studies/report/records.hpp"
#include "studies/report/sample.hpp"
#include "tests/studies/recorded_study.hpp"
#include "tests/studies/report_page.hpp"

namespace stickslip {
namespace {

using nlohmann::json;
using recorded::cell;
using recorded::data_of;
using recorded::description;
using recorded::picture;
using recorded::tags_of;
using recorded::three_methods;
using recorded::without_scripts;
using report::Against;
using report::Of;
using testing::AllOf;
using testing::HasSubstr;
using testing::Not;

class Report : public recorded::StudyOnDisk {};

TEST_F(Report, LoadsNothingFromANetwork) {
  record(description(), three_methods(), picture());
  const std::string html = page();
  for (const auto& tag : tags_of(html)) {
    EXPECT_THAT(tag.name, testing::AnyOf("!DOCTYPE", Not(testing::AnyOf("link", "img", "iframe", "object", "embed"))));
    EXPECT_THAT(tag.attributes, AllOf(Not(HasSubstr("src=")), Not(HasSubstr("http://")), Not(HasSubstr("https://"))))
        << tag.name;
  }
  EXPECT_THAT(html, HasSubstr("default-src 'none'"));  // the browser refuses what the page should not ask for
  EXPECT_THAT(html.substr(0, html.find("</style>")), AllOf(Not(HasSubstr("@import")), Not(HasSubstr("url(http"))));
}

TEST_F(Report, ClosesEveryElementItOpensAndUsesEachIdOnce) {
  record(description(), three_methods(), picture());
  const std::set<std::string> void_elements = {"!DOCTYPE", "meta", "input", "br"};
  std::vector<std::string> open;
  std::set<std::string> ids;
  for (const auto& tag : tags_of(page())) {
    if (void_elements.count(tag.name)) continue;
    if (const std::size_t at = tag.attributes.find(" id=\""); at != std::string::npos) {
      const std::string id = tag.attributes.substr(at + 5, tag.attributes.find('"', at + 5) - at - 5);
      EXPECT_TRUE(ids.insert(id).second) << id;
    }
    if (tag.name.front() != '/') {
      open.push_back(tag.name);
      continue;
    }
    ASSERT_FALSE(open.empty()) << tag.name;
    ASSERT_EQ("/" + open.back(), tag.name);
    open.pop_back();
  }
  EXPECT_TRUE(open.empty());
}

TEST_F(Report, CarriesEachChartsRowsUnderOneListOfFields) {
  record(description(), three_methods(), picture());
  const auto charts = data_of(page());
  EXPECT_GE(charts.size(), 6u);  // two costs of accuracy, one closed form, a knob, tractions, histories at least
  for (const auto& chart : charts) {
    EXPECT_FALSE(chart["rows"].empty());
    EXPECT_FALSE(chart["charts"].empty());
    for (const auto& row : chart["rows"]) {
      EXPECT_FALSE(row.empty() || row.back().is_null());
      EXPECT_LE(row.size(), chart["fields"].size());
    }
  }
}

TEST_F(Report, CarriesEachTextOfAChartOnce) {
  record(description(), three_methods(), picture());
  for (const auto& chart : data_of(page())) {
    EXPECT_TRUE(chart["texts"].contains("series"));
    for (const auto& [field, texts] : chart["texts"].items()) {
      EXPECT_EQ(std::set<json>(texts.begin(), texts.end()).size(), texts.size()) << field;
      const auto& fields = chart["fields"];
      const auto place = static_cast<std::size_t>(std::find(fields.begin(), fields.end(), field) - fields.begin());
      for (const auto& row : chart["rows"])
        EXPECT_TRUE(row.size() <= place || row[place].is_null() || row[place].get<std::size_t>() < texts.size())
            << field;
    }
  }
}

/// Without scripts and on paper there are no controls.
TEST_F(Report, SaysInWordsWhatAChartShowsFirst) {
  auto cells = three_methods();
  for (auto& c : cells) c["errors"]["enforcement"]["response:pull"] = 1e-15;
  record(description(), cells);
  EXPECT_THAT(page(), HasSubstr("<p class=\"chosen\">Quantity: worst response</p>"));
}

TEST_F(Report, EscapesHostileNames) {
  record(description(), three_methods(), picture());
  const auto count_scripts = [](const std::string& html) {
    std::size_t n = 0;
    for (const auto& tag : tags_of(html)) n += tag.name == "script";
    return n;
  };
  const std::size_t ordinary = count_scripts(page());

  const std::string hostile = "</script><!--<script>\"'<img src=x onerror=alert(1)>&amp;{{css}}$ink";
  json study = description();
  for (const char* key : {"title", "command", "scene_title", "explain"}) study[key] = hostile;
  auto cells = three_methods();
  for (auto& c : cells) {
    c["label"] = c["label"].get<std::string>() + " " + hostile;
    c["message"] = c["provenance"]["cpu"] = hostile;
    c["interface"] = {{hostile, c["interface"]["sole"]}};
    c["errors"]["enforcement"]["response:" + hostile] = 1e-12;  // not the worst: the charts stay the same ones
    c["responses"][hostile] = 1;
  }
  cells.back()["status"] = hostile;
  json drawn = picture();
  drawn["contact"][0]["name"] = drawn["contact"][0]["state"] = hostile;
  record(study, cells, drawn);
  const std::string html = page();

  EXPECT_EQ(count_scripts(html), ordinary);
  for (const auto& tag : tags_of(html)) EXPECT_NE(tag.name, "img");
  EXPECT_THAT(without_scripts(html), HasSubstr("&lt;img src=x onerror=alert(1)&gt;&amp;amp;{{css}}$ink"));
  bool found = false;  // and the charts still know the name as it was
  for (const auto& chart : data_of(html))
    for (const auto& series : chart["series"])
      found = found || series["name"].get<std::string>().find(hostile) != std::string::npos;
  EXPECT_TRUE(found);
}

TEST_F(Report, SaysEachWarningOnceInTheWordsOfTheWorstRun) {
  auto cells = three_methods();
  const auto warn = [&](std::size_t n, const char* where, double value, const char* text) {
    cells[n]["warnings"].push_back(
        {{"code", "locking"}, {"where", where}, {"value", value}, {"remedy", "take <T6>"}, {"text", text}});
  };
  warn(0, "pad", 0.3, "pad locks half-heartedly");
  warn(1, "pad", 0.9, "pad locks");
  warn(1, "seal", 0.4, "seal locks");
  record(description(), cells, picture());
  const std::string html = without_scripts(page());
  EXPECT_THAT(html, HasSubstr("Warning (locking, 2 of 7 runs): pad locks; take &lt;T6&gt;."));
  EXPECT_THAT(html, HasSubstr("Warning (locking, 1 of 7 runs): seal locks; take &lt;T6&gt;."));
  EXPECT_THAT(html, testing::Not(HasSubstr("half-heartedly")));
}

TEST_F(Report, DrawsAnInaccurateRunAsACross) {
  auto cells = three_methods();
  cells[3]["status"] = "inaccurate";
  record(description(), cells, picture());
  EXPECT_THAT(without_scripts(page()), HasSubstr("1 of 7 runs did not converge (1 inaccurate)."));
  const auto figure = report::work_precision(study(), Against::same_mesh, Of::responses);
  const auto crosses = std::count_if(figure->rows.begin(), figure->rows.end(), [](const json& row) {
    return row["failed"].get<bool>() && row["status"] == "inaccurate";
  });
  EXPECT_GE(crosses, 1);
}

TEST_F(Report, KeepsFailedRunsAsRowsWithTheirStatus) {
  auto cells = three_methods();
  cells[3]["status"] = "not_finite";
  cells[3]["message"] = "step 2 of 10";
  cells[3]["errors"] = json::object();
  cells[4]["status"] = "cap";
  record(description(), cells, picture());
  const std::string html = without_scripts(page());
  EXPECT_THAT(html, HasSubstr("<tr class=\"failed\"><td>Penalty stiffness=1e9</td><td class=\"s\">not finite</td>"));
  EXPECT_THAT(html, HasSubstr("step 2 of 10"));
  EXPECT_THAT(html, HasSubstr("2 of 7 runs did not converge (1 cap, 1 not_finite)"));

  const auto figure = report::work_precision(study(), Against::same_mesh, Of::responses);
  int crosses = 0;
  for (const auto& row : figure->rows) crosses += row["failed"].get<bool>();
  EXPECT_EQ(crosses, 1);  // the one that left numbers
}

TEST_F(Report, WritesAPageWithoutResults) {
  record(description(), {});
  EXPECT_THAT(page(), AllOf(HasSubstr("The study has no results yet."), HasSubstr("stickslip study a.json -o out")));
}

TEST_F(Report, WritesAPageWhereEveryRunFailed) {
  auto cells = three_methods();
  for (auto& c : cells) {
    c["status"] = "singular";
    c["errors"] = json::object();
    c.erase("interface");
    c["steps"] = json::array();
  }
  record(description(), cells);
  EXPECT_THAT(page(), HasSubstr("7 of 7 runs did not converge (7 singular)"));
}

TEST_F(Report, WritesAPageFromRowsThatHoldNextToNothing) {
  const json bare = {{"status", "converged"}, {"cost", json::object()}};
  json penalty = bare, uzawa = bare;
  penalty.update({{"id", "a"}, {"method", {{"penalty", json::object()}}}});
  uzawa.update({{"id", "b"}, {"label", "uzawa_al"}});
  record(nullptr, {penalty, uzawa});
  EXPECT_THAT(page(), AllOf(HasSubstr("Penalty"), HasSubstr("Uzawa AL"), HasSubstr("Frictional contact study")));
}

/// Rows as 0.1.0 wrote them: no checksum, ledger, hash of the scene or curves of the contact; warnings are texts.
TEST_F(Report, OpensWhatAnEarlierVersionRecorded) {
  std::filesystem::copy(STICKSLIP_SOURCE_DIR "/tests/studies/earlier_study", directory_,
                        std::filesystem::copy_options::recursive);
  EXPECT_THAT(page(), AllOf(HasSubstr("an earlier study"), HasSubstr("Monolithic AL"), HasSubstr("stiffness=100")));
  const auto rows = read_rows(directory_).rows;
  ASSERT_EQ(rows.size(), 2u);
  const auto cells = compare_rows(rows, rows, {});
  EXPECT_EQ(cells.size(), 2u);
  for (const auto& cell : cells) EXPECT_TRUE(cell.changes.empty());
  EXPECT_TRUE(disagreements({&rows.begin()->second, &rows.rbegin()->second}).empty());
}

TEST_F(Report, SaysWhichLinesAreNoRowsAndShowsNothingOfThem) {
  auto cells = three_methods();
  cells[0]["label"] = "a damaged label";
  cells[0]["errors"]["enforcement"]["response:press"] = "small";
  record(description(), cells);
  std::ofstream(directory_ / "results.jsonl", std::ios::app) << "{\"id\": \"torn\n[1]\n{\"id\": ";
  EXPECT_THAT(page(), AllOf(HasSubstr("line 1 is no row and was dropped: /errors/enforcement/response:press is"),
                            HasSubstr("line 8 is no row"), HasSubstr("line 9 is no row"),
                            HasSubstr("a torn last line (7 bytes) was dropped"), Not(HasSubstr("a damaged label"))));
}

TEST_F(Report, SaysHowManyRunsAreNotRecordedYet) {
  auto study = description();
  auto cells = three_methods();
  study["cells"] = json::array({"a", "b"});
  for (const auto& c : cells) study["cells"].push_back(c["id"]);
  record(study, cells);
  EXPECT_THAT(page(), HasSubstr("Of the study's 9 runs 2 are not recorded"));
}

TEST_F(Report, TakesTheLastRecordOfAnId) {
  auto cells = three_methods();
  cells.push_back(cells[0]);
  cells.back()["status"] = "cap";
  record(description(), cells);
  ASSERT_EQ(study().cells.size(), 7u);
  EXPECT_EQ(study().cells[0].status, "cap");
}

TEST_F(Report, SaysWhichFileIsMissingOrBroken) {
  const auto message = [&] {
    try {
      write_report(directory_);
    } catch (const std::runtime_error& e) {
      return std::string(e.what());
    }
    return std::string();
  };
  EXPECT_THAT(message(), HasSubstr("results.jsonl"));
  record(description(), three_methods());
  const std::string before = page();
  std::ofstream(directory_ / "study.json") << "{";
  EXPECT_THAT(message(), HasSubstr("study.json"));
  EXPECT_EQ(read_file(directory_ / "report.html"), before);  // the former report stands
}

/// 4000 runs in 100 scenes: the page shows some of them run by run, and says so.
TEST_F(Report, OfManyRunsShowsSomeAndCountsAll) {
  std::vector<json> cells;
  for (int scene = 0; scene < 100; ++scene)
    for (int i = 0; i < 40; ++i) {
      cells.push_back(cell("penalty", {{"stiffness", 10.0 + i}}, 1e-3 / (1 + i), 10 + i));
      cells.back()["vary"] = {{"/contacts/sole/friction", 0.01 * scene}};
      if (i == 7) cells.back()["status"] = "cap";
    }
  record(description(), cells);
  const auto whole = study();
  ASSERT_EQ(whole.cells.size(), 4000u);
  const auto shown = report::sample_of(whole);
  EXPECT_LE(shown.cells.size(), 250u);
  EXPECT_EQ(shown.main_variant, whole.main_variant);
  EXPECT_EQ(std::count_if(shown.cells.begin(), shown.cells.end(),
                          [&](const auto& cell) { return cell.variant == shown.main_variant; }),
            40);
  const std::string text = page();
  EXPECT_THAT(text, HasSubstr("Of 4000 runs (100 cap, 3900 converged) the charts and tables show 240"));
  EXPECT_LT(text.size(), 2'000'000u);  // it has 1.75 million, 0.84 of them of the chart library
}

/// Of one scene with too many settings the best and the worst stay.
TEST_F(Report, OfManySettingsKeepsTheTellingOnes) {
  std::vector<json> cells;
  for (int i = 0; i < 1000; ++i)
    cells.push_back(cell("penalty", {{"stiffness", 10.0 + i}}, i == 333 ? 1e-9 : i == 777 ? 0.5 : 1e-3, 10 + i));
  record(description(), cells);
  const auto shown = report::sample_of(study());
  EXPECT_LE(shown.cells.size(), 250u);
  for (const double stiffness : {343.0, 787.0})
    EXPECT_TRUE(std::any_of(shown.cells.begin(), shown.cells.end(), [&](const auto& cell) {
      return report::find_knob(cell, "stiffness")->value == stiffness;
    })) << stiffness;
}

TEST_F(Report, WarnsWhereRunsComeFromUnlikeMachines) {
  auto cells = three_methods();
  record(description(), cells);
  EXPECT_THAT(page(), Not(HasSubstr("different builds or machines")));
  cells[1]["provenance"]["cpu"] = "another processor";
  record(description(), cells);
  EXPECT_THAT(page(), HasSubstr("2 different builds or machines"));
}

}  // namespace
}  // namespace stickslip
