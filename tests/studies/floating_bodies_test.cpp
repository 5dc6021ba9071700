/// Bodies that nothing holds until something touches them.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <optional>

#include "studies/run/explain.hpp"
#include "studies/run/warnings.hpp"
#include "tests/studies/cases.hpp"

namespace stickslip::floating_bodies {
namespace {

using nlohmann::json;

const std::vector<std::string> methods{"penalty", "uzawa_al", "monolithic_al"};

/// A tube that stands on a floor, and a block that comes down on it from 0.05 above, by 0.3 in `steps` steps.
json tube_under_a_block(int steps) {
  const json rubber = {{"neo_hookean", {{"E", 1000}, {"nu", 0.3}}}};
  return {{"strain", "finite"},
          {"bodies",
           {{"tube",
             {{"mesh", {{"ring", {{"center", {0, 0}}, {"inner", 0.9}, {"outer", 1}, {"cells", {1, 32}}}}}},
              {"material", rubber}}},
            {"block",
             {{"mesh", {{"box", {{"min", {-0.5, 1.05}}, {"max", {0.5, 1.5}}, {"cells", {4, 2}}}}}},
              {"material", rubber}}}}},
          {"obstacles", {{"floor", {{"plane", {{"point", {0, -1}}, {"normal", {0, 1}}}}}}}},
          {"contacts",
           {{"all", {{"between", {"tube", "block"}}, {"friction", 0.2}}},
            {"floor", {{"slave", "tube.outer"}, {"master", "floor"}, {"friction", 0.5}}}}},
          {"supports", {{{"on", "block.top"}, {"move", {{"x", 0}, {"y", {{0, 0}, {1, -0.3}}}}}}}},
          {"time", {{"end", 1}, {"steps", steps}}}};
}

/// Nothing acts on the tube, so its place is where it was, though its tangent is singular.
TEST(AFloatingBody, StaysWhereItIsUntilItIsTouched) {
  for (const auto& method : methods) {
    json scene = tube_under_a_block(20);
    scene["time"] = {{"legs", {{0.15, 3}}}};  // the block is 0.005 above the tube then
    const auto result = cases::run(scene, {{method, json::object()}}, "tube.json");
    ASSERT_TRUE(is_converged(result.status())) << method << result.message();
    ASSERT_EQ(result.steps.size(), 3u);
    for (const auto& step : result.steps) {
      const auto& body = result.problem->model.bodies[1];
      ASSERT_EQ(result.problem->model.scene.bodies[1].name, "tube");
      const auto of_tube = step.increment->state.displacement.segment(2 * body.first_node, 2 * body.mesh.node_count);
      EXPECT_EQ(of_tube.norm(), 0) << method << step.increment->time;
      EXPECT_LE(step.newton, 5) << method;  // the block's own, moved at its top as a whole
    }
    EXPECT_THAT(warnings_of(result), testing::Contains(testing::Field(&Warning::code, WarningCode::floating_body)));
  }
}

/// Nothing but damping holds it at the end of a step, so there is no tangent that derivatives could be taken of.
TEST(AFloatingBody, IsNamedWhereDerivativesAreAskedFor) {
  json scene = tube_under_a_block(20);
  scene["time"] = {{"legs", {{0.15, 3}}}};
  scene["responses"] = {{"push", {{"reaction", {{"on", "block.top"}, {"component", "y"}}}}}};
  scene["parameters"] = {{"mu", "/contacts/floor/friction"}};
  for (const auto& method : methods) {
    const auto result = cases::run(scene, {{method, json::object()}}, "tube.json");
    EXPECT_EQ(result.status(), Status::singular) << method;
    EXPECT_THAT(result.message(), testing::StartsWith("there are no derivatives: tube floats at the end of the step at "
                                                      "t = 0.05, where it is free to move"))
        << method;
    EXPECT_THAT(result.message(), testing::HasSubstr("Hold it by a support, or leave out the parameters")) << method;
  }
}

TEST(AFloatingBody, IsToldBeforeTheRunAsHeldByContactAlone) {
  json scene = tube_under_a_block(20);
  scene["method"] = {{"monolithic_al", json::object()}};
  const Input input = cases::read(scene, "tube.json");
  const std::string text = explain(input, Problem(input.scene));
  EXPECT_THAT(text, testing::HasSubstr("tube: 64 nodes, 32 Q4 quadrilaterals; held by contact alone\n"));
  EXPECT_THAT(text, testing::HasSubstr("block: 15 nodes, 8 Q4 quadrilaterals\n"));
}

/// Two points that stick hold it from then on, one above the other, and all methods press it alike.
TEST(AFloatingBody, IsPressedByEveryMethodOnceItIsTouched) {
  std::vector<double> on_floor;
  for (const auto& method : methods) {
    const auto result = cases::run(tube_under_a_block(20), {{method, json::object()}}, "tube.json");
    ASSERT_TRUE(is_converged(result.status())) << method << result.message();
    const auto& model = result.problem->model;
    const auto& last = result.steps.back().increment->state;
    double force = 0;
    for (std::size_t p = 0; p < model.points.size(); ++p)
      if (model.points[p].obstacle >= 0)
        force -= last.contact.traction[model.points[p].multiplier] * result.problem->slots.geometry[p].area;
    on_floor.push_back(force);
    // penalty 87, monolithic 93; Uzawa 550, of which some hundred in the step in which the tube is met
    const int most = method == std::string("uzawa_al") ? 30 : 10;
    EXPECT_LE(result.trajectory.counters.newton, 20 * most) << method;
  }
  EXPECT_GT(on_floor[2], 0);
  EXPECT_NEAR(on_floor[1], on_floor[2], 1e-8 * on_floor[2]);  // Uzawa stops at 1e-10 of the tractions
  EXPECT_NEAR(on_floor[0], on_floor[2], 1e-4 * on_floor[2]);  // springs yield by 1e-3 of little
}

/// A block that a load presses on a smooth floor: free to slide along it, and with nothing that would make it. With the
/// geometry of the start and with that of the present, at any scale: its inner solves are singular. (At 1e4 it takes
/// 113 to 193 iterations.)
TEST(ABodyFreeToSlide, RestsWhereItIsPressedAtEveryScaleOfUzawa) {
  json scene = cases::load(std::filesystem::path(STICKSLIP_SOURCE_DIR) / "studies" / "hard" /
                           "free-to-slide-pressed-down-small.json");
  for (const char* strain : {"small", "finite"})
    for (const double scale : {1.0, 10.0, 30.0, 100.0, 300.0, 1e3}) {
      scene["strain"] = strain;
      if (scene["strain"] == "finite")
        scene["bodies"]["block"]["material"] = {{"neo_hookean", {{"E", 1000}, {"nu", 0}}}};
      const auto result = cases::run(scene, {{"uzawa_al", {{"scale", scale}}}}, "block.json");
      ASSERT_TRUE(is_converged(result.status())) << strain << scale << result.message();
      EXPECT_NEAR(result.steps.back().responses[0], 20, 1e-8 * 20) << strain << scale;  // balance; Uzawa's tolerance
      EXPECT_LE(result.trajectory.counters.newton, 60) << strain << scale;
    }
}

/// At first nothing presses on one of the disks, and the other is held by single nodes, on which it rolls as one slips.
/// Whatever supports alone do not hold is moved with what floats.
TEST(SlowFloatingBodies, AreFoundBesideThoseThatRoll) {
  const std::string file = std::string(STICKSLIP_SOURCE_DIR) + "/studies/hard/disks-between-plates.json";
  std::optional<double> press;
  for (const auto& method : {"monolithic_al", "uzawa_al", "penalty"}) {
    const auto result = cases::run(cases::load(file), {{method, json::object()}}, file);
    ASSERT_TRUE(is_converged(result.status())) << method << result.message();
    const auto& response = result.steps.back().responses;
    if (!press) press = response[0];
    const double yield = std::string(method) == "penalty" ? 1e-3 : 1e-7;  // its springs; Uzawa's tolerance, amplified
    EXPECT_NEAR(response[0], *press, yield * std::abs(*press)) << method;
  }
}

/// Without a floor the block pushes the tube along, and there is no force.
TEST(AFloatingBody, IsPushedAlongByWhatTouchesIt) {
  for (const auto& method : methods) {
    json scene = tube_under_a_block(20);
    scene["contacts"].erase("floor");
    scene["obstacles"].erase("floor");
    scene["time"] = {{"legs", {{0.3, 6}}}};  // the block goes down by 0.09; the gap, a mean over segments, is 0.0564
    scene["responses"] = {{"push", {{"reaction", {{"on", "block.top"}, {"component", "y"}}}}}};
    const auto result = cases::run(scene, {{method, json::object()}}, "tube.json");
    ASSERT_TRUE(is_converged(result.status())) << method << result.message();
    // to Newton's tolerance of the force that resists the block's motion
    EXPECT_LE(std::abs(result.steps.back().responses[0]), 1e-9 * 1000 * 0.09) << method;
    const auto& body = result.problem->model.bodies[1];
    const auto of_tube =
        result.steps.back().increment->state.displacement.segment(2 * body.first_node, 2 * body.mesh.node_count);
    EXPECT_LE(of_tube.reshaped(2, body.mesh.node_count).row(1).mean(), -0.033) << method;  // out of the block's way
    EXPECT_LT(result.trajectory.counters.newton, 3000) << method;  // penalty 757, monolithic 867, Uzawa 1263
  }
}

/// What falls and is held by nothing has no solution: it is given up within bounded work, and its motion is named.
TEST(AFloatingBody, ThatFallsIsNamedSoon) {
  for (const auto& method : methods) {
    json scene = tube_under_a_block(4);
    scene["contacts"].erase("floor");
    scene["obstacles"].erase("floor");
    scene["loads"] = {{{"on", "tube"}, {"body_force", {0, -1}}}};
    const auto result = cases::run(scene, {{method, json::object()}}, "tube.json");
    EXPECT_FALSE(is_converged(result.status())) << method;
    EXPECT_THAT(result.message(), testing::HasSubstr("tube is free to move")) << method;
    EXPECT_LT(result.trajectory.counters.newton, 3000) << method;
  }
}

}  // namespace
}  // namespace stickslip::floating_bodies
