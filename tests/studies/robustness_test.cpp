/// Scenes that are solvable, and that a solver could take for unsolvable: small loads, ties, steps without load, other
/// stiffnesses and scales.
#include <gtest/gtest.h>

#include <cmath>

#include "tests/studies/cases.hpp"
#include "tests/support/largest.hpp"

namespace stickslip {
namespace {

using nlohmann::json;

CaseResult run(const json& scene, const json& method) { return cases::run(scene, method, "scene.json"); }

/// A block on a floor with friction; traction `load` times [shear, -1] on top.
json block(const json& cells, double friction, double shear, double load) {
  json scene = json::parse(R"({
    "bodies": {"block": {"mesh": {"box": {"min": [0, 0], "max": [4, 2], "cells": [4, 2]}},
                         "material": {"linear_elastic": {"E": 1000, "nu": 0.3}}}},
    "obstacles": {"floor": {"plane": {"point": [0, 0], "normal": [0, 1]}}},
    "contacts": {"sole": {"slave": "block.bottom", "master": "floor", "friction": 0.3}},
    "loads": [{"on": "block.top", "traction": [0, -1], "history": [[0, 0], [1, 1]]}],
    "time": {"end": 1, "steps": 2},
    "responses": {"shift": {"displacement": {"on": "block.top", "component": "x"}}}})");
  scene["bodies"]["block"]["mesh"]["box"]["cells"] = cells;
  scene["contacts"]["sole"]["friction"] = friction;
  scene["loads"][0]["traction"] = {shear * load, -load};
  return scene;
}

// Gaps of exactly zero make the problem homogeneous: the solution is in proportion to the load.
TEST(SmallLoads, OnAClosedGapOfZeroScaleTheSolution) {
  for (const auto& method : {R"({"penalty": {}})", R"({"penalty": {"stiffness": 1e5}})", R"({"uzawa_al": {}})",
                             R"({"monolithic_al": {}})"}) {
    const double expected = run(block({8, 4}, 0.3, 0.1, 5), json::parse(method)).steps.back().responses[0] / 5;
    for (const double load : {5e-4, 5e-8, 5e-11, 5e-15}) {  // of E: down to 5e-18
      const auto result = run(block({8, 4}, 0.3, 0.1, load), json::parse(method));
      ASSERT_TRUE(is_converged(result.status())) << method << load << result.message();
      // tolerances of 1e-10 of the residuals, times the condition of a body that friction holds
      EXPECT_NEAR(result.steps.back().responses[0] / load, expected, 1e-7 * std::abs(expected)) << method << load;
    }
  }
}

TEST(StepsWithoutLoad, LeaveDerivativesToThoseWithLoad) {
  for (const auto& cells : {json{2, 1}, json{5, 3}, json{8, 2}})
    for (const auto& method : {R"({"penalty": {}})", R"({"uzawa_al": {}})", R"({"monolithic_al": {}})"}) {
      json scene = block(cells, 0.1, 0.07, 1);
      scene["loads"][0]["history"] = json::parse("[[0, 0], [1, 0], [2, 1]]");
      scene["time"] = json::parse(R"({"legs": [[1, 1], [2, 1]]})");
      scene["parameters"] =
          json::parse(R"({"height": "/bodies/block/mesh/box/max/1", "mu": "/contacts/sole/friction"})");
      const auto with_idle_step = run(scene, json::parse(method));
      ASSERT_TRUE(is_converged(with_idle_step.status())) << method << cells << with_idle_step.message();
      scene["loads"][0]["history"] = json::parse("[[0, 0], [1, 1]]");
      scene["time"] = json::parse(R"({"end": 1, "steps": 1})");
      const auto alone = run(scene, json::parse(method));
      ASSERT_TRUE(is_converged(alone.status())) << method << cells << alone.message();
      const auto& found = with_idle_step.steps.back().sensitivities;
      const auto& expected = alone.steps.back().sensitivities;
      ASSERT_EQ(found.size(), expected.size());
      // two runs to tolerances of 1e-10, times the condition of a body that friction holds
      for (Eigen::Index j = 0; j < expected.cols(); ++j)
        EXPECT_NEAR(found(0, j), expected(0, j), 1e-6 * largest_entry(expected)) << method << cells;
    }
}

/// A bar on a plane, pulled at its start and let go.
json bar(int cells, double pull, double back, int steps) {
  json scene = json::parse(R"({
    "bodies": {"bar": {"mesh": {"line": {"from": [0, 0], "to": [1, 0], "cells": 30}}, "element": "bar", "area": 1,
                       "material": {"linear_elastic": {"E": 1000, "nu": 0}}}},
    "obstacles": {"w": {"plane": {"point": [0, 0], "normal": [0, 1]}}},
    "contacts": {"c": {"slave": "bar.nodes", "master": "w", "friction": 0.3}},
    "loads": [{"on": "bar.nodes", "traction": [0, -100]}, {"on": "bar.start", "force": [-1, 0]}],
    "responses": {"D": {"displacement": {"on": "bar.start", "component": "x"}}},
    "parameters": {"mu": "/contacts/c/friction"}})");
  scene["bodies"]["bar"]["mesh"]["line"]["cells"] = cells;
  scene["loads"][1]["history"] = {{0, 0}, {1, pull}, {2, back}};
  scene["time"]["legs"] = {{1, steps}, {2, steps}};
  return scene;
}

// The front of slip stops on a node again and again: there a point goes to and fro between two states that agree.
TEST(UzawaUpdates, EndAtTies) {
  const auto method = json::parse(R"({"uzawa_al": {}})"), exact = json::parse(R"({"monolithic_al": {}})");
  for (const int cells : {20, 30, 40})
    for (const double pull : {10.0, 15.0, 20.0})
      for (const double back : {0.0, 7.0})
        for (const int steps : {4, 10}) {
          const json scene = bar(cells, pull, back, steps);
          const auto result = run(scene, method), expected = run(scene, exact);
          ASSERT_TRUE(is_converged(result.status()))
              << cells << " " << pull << " " << back << " " << steps << " " << result.message();
          const double size = std::abs(expected.steps[steps - 1].responses[0]);
          for (std::size_t n = 0; n < result.steps.size(); ++n)  // tolerance 1e-10, and what steps add up
            EXPECT_NEAR(result.steps[n].responses[0], expected.steps[n].responses[0], 1e-8 * size);
        }
}

TEST(UzawaUpdates, EndAtTheRoundingOfAStiffBodyOnASoftOne) {
  const json scene = json::parse(R"({
    "bodies": {"u": {"mesh": {"half_disk": {"center": [0, 2], "radius": 2, "cells": [6, 4], "facing": "down", "grade": 1.5}},
                     "material": {"linear_elastic": {"E": 9000, "nu": 0.4}}},
               "l": {"mesh": {"box": {"min": [-2, -1.5], "max": [2, 0], "cells": [11, 4]}},
                     "material": {"linear_elastic": {"E": 13, "nu": 0.4}}}},
    "contacts": {"c": {"slave": "u.arc", "master": "l.top"}},
    "supports": [{"on": "l.bottom", "move": {"x": 0, "y": 0}},
                 {"on": "u.flat", "move": {"x": 0, "y": [[0, 0], [1, -0.02]]}}],
    "time": {"end": 1, "steps": 4},
    "responses": {"N": {"contact_force": {"contact": "c", "component": "normal"}}}})");
  const auto result = run(scene, json::parse(R"({"uzawa_al": {}})"));
  const auto expected = run(scene, json::parse(R"({"monolithic_al": {}})"));
  ASSERT_TRUE(is_converged(result.status())) << result.message();
  EXPECT_NEAR(result.steps.back().responses[0], expected.steps.back().responses[0],
              1e-8 * expected.steps.back().responses[0]);  // both to 1e-10, times 9000 / 13
}

/// Two blocks, one upon the other, pressed together; `held`: what holds the upper one, or more of the lower.
json two_blocks(double upper, double lower, const json& held) {
  json scene = json::parse(R"({
    "bodies": {"up": {"mesh": {"box": {"min": [0, 1], "max": [2, 2], "cells": [4, 4]}},
                      "material": {"linear_elastic": {"E": 1, "nu": 0.3}}},
               "low": {"mesh": {"box": {"min": [-0.5, 0], "max": [2.5, 1], "cells": [5, 4]}},
                       "material": {"linear_elastic": {"E": 1, "nu": 0.3}}}},
    "contacts": {"c": {"slave": "up.bottom", "master": "low.top", "friction": 0.3}},
    "supports": [{"on": "low.bottom", "move": {"x": 0, "y": 0}}],
    "loads": [{"on": "up.top", "traction": [0, -0.01], "history": [[0, 0], [1, 1]]}],
    "time": {"end": 1, "steps": 2},
    "responses": {"d": {"displacement": {"on": "up.top", "component": "y"}},
                  "N": {"contact_force": {"contact": "c", "component": "normal"}}}})");
  scene["bodies"]["up"]["material"]["linear_elastic"]["E"] = upper;
  scene["bodies"]["low"]["material"]["linear_elastic"]["E"] = lower;
  scene["loads"][0]["traction"][1] = -0.01 * std::min(upper, lower);
  for (const auto& support : held) scene["supports"].push_back(support);
  return scene;
}

// A node that a support holds does not yield, however soft its body is: the other body alone does, and rho must suit
// it.
TEST(UzawaUpdates, ConvergeWhereASupportHoldsTheSofterSideOfAContact) {
  struct Case {
    double upper, lower;
    const char* held;
  };
  for (const auto& [upper, lower, held] :
       {Case{1, 1e6, R"([{"on": "up.left", "move": {"x": 0}}])"},
        Case{1, 1e6,
             R"([{"on": "up.left & up.bottom", "move": {"x": 0, "y": 0}}, {"on": "up.right", "move": {"x": 0}}])"},
        Case{1e6, 1, R"([{"on": "up.left", "move": {"x": 0}}, {"on": "low.top", "move": {"x": 0}}])"},
        Case{1e6, 1, R"([{"on": "up.left", "move": {"x": 0}}, {"on": "low.top", "move": {"x": 0, "y": 0}}])"}}) {
    const json scene = two_blocks(upper, lower, json::parse(held));
    const auto result = run(scene, json::parse(R"({"uzawa_al": {}})"));
    const auto expected = run(scene, json::parse(R"({"monolithic_al": {}})"));
    ASSERT_TRUE(is_converged(result.status())) << upper << held << result.message();
    ASSERT_TRUE(is_converged(expected.status())) << upper << held << expected.message();
    for (int i = 0; i < 2; ++i)  // both to 1e-10, times what rounding makes of 1e6
      EXPECT_NEAR(result.steps.back().responses[i], expected.steps.back().responses[i],
                  1e-7 * std::abs(expected.steps.back().responses[i]))
          << upper << held;
  }
}

// The forces of a stiff body that a soft one carries round as its stiffness times the soft one's displacements do:
// 1e-16 over the ratio of the stiffnesses. Up to 1e-4 that is a solution at rounding; beyond, the message says what it
// is.
TEST(StiffBodies, AreCarriedByAMasterAsSoftAsRoundingAllows) {
  for (const char* held : {R"([{"on": "up.left", "move": {"x": 0}}])", "[]"})
    for (const auto& method : {R"({"penalty": {}})", R"({"uzawa_al": {}})", R"({"monolithic_al": {}})"}) {
      for (const double ratio : {1e-6, 1e-9, 1e-10}) {
        const auto result = run(two_blocks(1, ratio, json::parse(held)), json::parse(method));
        ASSERT_TRUE(is_converged(result.status())) << method << held << ratio << result.message();
        const double force = 0.02 * ratio;  // that of the load, 0.01 over a length of 2
        EXPECT_NEAR(result.steps.back().responses[0], force, 1e-4 * force) << method << held << ratio;
      }
      const auto drowned = run(two_blocks(1, 1e-13, json::parse(held)), json::parse(method));
      EXPECT_FALSE(is_converged(drowned.status())) << method << held;
      const bool told = drowned.message().find("forces of the stiffest body") != std::string::npos;
      EXPECT_TRUE(told || drowned.status() != Status::inaccurate) << drowned.message();
    }
}

// What a support holds decides which stiffness rho takes, and not which side is stiffer: where both are the same, the
// solution of a penalty, which depends on rho, has one derivative.
TEST(Penalties, AreSmoothInTheStiffnessOfEqualBodies) {
  json scene = two_blocks(1, 1, json::parse(R"([{"on": "up.bottom", "move": {"x": 0}}])"));
  scene["bodies"]["low"]["mesh"]["box"] = {{"min", {-0.75, 0}}, {"max", {2.25, 1}}, {"cells", {6, 4}}};  // as fine
  scene["parameters"]["E"] = "/bodies/up/material/linear_elastic/E";
  const auto at = [&](double E) {
    scene["bodies"]["up"]["material"]["linear_elastic"]["E"] = E;
    auto result = run(scene, json::parse(R"({"penalty": {}})"));
    EXPECT_TRUE(is_converged(result.status())) << result.message();
    return result;
  };
  constexpr double h = 1e-5;  // the penalty leaves 1e-3 of the answer, whose kink would be 5e-4 of the derivative
  const auto result = at(1);
  const double derivative = result.steps.back().sensitivities(1, 0), d = result.steps.back().responses[1];
  EXPECT_TRUE(result.steps.back().differentiable);
  for (const double side : {h, -h})  // differences: h of the derivative, by a second derivative of its size
    EXPECT_NEAR((at(1 + side).steps.back().responses[1] - d) / side, derivative, 8 * h * std::abs(derivative)) << side;
}

// A scale of a billionth leaves nearly all of an error to the next pass: that it will not settle shows early.
TEST(IteratedDerivatives, ThatDoNotSettleAreGivenUpEarly) {
  json scene = block({4, 2}, 0.3, 0.1, 1);
  scene["parameters"] = {{"mu", "/contacts/sole/friction"}, {"E", "/bodies/block/material/linear_elastic/E"}};
  const auto result = run(scene, json::parse(R"({"uzawa_al": {"sensitivity": "iterated", "scale": 1e-7, "adapt": false,
                                                  "tolerance": 1e-3, "max_augmentations": 20000}})"));
  EXPECT_EQ(result.gradients.status, Status::cap) << result.message();
  EXPECT_NE(result.gradients.message.find("would not settle in 20000 passes"), std::string::npos);
  EXPECT_LE(result.gradients.counters.sensitivity_backsolves, 2 * 2000);  // 2 parameters; the limit is 20000 passes
}

TEST(Scales, OfAMillionthNeedNoOtherPath) {
  const auto belt = cases::load(cases::shipped / "belt.json");
  const auto expected = run(belt, json::parse(R"({"monolithic_al": {}})"));
  for (const double scale : {1e-5, 1e-6, 1e-7, 1e-8}) {
    const auto result = run(belt, {{"monolithic_al", {{"scale", scale}}}});
    ASSERT_TRUE(is_converged(result.status())) << scale << result.message();
    EXPECT_EQ(result.trajectory.counters.cutbacks, 0) << scale;
    for (Eigen::Index i = 0; i < expected.steps.back().responses.size(); ++i) {
      const double x = expected.steps.back().responses[i];
      EXPECT_NEAR(result.steps.back().responses[i], x, 1e-9 * std::abs(x))
          << scale;  // lambda / rho rounds to u / scale
    }
  }
}

TEST(Times, ThatCannotBeHalvedEndARunAllTheSame) {
  json scene = block({2, 1}, 0.1, 0.5, 1);  // slides
  scene["loads"][0].erase("history");
  scene["time"] = {{"end", 5e-324}, {"steps", 1}};
  EXPECT_EQ(run(scene, json::parse(R"({"monolithic_al": {}})")).status(), Status::no_equilibrium);
  auto belt = cases::load(cases::shipped / "belt.json");
  belt["time"] = {{"end", 5e-324}, {"steps", 1}};
  belt.erase("parameters");
  belt["supports"][1]["move"]["y"] = json::parse("[[0, 1e-20], [1, -0.01]]");
  EXPECT_FALSE(is_converged(run(belt, json::parse(R"({"monolithic_al": {"scale": 1e-163}})")).status()));
}

// At the end of its master a node that moves on loses its contact, and the force falls by a share.
TEST(OneSidedDerivatives, AreNotGivenWhereANodeSlidesOffTheEndOfItsMaster) {
  const json scene = json::parse(R"({
    "bodies": {"a": {"mesh": {"box": {"min": [0, 0], "max": [4, 1], "cells": [4, 2]}},
                     "material": {"linear_elastic": {"E": 500, "nu": 0.3}}},
               "b": {"mesh": {"quad": {"corners": [[0, 1], [4, 1], [4, 2], [0, 2]], "cells": [4, 1]}},
                     "material": {"linear_elastic": {"E": 1000, "nu": 0.2}}}},
    "contacts": {"c": {"slave": "b.bottom", "master": "a.top"}},
    "supports": [{"on": "a.bottom", "move": {"x": 0, "y": 0}},
                 {"on": "b.top", "move": {"x": 0, "y": [[0, 0], [1, -0.01]]}}],
    "time": {"end": 1, "steps": 1},
    "responses": {"N": {"contact_force": {"contact": "c", "component": "normal"}}},
    "parameters": {"shift": {"/bodies/b/mesh/quad/corners/0/0": 1, "/bodies/b/mesh/quad/corners/1/0": 1,
                             "/bodies/b/mesh/quad/corners/2/0": 1, "/bodies/b/mesh/quad/corners/3/0": 1},
                   "E": "/bodies/b/material/linear_elastic/E"}})");
  for (const auto& method : {R"({"penalty": {}})", R"({"uzawa_al": {}})", R"({"monolithic_al": {}})"}) {
    const auto result = run(scene, json::parse(method));
    ASSERT_TRUE(is_converged(result.status())) << method << result.message();
    const auto& step = result.steps.back();
    EXPECT_FALSE(step.differentiable) << method;
    ASSERT_GT(step.backward.size(), 0) << method;
    const std::size_t E = 0, shift = 1;  // in the order of their names
    EXPECT_TRUE(std::isnan(step.backward(0, shift))) << method;
    EXPECT_TRUE(std::isnan(step.forward(0, shift))) << method;
    EXPECT_FALSE(result.steps.back().has_kink(result.problem->model.scene, result.method, 0, E)) << method;
  }
}

}  // namespace
}  // namespace stickslip
