/// Derivatives with two sides as result.json has them: by direct and by adjoint derivatives, with states kept and let
/// go.
#include <gmock/gmock.h>

#include "tests/studies/cases.hpp"
#include "tests/studies/tied_nodes.hpp"

namespace stickslip::sided_modes {
namespace {

using nlohmann::json;

const std::filesystem::path hard = std::filesystem::path(STICKSLIP_SOURCE_DIR) / "studies" / "hard";

/// How derivatives are taken: direct, adjoint, and adjoint with next to no memory.
const std::vector<json> modes = {{{"mode", "direct"}}, {{"mode", "adjoint"}}, {{"mode", "adjoint"}, {"memory", 1e-6}}};

const std::vector<json> methods = {{{"monolithic_al", json::object()}}, {{"uzawa_al", {{"tolerance", 1e-12}}}}};

struct Outcome {
  json steps, objectives;
};

Outcome outcome(json scene, const json& method, const json& mode) {
  scene["sensitivity"] = mode;
  const json end = scene["time"].contains("end") ? scene["time"]["end"] : scene["time"]["legs"].back()[0];
  for (const auto& [name, unused] : scene["responses"].items())
    scene["objectives"]["of " + name] = {{"of", name}, {"at", end}};
  const auto result = cases::run(scene, method, hard / "scene.json");
  EXPECT_TRUE(is_converged(result.status())) << result.message();
  return {steps_json(result), objectives_json(result)};
}

/// Sides of one derivative at the last step, to 1e-9 of `size`, by every method and mode; and of the objective of it.
void expect_sides(const json& scene, const std::string& response, const std::string& parameter, double below,
                  double above, double size) {
  constexpr double rounding = 1e-9;  // of derivatives of chains of one or two unknowns
  for (const auto& method : methods)
    for (const auto& mode : modes) {
      SCOPED_TRACE(response + "/" + parameter + " " + method.dump() + " " + mode.dump());
      const auto [steps, objectives] = outcome(scene, method, mode);
      EXPECT_EQ(steps.back()["differentiable"], false);
      const json sides = steps.back()["one_sided"][response][parameter];
      ASSERT_TRUE(sides[0].is_number() && sides[1].is_number());
      EXPECT_NEAR(sides[0], below, rounding * size);
      EXPECT_NEAR(sides[1], above, rounding * size);
      const json of_objective = objectives["of " + response]["one_sided"][parameter];
      ASSERT_TRUE(of_objective.is_array());
      EXPECT_NEAR(of_objective[0], below, rounding * size);
      EXPECT_NEAR(of_objective[1], above, rounding * size);
    }
}

// C22: the tangential force is exactly what friction bears, and nothing slips.
TEST(SidedModes, OfABlockAtTheEdgeOfItsCone) {
  const json push = cases::load(hard / "push-at-friction.json");
  expect_sides(push, "u", "P", 0, 1e-3, 1e-3);
  expect_sides(push, "friction", "P", -1, 0, 1);
}

// C31: A1 at F = k g0.
TEST(SidedModes, OfASpringThatJustTouchesItsStop) {
  const json touch = cases::load(hard / "touch-exactly.json");
  expect_sides(touch, "u", "F", 1e-3, 0, 1e-3);
  expect_sides(touch, "press", "F", 0, 1, 1);
  expect_sides(touch, "u", "g0", 1, 0, 1);
}

// C31: A2 at U = 0.03.
TEST(SidedModes, OfABlockThatIsAboutToSlip) {
  const json slider = cases::load(hard / "slider-at-first-slip.json");
  expect_sides(slider, "u", "U", 0, 1, 1);
  expect_sides(slider, "u", "mu", -0.1, 0, 0.1);
}

void expect_alike(const json& found, const json& wanted) {
  ASSERT_EQ(found.size(), wanted.size());
  for (std::size_t n = 0; n < wanted.size(); ++n) {
    EXPECT_EQ(found[n]["differentiable"], wanted[n]["differentiable"]) << n;
    EXPECT_EQ(found[n]["margins"], wanted[n]["margins"]) << n;
    ASSERT_EQ(found[n].contains("one_sided"), wanted[n].contains("one_sided")) << n;
    if (!wanted[n].contains("one_sided")) continue;
    for (const auto& [response, by] : wanted[n]["one_sided"].items())
      for (const auto& [parameter, sides] : by.items())
        for (int side : {0, 1}) {
          const json& value = found[n]["one_sided"][response][parameter][side];
          ASSERT_EQ(value.is_null(), sides[side].is_null()) << n << " " << response << "/" << parameter;
          if (value.is_null()) continue;
          const double size = std::max(std::abs(sides[0].is_null() ? 0 : sides[0].get<double>()),
                                       std::abs(sides[1].is_null() ? 0 : sides[1].get<double>()));
          // (factors that were updated in another order round otherwise; 1e-9: what has_kink takes for rounding)
          EXPECT_NEAR(value, sides[side], 1e-9 * std::max(size, 1.0)) << n << " " << response << "/" << parameter;
        }
  }
}

/// A block that slips to the edge of its cone, and goes back: later steps remember one side.
json there_and_back() {
  json scene = cases::load(hard / "slider-at-first-slip.json");
  scene["supports"][0]["move"]["x"] = {{0, 0}, {1, 0.03}, {2, 0.02}};
  scene["time"] = {{"legs", {{2, 6}}}};
  return scene;
}

TEST(SidedModes, TellTheSameOfStepsThatRememberOneSide) {
  const auto direct = outcome(there_and_back(), methods[0], modes[0]);
  EXPECT_EQ(direct.steps[1]["differentiable"], true);
  for (std::size_t n : {2u, 3u, 5u}) EXPECT_EQ(direct.steps[n]["differentiable"], false) << n;
  for (std::size_t mode : {1u, 2u})
    expect_alike(outcome(there_and_back(), methods[0], modes[mode]).steps, direct.steps);
}

TEST(SidedModes, TellTheSameOfALargestValueThatTwoNodesShare) {
  const json scene = cases::tied_nodes();
  const auto direct = outcome(scene, methods[0], modes[0]);
  EXPECT_EQ(direct.steps.back()["differentiable"], false);
  for (std::size_t mode : {1u, 2u}) expect_alike(outcome(scene, methods[0], modes[mode]).steps, direct.steps);
}

TEST(SidedModes, TellTheSameOfAFlowThatIsAboutToBegin) {
  json scene = cases::load(hard.parent_path() / "scenes" / "plastic_bar.json");
  scene["time"] = {{"legs", {{1, 7}}}};
  scene["supports"][0]["move"]["x"] = {{0, 0}, {1, 0.035}};
  const auto direct = outcome(scene, methods[0], modes[0]);
  for (std::size_t mode : {1u, 2u}) expect_alike(outcome(scene, methods[0], modes[mode]).steps, direct.steps);
}

TEST(SidedModes, OfMoreParametersThanHaveSidesCountsEveryStepFromTheTieOn) {
  json scene = there_and_back();
  for (int k = 0; k <= most_sided_parameters; ++k)
    scene["parameters"]["more " + std::to_string(k)] = "/contacts/sole/friction";
  const auto adjoint = outcome(scene, methods[0], modes[1]);
  for (std::size_t n = 0; n < 6; ++n) {
    EXPECT_EQ(adjoint.steps[n]["differentiable"], n < 2) << n;
    if (n >= 2) {
      EXPECT_EQ(adjoint.steps[n]["one_sided"], json::object()) << n;
    }
  }
}

TEST(SidedModes, TakeNothingWhereNothingTies) {
  json scene = cases::load(hard / "slider-at-first-slip.json");
  scene["supports"][0]["move"]["x"] = {{0, 0}, {1, 0.05}};
  scene["time"]["steps"] = 4;
  scene["sensitivity"] = modes[1];
  scene["objectives"]["J"] = {{"of", "u"}, {"at", 1}};
  const auto result = cases::run(scene, methods[0], hard / "scene.json");
  EXPECT_FALSE(result.one_sided);
  EXPECT_FALSE(steps_json(result).back().contains("nearest_change"));  // an adjoint does not know it
  EXPECT_FALSE(objectives_json(result)["J"].contains("one_sided"));
}

TEST(SidedModes, DirectOnesTellHowFarTheNearestChangeIs) {
  json scene = cases::load(hard / "slider-at-first-slip.json");
  scene["supports"][0]["move"]["x"] = {{0, 0}, {1, 0.05}};
  scene["time"]["steps"] = 5;  // to 0.01, 0.02, ...: it sticks below 0.03
  const json steps = outcome(scene, methods[0], modes[0]).steps;
  const json& second = steps[1]["nearest_change"];  // U drags by 2/5 of itself, and slips at 0.03
  EXPECT_NEAR(second["U"][1], 0.03 / 0.4 - 0.05, 1e-12);
  EXPECT_NEAR(second["mu"][0], 0.1, 1e-12);
  EXPECT_TRUE(second["mu"][1].is_null());
  EXPECT_EQ(steps[2]["nearest_change"]["U"], json({0, 0}));  // on the edge
  EXPECT_EQ(steps[2]["differentiable"], false);
}

}  // namespace
}  // namespace stickslip::sided_modes
