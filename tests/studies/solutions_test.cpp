/// Scenes that have several solutions, one or none: which is told, and which is taken.
#include <gtest/gtest.h>

#include "studies/run/warnings.hpp"
#include "tests/studies/cases.hpp"

namespace stickslip {
namespace {

using nlohmann::json;

const std::vector<json>& methods() {
  static const std::vector<json> all = {
      json::parse(R"({"penalty": {"stiffness": 1e5}})"), json::parse(R"({"uzawa_al": {}})"),
      json::parse(R"({"uzawa_al": {"scale": 1}})"),      json::parse(R"({"uzawa_al": {"scale": 1000}})"),
      json::parse(R"({"monolithic_al": {}})"),           json::parse(R"({"monolithic_al": {"scale": 1e-3}})")};
  return all;
}

CaseResult solve(const json& scene, const json& method) { return cases::run(scene, method, "scene.json"); }

bool warns(const CaseResult& result, WarningCode code) {
  const auto warnings = warnings_of(result);
  return std::any_of(warnings.begin(), warnings.end(), [&](const auto& w) { return w.code == code; });
}

/// A Q4 element with planes at some of its nodes.
json element(const json& corners, const json& obstacles, const json& contacts, const json& supports,
             const json& loads) {
  json scene = {{"obstacles", obstacles},
                {"contacts", contacts},
                {"supports", supports},
                {"loads", loads},
                {"time", {{"end", 1}, {"steps", 1}}},
                {"responses", {{"w", {{"strain_energy", json::object()}}}}}};
  scene["bodies"]["q"] = {{"mesh", {{"quad", {{"corners", corners}, {"cells", {1, 1}}}}}},
                          {"material", {{"linear_elastic", {{"E", 100}, {"nu", 0.3}}}}}};
  return scene;
}

json plane(const json& point, const json& normal) { return {{"plane", {{"point", point}, {"normal", normal}}}}; }

json hinged(const json& corners, const json& normal, double friction, const json& loads) {
  return element(corners, {{"o", plane(corners[0], normal)}},
                 {{"c", {{"slave", "q.bottom & q.left"}, {"master", "o"}, {"friction", friction}}}},
                 json::parse(R"([{"on": "q.top & q.left", "move": {"x": 0, "y": 0}}])"), loads);
}

// Energies of both solutions by an independent enumeration of open, stick and both slips: .192675 in stick, .192830 in
// slip.
TEST(SeveralSolutions, OfABodyThatAHingeLetsTurnAreTold) {
  const json scene = hinged({{-0.132, 0.17}, {1.028, 0.137}, {0.997, 0.999}, {0.182, 0.85}},
                            {-0.7702951349118817, -0.6376875450650467}, 4.937508372252435, json::parse(R"([
      {"on": "q.bottom & q.left", "force": [0.301, 1.947], "history": [[0, 0], [1, 1]]},
      {"on": "q.bottom & q.right", "force": [-1.479, -0.927], "history": [[0, 0], [1, 1]]},
      {"on": "q.top & q.right", "force": [1.719, -0.053], "history": [[0, 0], [1, 1]]}])"));
  for (const auto& method : methods()) {
    const auto result = solve(scene, method);
    ASSERT_TRUE(is_converged(result.status())) << method << result.message();
    EXPECT_TRUE(warns(result, WarningCode::non_unique)) << method;
    ASSERT_EQ(result.trajectory.increments[0].others.size(), 1u) << method;
    EXPECT_NEAR(result.steps[0].responses[0], 0.192675, 1e-3 * 0.192675) << method;  // of the penalty's own solution
  }
}

// Under this load the enumeration finds no combination that holds.
TEST(SeveralSolutions, AreToldFromNone) {
  const json scene = hinged({{0.086, -0.106}, {0.923, 0.122}, {0.895, 1.077}, {0.154, 1.111}},
                            {-0.1605035331190977, 0.987035265761202}, 1.8929690852885337, json::parse(R"([
      {"on": "q.bottom & q.left", "force": [-1.006, -0.382]}, {"on": "q.bottom & q.right", "force": [0.41, 0.308]},
      {"on": "q.top & q.right", "force": [1.078, -0.721]}])"));
  for (const auto& method : methods()) EXPECT_EQ(solve(scene, method).status(), Status::no_equilibrium) << method;
}

TEST(SeveralSolutions, AreChosenFromByNoMethodAndNoScale) {
  const json corners = {{-0.01, -0.032}, {1.104, 0.051}, {0.829, 1.096}, {-0.045, 0.868}};
  json scene = element(corners,
                       {{"o0", plane(corners[0], {-0.6889053147634702, 0.7248513415112399})},
                        {"o1", plane(corners[1], {-0.07942579239714077, 0.9968407814200251})}},
                       {{"c0", {{"slave", "q.bottom & q.left"}, {"master", "o0"}, {"friction", 5.020077384882007}}},
                        {"c1", {{"slave", "q.bottom & q.right"}, {"master", "o1"}, {"friction", 5.020077384882007}}}},
                       json::parse(R"([{"on": "q.top & q.right", "move": {"x": 0, "y": 0}},
                                       {"on": "q.top & q.left", "move": {"x": 0, "y": 0}}])"),
                       json::parse(R"([
      {"on": "q.bottom & q.left", "force": [-0.16, -0.714], "history": [[0, 0], [1, 1]]},
      {"on": "q.bottom & q.right", "force": [1.697, -0.215], "history": [[0, 0], [1, 1]]}])"));
  for (int steps : {1, 4}) {
    scene["time"]["steps"] = steps;
    const auto expected = solve(scene, methods().back());
    for (const auto& method : methods()) {
      const auto result = solve(scene, method);
      ASSERT_TRUE(is_converged(result.status())) << method << result.message();
      EXPECT_EQ(result.trajectory.increments.back().state.contact.state,
                expected.trajectory.increments.back().state.contact.state)
          << method << " " << steps;
      EXPECT_EQ(warns(result, WarningCode::branch_ends), warns(expected, WarningCode::branch_ends))
          << method << " " << steps;
    }
  }
}

json on_springs(const json& stiffness, const json& obstacles, const json& contacts, const json& loads) {
  json scene = {{"obstacles", obstacles},
                {"contacts", contacts},
                {"loads", loads},
                {"time", {{"end", 1}, {"steps", 1}}},
                {"responses", {{"x", {{"displacement", {{"on", "p.node"}, {"component", "x"}}}}}}}};
  scene["bodies"]["p"] = {{"mesh", {{"point", {{"at", {0, 0}}}}}},
                          {"material", {{"grounded_spring", {{"stiffness", stiffness}}}}}};
  return scene;
}

// The force grows in proportion and the point sticks throughout: nothing ends, nothing jumps.
TEST(SeveralSolutions, ThatAreNotTakenEndNoBranch) {
  const json scene = on_springs({{1, 0.5}, {0.5, 1}}, {{"f", plane({0, 0}, {0, -1})}},
                                {{"c", {{"slave", "p.node"}, {"master", "f"}, {"friction", 3}}}},
                                json::parse(R"([{"on": "p.node", "force": [1.9, 1], "history": [[0, 0], [1, 1]]}])"));
  for (const double scale : {0.01, 0.1, 1.0, 100.0}) {
    const auto result = solve(scene, {{"uzawa_al", {{"scale", scale}}}});
    ASSERT_TRUE(is_converged(result.status())) << scale << result.message();
    EXPECT_FALSE(warns(result, WarningCode::branch_ends)) << scale;
    EXPECT_LT(std::abs(result.steps[0].responses[0]), 1e-9) << scale;  // of a motion of some 1, by the force alone
  }
}

TEST(SeveralSolutions, OfTwoContactsOnOneNodeAreFoundFromEveryScale) {
  const json scene =
      on_springs({{0.042783135416841145, -0.03443521335088928}, {-0.03443521335088928, 0.030234372229869317}},
                 {{"o0", plane({0, 0}, {0.6838388061651445, 0.7296331182057391})},
                  {"o1", plane({0, 0}, {-0.9818170429411627, -0.18982964518291434})}},
                 {{"c0", {{"slave", "p.node"}, {"master", "o0"}, {"friction", 5.406709638624458}}},
                  {"c1", {{"slave", "p.node"}, {"master", "o1"}, {"friction", 5.406709638624458}}}},
                 json::parse(R"([{"on": "p.node", "force": [0.00013221898327745542, -7.458523069204335e-05]}])"));
  for (const double scale : {1.0, 10.0, 100.0, 808.5389260259483, 3000.0}) {
    const auto result = solve(scene, {{"uzawa_al", {{"scale", scale}}}});
    EXPECT_TRUE(is_converged(result.status())) << scale << result.message();
  }
}

/// A point on springs and planes stands for the same at finite strain: nothing of it depends on where it is.
TEST(PointsOnSprings, AreTheSameAtFiniteStrain) {
  json scene = on_springs({{1, 0.5}, {0.5, 1}}, {{"f", plane({0, 0}, {0, -1})}},
                          {{"c", {{"slave", "p.node"}, {"master", "f"}, {"friction", 3}}}},
                          json::parse(R"([{"on": "p.node", "force": [2.5, 1]}])"));
  for (const auto& method : methods()) {
    scene["strain"] = "small";
    const auto small = solve(scene, method);
    scene["strain"] = "finite";
    const auto finite = solve(scene, method);
    EXPECT_TRUE(warns(finite, WarningCode::non_unique)) << method;
    ASSERT_EQ(small.status(), finite.status()) << method;
    EXPECT_EQ(small.steps[0].responses, finite.steps[0].responses) << method;
    EXPECT_EQ(small.trajectory.counters.newton, finite.trajectory.counters.newton) << method;
  }
}

/// At mu = 2 the slip to one side makes just the pressure that holds it: under this load every slip from 0 to 2 is a
/// solution, with the pressure 1 - slip / 2. Under a smaller load the point sticks, and nothing else is a solution.
TEST(SeveralSolutions, AreToldOfAContinuum) {
  for (const double force : {2.0, 1.5}) {
    const json scene = on_springs({{1, 0.5}, {0.5, 1}}, {{"f", plane({0, 0}, {0, -1})}},
                                  {{"c", {{"slave", "p.node"}, {"master", "f"}, {"friction", 2}}}},
                                  {{{"on", "p.node"}, {"force", {force, 1}}}});
    for (const auto& method : methods()) {
      const auto result = solve(scene, method);
      ASSERT_TRUE(is_converged(result.status())) << method << result.message();
      EXPECT_EQ(warns(result, WarningCode::non_unique), force == 2.0) << method << force;
    }
  }
}

json between_walls(double left, double right, double force) {
  return on_springs({{100, 0}, {0, 100}}, {{"w0", plane({left, 0}, {1, 0})}, {"w1", plane({right, 0}, {-1, 0})}},
                    {{"c0", {{"slave", "p.node"}, {"master", "w0"}}}, {"c1", {{"slave", "p.node"}, {"master", "w1"}}}},
                    {{{"on", "p.node"}, {"force", {force, 0}}}});
}

TEST(ContradictingWalls, AreInfeasibleForEveryMethodAndScaleAlsoWhereOneAloneIsTouched) {
  std::vector<json> all;
  for (const double scale : {1.0, 1e3, 1e5, 1e7}) all.push_back({{"penalty", {{"stiffness", scale}}}});
  for (const double scale : {1e-3, 1.0, 1e3}) {
    all.push_back({{"uzawa_al", {{"scale", scale}}}});
    all.push_back({{"monolithic_al", {{"scale", scale}}}});
  }
  for (const char* strain : {"small", "finite"})
    for (const bool friction : {false, true})
      for (const double force : {-1000.0, -1.0, 0.0, 3.0}) {
        json scene = between_walls(0.001, 0, force);
        scene["strain"] = strain;
        if (friction)
          for (auto& contact : scene["contacts"]) contact["friction"] = 0.4;
        for (const auto& method : all)
          EXPECT_EQ(solve(scene, method).status(), Status::infeasible)
              << strain << " " << force << " " << method << " " << friction;
      }
}

/// A slot that a support across it leaves alone, and one whose third wall cuts off what the other two leave.
TEST(ContradictingWalls, AreToldWhereASupportOrAThirdWallLeavesNoPlace) {
  const auto on = [](const char* wall) { return json{{"slave", "p.node"}, {"master", wall}}; };
  const json walls = {{"a", plane({0, 0}, {-1, 1})}, {"b", plane({0, 0}, {1, 1})}, {"c", plane({0, -0.001}, {0, -1})}};
  const json load = {{{"on", "p.node"}, {"force", {0.1, -1}}}};
  const json corner = on_springs({{100, 0}, {0, 100}}, walls, {{"a", on("a")}, {"b", on("b")}}, load);
  json closed = on_springs({{100, 0}, {0, 100}}, walls, {{"a", on("a")}, {"b", on("b")}, {"c", on("c")}}, load);
  for (const char* method : {"uzawa_al", "monolithic_al"}) {
    EXPECT_TRUE(is_converged(solve(corner, {{method, json::object()}}).status())) << method;
    EXPECT_EQ(solve(closed, {{method, json::object()}}).status(), Status::infeasible) << method;
  }
}

TEST(ContradictingWalls, AreToldFromWallsThatLeaveRoom) {
  const json scene = between_walls(-1e-6, 0, -1000);
  for (const double stiffness : {1.0, 1e3, 1e5, 1e7}) {
    const auto result = solve(scene, {{"penalty", {{"stiffness", stiffness}}}});
    EXPECT_TRUE(is_converged(result.status())) << stiffness << result.message();
  }
}

}  // namespace
}  // namespace stickslip
