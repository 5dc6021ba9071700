/// Runs that let states go: which stay, and that the others come back with the bits they had.
#include "methods/stepping/checkpoints.hpp"

#include <gtest/gtest.h>

#include "methods/method.hpp"
#include "tests/support/same_bits.hpp"
#include "tests/support/sliding_scenes.hpp"

namespace stickslip::checkpoints_test {
namespace {

TEST(Checkpoints, LetGoOfHardlyMoreStepsThanThereIsNoRoomFor) {
  for (std::size_t steps = 1; steps <= 120; ++steps)
    for (std::size_t room = 1; room <= steps; ++room) {
      const auto plan = plan_checkpoints(steps, static_cast<double>(room) + 0.5);
      if (room == steps) {
        EXPECT_FALSE(plan) << steps;
        continue;
      }
      ASSERT_TRUE(plan) << steps << " " << room;
      const std::size_t taken = plan->whole() + plan->stride - 1;  // with a stretch of those that come back
      if (plan->thinned < steps) {
        EXPECT_LE(taken, room) << steps;
        EXPECT_LE(plan->repeated(), steps - room + 2 * plan->stride) << steps << " " << room;
      }
      // two square roots, rounded up, and the last state, where there is no room for them
      const double least = 2 * std::sqrt(static_cast<double>(steps)) + 2;
      EXPECT_LE(static_cast<double>(taken), std::max(static_cast<double>(room), least)) << steps << " " << room;
    }
}

std::size_t whole_states(const Trajectory<double>& trajectory) {
  return std::count_if(trajectory.increments.begin(), trajectory.increments.end(),
                       [](const auto& increment) { return is_whole(increment.state); });
}

/// `room`: whole states that there is room for.
struct Let {
  Model model;
  Slots<double> slots;
  Workspace<double> workspace;
  Trajectory<double> trajectory;
  Let(const Scene& scene, const Method& method, RunOptions options, double room)
      : model(make_model(scene)), slots(make_slots<double>(model, scene.as<double>())) {
    options.state_memory = room * thinned_bytes(model);
    trajectory = solve(model, slots, method, options, workspace);
  }
};

/// A run in which states are let go has the bits of one that keeps them, and so have those that are solved again, in
/// whatever order they are asked for.
void expect_same_states(const Scene& scene, const Method& method, const RunOptions& options = {}) {
  const std::string what = scene.title + " " + std::string(name_of(method));
  const Let all(scene, method, options, std::numeric_limits<double>::infinity());
  ASSERT_TRUE(is_converged(all.trajectory.status)) << what << all.trajectory.message;
  EXPECT_EQ(all.workspace.checkpoints, nullptr);
  for (const double room : {6.0, 1.0}) {
    Let few(scene, method, options, room);
    ASSERT_EQ(few.trajectory.increments.size(), all.trajectory.increments.size()) << what;
    EXPECT_LT(whole_states(few.trajectory), all.trajectory.increments.size()) << what;
    EXPECT_EQ(few.trajectory.counters.newton, all.trajectory.counters.newton) << what;
    EXPECT_EQ(few.trajectory.counters.factorizations, all.trajectory.counters.factorizations) << what;
    Counters counters;
    for (int pass = 0; pass < 2; ++pass)
      for (std::size_t k = few.trajectory.increments.size(); k-- > 0;) {
        const std::size_t n = pass == 0 ? k : few.trajectory.increments.size() - 1 - k;
        const auto& kept = few.trajectory.increments[n].state;
        const auto& expected = all.trajectory.increments[n].state;
        const std::string where = what + ", increment " + std::to_string(n);
        if (is_whole(kept)) {
          expect_same_bits(kept, expected, where);
          continue;
        }
        const auto again = solve_again(few.model, few.slots, method, few.trajectory, n, few.workspace, counters);
        const auto& state = again.increments.at(n - again.first).state;
        expect_same_bits(state, expected, where);
        EXPECT_TRUE(same_bits(state.history.bodies, expected.history.bodies)) << where;
      }
    EXPECT_GT(counters.newton, 0) << what;
  }
}

TEST(Checkpoints, GiveBackTheStatesOfElasticBodiesByEitherEngine) {
  for (const auto engine : {LinearAlgebra::Engine::condensed, LinearAlgebra::Engine::sparse})
    for (const Method& method : scenes::all_methods()) {
      RunOptions options;
      options.linear_algebra.engine = engine;
      expect_same_states(scenes::two_boxes(6, 9), method, options);
      expect_same_states(scenes::pull_out(30, {0, 1, 0}, 6), method, options);
    }
}

TEST(Checkpoints, GiveBackTheStatesOfMetalThatFlows) {
  for (const bool finite : {false, true})
    for (const Method& method : scenes::all_methods()) expect_same_states(scenes::pressed_metal(finite), method);
}

TEST(Checkpoints, GiveBackTheStatesOfADieThatSlidesAlongASmoothSide) {
  for (const Scene& die : {scenes::sliding_die(), scenes::integrated_die()})
    for (const Method& method : scenes::all_methods()) expect_same_states(die, method);
}

TEST(Checkpoints, GiveBackTheStatesOfStepsThatAreCut) {
  MonolithicAL method;
  method.newton.max_iterations = 4;
  const Let all(scenes::sliding_die(), method, {}, 1);
  EXPECT_GT(all.trajectory.counters.cutbacks, 0);
  expect_same_states(scenes::sliding_die(), method);
}

TEST(Checkpoints, KeepTheStatesThatAreWritten) {
  RunOptions options;
  options.output_every = 5;
  const Let few(scenes::two_boxes(6, 9), MonolithicAL{}, options, 1);
  for (const std::size_t step : {5, 10, 12}) EXPECT_TRUE(is_whole(few.trajectory.increments[step - 1].state)) << step;
  EXPECT_FALSE(is_whole(few.trajectory.increments[5].state));
  options.output_every = 1;
  EXPECT_EQ(Let(scenes::two_boxes(6, 9), MonolithicAL{}, options, 1).workspace.checkpoints, nullptr);
}

}  // namespace
}  // namespace stickslip::checkpoints_test
