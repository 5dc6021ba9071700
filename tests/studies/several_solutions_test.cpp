/// Scenes with more answers than one: what warnings, reports and comparisons say of them.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "studies/report/disagreement.hpp"
#include "studies/run/gradient_report.hpp"
#include "studies/run/warnings.hpp"
#include "tests/studies/cases.hpp"

namespace stickslip::several_solutions {
namespace {

using nlohmann::json;
using testing::Contains;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::Not;
using testing::SizeIs;

const json penalty = {{"penalty", json::object()}}, uzawa = {{"uzawa_al", json::object()}},
           monolithic = {{"monolithic_al", json::object()}};

auto has_code(WarningCode code) { return testing::Field(&Warning::code, code); }
auto is_undetermined(const std::string& where) {
  return testing::AllOf(has_code(WarningCode::non_unique), testing::Field(&Warning::where, where),
                        testing::Field(&Warning::value, 0),
                        testing::Field(&Warning::text, HasSubstr("not determined")));
}

std::vector<Warning> warnings(const json& document, const json& method) {
  return warnings_of(cases::run(document, method, "scene.json"));
}

/// A point on springs in a groove of two planes at right angles, pressed into it and a little aside.
json groove(double friction) {
  const auto plane = [](double x) { return json{{"plane", {{"point", {0, 0}}, {"normal", {x, 1}}}}}; };
  const auto contact = [&](const char* wall) {
    return json{{"slave", "m.node"}, {"master", wall}, {"friction", friction}};
  };
  return {{"bodies",
           {{"m",
             {{"mesh", {{"point", {{"at", {0, 0}}}}}},
              {"material", {{"grounded_spring", {{"stiffness", {{100, 0}, {0, 100}}}}}}}}}}},
          {"obstacles", {{"l", plane(1)}, {"r", plane(-1)}}},
          {"contacts", {{"a", contact("l")}, {"b", contact("r")}}},
          {"loads", {{{"on", "m.node"}, {"force", {1, -10}}, {"history", {{0, 0}, {1, 1}}}}}},
          {"time", {{"end", 1}, {"steps", 5}}}};
}

TEST(SeveralSolutions, AreToldOfANodeThatFrictionHoldsInTwoContacts) {
  for (const json& method : {penalty, uzawa, monolithic}) {
    const auto found = warnings(groove(0.5), method);
    EXPECT_THAT(found, Contains(is_undetermined("a"))) << method;
    EXPECT_THAT(found, Contains(is_undetermined("b"))) << method;
    EXPECT_THAT(found, Not(Contains(has_code(WarningCode::idle_friction)))) << method;
  }
}

/// A block stands on the same floor by two contacts. Their sum has a derivative, and what the block does; the force of
/// each has none. So it is with an objective of it.
json block_in_two_contacts() {
  return json::parse(R"({
    "bodies": {"b": {"mesh": {"box": {"min": [0, 0], "max": [2, 1], "cells": [4, 2]}},
                     "material": {"linear_elastic": {"E": 1000, "nu": 0.3}}}},
    "obstacles": {"f": {"plane": {"point": [0, 0], "normal": [0, 1]}}},
    "contacts": {"a": {"slave": "b.bottom", "master": "f", "friction": 0.3},
                 "c": {"slave": "b.bottom", "master": "f", "friction": 0.3}},
    "supports": [{"on": "b.top", "move": {"x": [[0, 0], [1, 0.002]], "y": [[0, 0], [1, -0.01]]}}],
    "time": {"end": 1, "steps": 2},
    "parameters": {"E": "/bodies/b/material/linear_elastic/E"},
    "responses": {"all": {"reaction": {"on": "b.top", "component": "y"}},
                  "na": {"contact_force": {"contact": "a", "component": "normal"}},
                  "pa": {"contact_pressure": {"contact": "a"}},
                  "side": {"displacement": {"at": [2, 0.5], "component": "x"}}},
    "objectives": {"twice": {"of": "all", "sum": true}, "one": {"of": "na", "sum": true}}})");
}

TEST(SeveralSolutions, HaveDerivativesOfWhatIsDeterminedAlone) {
  json scene = block_in_two_contacts();
  const auto is_known = [](const json& derivative) { return derivative.is_number(); };
  for (const json& method : {penalty, uzawa, monolithic})
    for (const char* mode : {"direct", "adjoint"}) {
      scene["sensitivity"] = {{"mode", mode}};
      const CaseResult result = cases::run(scene, method, "scene.json");
      const json step = steps_json(result).back(), objectives = objectives_json(result);
      EXPECT_EQ(step["undetermined"], json({"na", "pa"})) << method << mode;
      EXPECT_TRUE(is_known(objectives["twice"]["gradient"]["E"])) << method << mode;
      EXPECT_FALSE(is_known(objectives["one"]["gradient"]["E"])) << method << mode;
      if (std::string(mode) == "adjoint") continue;
      for (const char* name : {"all", "na", "pa", "side"})
        EXPECT_EQ(is_known(step["sensitivities"][name]["E"]), std::string(name) == "all" || std::string(name) == "side")
            << method << name;
    }
}

/// A comparison with differences leaves such responses out, and says so.
TEST(SeveralSolutions, AreNoDerivativesThatDifferencesCouldCheck) {
  json scene = block_in_two_contacts();
  scene["method"] = monolithic;
  for (const char* mode : {"direct", "adjoint"}) {
    scene["sensitivity"] = {{"mode", mode}};
    const Input input = cases::read(scene, "scene.json");
    const auto check = check_gradients({input, std::make_shared<const Problem>(input.scene)}, "scene.json");
    EXPECT_TRUE(check.passed()) << mode;
    using Verdict = GradientCheck::Verdict;
    for (const auto& entry : check.entries) {
      const bool is_open = entry.response == "na" || entry.response == "pa" || entry.response == "one";
      EXPECT_EQ(entry.verdict, is_open ? Verdict::undetermined : Verdict::agrees) << mode << entry.response;
    }
  }
}

/// A point between two walls without any room: only the difference of their forces is determined.
TEST(SeveralSolutions, AreToldOfANodeBetweenTwoWalls) {
  json scene = groove(0);
  scene["obstacles"] = {{"l", {{"plane", {{"point", {0, 0}}, {"normal", {1, 0}}}}}},
                        {"r", {{"plane", {{"point", {0, 0}}, {"normal", {-1, 0}}}}}}};
  for (auto& contact : scene["contacts"]) contact.erase("friction");
  for (const auto& method : {uzawa, monolithic}) {
    EXPECT_THAT(warnings(scene, method), Contains(is_undetermined("a"))) << method;
    EXPECT_THAT(warnings(scene, method), Contains(is_undetermined("b"))) << method;
  }
  scene["obstacles"]["l"]["plane"]["normal"] = {1, 0.5};  // wider above: it is held by the right one alone
  EXPECT_THAT(warnings(scene, monolithic), Not(Contains(is_undetermined("a"))));
}

TEST(SeveralSolutions, AreNotToldOfANodeInTwoContactsWithoutFriction) {
  for (const json& method : {penalty, uzawa, monolithic}) EXPECT_THAT(warnings(groove(0), method), IsEmpty()) << method;
}

TEST(SeveralSolutions, AreToldOfNodesOfARigidFaceOnOneFacet) {
  for (const json& method : {uzawa, monolithic}) {  // (of a penalty its springs decide, which soft_penalty tells)
    // three nodes share out the force of two nodes of the slab, which the block alone resists: by 3e-9 of its motion
    EXPECT_THAT(warnings(cases::block_on_a_slab(2, 3e-6), method), Contains(is_undetermined("t"))) << method;
    EXPECT_THAT(warnings(cases::block_on_a_slab(1, 3e-6), method), Not(Contains(is_undetermined("t")))) << method;
    EXPECT_THAT(warnings(cases::block_on_a_slab(2, 100), method), Not(Contains(is_undetermined("t")))) << method;
  }
}

TEST(SeveralSolutions, AreToldOfNodesOfADrivenFaceOnOneFacet) {
  json scene = cases::block_on_a_slab(2, 100);
  scene["supports"].push_back(scene["supports"][1]);
  scene["supports"][2]["on"] = "block.bottom";
  EXPECT_THAT(warnings(scene, monolithic), Contains(is_undetermined("t")));
}

/// Half rings fitted into one another at finite strain, the inner one turned: a node of the outer one begins on the
/// vertex of the inner one at 90 degrees, and sticks.
json rings(const json& surface) {
  const auto ring = [](double inner, double outer, int cells, double modulus) {
    return json{
        {"mesh",
         {{"ring",
           {{"center", {0, 0}}, {"inner", inner}, {"outer", outer}, {"to_angle", 180}, {"cells", {1, cells}}}}}},
        {"material", {{"neo_hookean", {{"E", modulus}, {"nu", 0.3}}}}}};
  };
  return {
      {"strain", "finite"},
      {"bodies", {{"i", ring(1, 2, 8, 1)}, {"o", ring(2, 3, 10, 100)}}},
      {"contacts",
       {{"c",
         {{"slave", "o.inner"}, {"master", "i.outer"}, {"friction", 1.6}, {"offset", -0.02}, {"surface", surface}}}}},
      {"supports",
       {{{"on", "o.outer"}, {"move", {{"x", 0}, {"y", 0}}}},
        {{"on", "i.inner"}, {"rotate", {{"center", {0, 0}}, {"angle", {{0, 0}, {1, 0.1}}}}}}}},
      {"time", {{"end", 1}, {"steps", 1}}}};
}

TEST(SeveralSolutions, AreToldOfAPointThatBeginsOnAVertex) {
  const auto leaves = testing::AllOf(has_code(WarningCode::non_unique), testing::Field(&Warning::where, "c"),
                                     testing::Field(&Warning::text, HasSubstr("vertex")));
  EXPECT_THAT(warnings(rings("faceted"), monolithic), Contains(leaves));
  EXPECT_THAT(warnings(rings("smooth"), monolithic), Not(Contains(leaves)));
  json turned = rings("faceted");  // no node begins on a vertex: not by 1e-9 of a facet, but by half of one
  turned["bodies"]["o"]["mesh"]["ring"]["cells"] = {1, 9};
  turned["bodies"]["i"]["mesh"]["ring"]["from_angle"] = 1;
  EXPECT_THAT(warnings(turned, monolithic), Not(Contains(leaves)));
}

/// A point on springs that a force N presses onto a roof of two facets, its anchor at d beside the ridge. On a facet of
/// slope -+ m it is at d -+ N m / k, to first order in m. So both facets have a solution where |d| < N m / k.
TEST(SeveralSolutions, AreToldOfAPointNextToAVertexThatStandsOut) {
  constexpr double k = 100, N = 1, slope = 0.05;
  const auto roof = [&](double d, double side) {
    return json{
        {"strain", "finite"},
        {"bodies",
         {{"b",
           {{"mesh", {{"point", {{"at", {side, 1}}}}}},
            {"material", {{"grounded_spring", {{"stiffness", {{k, 0}, {0, k}}}}}}}}}}},
        {"obstacles", {{"roof", {{"polyline", {{"points", {{-2, -2 * slope}, {0, 0}, {2, -2 * slope}}}}}}}}},
        {"contacts", {{"c", {{"slave", "b.node"}, {"master", "roof"}, {"surface", "faceted"}}}}},
        {"supports", {{{"on", "b.anchor"}, {"move", {{"x", {{0, 0}, {1, d - side}}}, {"y", {{0, 0}, {1, -1}}}}}}}},
        {"loads", {{{"on", "b.node"}, {"force", {0, -N}}}}},
        {"time", {{"end", 1}, {"steps", 8}}}};
  };
  const auto near =
      testing::AllOf(has_code(WarningCode::non_unique), testing::Field(&Warning::text, HasSubstr("vertex")));
  const double reach = N * slope / k;
  for (const json& method : {penalty, uzawa, monolithic})
    for (const double side : {-1e-2, 1e-2}) {  // where it comes from
      EXPECT_THAT(warnings(roof(0.9 * std::copysign(reach, side), side), method), Contains(near)) << method;
      EXPECT_THAT(warnings(roof(1.1 * std::copysign(reach, side), side), method), Not(Contains(near))) << method;
    }
}

/// Bars in a row that lie a little above a rough floor sag onto it: which of them slide, and how far, depends on the
/// way.
TEST(SeveralSolutions, AreToldOfBarsThatBeginAsAMechanism) {
  const auto folds = testing::AllOf(has_code(WarningCode::non_unique), testing::Field(&Warning::where, "b"),
                                    testing::Field(&Warning::value, 1));
  const auto chain = [](int cells, const char* strain) {
    return json{{"strain", strain},
                {"bodies",
                 {{"b",
                   {{"mesh", {{"line", {{"from", {0, 0}}, {"to", {2.4, 0.03}}, {"cells", cells}}}}},
                    {"element", "bar"},
                    {"area", 0.8},
                    {"material", {{"linear_elastic", {{"E", 1000}, {"nu", 0}}}}}}}}},
                {"obstacles", {{"floor", {{"plane", {{"point", {0, 0}}, {"normal", {0, 1}}}}}}}},
                {"contacts", {{"c", {{"slave", "b.nodes"}, {"master", "floor"}, {"friction", 0.3}}}}},
                {"supports", {{{"on", "b.end"}, {"move", {{"x", {{0, 0}, {1, -0.04}}}, {"y", 0}}}}}},
                {"loads", {{{"on", "b.nodes"}, {"force", {0, -4}}, {"history", {{0, 0.1}, {1, 1}}}}}},
                {"time", {{"end", 1}, {"steps", 2}}}};
  };
  for (const auto& method : {penalty, uzawa, monolithic}) {
    EXPECT_THAT(warnings(chain(11, "finite"), method), Contains(folds)) << method;
    EXPECT_THAT(warnings(chain(1, "finite"), method), Not(Contains(folds))) << method;  // it turns as a whole
  }
  json frictionless = chain(11, "finite");
  frictionless["contacts"]["c"].erase("friction");
  EXPECT_THAT(warnings(frictionless, monolithic), Not(Contains(folds)));
}

/// The corner at (1, 1) of one square is moved inwards along the diagonal: beyond the other diagonal it is folded, and
/// just before it nearly so (there the volume is a hundredth of what it is at the corner across).
TEST(FoldedElements, AreToldWhereNoIntegrationPointSeesThem) {
  const auto corner = [](const char* on, double by) {
    return json{{"on", on}, {"move", {{"x", {{0, 0}, {1, by}}}, {"y", {{0, 0}, {1, by}}}}}};
  };
  for (const auto& [by, folded] : {std::pair{-0.45, false}, {-0.495, true}, {-0.55, true}}) {
    json scene = {{"strain", "finite"},
                  {"bodies",
                   {{"b",
                     {{"mesh", {{"box", {{"min", {0, 0}}, {"max", {1, 1}}, {"cells", {1, 1}}}}}},
                      {"material", {{"neo_hookean", {{"E", 1}, {"nu", 0.3}}}}}}}}},
                  {"supports", json::array()},
                  {"time", {{"end", 1}, {"steps", 4}}}};
    for (const char* on : {"b.left & b.bottom", "b.right & b.bottom", "b.left & b.top"})
      scene["supports"].push_back(corner(on, 0));
    scene["supports"].push_back(corner("b.right & b.top", by));
    const auto told = has_code(WarningCode::folded_element);
    if (folded)
      EXPECT_THAT(warnings(scene, monolithic), Contains(told));
    else
      EXPECT_THAT(warnings(scene, monolithic), Not(Contains(told)));
  }
}

/// A column whose ends stay level buckles sideways at a strain of pi^2 / 12 (width / height)^2, which is 0.82 % here,
/// and in its second shape at four times that. Beyond the first the straight column is an equilibrium that is unstable.
TEST(UnstableSteps, AreTold) {
  json scene = json::parse(R"({
    "strain": "finite",
    "bodies": {"b": {"mesh": {"box": {"min": [-0.5, 0], "max": [0.5, 10], "cells": [1, 6]}}, "element": "Q8",
                     "material": {"neo_hookean": {"E": 1, "nu": 0.2}}}},
    "obstacles": {"g": {"plane": {"point": [0, 0], "normal": [0, 1]}}},
    "contacts": {"c": {"slave": "b.bottom", "master": "g", "friction": 1}},
    "supports": [{"on": "b.top", "move": {"y": [[0, 0], [1, -0.04]]}}],
    "time": {"end": 1, "steps": 2}})");
  const auto unstable = has_code(WarningCode::unstable);
  for (const json& method : {penalty, uzawa, monolithic}) EXPECT_THAT(warnings(scene, method), Not(Contains(unstable)));
  for (const double shorter : {-0.2, -0.4}) {  // beyond one of the shapes, and beyond two
    scene["supports"][0]["move"]["y"][1][1] = shorter;
    for (const json& method : {penalty, uzawa, monolithic}) EXPECT_THAT(warnings(scene, method), Contains(unstable));
  }
}

/// A slender bar is shortened by 1.6 %, beyond four of its buckling loads, and a small force shows it the way aside.
/// The straight shape, or one near it, is an equilibrium too; of it the determinant has the sign of a stable one.
/// `floor`: whether there is one below, which the bar does not touch. Elastica with clamped ends, small slopes: the
/// middle moves by 2 / pi times the root of length times shortening. That shortening is without what the bar bears
/// straight, pi^2 / 3 (thickness / length)^2 = .206 %. Slopes of 14 degrees change it by about 1 %, the small force by
/// less.
TEST(UnstableSteps, AreCutToFollowTheBodiesAsTheyBuckle) {
  const auto bar = [](int steps, bool floor) {
    json scene = json::parse(R"({
      "strain": "finite",
      "bodies": {"b": {"mesh": {"box": {"min": [-10, -0.25], "max": [10, 0.25], "cells": [40, 1]}}, "element": "Q8",
                       "material": {"neo_hookean": {"E": 1000, "nu": 0.3}}}},
      "supports": [{"on": "b.left", "move": {"x": [[0, 0], [1, 0.16]], "y": 0}},
                   {"on": "b.right", "move": {"x": [[0, 0], [1, -0.16]], "y": 0}}],
      "loads": [{"on": "b.top", "force": [0, 0.05]}],
      "responses": {"crown": {"displacement": {"at": [0, 0], "component": "y"}}}})");
    scene["time"] = {{"end", 1}, {"steps", steps}};
    if (floor) {
      scene["obstacles"] = {{"g", {{"plane", {{"point", {0, -5}}, {"normal", {0, 1}}}}}}};
      scene["contacts"] = {{"c", {{"slave", "b.bottom"}, {"master", "g"}, {"friction", 0.3}}}};
    }
    return scene;
  };
  const auto crown = [&](const CaseResult& result) { return result.steps.back().responses[0]; };
  const auto followed = cases::run(bar(160, false), monolithic, "scene.json");
  const double shortening = 0.32 - 20 * 2.06e-3, elastica = 2 / 3.14159 * std::sqrt(20 * shortening);
  EXPECT_NEAR(crown(followed), elastica, 0.02 * elastica);
  EXPECT_THAT(warnings_of(followed), Not(Contains(has_code(WarningCode::unstable))));
  for (const bool floor : {false, true})
    for (const json& method : {penalty, uzawa, monolithic}) {
      const auto result = cases::run(bar(1, floor), method, "scene.json");
      EXPECT_GT(result.trajectory.counters.cutbacks, 0) << method << floor;
      EXPECT_NEAR(crown(result), crown(followed), 1e-8 * crown(followed)) << method << floor;  // (Newton's tolerance)
      EXPECT_THAT(warnings_of(result), Not(Contains(has_code(WarningCode::unstable)))) << method << floor;
    }
}

/// A straight bar carries a small block that does not touch it, and is shortened beyond one after the other of its
/// buckling loads. Nothing pushes it aside, so it stays straight, and one motion more is not resisted. Most of its top
/// is away from the block: where tangents are condensed, these rows are eliminated before those that points touch.
TEST(UnstableSteps, HaveTheSameUnresistedMotionsByEveryEngine) {
  json scene = json::parse(R"({
    "strain": "finite",
    "bodies": {"bar": {"mesh": {"box": {"min": [-10, -0.25], "max": [10, 0.25], "cells": [40, 1]}}, "element": "Q8",
                       "material": {"neo_hookean": {"E": 1000, "nu": 0.3}}},
               "block": {"mesh": {"box": {"min": [-0.4, 0.5], "max": [0.4, 1], "cells": [2, 1]}},
                         "material": {"neo_hookean": {"E": 1000, "nu": 0.3}}}},
    "contacts": {"c": {"slave": "block.bottom", "master": "bar.top", "friction": 0.3}},
    "supports": [{"on": "bar.left", "move": {"x": [[0, 0], [1, 0.16]], "y": 0}},
                 {"on": "bar.right", "move": {"x": [[0, 0], [1, -0.16]], "y": 0}},
                 {"on": "block.top", "move": {"x": 0, "y": 0}}],
    "time": {"end": 1, "steps": 40}})");
  for (const json& method : {penalty, monolithic}) {
    std::vector<std::vector<int>> counts;
    for (const char* engine : {"sparse", "auto"}) {
      scene["linear_solver"] = {{"engine", engine}};
      const auto result = cases::run(scene, method, "scene.json");
      EXPECT_EQ(result.trajectory.engine.find("condensed") == std::string::npos, engine == std::string("sparse"))
          << result.trajectory.engine;
      auto& of_engine = counts.emplace_back();
      for (const auto& step : result.steps) {
        of_engine.push_back(step.increment->unresisted);
        EXPECT_EQ(step.increment->unstable, step.increment->unresisted % 2 == 1) << engine << method;
      }
      EXPECT_EQ(of_engine.front(), 0);
      EXPECT_EQ(of_engine.back(), 4);
    }
    EXPECT_EQ(counts[0], counts[1]) << method;
  }
}

/// A block under a load, which would tip off the one node it touches a circle with, comes to rest on two, by every
/// method.
TEST(UnstableSteps, AreNoneWhereABodyComesToRest) {
  const json scene = json::parse(R"({
    "space": "plane_stress", "strain": "finite",
    "bodies": {"b": {"mesh": {"box": {"min": [-0.3316265, 0.00653576], "max": [0.3316265, 0.95955876], "cells": [2, 1]}},
                     "material": {"neo_hookean": {"E": 200.485, "nu": 0.2}}}},
    "obstacles": {"g": {"circle": {"center": [-0.101739, -0.822108], "radius": 0.822108}}},
    "contacts": {"c": {"slave": "b.bottom", "master": "g", "friction": 0.000532298}},
    "supports": [{"on": "b.top", "move": {"x": [[0, 0], [0.5, 0.0782979], [1, -0.0571219]]}}],
    "loads": [{"on": "b.top", "traction": [0, -20.0485], "history": [[0, 0.2], [1, 1]]}],
    "time": {"end": 1, "steps": 3}})");
  for (const json& method : {penalty, uzawa, monolithic})
    EXPECT_THAT(warnings(scene, method), Not(Contains(has_code(WarningCode::unstable))));
}

TEST(SoftPenalty, IsToldWhereItsSpringsYieldBesideTheBodies) {
  const json scene = cases::block_on_a_slab(1, 100);
  const auto soft = has_code(WarningCode::soft_penalty);
  EXPECT_THAT(warnings(scene, penalty), Not(Contains(soft)));  // 1e3: by 1e-3
  EXPECT_THAT(warnings(scene, uzawa), Not(Contains(soft)));
  EXPECT_THAT(warnings(scene, {{"penalty", {{"stiffness", 10}}}}), Contains(soft));
}

/// A row of a study: a penalty, or another run of that label, with one response.
json row(const std::string& label, double value, double error, double scale) {
  return {{"label", label},
          {"status", "converged"},
          {"vary", json::object()},
          {"responses", {{"heat", value}}},
          {"scales", {{"heat", scale}}},
          {"errors", {{"kkt", {{"gap", error}, {"stick", error / 2}}}}},
          {"warnings", json::array()}};
}

std::vector<std::string> disagree(const std::vector<json>& rows) {
  std::vector<const json*> all;
  for (const auto& each : rows) all.push_back(&each);
  return disagreements(all);
}

TEST(Disagreements, NameRunsThatDifferByMoreThanTheirErrorsExplain) {
  const auto found = disagree({row("penalty", 0.03436, 1e-3, 0.1), row("uzawa_al", 0.03034, 1e-11, 0.1),
                               row("monolithic_al", 0.03449, 1e-12, 0.1)});
  ASSERT_THAT(found, SizeIs(1));
  EXPECT_THAT(found[0], HasSubstr("heat"));
  EXPECT_THAT(found[0], HasSubstr("0.03034 by uzawa_al"));
  EXPECT_THAT(found[0], HasSubstr("0.03449 by monolithic_al"));
  EXPECT_THAT(found[0], HasSubstr("12 % apart"));
}

TEST(Disagreements, AreExplainedByTheErrorOfAPenalty) {
  EXPECT_THAT(disagree({row("penalty", 0.031, 1e-2, 0.1), row("uzawa_al", 0.03, 1e-11, 0.1)}), IsEmpty());
}

TEST(Disagreements, AreExplainedByTheToleranceOfAMethod) {
  json loose = row("uzawa_al", 0.03001, 1e-6, 0.1);
  EXPECT_THAT(disagree({loose, row("monolithic_al", 0.03, 1e-12, 0.1)}), SizeIs(1));
  loose["method"] = {{"uzawa_al", {{"tolerance", 1e-4}}}};
  EXPECT_THAT(disagree({loose, row("monolithic_al", 0.03, 1e-12, 0.1)}), IsEmpty());
}

TEST(Disagreements, AreNoneOfWhatIsRoundingBesideItsKind) {
  EXPECT_THAT(disagree({row("uzawa_al", 1e-17, 1e-12, 1), row("monolithic_al", -4e-17, 1e-12, 1)}), IsEmpty());
}

TEST(Disagreements, AreNotSoughtBetweenVariantsOrRunsThatFailed) {
  json varied = row("monolithic_al", 2, 1e-12, 1), failed = row("penalty", 3, 1e-12, 1);
  varied["vary"] = {{"/contacts/t/friction", 0.2}};
  failed["status"] = "cycle";
  EXPECT_THAT(disagree({row("uzawa_al", 1, 1e-12, 1), varied, failed}), IsEmpty());
}

TEST(Disagreements, RepeatWhatTheRunsWarnOf) {
  json warned = row("monolithic_al", 2, 1e-12, 1);
  warned["warnings"] = {{{"code", "non_unique"}}, {{"code", "single_node"}}};
  EXPECT_THAT(disagree({row("uzawa_al", 1, 1e-12, 1), warned}), ElementsAre(HasSubstr("they warn of non_unique.")));
}

}  // namespace
}  // namespace stickslip::several_solutions
