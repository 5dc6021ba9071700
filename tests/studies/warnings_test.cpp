#include "studies/run/warnings.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <set>

#include "tests/studies/cases.hpp"
#include "tests/support/scenes.hpp"

namespace stickslip {
namespace {

using nlohmann::json;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

/// A block of 4 x 1 on another one of 8 x 1, pressed by `press` and pushed along by `push`.
json blocks(double press, double push, double friction) {
  const json material = {{"linear_elastic", {{"E", 1000}, {"nu", 0.3}}}};
  const auto box = [&](double left, double bottom, double right, int cells) {
    return json{{"mesh", {{"box", {{"min", {left, bottom}}, {"max", {right, bottom + 1}}, {"cells", {cells, 2}}}}}},
                {"material", material}};
  };
  return {{"bodies", {{"lower", box(0, 0, 8, 15)}, {"upper", box(2, 1, 6, 8)}}},
          {"contacts", {{"sole", {{"slave", "upper.bottom"}, {"master", "lower.top"}, {"friction", friction}}}}},
          {"supports",
           {{{"on", "lower.bottom"}, {"move", {{"x", 0}, {"y", 0}}}},
            {{"on", "upper.top"},
             {"move", {{"x", {{0, 0}, {1, 0}, {2, push}}}, {"y", {{0, 0}, {1, -press}, {2, -press}}}}}}}},
          {"time", {{"end", 2}, {"steps", 4}}}};
}

std::vector<Warning> warnings(const json& document) {
  return warnings_of(cases::run(document, {{"monolithic_al", json::object()}}, "blocks.json"));
}

/// A warning of that code about that place whose text has these words.
auto is(WarningCode code, const std::string& where, const std::string& words) {
  return testing::AllOf(testing::Field(&Warning::code, code), testing::Field(&Warning::where, where),
                        testing::Field(&Warning::text, HasSubstr(words)),
                        testing::Field(&Warning::remedy, testing::Not(IsEmpty())));
}

TEST(Warnings, AreNoneWhereSmallStrainHolds) { EXPECT_THAT(warnings(blocks(0.002, 0.02, 0.1)), IsEmpty()); }

TEST(Warnings, NameSlidingBeyondHalfAnElementWithItsLength) {
  // elements of 0.5; the sole lags behind the top by its shear, some 0.1 of it
  EXPECT_THAT(warnings(blocks(0.002, 1.0, 0.1)),
              ElementsAre(is(WarningCode::large_sliding, "sole", "sole: a point slides by 2 elements")));
}

TEST(Warnings, NameStrainAndRotation) {
  const auto found = warnings(blocks(0.3, 0.02, 0.1));
  EXPECT_THAT(found, testing::Contains(is(WarningCode::large_strain, "upper", "upper is strained by up to")));
  EXPECT_THAT(warnings(blocks(0.002, 0.02, 0.1)), IsEmpty());
  // a bar of 4 x 1 whose end turns by 6 degrees about its corner: without strain, but for what the support takes
  json turned = blocks(0.002, 0.02, 0.1);
  turned["contacts"] = json::object();
  turned["supports"] = {{{"on", "lower.bottom"}, {"move", {{"x", 0}, {"y", 0}}}},
                        {{"on", "upper.top"}, {"rotate", {{"center", {2, 2}}, {"angle", {{0, 0}, {2, 6}}}}}}};
  EXPECT_THAT(warnings(turned),
              testing::Contains(is(WarningCode::large_rotation, "upper", "upper rotates by up to 6")));
}

/// As where E is in Pa and the rest in N and mm.
TEST(Warnings, NameAPressedBodyThatIsHardlyStrained) {
  json stiff = blocks(0.002, 0.02, 0.1);
  stiff["bodies"].erase("lower");
  stiff["obstacles"] = {{"floor", {{"plane", {{"point", {0, 1}}, {"normal", {0, 1}}}}}}};
  stiff["contacts"]["sole"]["master"] = "floor";
  stiff["supports"] = {{{"on", "upper.top"}, {"move", {{"x", {{0, 0}, {1, 0}, {2, 0.02}}}}}}};
  stiff["loads"] = {{{"on", "upper.top"}, {"pressure", 10}, {"history", {{0, 0}, {1, 1}}}}};
  stiff["bodies"]["upper"]["material"]["linear_elastic"]["E"] = 210e9;
  const auto found = warnings(stiff);
  EXPECT_THAT(found, testing::Contains(is(WarningCode::tiny_strain, "upper", "upper is strained by no more than")));
  EXPECT_THAT(found, testing::Not(testing::Contains(testing::Field(&Warning::code, WarningCode::floating_body))));
  stiff["bodies"]["upper"]["material"]["linear_elastic"]["E"] = 1e3;
  EXPECT_THAT(warnings(stiff),
              testing::Not(testing::Contains(testing::Field(&Warning::code, WarningCode::tiny_strain))));
  stiff["bodies"]["upper"]["material"]["linear_elastic"]["E"] = 0.1;
  EXPECT_THAT(warnings(stiff),
              testing::Contains(testing::AllOf(testing::Field(&Warning::code, WarningCode::large_strain),
                                               testing::Field(&Warning::remedy, HasSubstr("units")))));
}

TEST(Warnings, NameFrictionThatNeverSlips) {
  EXPECT_THAT(
      warnings(blocks(0.002, 0, 5)),
      ElementsAre(is(WarningCode::idle_friction, "sole",
                     "sole: no point slipped in any step, so that the friction coefficient of 5 has no influence")));
}

TEST(Warnings, AreNotLookedForInWhatDidNotConverge) {
  json floating = blocks(0.002, 1.0, 0.1);
  floating["supports"].erase(1);
  floating["loads"] = {{{"on", "upper.top"}, {"traction", {0, 1}}}};
  EXPECT_THAT(warnings(floating), IsEmpty());
}

TEST(Warnings, SayWhatCutStepsMeanWithFriction) {
  // slip runs over 20 nodes in one step; a node an iteration
  const auto problem = std::make_shared<const Problem>(scenes::pull_out(30, {0, 1}, 1));
  UzawaAL frozen;  // with a frozen cone no motion stands in for Newton's method
  frozen.cone = UzawaAL::Cone::frozen;
  frozen.newton.max_iterations = 3;
  for (const Method& method : {Method(frozen), Method(MonolithicAL{})}) {
    std::shared_ptr<Condensation<double>> condensation;
    const auto result = run_case(problem, method, {}, condensation);
    ASSERT_TRUE(is_converged(result.status())) << result.message();
    const bool cut = result.trajectory.counters.cutbacks > 0;
    EXPECT_EQ(cut, std::holds_alternative<UzawaAL>(method));
    EXPECT_EQ(warnings_of(result).size(), cut ? 1 : 0);
    if (cut) {
      EXPECT_THAT(warnings_of(result),
                  ElementsAre(is(WarningCode::cut_steps, "", "1 of 1 steps were cut into smaller ones")));
    }
  }
}

TEST(Warnings, AreObjectsOfAClosedSetInEveryResult) {
  const auto result = cases::run(blocks(0.002, 1.0, 0.1), {{"monolithic_al", json::object()}}, "blocks.json");
  const auto written = result_json(result, "")["warnings"];
  ASSERT_EQ(written.size(), 1u);
  EXPECT_EQ(written[0]["code"], "large_sliding");
  EXPECT_EQ(written[0]["where"], "sole");
  EXPECT_NEAR(written[0]["value"], 2, 0.1);  // the push over an element of 0.5, but for what the blocks shear
  EXPECT_THAT(written[0]["remedy"].get<std::string>(), testing::Not(IsEmpty()));
  EXPECT_THAT(written[0]["text"].get<std::string>(), HasSubstr("slides by"));
  std::set<std::string_view> names;
  for (int code = 0; code <= static_cast<int>(WarningCode::non_unique); ++code)
    names.insert(name_of(static_cast<WarningCode>(code)));
  EXPECT_EQ(names.size(), 24u);
  EXPECT_EQ(names.count(""), 0u);
}

// --- locking ---------------------------------------------------------------------------------------------------------

/// A block of 2 x 2 on a floor, held along by its left side and pushed down by a punch on half of its top.
json rubber(const std::string& element, double nu, const std::string& space = "plane_strain", int cells = 8) {
  return {
      {"space", space},
      {"bodies",
       {{"pad",
         {{"mesh", {{"box", {{"min", {0, 0}}, {"max", {2, 2}}, {"cells", {cells, cells}}}}}},
          {"material", {{"linear_elastic", {{"E", 1000}, {"nu", nu}}}}},
          {"element", element}}}}},
      {"obstacles",
       {{"punch", {{"polyline", {{"points", {{1, 2}, {-1, 2}, {-1, 3}, {1, 3}, {1, 2}}}}}, {"move", {{"y", -0.01}}}}}}},
      {"contacts", {{"face", {{"slave", "pad.top"}, {"master", "punch"}}}}},
      {"supports",
       {{{"on", "pad.bottom"}, {"move", {{"x", 0}, {"y", 0}}}}, {{"on", "pad.left"}, {"move", {{"x", 0}}}}}},
      {"time", {{"end", 1}, {"steps", 1}}}};
}

bool locks(const json& document) {
  const auto found = warnings(document);
  return std::any_of(found.begin(), found.end(), [](const Warning& w) { return w.code == WarningCode::locking; });
}

TEST(Warnings, NameLockingWithItsMeasureAndARemedyThatMendsIt) {
  for (const char* space : {"plane_strain", "axisymmetric"})
    for (const char* element : {"Q4", "T3"})
      for (const double nu : {0.4999, 0.499999}) {
        const auto found = warnings(rubber(element, nu, space));
        const std::string what = std::string(space) + " " + element + " " + std::to_string(nu);
        ASSERT_THAT(found, testing::Contains(is(WarningCode::locking, "pad", "pad locks: nu = 0.4999"))) << what;
        EXPECT_GT(found.front().value, 0.2) << what;
        EXPECT_FALSE(locks(rubber(element == std::string("Q4") ? "Q4_mean_dilatation" : "T6", nu, space))) << what;
        EXPECT_FALSE(locks(rubber("Q8", nu, space))) << what;
      }
}

TEST(Warnings, SayNothingOfLockingWhereItDoesNoHarm) {
  for (const char* element : {"Q4", "T3"}) {
    EXPECT_FALSE(locks(rubber(element, 0.3))) << element;
    EXPECT_FALSE(locks(rubber(element, 0.4))) << element;
    EXPECT_FALSE(locks(rubber(element, 0.4999, "plane_stress"))) << element;
    // pressed evenly on a smooth floor: one pressure everywhere
    json even = rubber(element, 0.4999);
    even["obstacles"]["punch"] = {{"plane", {{"point", {0, 2}}, {"normal", {0, -1}}}}, {"move", {{"y", -0.01}}}};
    even["supports"][0]["move"].erase("x");
    EXPECT_FALSE(locks(even)) << element;
  }
}

// --- a contact that one node carries ---------------------------------------------------------------------------------

/// A half disk of radius 8 pressed on a floor by `down`; `cells` along a quarter of the arc.
json roller(int cells, double down) {
  return {{"bodies",
           {{"roller",
             {{"mesh", {{"half_disk", {{"center", {0, 8}}, {"radius", 8}, {"cells", {cells, cells}}}}}},
              {"material", {{"linear_elastic", {{"E", 1000}, {"nu", 0.3}}}}}}}}},
          {"obstacles", {{"floor", {{"plane", {{"point", {0, 0}}, {"normal", {0, 1}}}}}}}},
          {"contacts", {{"touch", {{"slave", "roller.arc"}, {"master", "floor"}}}}},
          {"supports", {{{"on", "roller.flat"}, {"move", {{"x", 0}, {"y", {{0, 0}, {1, -down}}}}}}}},
          {"time", {{"end", 1}, {"steps", 2}}}};
}

TEST(Warnings, NameAContactThatOneNodeCarries) {
  const auto found = warnings(roller(4, 0.001));
  EXPECT_THAT(found, ElementsAre(is(WarningCode::single_node, "touch", "touch: one of 9 nodes carries 100 %")));
  EXPECT_EQ(found.front().value, 1);
  EXPECT_THAT(warnings(roller(16, 0.2)), IsEmpty()) << "several nodes carry it";
}

TEST(Warnings, SayNothingOfASingleNodeThatIsMeant) {
  json document = roller(4, 0.001);
  document["bodies"]["roller"]["mesh"] = {{"box", {{"min", {0, 0}}, {"max", {1, 8}}, {"cells", {2, 8}}}}};
  document["supports"][0]["on"] = "roller.top";
  document["contacts"]["touch"]["slave"] = "roller.bottom & roller.left";
  EXPECT_THAT(warnings(document), IsEmpty());
  EXPECT_THAT(warnings_of(cases::run(cases::load(cases::shipped / "slider.json"), {{"monolithic_al", json::object()}},
                                     "slider.json")),
              IsEmpty());
}

TEST(Warnings, NameAResponseWhosePlaceTwoBodiesHold) {
  json scene = blocks(0.002, 0.02, 0.1);
  const auto at = [](const char* body) {
    json place = {{"at", {4, 1}}, {"component", "x"}};
    if (body) place["on"] = body;
    return json{{"displacement", place}};
  };
  scene["responses"] = {{"lower", at("lower")}, {"upper", at("upper")}};
  EXPECT_THAT(warnings(scene), IsEmpty());
  const auto result = cases::run(scene, {{"monolithic_al", json::object()}}, "blocks.json");
  const auto& moved = result.steps.back().responses;  // the upper block slides
  EXPECT_GT(moved[1] - moved[0], 0.005);
  scene["responses"]["either"] = at(nullptr);
  EXPECT_THAT(warnings(scene), ElementsAre(is(WarningCode::shared_place, "lower", "upper holds its point too")));
}

TEST(Warnings, NameABodyThatMayBeAnywhere) {
  const json scene = {{"bodies",
                       {{"block",
                         {{"mesh", {{"box", {{"min", {0, 0}}, {"max", {2, 1}}, {"cells", {2, 1}}}}}},
                          {"material", {{"linear_elastic", {{"E", 100}, {"nu", 0.3}}}}}}}}},
                      {"time", {{"end", 1}, {"steps", 1}}}};
  for (const char* method : {"penalty", "uzawa_al", "monolithic_al"}) {
    const auto result = cases::run(scene, {{method, json::object()}}, "loose.json");
    EXPECT_TRUE(is_converged(result.status())) << method << result.message();
    EXPECT_THAT(warnings_of(result), ElementsAre(is(WarningCode::non_unique, "block", "block may be anywhere")));
  }
}

}  // namespace
}  // namespace stickslip
