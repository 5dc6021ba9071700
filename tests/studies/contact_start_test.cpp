/// Contact at the start, contact that never closes, and what a run that failed says of its contact points.
#include "studies/run/contact_start.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>

#include "studies/run/explain.hpp"
#include "studies/run/failed_contact.hpp"
#include "studies/run/warnings.hpp"
#include "tests/studies/cases.hpp"

namespace stickslip::contact_start {
namespace {

using nlohmann::json;
using testing::AllOf;
using testing::HasSubstr;
using testing::Not;

const std::vector<std::string> methods{"penalty", "uzawa_al", "monolithic_al"};

/// A block of 8 x 4 cells, its lower side at the height y, on a rough floor, pressed by a traction.
json block(double y, const json& traction) {
  return {{"bodies",
           {{"b",
             {{"mesh", {{"box", {{"min", {0, y}}, {"max", {2, 1}}, {"cells", {8, 4}}}}}},
              {"material", {{"linear_elastic", {{"E", 1000}, {"nu", 0.3}}}}}}}}},
          {"obstacles", {{"floor", {{"plane", {{"point", {0, 0}}, {"normal", {0, 1}}}}}}}},
          {"contacts", {{"sole", {{"slave", "b.bottom"}, {"master", "floor"}, {"friction", 0.3}}}}},
          {"loads", {{{"on", "b.top"}, {"traction", traction}, {"history", {{0, 0}, {1, 1}}}}}},
          {"time", {{"end", 1}, {"steps", 2}}},
          {"method", {{"monolithic_al", json::object()}}}};
}

/// The same held at its top, which moves by `dy`.
json held_block(double y, double dy) {
  json scene = block(y, {0, 0});
  scene.erase("loads");
  scene["supports"] = {{{"on", "b.top"}, {"move", {{"x", 0}, {"y", {{0, 0}, {1, dy}}}}}}};
  return scene;
}

CaseResult run(const json& scene, const std::string& method = "monolithic_al") {
  return cases::run(scene, {{method, json::object()}}, "start.json");
}

Problem problem_of(const json& scene) { return Problem(cases::read(scene, "start.json").scene); }

std::string message_of(const json& scene, const std::string& method) {
  const auto result = run(scene, method);
  EXPECT_FALSE(is_converged(result.status())) << method;
  return result.message();
}

// --- runs that failed ----------------------------------------------------------------------------------------------

TEST(FailedContact, ABodyThatIsPulledOffHasOpenPoints) {
  for (const auto& method : methods)
    EXPECT_THAT(message_of(block(0, {0, 5}), method),
                AllOf(HasSubstr("9 contact points: 0 stick, 0 slip, 9 open; all are open: the load may pull"),
                      HasSubstr("check the sign of the load")));
}

TEST(FailedContact, ABodyThatIsPushedBeyondFrictionHasPointsThatSlip) {
  for (const auto& method : methods)
    EXPECT_THAT(
        message_of(block(0, {2, -5}), method),
        AllOf(HasSubstr("9 contact points: 0 stick, 8 slip, 1 open; most of those that touch slip: the load may "
                        "be more than friction bears"),
              Not(HasSubstr("normal of a plane"))));
}

TEST(FailedContact, ABodyWithoutFrictionHasNothingThatResistsSliding) {
  json scene = block(0, {0.5, -5});
  scene["contacts"]["sole"].erase("friction");
  for (const auto& method : methods)
    EXPECT_THAT(message_of(scene, method),
                HasSubstr("9 contact points: 9 closed, 0 open; no contact has friction, so nothing resists sliding"));
}

TEST(FailedContact, AnObstacleThatIsTurnedIsTheOnlyAdvice) {
  json plane = block(0, {0, -5}), polyline = plane;
  plane["obstacles"]["floor"]["plane"]["normal"] = {0, -1};
  polyline["obstacles"]["floor"] = {{"polyline", {{"points", {{4, 0}, {-2, 0}}}}}};
  for (const auto& method : methods) {
    EXPECT_THAT(message_of(plane, method),
                AllOf(HasSubstr("9 open; sole: the solid of floor is on the side of b.bottom"),
                      HasSubstr("turn the normal of the plane round"), Not(HasSubstr("sign of the load"))));
    EXPECT_THAT(message_of(polyline, method),
                AllOf(HasSubstr("turn the points of the polyline round"), Not(HasSubstr("sign of the load"))));
  }
}

TEST(FailedContact, SaysHowFarABodyIsFromItsMaster) {
  EXPECT_EQ(failed_contact_in_words({.open = 3, .unheld = true, .nearest = 0.125}),
            "3 contact points: 0 stick, 0 slip, 3 open; all are open, and the nearest starts 0.125 from its master: "
            "nothing holds the body on its way; let it touch at the start, or move it by a support");
}

TEST(FailedContact, SaysThatNoPointFacesItsMaster) {
  EXPECT_THAT(failed_contact_in_words({.open = 3, .unheld = true, .nearest = std::numeric_limits<double>::infinity()}),
              HasSubstr("3 open; all are open, and none faces a master at the start: nothing holds the body"));
}

TEST(FailedContact, GivesNumbersAloneWhereThePatternHasNoCause) {
  EXPECT_EQ(failed_contact_in_words({}), "");
  EXPECT_EQ(failed_contact_in_words({.open = 1, .stick = 5, .slip = 2, .unheld = true}),
            "8 contact points: 5 stick, 2 slip, 1 open");
  // supports hold the bodies: that all slip, or are open, is no fault
  EXPECT_THAT(failed_contact_in_words({.open = 1, .stick = 5, .slip = 2, .unheld = true, .unbalanced = true}),
              HasSubstr("the load may pull the body off its master; check its sign"));
  EXPECT_EQ(failed_contact_in_words({.slip = 1}), "1 contact point: 0 stick, 1 slip, 0 open");
  EXPECT_EQ(failed_contact_in_words({.open = 2}), "2 contact points: 0 stick, 0 slip, 2 open");
}

// --- advice of methods ----------------------------------------------------------------------------------------------

TEST(FittingAdvice, NamesNoScaleWithoutContact) {
  EXPECT_EQ(advice_in_words({}), "try more steps");
  EXPECT_EQ(advice_in_words({.contact = true}), "try more steps, or a smaller stiffness or scale");
}

TEST(FittingAdvice, NamesWaysThatTheSceneDoesNotGo) {
  EXPECT_EQ(advice_in_words({.contact = true, .may_be_segments = true}),
            "try more steps, a smaller stiffness or scale, or segments");
  EXPECT_THAT(advice_in_words({true, true, true, true}),
              testing::EndsWith(", the other side as the slave, a smooth master, or segments"));
}

TEST(FittingAdvice, ARigidPolylineThatIsSmoothIsNotToBecomeSo) {
  json scene = block(0, {2, -5});
  scene["strain"] = "finite";
  scene["bodies"]["b"]["material"] = {{"neo_hookean", {{"E", 1000}, {"nu", 0.3}}}};
  scene["obstacles"]["floor"] = {{"polyline", {{"points", {{-2, 0}, {0, 0}, {1, 0.02}, {2, 0}, {4, 0}}}}}};
  scene["contacts"]["sole"]["surface"] = "smooth";
  const std::string message = message_of(scene, "monolithic_al");
  EXPECT_THAT(message, HasSubstr("no equilibrium may lead on from the last"));
  EXPECT_THAT(message, AllOf(Not(HasSubstr("a smooth master")), Not(HasSubstr("the other side"))));
}

// --- the start -----------------------------------------------------------------------------------------------------

TEST(StartGaps, AreThoseOfPointsAndSayWhatOverlaps) {
  json scene = held_block(0, 0);
  scene["obstacles"]["floor"] = {{"circle", {{"center", {1, -10}}, {"radius", 10.01}}}};
  const auto gaps = start_gaps(problem_of(scene)).at(0);
  EXPECT_NEAR(gaps.least, -0.01, 1e-12);
  EXPECT_NEAR(gaps.largest, std::hypot(1, 10) - 10.01, 1e-12);
  EXPECT_EQ(gaps.points, 9);
  EXPECT_EQ(gaps.overlapping, 3);  // as far from the middle as sqrt(10.01^2 - 10^2) = 0.447: -0.25, 0, 0.25
  EXPECT_EQ(gaps.in_words(), "least -0.01, largest 0.0399, 3 of 9 points overlap");
}

TEST(StartGaps, ArePrintedByExplain) {
  const auto input = cases::read(held_block(0.125, 0), "start.json");
  EXPECT_THAT(
      explain(input, Problem(input.scene)),
      HasSubstr("Coulomb friction 0.3\n    gap at the start: least 0.125, largest 0.125, 0 of 9 points overlap"));
}

TEST(StartGaps, TakeThePairsOfOneRuleTogether) {
  json scene = held_block(0, 0);
  scene["bodies"]["c"] = scene["bodies"]["b"];
  scene["bodies"]["c"]["mesh"]["box"]["min"] = {0, 1.25};
  scene["bodies"]["c"]["mesh"]["box"]["max"] = {2, 2};
  scene["bodies"]["d"] = scene["bodies"]["b"];
  scene["bodies"]["d"]["mesh"]["box"]["min"] = {0, 2.5};
  scene["bodies"]["d"]["mesh"]["box"]["max"] = {2, 3};
  scene["contacts"]["all"] = {{"between", "all"}};
  const Problem problem = problem_of(scene);
  const auto pairs = start_gaps(problem);
  ASSERT_EQ(pairs.size(), 4u);
  const auto rules = start_gaps_of_rules(problem);
  ASSERT_EQ(rules.size(), 2u);
  EXPECT_EQ(rules[0].name, "all");
  EXPECT_EQ(rules[0].least, std::min({pairs[0].least, pairs[1].least, pairs[2].least}));
  EXPECT_EQ(rules[0].points, pairs[0].points + pairs[1].points + pairs[2].points);
}

TEST(StartsOverlapping, NamesTheDepthThatNoOffsetAsksFor) {
  json scene = held_block(-0.02, 0);
  const auto found = overlaps_at_start(problem_of(scene));
  ASSERT_EQ(found.size(), 1u);
  EXPECT_EQ(found[0].code, WarningCode::starts_overlapping);
  EXPECT_EQ(found[0].where, "sole");
  EXPECT_NEAR(found[0].value, 0.02, 1e-12);
  EXPECT_THAT(found[0].text, HasSubstr("9 of 9 points overlap at the start by up to 0.02"));
  const auto warnings = warnings_json(run(scene));
  ASSERT_FALSE(warnings.empty());
  EXPECT_EQ(warnings[0]["code"], "starts_overlapping");
  const auto input = cases::read(scene, "start.json");
  EXPECT_THAT(explain(input, Problem(input.scene)), HasSubstr("warning (starts_overlapping): sole: 9 of 9"));
  scene["contacts"]["sole"]["offset"] = 0.02;  // makes up for it
  EXPECT_TRUE(overlaps_at_start(problem_of(scene)).empty());
}

TEST(StartsOverlapping, IsNotWhatAnOffsetAsksForNorRounding) {
  json scene = held_block(0, 0);
  scene["contacts"]["sole"]["offset"] = -0.02;
  EXPECT_TRUE(overlaps_at_start(problem_of(scene)).empty());
  EXPECT_EQ(start_gaps(problem_of(scene)).at(0).overlapping, 9);
  EXPECT_EQ(start_gaps(problem_of(held_block(-1e-8, 0))).at(0).overlapping, 0);  // of facets of 0.25
  EXPECT_EQ(start_gaps(problem_of(held_block(-1e-8, 0))).at(0).least, 0);
  EXPECT_EQ(start_gaps(problem_of(held_block(-1e-6, 0))).at(0).overlapping, 9);
}

TEST(StartsOverlapping, IsToldOfNoShippedScene) {
  for (const auto& file : std::filesystem::directory_iterator(cases::shipped)) {
    const std::string name = file.path().filename();
    if (!name.ends_with(".json") || name.ends_with(".study.json")) continue;
    EXPECT_TRUE(overlaps_at_start(Problem(cases::read(cases::load(file.path()), file.path()).scene)).empty()) << name;
  }
}

// --- the run -------------------------------------------------------------------------------------------------------

TEST(NeverCloses, NamesTheLeastDistanceOfTheRun) {
  for (const auto& method : methods) {
    const auto found = contacts_never_closed(run(held_block(0.125, -0.05), method));
    ASSERT_EQ(found.size(), 1u) << method;
    EXPECT_EQ(found[0].code, WarningCode::never_closes);
    EXPECT_EQ(found[0].where, "sole");
    EXPECT_NEAR(found[0].value, 0.075, 1e-9);  // the block moves as a whole, to rounding
    EXPECT_THAT(found[0].text, HasSubstr("the nearest is 0.075 away at the least"));
    EXPECT_EQ(warnings_json(run(held_block(0.125, -0.05), method))[0]["code"], "never_closes");
    EXPECT_TRUE(contacts_never_closed(run(held_block(0.125, -0.15), method)).empty()) << method;
  }
}

TEST(NeverCloses, AsksForOneUnitWhereABodyIsTiny) {
  json scene = held_block(0.125, -0.05);
  scene["obstacles"]["floor"] = {{"plane", {{"point", {0, -150}}, {"normal", {0, 1}}}}};
  const auto far = contacts_never_closed(run(scene, "monolithic_al"));
  ASSERT_EQ(far.size(), 1u);
  EXPECT_THAT(far[0].remedy, HasSubstr("times the size of the slave's body: give all lengths in one unit"));
  const auto near = contacts_never_closed(run(held_block(0.125, -0.05), "monolithic_al"));
  EXPECT_THAT(near[0].remedy, testing::StartsWith("look at the gap at the start"));
}

TEST(NeverCloses, IsNotSaidOfPointsThatTouchWithoutForce) {
  for (const auto& method : methods)
    EXPECT_TRUE(contacts_never_closed(run(held_block(0.125, -0.125), method)).empty()) << method;
  // a mass between two walls: the forces say that nothing of its size is a gap
  const std::string walls = STICKSLIP_SOURCE_DIR "/studies/hard/between-two-walls.json";
  EXPECT_TRUE(
      contacts_never_closed(cases::run(cases::load(walls), {{"monolithic_al", json::object()}}, walls)).empty());
}

TEST(NeverCloses, IsNotSaidOfARunThatFailed) { EXPECT_TRUE(contacts_never_closed(run(block(0, {0, 5}))).empty()); }

TEST(NeverCloses, OfPairsOfOneRuleOneThatClosesWillDo) {
  json scene = held_block(0, 0);
  for (const auto& [name, low, high] : {std::tuple{"c", 1.0, 2.0}, {"d", 2.5, 3.0}}) {
    scene["bodies"][name] = scene["bodies"]["b"];
    scene["bodies"][name]["mesh"]["box"]["min"] = {0, low};
    scene["bodies"][name]["mesh"]["box"]["max"] = {2, high};
  }
  scene["contacts"] = {{"all", {{"between", "all"}}}};
  scene["supports"] = {{{"on", "b.bottom"}, {"move", {{"x", 0}, {"y", 0}}}},
                       {{"on", "c.top"}, {"move", {{"x", 0}, {"y", -0.01}}}},
                       {{"on", "d.top"}, {"move", {{"x", 0}, {"y", 0}}}}};
  const auto result = run(scene);
  ASSERT_TRUE(is_converged(result.status())) << result.message();
  EXPECT_TRUE(contacts_never_closed(result).empty());
}

}  // namespace
}  // namespace stickslip::contact_start
