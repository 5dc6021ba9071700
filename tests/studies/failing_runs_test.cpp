/// Runs that cannot succeed: they say why, by name, at once, and nothing reads what they do not have.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "studies/run/warnings.hpp"
#include "tests/studies/cases.hpp"

namespace stickslip::failing_runs {
namespace {

using nlohmann::json;
using testing::HasSubstr;

const std::vector<std::string> methods{"penalty", "uzawa_al", "monolithic_al"};

CaseResult run(const json& scene, const std::string& method, const json& options = json::object()) {
  return cases::run(scene, {{method, options}}, "failing.json");
}

json box(std::array<double, 2> low, std::array<double, 2> high, std::array<int, 2> cells, bool finite = false,
         double E = 1000, double nu = 0.3) {
  return {{"mesh", {{"box", {{"min", low}, {"max", high}, {"cells", cells}}}}},
          {"material", {{finite ? "neo_hookean" : "linear_elastic", {{"E", E}, {"nu", nu}}}}}};
}

/// A block of `cells` x 2 cells on a rough floor.
json block(int cells, bool finite = false) {
  return {{"strain", finite ? "finite" : "small"},
          {"bodies", {{"b", box({0, 0}, {2, 1}, {cells, 2}, finite)}}},
          {"obstacles", {{"floor", {{"plane", {{"point", {0, 0}}, {"normal", {0, 1}}}}}}}},
          {"contacts", {{"sole", {{"slave", "b.bottom"}, {"master", "floor"}, {"friction", 0.3}}}}},
          {"time", {{"end", 1}, {"steps", 4}}},
          {"responses", {{"n", {{"contact_force", {{"contact", "sole"}, {"component", "normal"}}}}}}}};
}

json held(json scene) {
  scene["supports"] = {{{"on", "b.top"}, {"move", {{"x", {{0, 0}, {1, 0.02}}}, {"y", {{0, 0}, {1, -0.01}}}}}}};
  return scene;
}

TEST(ForgottenBody, IsNamedWithFewPointsAndWithMany) {
  for (const int cells : {4, 8})  // all branches are tried with up to six frictional points
    for (const auto& method : methods) {
      json scene = held(block(cells));
      scene["bodies"]["forgotten"] = box({5, 5}, {6, 6}, {2, 2});
      const auto result = run(scene, method);
      EXPECT_EQ(result.status(), Status::no_equilibrium) << method << cells;
      EXPECT_THAT(result.message(), HasSubstr("forgotten is free to move")) << method << cells;
    }
}

/// A chain of bars on a drum. `held_at_start`: so that its first bar cannot swing.
json belt(int cells, bool held_at_start) {
  const json arc = {{"center", {0, 0}}, {"radius", 1}, {"from_angle", -11.25}, {"to_angle", 191.25}, {"cells", cells}};
  json scene = {{"bodies",
                 {{"belt",
                   {{"mesh", {{"arc", arc}}},
                    {"element", "bar"},
                    {"area", 1},
                    {"material", {{"linear_elastic", {{"E", 10000}, {"nu", 0}}}}}}}}},
                {"obstacles", {{"drum", {{"circle", {{"center", {0, 0}}, {"radius", 1}}}}}}},
                {"contacts", {{"wrap", {{"slave", "belt.interior"}, {"master", "drum"}, {"friction", 0.3}}}}},
                {"supports", {{{"on", "belt.end"}, {"move", {{"x", 0}, {"y", 0}}}}}},
                {"time", {{"end", 1}, {"steps", 4}}}};
  if (held_at_start) scene["supports"].push_back({{"on", "belt.start"}, {"move", {{"x", 0}}}});
  return scene;
}

TEST(BodyOfBars, WhoseJointIsFreeToMoveAcrossThemHasNoEquilibrium) {
  for (const int cells : {6, 7, 9}) {  // of 9 the force is along the first bar
    json scene = belt(cells, false);
    scene["supports"][0]["move"]["y"] = {{0, 0}, {1, -0.01}};
    scene["loads"] = {{{"on", "belt.start"}, {"force", {0, -1}}}};
    for (const auto& method : methods) {
      const auto result = run(scene, method);
      EXPECT_EQ(result.status(), Status::no_equilibrium) << method << cells;
      EXPECT_THAT(result.message(), HasSubstr("the joint of belt at (0.980785, -0.19509) is free to move along ("))
          << method << cells;
    }
  }
}

TEST(BeltUnderNoLoad, StaysWhereItIs) {
  for (const auto& method : methods) {
    const auto result = run(belt(9, true), method);
    EXPECT_EQ(result.status(), Status::converged) << method << result.message();
    // the places of the nodes on the drum round, and no load presses: nothing moves at all
    EXPECT_TRUE((result.trajectory.increments.back().state.displacement.array() == 0).all()) << method;
    EXPECT_TRUE((result.trajectory.increments.back().state.contact.traction.array() == 0).all()) << method;
  }
}

/// A step fails before its first augmentation ends.
TEST(FailedStep, HasNoDerivativesAndThoseBeforeKeepTheirs) {
  json scene = held(block(8));
  scene["parameters"] = {{"mu", "/contacts/sole/friction"}};
  scene["objectives"] = {{"J", {{"of", "n"}, {"sum", true}}}};
  const json fails = {{"sensitivity", "truncated"}, {"newton", {{"max_iterations", 1}}}};
  for (const char* mode : {"direct", "adjoint"}) {
    scene["sensitivity"] = {{"mode", mode}};
    const auto result = run(scene, "uzawa_al", fails);
    EXPECT_EQ(result.status(), Status::cap) << mode;
    ASSERT_EQ(result.steps.size(), 1u) << mode;
    EXPECT_EQ(result.steps[0].sensitivities.size(), 0) << mode;
    EXPECT_EQ(result.gradients.of_objectives.size(), 0) << mode;
  }
  // Frictionless at first, then dragged: the second step needs more iterations than it may take.
  scene.erase("sensitivity");
  for (const auto& method : methods) {
    json pulled = block(8);
    pulled["parameters"] = {{"mu", "/contacts/sole/friction"}};
    pulled["loads"] = {{{"on", "b.top"}, {"traction", {0, -10}}, {"history", {{0, 0}, {0.5, 1}}}},
                       {{"on", "b.top"}, {"traction", {40, 0}}, {"history", {{0, 0}, {0.5, 0}, {1, 1}}}}};
    const auto result = run(pulled, method);
    EXPECT_EQ(result.status(), Status::no_equilibrium) << method;
    ASSERT_EQ(result.steps.size(), 3u) << method;
  }
}

TEST(FailedRun, KeepsTheWarningsOfTheStepsBefore) {
  json scene = block(2);
  scene["bodies"]["b"] = box({0, 0}, {2, 1}, {2, 1}, false, 1000, 0.4999);
  scene["contacts"]["sole"]["friction"] = 0.2;
  scene["loads"] = {{{"on", "b.top"}, {"traction", {0, -100}}, {"history", {{0, 0}, {1, 1}}}},
                    {{"on", "b.top"}, {"traction", {40, 0}}, {"history", {{0, 0}, {1, 0}, {2, 1}}}}};
  scene["time"] = {{"end", 2}, {"steps", 2}};
  for (const auto& method : methods) {
    const auto failed = run(scene, method);
    ASSERT_EQ(failed.status(), Status::no_equilibrium) << method;
    json first = scene;
    first["time"] = {{"end", 1}, {"steps", 1}};
    const auto alone = run(first, method);
    ASSERT_TRUE(is_converged(alone.status())) << method;
    EXPECT_FALSE(warnings_of(alone).empty()) << method;
    std::vector<std::string> expected, found;
    for (const auto& warning : warnings_of(alone)) expected.push_back(warning.text);
    for (const auto& warning : warnings_of(failed)) found.push_back(warning.text);
    EXPECT_EQ(found, expected) << method;
  }
}

/// Two half rings of one body, whose ends supports move through one another.
TEST(EndsThatCross, AreInfeasible) {
  json scene = {{"strain", "finite"},
                {"bodies",
                 {{"b",
                   {{"mesh",
                     {{"ring",
                       {{"center", {0, 0}},
                        {"inner", 3},
                        {"outer", 3.3},
                        {"cells", {1, 20}},
                        {"from_angle", 20},
                        {"to_angle", 160}}}}},
                    {"material", {{"neo_hookean", {{"E", 100}, {"nu", 0.3}}}}}}}}},
                {"contacts", {{"self", {{"between", {"b"}}, {"self", true}, {"friction", 0.2}}}}},
                {"supports",
                 {{{"on", "b.start"}, {"move", {{"x", {{0, 0}, {1, -3.0}}}, {"y", 0}}}},
                  {{"on", "b.end"}, {"move", {{"x", {{0, 0}, {1, 3.0}}}, {"y", 0}}}}}},
                {"time", {{"end", 1}, {"steps", 15}}}};
  for (const auto& method : methods) {
    const auto result = run(scene, method);
    EXPECT_EQ(result.status(), Status::infeasible) << method << result.message();
    EXPECT_THAT(result.message(), HasSubstr("cross and overlap by")) << method;
    EXPECT_THAT(result.message(), HasSubstr("self")) << method;
    EXPECT_LT(result.trajectory.counters.newton, 1000) << method;  // and not 5000 in vain
  }
}

TEST(LoadThatNoContactBalances, IsNamedAtFiniteStrainToo) {
  for (const auto& traction : std::vector<std::array<double, 2>>{{4, -10}, {0, 1}, {0.1, 0}})
    for (const auto& method : methods) {
      json scene = block(4, true);
      scene["loads"] = {{{"on", "b.top"}, {"traction", traction}}};
      const auto result = run(scene, method);
      EXPECT_EQ(result.status(), Status::no_equilibrium) << method << traction[0];
      EXPECT_THAT(result.message(), HasSubstr("b is free to slide")) << method << traction[0];
      EXPECT_LT(result.trajectory.counters.newton, 300) << method << traction[0];
    }
}

/// A support holds the block along the floor alone.
TEST(LoadThatPullsOffTheFloor, AsksForItsSign) {
  for (const auto& method : methods) {
    json scene = block(4, false);
    scene["supports"] = {{{"on", "b.top"}, {"move", {{"x", 0}}}}};
    scene["loads"] = {{{"on", "b.top"}, {"pressure", -10}}};
    const auto result = run(scene, method);
    EXPECT_FALSE(is_converged(result.status())) << method;
    EXPECT_THAT(result.message(), testing::ContainsRegex("check (its sign|the sign of the load)")) << method;
  }
}

/// A point on springs whose axes lean: pushed aside by 1 against a bound of .5, it is lifted where nothing rubs, and
/// pressed on where the bound does.
TEST(FrictionThatEndsAtOnce, IsNamedWhereThereIsNoEquilibrium) {
  const json scene = json::parse(R"({
    "bodies": {"m": {"mesh": {"point": {"at": [0, 0]}},
                     "material": {"grounded_spring": {"stiffness": [[1, 0.9], [0.9, 1]]}}}},
    "obstacles": {"g": {"plane": {"point": [0, 0], "normal": [0, 1]}}},
    "contacts": {"c": {"slave": "m.node", "master": "g", "friction": {"tresca": 0.5}}},
    "loads": [{"on": "m.node", "force": [1, 0], "history": [[0, 0], [1, 0], [2, 1]]},
              {"on": "m.node", "force": [0, -1], "history": [[0, 0], [1, 1], [2, -0.7]]}],
    "time": {"end": 2, "steps": 40}})");
  for (const auto& method : methods) {
    const auto result = run(scene, method);
    EXPECT_EQ(result.status(), Status::no_equilibrium) << method;
    EXPECT_THAT(result.message(), HasSubstr("ends at once where a point opens")) << method;
    json rising = scene;
    rising["contacts"]["c"]["friction"] = 0.5;
    EXPECT_EQ(run(rising, method).status(), Status::converged) << method;
  }
}

/// Friction draws a slab along until the middle of a side is within a quarter of the side of one of its ends, though no
/// integration point sees it. The steps before are solved.
TEST(AFoldedSide, IsNamedAndNoSolution) {
  const std::string file = STICKSLIP_SOURCE_DIR "/studies/hard/slab-folds-under-a-dragged-die.json";
  const auto result = cases::run(cases::load(file), {{"monolithic_al", json::object()}}, file);
  EXPECT_EQ(result.status(), Status::inverted_element);
  EXPECT_THAT(result.message(), testing::StartsWith("a pressed side of slab is folded: its middle node, ("));
  EXPECT_THAT(result.message(), testing::Not(HasSubstr("given up after")));
  ASSERT_GE(result.steps.size(), 7u);
  EXPECT_TRUE(result.steps[6].increment->usable());
}

}  // namespace
}  // namespace stickslip::failing_runs
