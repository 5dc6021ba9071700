/// The page of a single run.
#include <gmock/gmock.h>

#include <fstream>

#include "studies/io/atomic_file.hpp"
#include "studies/report/report.hpp"
#include "studies/run/fields.hpp"
#include "studies/run/film.hpp"
#include "studies/run/picture_json.hpp"
#include "tests/studies/cases.hpp"
#include "tests/studies/recorded_study.hpp"
#include "tests/studies/report_page.hpp"

namespace stickslip {
namespace {

using recorded::json;
using testing::AllOf;
using testing::HasSubstr;
using testing::Not;
namespace fs = std::filesystem;

class ReportOfARun : public recorded::StudyOnDisk {
 protected:
  /// What `run --report` leaves of a shipped scene, and its page without scripts.
  std::string page_of(const std::string& scene, bool with_picture = true) {
    const auto document = cases::load(cases::shipped / (scene + ".json"));
    return page_of(cases::run(document, document["method"], cases::shipped / (scene + ".json")), with_picture);
  }
  std::string page_of(const CaseResult& result, bool with_picture = true) {
    std::ofstream(directory_ / "result.json") << result_json(result, "").dump();
    if (with_picture) {
      json drawn = picture_json(result);
      drawn["interface"] = interface_json(result);
      drawn["film"] = film_json(result);
      std::ofstream(directory_ / "picture.json") << drawn.dump();
    }
    return written();
  }
  /// A file of its figures.
  std::string text_of(const std::string& name) const { return read_file(directory_ / "figures" / name); }
  std::string written() {
    write_run_report(directory_);
    return recorded::without_scripts(read_file(directory_ / "report.html"));
  }
};

TEST_F(ReportOfARun, HasPictureHistoriesStatesAndValues) {
  const std::string html = page_of("belt");
  EXPECT_THAT(html, AllOf(HasSubstr("<h1>Belt over a drum: tension from friction</h1>"), HasSubstr("id=\"overview\""),
                          HasSubstr("id=\"response-histories\""), HasSubstr("id=\"tractions\""),
                          HasSubstr("id=\"film\""), HasSubstr("Monolithic AL, 4 steps: converged with"),
                          HasSubstr("<th scope=\"col\" class=\"n\">d / d mu</th>"), HasSubstr("<caption>Steps")));
  EXPECT_THAT(html, AllOf(HasSubstr("<caption>What each effect of the scene added"), HasSubstr("direct sensitivity"),
                          HasSubstr(">off<")));
  EXPECT_THAT(html, AllOf(Not(HasSubstr("most accurate run of each method")), Not(HasSubstr("class=\"verdict\""))));
  EXPECT_TRUE(fs::exists(directory_ / "figures" / "response-histories.csv"));
}

/// As 0.1.0 wrote it: no ledger, parameters, picture or certificate; warnings are texts.
TEST_F(ReportOfARun, OpensWhatAnEarlierVersionWrote) {
  fs::copy(STICKSLIP_SOURCE_DIR "/tests/studies/earlier_run", directory_);
  EXPECT_THAT(written(), AllOf(HasSubstr("<h1>an earlier run</h1>"), HasSubstr("Monolithic AL, 1 step: converged with"),
                               HasSubstr("Warning (of an earlier version): the mesh is coarse; run it again."),
                               HasSubstr("0.1.0"), HasSubstr("d / d g0</th>"), HasSubstr("id=\"histories\"")));
}

/// A slider over the steps whose fields were kept, the last of them first.
TEST_F(ReportOfARun, HasASliderOverTheStepsThatWereKept) {
  const auto document = cases::load(cases::shipped / "ironing.json");
  const auto result = cases::run(document, document["method"], cases::shipped / "ironing.json");
  EXPECT_THAT(page_of(result), Not(HasSubstr("id=\"steps\"")));
  json drawn = picture_json(result, 1);
  drawn["interface"] = interface_json(result);
  std::ofstream(directory_ / "picture.json") << drawn.dump();
  const std::string html = written();
  EXPECT_THAT(html, AllOf(HasSubstr("<input type=\"range\" autocomplete=\"off\" min=\"0\" max=\"6\" value=\"6\">"),
                          HasSubstr("data-words=\"start, t = 0: "), HasSubstr("id=\"step-tractions\"")));
  std::size_t pictures = 0, hidden = 0;
  for (const auto& tag : recorded::tags_of(html))
    if (tag.attributes.find("class=\"step drawn\"") != std::string::npos) {
      ++pictures;
      hidden += tag.attributes.ends_with(" hidden");
    }
  EXPECT_EQ(pictures, 7u);
  EXPECT_EQ(hidden, 6u);
}

TEST_F(ReportOfARun, TheStepTableSaysHowManyIterationsTheHistoryHolds) {
  EXPECT_THAT(page_of("ironing"),
              AllOf(HasSubstr(">in the history</th>"), HasSubstr("History: lines recorded for the last attempt")));
}

// The total is of the solve and its derivatives; output comes on top of it.
TEST_F(ReportOfARun, TellsTheSecondsOfTheSolveWhateverItsOutputTook) {
  page_of("belt");
  std::ifstream in(directory_ / "result.json");
  json record = json::parse(in);
  record["cost"]["seconds"]["total"] = 2;
  record["cost"]["seconds"]["output"] = 1.5;
  std::ofstream(directory_ / "result.json") << record.dump();
  EXPECT_THAT(written(), HasSubstr("back-solves in 2&nbsp;s."));
}

TEST_F(ReportOfARun, OfAFrictionlessSceneDoesNotSayThatItSlips) {
  const std::string html = page_of("press_fit");
  EXPECT_THAT(html, AllOf(HasSubstr("fit: touch"), HasSubstr(">touches<"), Not(HasSubstr("fit: slip")),
                          Not(HasSubstr(">slips<")), Not(HasSubstr("tangential traction q"))));
}

/// At the last step of this scene nothing touches.
TEST_F(ReportOfARun, OfAFrictionlessSceneThatEndsOpenSpeaksOfNoSlipAndDrawsNoTractions) {
  const std::string html = page_of("indentation");
  EXPECT_THAT(html, AllOf(HasSubstr("id=\"derivative-histories\""), Not(HasSubstr("begins to slip")),
                          Not(HasSubstr("tangential")), Not(HasSubstr("id=\"tractions\""))));
}

/// The block of the slider, dragged to the edge of its cone at the third step of five, and on.
json dragged_block() {
  json document = cases::load(cases::shipped / "slider.json");
  document["supports"][0]["move"]["x"] = {{0, 0}, {1, 0.05}};
  document["time"] = {{"end", 1}, {"steps", 5}};
  document["parameters"] = {{"U", "/supports/0/move/x/1/1"}, {"mu", "/contacts/sole/friction"}};
  return document;
}

TEST_F(ReportOfARun, HasMarginsAsATableAndAsAMap) {
  const json document = dragged_block();
  const std::string html = page_of(cases::run(document, document["method"], cases::shipped / "slider.json"));
  EXPECT_THAT(html, AllOf(HasSubstr(">Where derivatives hold</h2>"), HasSubstr("id=\"nearest-change\""),
                          HasSubstr("<caption>Margins of every step"), HasSubstr(">two sides<"),
                          HasSubstr(">0, at a change<"), HasSubstr(">mu may change by</th>")));
  const std::string csv = text_of("nearest-change.csv");
  EXPECT_THAT(csv, HasSubstr("parameter,above,below,differentiable,time,value"));
  EXPECT_THAT(csv, HasSubstr("U,0,0,false,0.6"));
}

/// At t = 0.6 the derivative by U is 0 from below and 0.6 from above: both are points, and no curve passes.
TEST_F(ReportOfARun, DrawsNoDerivativeWithTwoSidesAsAPointOfACurve) {
  const json document = dragged_block();
  const std::string html = page_of(cases::run(document, document["method"], cases::shipped / "slider.json"));
  EXPECT_THAT(html, HasSubstr("values from below and from above differ at a step, the curve has a gap"));
  std::istringstream rows(text_of("derivative-histories.csv"));
  std::vector<std::string> at_the_edge;
  for (std::string row; std::getline(rows, row);)
    if (row.find("d u / d U") != std::string::npos && row.find("0.6") != std::string::npos) at_the_edge.push_back(row);
  ASSERT_EQ(at_the_edge.size(), 2u);
  EXPECT_THAT(at_the_edge[0], HasSubstr("from below"));
  EXPECT_THAT(at_the_edge[1], HasSubstr("from above"));
}

TEST_F(ReportOfARun, OfAnAdjointHasTheMarginsAndNoMap) {
  json document = dragged_block();
  document["sensitivity"] = {{"mode", "adjoint"}};
  document["objectives"]["J"] = {{"of", "u"}, {"at", 1}};
  const std::string html = page_of(cases::run(document, document["method"], cases::shipped / "slider.json"));
  EXPECT_THAT(html, AllOf(HasSubstr("<caption>Margins of every step"), HasSubstr(">two sides<"),
                          Not(HasSubstr("id=\"nearest-change\""))));
}

/// The two charts of the histories stand side by side below the picture; one alone stands beside it.
TEST_F(ReportOfARun, TwoHistoriesHaveARowOfTheirOwn) {
  const std::string row = "<div class=\"first histories\">";
  const std::string with_loop = page_of("slider");
  EXPECT_THAT(with_loop, AllOf(HasSubstr(row), HasSubstr("response over time"), HasSubstr("force along displacement")));
  EXPECT_LT(with_loop.find("id=\"overview\""), with_loop.find(row));
  EXPECT_LT(with_loop.find(row), with_loop.find("force along displacement"));
  const std::string alone = page_of("pull_out");
  EXPECT_THAT(alone, AllOf(Not(HasSubstr(row)), Not(HasSubstr("force along displacement"))));
}

/// Of the slider u follows U0, and no force does: what their derivatives hold is rounding.
TEST_F(ReportOfARun, HasZeroForWhatIsRounding) {
  const std::string html = page_of("slider");
  const auto row = html.substr(html.find("<td>pull</td>"), 400);
  EXPECT_THAT(row.substr(0, row.find("</tr>")), testing::ContainsRegex("\"n\">0</td>"));
}

/// A run without augmentations has no sawtooth to explain.
TEST_F(ReportOfARun, SpeaksOfAugmentationsWhereThereAreSome) {
  EXPECT_THAT(page_of("slider"), AllOf(HasSubstr("<p>The load step that took most"), Not(HasSubstr("sawtooth"))));
}

TEST_F(ReportOfARun, StatesOfManyContactsShareAColumn) {
  EXPECT_THAT(page_of("slider"), HasSubstr("sole: stick</th>"));
  json result = json::parse(std::ifstream(directory_ / "result.json"));
  for (auto& step : result["steps"])
    for (const char* name : {"a", "b", "c"}) step["contacts"][name] = {{"open", 1}, {"stick", 2}, {"slip", 3}};
  result["steps"][0]["contacts"]["a"]["open"] = 7;  // else the column would be the same in every row
  std::ofstream(directory_ / "result.json") << result.dump();
  EXPECT_THAT(written(), AllOf(HasSubstr("a: open / stick / slip</th>"), HasSubstr(">7 / 2 / 3</td>"),
                               Not(HasSubstr("a: stick</th>"))));
}

TEST_F(ReportOfARun, WithoutAPictureSaysHowToGetOne) {
  const std::string html = page_of("slider", false);
  EXPECT_THAT(html, AllOf(HasSubstr("run --report"), HasSubstr("id=\"response-histories\""), HasSubstr("mu")));
}

TEST_F(ReportOfARun, EscapesHostileNames) {
  page_of("stop");
  json result = json::parse(std::ifstream(directory_ / "result.json"));
  const std::string hostile = "<img src=x onerror=alert(1)>";
  result["scene"]["title"] = result["message"] = result["status"] = hostile;
  for (auto& step : result["steps"]) {
    step["responses"][hostile] = 1;
    step["sensitivities"][hostile] = {{hostile, 2}};
    step["contacts"][hostile] = {{"open", 1}};
  }
  std::ofstream(directory_ / "result.json") << result.dump();
  const std::string html = written();
  for (const auto& tag : recorded::tags_of(html)) EXPECT_NE(tag.name, "img");
  EXPECT_THAT(html, HasSubstr("&lt;img src=x"));
}

/// A block that is pressed, and then pushed by more than friction can hold, in `steps` steps; of one, the first fails.
CaseResult pushed_away(int steps) {
  const json scene = {
      {"bodies",
       {{"b",
         {{"mesh", {{"box", {{"min", {0, 0}}, {"max", {2, 1}}, {"cells", {8, 2}}}}}},
          {"material", {{"linear_elastic", {{"E", 1000}, {"nu", 0.3}}}}}}}}},
      {"obstacles", {{"floor", {{"plane", {{"point", {0, 0}}, {"normal", {0, 1}}}}}}}},
      {"contacts", {{"sole", {{"slave", "b.bottom"}, {"master", "floor"}, {"friction", 0.3}}}}},
      {"loads",
       {{{"on", "b.top"}, {"traction", {0, -10}}},
        {{"on", "b.top"}, {"traction", {40, 0}}, {"history", {{0, 0}, {0.5, steps == 1 ? 0.5 : 0.05}, {1, 1}}}}}},
      {"time", {{"end", 1}, {"steps", steps}}},
      {"responses",
       {{"n", {{"contact_force", {{"contact", "sole"}, {"component", "normal"}}}}},
        {"aside", {{"displacement", {{"on", "b.top"}, {"component", "x"}}}}}}},
      {"objectives", {{"J", {{"of", "aside"}, {"sum", true}}}}},
      {"parameters", {{"mu", "/contacts/sole/friction"}}}};
  return cases::run(scene, {{"monolithic_al", json::object()}}, "pushed.json");
}

TEST_F(ReportOfARun, WithoutASolutionShowsTheLastStepThatHasOneUnderABanner) {
  const auto result = pushed_away(2);
  ASSERT_EQ(result.status(), Status::no_equilibrium);
  const json document = json::parse(result_json(result, "").dump());
  const json &solved = document["steps"][0], &failed = document["steps"].back();
  EXPECT_TRUE(solved.contains("responses") && solved.contains("sensitivities") && solved.contains("margins"));
  for (const char* answer : {"responses", "sensitivities", "one_sided", "differentiable", "contacts", "margins"})
    EXPECT_FALSE(failed.contains(answer)) << answer;
  EXPECT_TRUE(failed["iterate"]["responses"].contains("n") && failed["iterate"]["contacts"].contains("sole"));
  EXPECT_TRUE(document["objectives"]["J"]["value"].is_null());
  const json picture = picture_json(result);
  const auto& x = result.steps[0].increment->state.displacement;
  EXPECT_EQ(field_files(result, 1), (std::vector<std::string>{"fields.pvd", "fields_0000.vtu", "obstacles_0000.vtu",
                                                              "fields_0001.vtu", "obstacles_0001.vtu"}));
  EXPECT_EQ(film_json(result)["times"], json::parse("[0.5]"));
  EXPECT_NE(picture.dump().find(json(x[x.size() - 2]).dump()), std::string::npos);
  const std::string html = page_of(result);
  EXPECT_THAT(html,
              AllOf(HasSubstr("<p class=\"banner\"><strong>No solution at t = 1: no equilibrium.</strong> What is "
                              "shown is the last step that converged, t = 0.5.</p>"),
                    HasSubstr("Responses at the last step that converged, and their derivatives"),
                    HasSubstr("id=\"overview\"")));
}

TEST_F(ReportOfARun, InSpaceDrawsLinesOnItsObstacles) {
  const auto picture_of = [](const char* strain) {
    json scene = json::parse(R"({
      "space": "solid",
      "bodies": {"block": {"mesh": {"box": {"min": [0, 0, 0], "max": [1, 1, 1], "cells": [1, 1, 1]}},
                           "material": {"neo_hookean": {"E": 1000, "nu": 0.3}}}},
      "obstacles": {"floor": {"plane": {"point": [0, 0, 0], "normal": [0, 0, 1]}},
                    "ball": {"sphere": {"center": [0.5, 0.5, 2], "radius": 1}, "move": {"z": [[0, 0], [1, -0.01]]}},
                    "drum": {"cylinder": {"point": [3, 0, 0.5], "axis": [0, 1, 0], "radius": 2}}},
      "contacts": {"sole": {"slave": "block.bottom", "master": "floor"}, "top": {"slave": "block.top", "master": "ball"},
                   "side": {"slave": "block.right", "master": "drum"}},
      "supports": [{"on": "block.left", "move": {"x": 0}}, {"on": "block.front", "move": {"y": 0}}],
      "time": {"end": 1, "steps": 1}, "method": {"monolithic_al": {}}})");
    scene["strain"] = strain;
    if (scene["strain"] == "small")
      scene["bodies"]["block"]["material"] = {{"linear_elastic", {{"E", 1000}, {"nu", 0.3}}}};
    return picture_json(cases::run(scene, {{"monolithic_al", json::object()}}, "space.json"));
  };
  const json small = picture_of("small")["obstacles"], finite = picture_of("finite")["obstacles"];
  std::map<std::size_t, int> lines;  // by their points
  for (const auto& obstacle : small) ++lines[obstacle["wire"]["points"].size()];
  EXPECT_EQ(lines,
            (std::map<std::size_t, int>{{2, 18 + 16}, {49, 11 + 5}}));  // of the plane, the drum; of both round ones
  ASSERT_EQ(finite.size(), small.size());
  int moved = 0;
  for (std::size_t i = 0; i < small.size(); ++i) {
    const json by = small[i]["wire"]["moved"]["by"], from = small[i]["wire"]["points"][0],
               to = finite[i]["wire"]["points"][0];
    moved += by != json({0.0, 0.0});
    EXPECT_FALSE(finite[i]["wire"].contains("moved")) << "drawn where it is";
    for (int k : {0, 1}) EXPECT_NEAR(to[k], from[k].get<double>() + by[k].get<double>(), 1e-12) << i;
  }
  EXPECT_EQ(moved, 11) << "the ball";
}

TEST_F(ReportOfARun, ThatIsInaccurateSaysNotToUseItsValues) {
  const auto document = cases::load(cases::shipped / "stop.json");
  const std::string file = cases::shipped / "stop.json";
  const std::string stiff = page_of(cases::run(document, {{"penalty", {{"stiffness", 1e16}}}}, file));
  EXPECT_THAT(stiff, AllOf(HasSubstr("<p class=\"banner\"><strong>Inaccurate.</strong>"),
                           HasSubstr("Responses at the last step, and")));
  EXPECT_THAT(page_of(cases::run(document, {{"penalty", {{"stiffness", 1e3}}}}, file)), Not(HasSubstr("banner\"")));
}

TEST_F(ReportOfARun, WithoutAnySolutionShowsTheStartUnderABanner) {
  const auto result = pushed_away(1);
  ASSERT_EQ(result.steps.size(), 1u);
  EXPECT_EQ(field_files(result, 1), std::vector<std::string>{"fields.pvd"});
  const std::string html = page_of(result);
  EXPECT_THAT(html, AllOf(HasSubstr("No step before it converged: what is shown is the start."),
                          HasSubstr("id=\"overview\""), Not(HasSubstr("<caption>Responses"))));
}

TEST_F(ReportOfARun, SaysThatAnEditedResultIsNone) {
  std::ofstream(directory_ / "result.json") << "[]";
  EXPECT_THROW(write_run_report(directory_), std::runtime_error);
}

}  // namespace
}  // namespace stickslip
