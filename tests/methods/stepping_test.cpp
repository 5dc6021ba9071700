/// Step cutting: what fails is cut, what was cut is remembered, and what is given up leaves no trace.
#include <gtest/gtest.h>

#include "core/model/response.hpp"
#include "tests/support/blocks.hpp"
#include "tests/support/same_bits.hpp"
#include "tests/support/solved.hpp"

namespace stickslip::stepping_test {
namespace {

using scenes::run;

/// A frozen cone is not followed by a motion where it fails (methods/rescue/rescue.hpp): its increments are cut.
UzawaAL limited(int max_iterations) {
  UzawaAL method;
  method.cone = UzawaAL::Cone::frozen;
  method.tolerance = 1e-12;
  method.newton.max_iterations = max_iterations;
  return method;
}

/// Slip runs over 20 nodes in one step, one an iteration.
Scene abrupt() { return scenes::pull_out(30, {0, 1}, 1); }

TEST(Stepping, CutsAnIncrementThatDoesNotConvergeAndReachesTheEnd) {
  const auto s = run(abrupt(), limited(3));
  ASSERT_TRUE(is_converged(s.trajectory.status)) << s.trajectory.message;
  EXPECT_GT(s.trajectory.counters.cutbacks, 0);
  double before = 0;
  int requested = 0;
  for (const auto& increment : s.trajectory.increments) {
    EXPECT_GT(increment.time, before);
    before = increment.time;
    requested += increment.requested;
    const Vector<double> balance = nodal_balance(s.model, s.slots, increment.state, increment.time);
    for (int dof : s.model.free_dofs)
      // the method's tolerance of 1e-12 of forces of order 1, with room for the scale of the largest increment
      EXPECT_NEAR(balance[dof], 0, 1e-10) << increment.time;
  }
  EXPECT_EQ(requested, static_cast<int>(s.model.times.size()));
  EXPECT_EQ(before, s.model.times.back());
}

TEST(Stepping, ReplayOfTheStepTableGivesTheSameBits) {
  const auto scene = abrupt();
  const auto first = run(scene, limited(3));
  ASSERT_GT(first.trajectory.counters.cutbacks, 0);
  RunOptions replay;
  replay.replay = first.trajectory.step_table();
  const auto again = run(scene, limited(3), replay);
  expect_same_bits(again.trajectory, first.trajectory, "replayed");
}

TEST(Stepping, GivesUpWithTheStatusAndKeepsWhatWasReached) {
  // from one step to the next the front advances by more than one Newton step can follow, however small the increment
  const auto s = run(scenes::greco_plate(8), limited(1));
  EXPECT_EQ(s.trajectory.status, Status::cap);
  ASSERT_EQ(s.trajectory.increments.size(), 1u) << "sub-steps of a step that was given up are rolled back";
  EXPECT_TRUE(s.trajectory.increments.back().requested);
  EXPECT_EQ(s.trajectory.increments.back().time, 1);
  EXPECT_GT(s.trajectory.increments.back().cutbacks, 0);
}

/// Two blocks at finite strain, the upper one pressed on the lower and drawn along it.
Scene drawn_blocks() {
  Scene s;
  s.finite_strain = true;
  s.legs = {{1, 1}};
  for (auto [name, low, high] : {std::tuple("lower", 0.0, 1.0), std::tuple("upper", 1.0, 2.0)})
    s.bodies.push_back(scenes::box_body(name, {0, low}, {3, high}, {name == std::string("upper") ? 4 : 3, 1}));
  for (auto& body : s.bodies) body.material = NeoHookean{1000.0, 0.3};
  s.contacts = {scenes::contact("sole", "upper.bottom", "lower.top")};
  s.contacts[0].friction = 0.3;
  s.supports = {scenes::support("lower.bottom", {{'x', scenes::ramp(0.0)}, {'y', scenes::ramp(0.0)}}),
                scenes::support("upper.top", {{'x', scenes::ramp(1.0)}, {'y', scenes::ramp(-0.3)}})};
  return s;
}

TEST(Stepping, GivesUpAfterBoundedWork) {
  // No part of the step ends within its few iterations, however it is cut.
  MonolithicAL method;
  method.newton.max_iterations = 3;
  const auto s = run(drawn_blocks(), method);
  EXPECT_EQ(s.trajectory.status, Status::cap) << s.trajectory.message;
  EXPECT_LE(s.trajectory.counters.newton, 5050);  // (the bound, one equilibrium, and parts that go well)
  ASSERT_EQ(s.trajectory.increments.size(), 1u);
}

TEST(Stepping, BreakpointsOfEveryTableAreHit) {
  auto scene = scenes::slider({{0, 0}, {0.37, 0.1}, {1, -0.1}}, 4);
  const auto s = run(scene, MonolithicAL{});
  const std::vector<double> expected{0.25, 0.37, 0.5, 0.75, 1};
  ASSERT_EQ(s.trajectory.increments.size(), expected.size());
  for (std::size_t n = 0; n < expected.size(); ++n) EXPECT_DOUBLE_EQ(s.trajectory.increments[n].time, expected[n]);
}

}  // namespace
}  // namespace stickslip::stepping_test
