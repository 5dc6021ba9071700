/// Objectives of responses that the test writes: values and gradients by hand.
#include <gtest/gtest.h>

#include "core/model/contact_assembly.hpp"
#include "sensitivity/adjoint.hpp"
#include "tests/support/solved.hpp"

namespace stickslip::objectives_test {
namespace {

/// A point whose displacements along x and y are the responses; three steps, the second of them in two parts.
struct Made {
  Model model;
  Slots<double> slots;
  Trajectory<double> trajectory;
  Gradients gradients;

  Made() {
    Scene s;
    s.legs = {{3, 3}};
    const Number target = scenes::parameter(s, "target", 4);
    scenes::parameter(s, "other", 1);
    s.bodies = {{"a", PointMesh{{0.0, 0.0}}, GroundedSpring{{{1.0, 0.0}, {0.0, 1.0}}}, "", 1.0}};
    s.responses = {scenes::response("x", Response::Kind::displacement, "a.node", "x"),
                   scenes::response("y", Response::Kind::displacement, "a.node", "y")};
    s.objectives = {{"sum", 0, {}},
                    {"last", 1, 3.0},
                    {"on target", 1, {}, scenes::table({{0, 0.0}, {2, target}})},  // 2, 4, 4
                    {"on target at 2", 0, 2.0, scenes::table({{0, 0.0}, {2, target}})}};
    model = make_model(s);
    slots = make_slots<double>(model, s.as<double>());
    add(1, true, 10, 1);
    add(1.5, false, 1000, 1000);
    add(2, true, 20, 5);
    add(3, true, 30, -2);
  }
  /// Displacements x and y, whose derivatives are x, 2x by the first and y, 3y by the second parameter.
  void add(double time, bool requested, double x, double y) {
    auto& increment = trajectory.increments.emplace_back();
    increment.time = time;
    increment.requested = requested;
    increment.state = initial_state<double>(model, slots);
    increment.state.displacement << x, y, 0, 0;
    Matrix<double> derivative(2, 2);
    derivative << x, 2 * x, y, 3 * y;
    gradients.of_responses.push_back(derivative);
  }
};

TEST(Objectives, AddUpTheStepsThatWereAskedFor) {
  Made made;
  const Vector<double> values = objective_values(made.model, made.slots, made.trajectory);
  EXPECT_EQ(values[0], 60);
  EXPECT_EQ(values[1], -2);
  EXPECT_EQ(values[2], 1 + 1 + 36);  // (1 - 2)^2, (5 - 4)^2, (-2 - 4)^2
  EXPECT_EQ(values[3], 256);         // (20 - 4)^2
}

TEST(Objectives, GradientsGoByTheChainRuleAndCountTheTarget) {
  Made made;
  const auto of = objective_gradients(made.model, made.slots, made.trajectory, made.gradients.of_responses);
  ASSERT_EQ(of.rows(), 4);
  EXPECT_EQ(of(0, 0), 60);
  EXPECT_EQ(of(0, 1), 120);
  EXPECT_EQ(of(1, 0), -2);
  EXPECT_EQ(of(1, 1), -6);
  // 2 (F - T) (dF - dT), T = target / 2, target, target
  EXPECT_EQ(of(2, 0), 2 * (-1 * (1 - 0.5) + 1 * (5 - 1) - 6 * (-2 - 1)));
  EXPECT_EQ(of(2, 1), 2 * (-1 * 3 + 1 * 15 - 6 * -6));
  EXPECT_EQ(of(3, 0), 2 * 16 * (20 - 1));
  EXPECT_EQ(of(3, 1), 2 * 16 * 40);
}

TEST(Objectives, OfARunThatEndedEarlyHaveNoGradient) {
  Made made;
  made.gradients.of_responses.pop_back();
  EXPECT_EQ(objective_gradients(made.model, made.slots, made.trajectory, made.gradients.of_responses).size(), 0);
}

}  // namespace
}  // namespace stickslip::objectives_test
