/// Inputs that once ended the program: a typo in a body that contacts name, states that an adjoint let go.
#include <gmock/gmock.h>

#include "studies/run/picture_json.hpp"
#include "studies/run/simulation.hpp"
#include "studies/run/warnings.hpp"
#include "tests/studies/cases.hpp"

namespace stickslip::crashes {
namespace {

using nlohmann::json;
using testing::HasSubstr;

/// The faults of a scene in text.
std::string faults_of(const std::string& text) {
  Diagnostics diagnostics;
  const auto document = JsonDocument::parse(text, "scene.json", diagnostics);
  if (document) prepare(*document, {}, std::nullopt, diagnostics);
  return diagnostics.text();
}

/// Two bodies between which there is a contact; `keys` are the first body's beside its mesh.
std::string two_bodies(const std::string& keys, const std::string& between) {
  return R"({"bodies": {
    "a": {"mesh": {"box": {"min": [0, 0], "max": [1, 1], "cells": [2, 2]}}, )" +
         keys + R"(},
    "b": {"mesh": {"box": {"min": [0, 1], "max": [1, 2], "cells": [1, 1]}},
          "material": {"linear_elastic": {"E": 1, "nu": 0.3}}}},
    "contacts": {"c": {"between": )" +
         between + R"(, "friction": 0.2}},
    "supports": [{"on": "a.bottom", "move": {"x": 0, "y": 0}}, {"on": "b.top", "move": {"x": 0, "y": -0.01}}],
    "responses": {"press": {"contact_force": {"contact": "c/a~b", "component": "normal"}}},
    "time": {"end": 1, "steps": 1}, "method": {"monolithic_al": {}}})";
}

TEST(ATypoInABody, IsAllThatIsSaidOfTheContactsBetweenBodies) {
  const std::pair<const char*, const char*> typos[] = {
      {R"("material": {"linear_elastik": {"E": 1, "nu": 0.3}})", "unknown key \"linear_elastik\""},
      {R"("material": 3)", "must be"},
      {R"("materiel": {"linear_elastic": {"E": 1, "nu": 0.3}})", "the key \"material\" is missing"}};
  for (const auto& [keys, fault] : typos)
    for (const char* between : {R"("all")", R"(["a", "b"])"}) {
      const std::string faults = faults_of(two_bodies(keys, between));
      EXPECT_THAT(faults, HasSubstr(fault));
      EXPECT_THAT(faults, testing::Not(HasSubstr("no such contact")));
    }
  EXPECT_EQ(faults_of(two_bodies(R"("material": {"linear_elastic": {"E": 1, "nu": 0.3}})", R"("all")")), "");
}

/// The page comes with what is kept: the last step always is.
TEST(APictureOfARunThatLetStatesGo, HasThePathsOfThoseThatAreKept) {
  json scene = cases::load(cases::shipped / "slider.json");
  scene["objectives"]["J"] = {{"of", "u"}, {"sum", true}};
  const auto run_with = [&](double megabytes) {
    scene["sensitivity"] = {{"mode", "adjoint"}, {"memory", megabytes}};
    Simulation simulation{cases::read(scene, "slider.json"), nullptr};
    simulation.problem = std::make_shared<const Problem>(simulation.input.scene);
    return simulate(simulation);
  };
  const CaseResult all = run_with(512), few = run_with(1e-6);
  const json whole = picture_json(all)["paths"], kept = picture_json(few)["paths"];
  ASSERT_EQ(whole.size(), 2u);
  ASSERT_EQ(kept.size(), 2u);
  EXPECT_EQ(whole[0]["displacement"].size(), all.steps.size());
  EXPECT_LT(kept[0]["displacement"].size(), all.steps.size());
  EXPECT_EQ(kept[0]["displacement"].back(), whole[0]["displacement"].back());
  EXPECT_EQ(warnings_json(few), warnings_json(all));
}

/// A model that is one place has no arms: moments over its size were 1e300, and the least squares that look for forces
/// that balance the load lost all columns.
TEST(AModelThatIsOnePlace, IsBalancedByItsSpring) {
  const json scene = json::parse(R"({
    "bodies": {"m": {"mesh": {"point": {"at": [0.10168, 0.0534822]}},
                     "material": {"grounded_spring": {"stiffness": [[1486.39, 676.293], [676.293, 1529.81]]}}}},
    "obstacles": {"g": {"plane": {"point": [0, 0], "normal": [0, 1]}}},
    "contacts": {"c": {"slave": "m.node", "master": "g", "friction": {"tresca": 86.2585}}},
    "loads": [{"on": "m.node", "force": [203.754, -178.508], "history": [[0, 0], [0.5, 0.242662], [1, -0.415671]]},
              {"on": "m.node", "force": [0, -126.031]}],
    "time": {"end": 1, "steps": 5}})");
  for (const char* method : {"penalty", "uzawa_al", "monolithic_al"})
    EXPECT_EQ(cases::run(scene, {{method, json::object()}}, "point.json").status(), Status::converged) << method;
}

}  // namespace
}  // namespace stickslip::crashes
