/// The sentences of a report, and what it holds its errors against.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>
#include <string>

#include "studies/report/charts.hpp"
#include "studies/report/headline.hpp"
#include "studies/report/records.hpp"
#include "studies/report/settings.hpp"
#include "tests/studies/recorded_study.hpp"
#include "tests/studies/report_page.hpp"

namespace stickslip {
namespace {

using nlohmann::json;
using recorded::all_of;
using recorded::cell;
using recorded::description;
using recorded::three_methods;
using recorded::without_scripts;
using report::Against;
using report::Of;
using testing::AllOf;
using testing::HasSubstr;
using testing::Not;

class ReportHeadline : public recorded::StudyOnDisk {};

TEST_F(ReportHeadline, HeadlineSaysHowThePenaltysErrorFallsAndLeavesTheCheapestToTheVerdict) {
  record(description(), three_methods());
  const std::string text = all_of(report::headline(study()));
  EXPECT_THAT(text, HasSubstr("Penalty's error falls as stiffness to the power -1 down to 1e-9 at stiffness 1e9."));
  EXPECT_THAT(text, Not(HasSubstr("factorisations")));
}

TEST_F(ReportHeadline, HeadlineSaysForWhichSceneThePenaltysErrorFallsAndWhereItFails) {
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

TEST_F(ReportHeadline, SaysHowFarTheOtherVariantsAreOff) {
  std::vector<json> cells;
  for (const auto& [h, off] : {std::pair{4, 0.3}, {2, 0.12}, {1, 0.01}})
    for (json row : three_methods()) {
      row["vary"] = {{"h", h}};
      row["id"] = row["id"].get<std::string>() + std::to_string(h);
      row["errors"]["discretization"] = {{"response:press", off * (row["method"].contains("penalty") ? 2 : 1)}};
      cells.push_back(row);
    }
  record(description(), cells);
  EXPECT_THAT(all_of(report::headline(study())),
              HasSubstr("These figures are for h = 1; the charts offer the others. Their best runs are off by 30 % at "
                        "h = 4 and 12 % at h = 2."));
}

TEST_F(ReportHeadline, SaysForEachSceneWhichMethodIsCheapest) {
  std::vector<json> cells = three_methods();
  for (json row : three_methods()) {
    row["scene"] = "b.json";
    row["id"] = row["id"].get<std::string>() + "b";
    if (row["method"].contains("penalty")) row["errors"]["enforcement"]["response:press"] = 1e-9;
    row["cost"]["counts"]["factorizations"] = row["method"].contains("penalty") ? 3 : 30;
    cells.push_back(row);
  }
  for (std::size_t i = 0; i < cells.size() / 2; ++i) cells[i]["scene"] = "a.json";
  json study = description();
  study["scenes"] = {"a.json", "b.json"};
  study["scene_titles"] = {{"a.json", "A"}, {"b.json", "B"}};
  record(study, cells);
  const std::string html = page();
  const auto table = html.substr(html.find("Which method is cheapest, scene by scene"), 3000);
  EXPECT_THAT(table, HasSubstr("<th scope=\"row\">a.json: A</th>"));
  EXPECT_THAT(table, HasSubstr("<th scope=\"row\">b.json: B</th>"));
  const auto of_a = table.substr(table.find("a.json"), table.find("b.json") - table.find("a.json"));
  const auto of_b = table.substr(table.find("b.json"), table.find("</table>") - table.find("b.json"));
  EXPECT_THAT(of_a, HasSubstr("Monolithic AL"));
  EXPECT_THAT(of_b, HasSubstr("Penalty"));
  EXPECT_THAT(of_b, Not(HasSubstr("Monolithic AL")));
  for (auto& row : cells)
    if (row["scene"] == "b.json") row["status"] = "cap";
  record(study, cells);
  EXPECT_THAT(page(), HasSubstr(">no run converged</td>"));
}

TEST_F(ReportHeadline, SaysWhatVariesTogether) {
  std::vector<json> cells = three_methods();
  for (json row : three_methods()) {
    row["id"] = row["id"].get<std::string>() + "b";
    row["vary"] = {{"/bodies/a/mesh/gmsh", "fine.msh"}, {"/time/legs", {{1, 2}}}};
    cells.push_back(row);
  }
  for (std::size_t i = 0; i < cells.size() / 2; ++i)
    cells[i]["vary"] = {{"/bodies/a/mesh/gmsh", "coarse.msh"}, {"/time/legs", {{1, 1}}}};
  json study = description();
  study["vary"] = {
      {"meshes", {{"/bodies/a/mesh/gmsh", {"coarse.msh", "fine.msh"}}, {"/time/legs", {{{1, 1}}, {{1, 2}}}}}}};
  record(study, cells);
  EXPECT_THAT(this->study().variants, testing::ElementsAre("meshes (gmsh = coarse.msh)", "meshes (gmsh = fine.msh)"));
  EXPECT_THAT(page(), HasSubstr("Varied together as meshes, 2 variants: /bodies/a/mesh/gmsh, /time/legs."));
}

/// Which methods are lost where comes before who is the cheapest.
TEST_F(ReportHeadline, SaysWhichMethodsConvergeWhere) {
  std::vector<json> cells;
  for (const double friction : {0.1, 0.3, 0.4})
    for (auto& c : three_methods()) {
      c["id"] = std::to_string(cells.size());
      c["vary"] = {{"/contacts/sole/friction", friction}};
      if (friction == 0.4 && !c["method"].contains("monolithic_al")) c["status"] = "cap";
      cells.push_back(c);
    }
  record(description(), cells);
  EXPECT_EQ(report::failures(study()),
            "At friction = 0.4 only Monolithic AL converged. 6 of 21 runs did not converge (6 cap).");
  const std::string text = without_scripts(page());
  EXPECT_LT(text.find("At friction = 0.4 only Monolithic AL converged."), text.find("is cheapest"));
  for (auto& c : cells)
    if (c["method"].contains("uzawa_al")) c["status"] = "cycle";
  record(description(), cells);
  EXPECT_THAT(report::failures(study()),
              HasSubstr("At friction = 0.1 and friction = 0.3 no run of Uzawa AL converged."));
  record(description(), three_methods());
  EXPECT_EQ(report::failures(study()), "");
}

TEST_F(ReportHeadline, NamesTheReferenceAndThatItIsOneOfTheRuns) {
  json about = description();
  about["reference"] = {{{"method", {{"monolithic_al", json::object()}}}}};
  record(about, three_methods());
  EXPECT_EQ(report::reference_run(study()), "Monolithic AL, one of the runs");
  EXPECT_THAT(page(), HasSubstr("Error of the worst response against Monolithic AL, one of the runs."));
  about["reference"][0] = {{"method", {{"penalty", {{"stiffness", 1e12}}}}}};
  record(about, three_methods());
  EXPECT_EQ(report::reference_run(study()), "Penalty, run as the reference only");
}

/// The picture is of one run, and says of which.
TEST_F(ReportHeadline, NamesTheRunOfThePicture) {
  json about = description();
  const auto cells = recorded::in_two_scenes(three_methods());
  about["cells"] = {"another", cells.back()["id"]};
  record(about, cells, recorded::picture());
  EXPECT_EQ(report::run_of_picture(study()), "Monolithic AL, friction = 0.3");
  EXPECT_THAT(page(), HasSubstr("Monolithic AL, friction = 0.3. At the last step: "));
}

TEST_F(ReportHeadline, DefinesWorkAtItsAxis) {
  record(description(), three_methods());
  EXPECT_EQ(report::work_in_words(study()), "work (factorisations + 0.1 back-solves)");
  EXPECT_THAT(page(), HasSubstr("\"title\":\"work (factorisations + 0.1 back-solves)\""));
}

TEST_F(ReportHeadline, NamesWhatTheDiscretisationErrorIsAgainst) {
  json study_json = description();
  const json method = {{"method", {{"monolithic_al", json::object()}}}}, fine = {{"overkill", {{"refine", 2}}}};
  const json closed = {{"analytic", "hertz_line"}}, given = {{"values", {{"press", 9.9}}}};
  const json file = {{"overkill", {{"vary", {{"/bodies/foot/mesh/gmsh", "fine.msh"}}}, {"refine", 1}}}};
  for (const auto& [references, words] :
       {std::pair{json{method, closed}, "the closed form"}, std::pair{json{method, fine}, "the finer mesh"},
        std::pair{json{method, file}, "the common mesh (fine.msh, 1 level finer)"},
        std::pair{json::array({given}), "the given values"}, std::pair{json{closed, fine}, "the references"}}) {
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

TEST_F(ReportHeadline, HeadlineSaysWhatTheDistanceFromAReferenceIs) {
  auto cells = three_methods();
  json told = description();
  const auto said = [&](const json& reference) {
    told["reference"] = json::array({reference});
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
TEST_F(ReportHeadline, HeadlineTakesTheMeshsErrorOfTheRunThatEnforcesContactBest) {
  auto cells = three_methods();
  cells[0]["errors"]["discretization"]["response:press"] = 1e-5;
  record(description(), cells);
  EXPECT_THAT(all_of(report::headline(study())), HasSubstr("is off by 1 % in its worst response"));
  EXPECT_EQ(report::own_error(study(), Of::responses), 0.01);
}

TEST_F(ReportHeadline, FoldsAwayWhatIsExactForMostRuns) {
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

/// The KKT measures are no errors: nothing may be called accurate by them.
TEST_F(ReportHeadline, OfAStudyWithoutReferencesSaysThatNoErrorWasMeasured) {
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

TEST_F(ReportHeadline, OfAMergedStudySaysWhatTheCommandWas) {
  json merged = description();
  merged["command"] = "stickslip merge p1 p2 -o m";
  merged["cells"] = {"none"};
  record(merged, three_methods());
  const std::string html = without_scripts(page());
  EXPECT_THAT(html, AllOf(HasSubstr("joined by:</p><pre>stickslip merge p1 p2 -o m"), HasSubstr("and merge again"),
                          Not(HasSubstr("This repeats the study")), Not(HasSubstr("the command at the end"))));
}

TEST_F(ReportHeadline, HeadlineSeesRoundingLiftThePenaltysError) {
  auto cells = three_methods();
  cells.push_back(cell("penalty", {{"stiffness", 1e12}}, 3e-4, 14));
  record(description(), cells);
  EXPECT_THAT(all_of(report::headline(study())), HasSubstr("and rises again beyond it, to 3e-4 at 1e12"));
}

}  // namespace
}  // namespace stickslip
