#include "methods/newton/trace.hpp"

#include <gtest/gtest.h>

#include "methods/method.hpp"
#include "tests/support/same_bits.hpp"
#include "tests/support/solved.hpp"

namespace stickslip::trace_test {
namespace {

struct Traced {
  Model model;
  Slots<double> slots;
  Trace trace;
  Trajectory<double> trajectory;
  Traced(const Scene& scene, const Method& method) : model(make_model(scene)) {
    slots = make_slots<double>(model, scene.as<double>());
    RunOptions options;
    options.trace = &trace;
    trajectory = solve(model, slots, method, options);
  }
};

TEST(Trace, HasEveryIterateOfTheHistory) {
  for (const Method& method : {Method(Penalty{}), Method(UzawaAL{}), Method(MonolithicAL{})}) {
    const Traced t(scenes::slider({{0, 0}, {1, 0.1}, {2, -0.1}}, 6), method);
    std::size_t next = 0;
    for (const auto& increment : t.trajectory.increments)
      for (const auto& record : increment.history) {
        ASSERT_LT(next, t.trace.iterates.size());
        const auto& iterate = t.trace.iterates[next++];
        EXPECT_EQ(iterate.time, increment.time);
        EXPECT_EQ(iterate.record.residual, record.residual);
      }
    EXPECT_EQ(next, t.trace.iterates.size());
  }
}

TEST(Trace, DoesNotChangeTheSolution) {
  for (const Method& method : {Method(Penalty{}), Method(UzawaAL{}), Method(MonolithicAL{})}) {
    const Traced t(scenes::two_boxes(6, 9), method);
    expect_same_bits(t.trajectory, solve(t.model, t.slots, method), std::string(name_of(method)) + " traced");
  }
}

TEST(Trace, ShowsTheTrialTractionAndItsProjection) {
  const Traced t(scenes::dragged_point({{0, 0, 0}, {1, 0, -0.6}, {2, 0.7, -0.6}}, 16, 0.3), MonolithicAL{});
  const double mu = t.slots.friction[0].slope_at_apex();
  bool slipped = false, stuck = false;
  for (const auto& i : t.trace.iterates) {
    ASSERT_EQ(i.trial.size(), 3);
    if (i.state[0] == ContactState::stick) {
      EXPECT_EQ(i.traction, i.trial);
      stuck = true;
    } else if (i.state[0] == ContactState::slip) {  // on the cone, along the trial: a few roundings
      EXPECT_NEAR(i.traction.tail(2).norm(), -mu * i.traction[0], -1e-14 * i.traction[0]);
      slipped |= i.traction[0] < 0;
    } else {
      EXPECT_EQ(i.traction.norm(), 0);
    }
  }
  EXPECT_TRUE(slipped && stuck);
}

TEST(Trace, KeepsNoTractionsOfManyPoints) {
  const Traced t(scenes::greco_plate(8), MonolithicAL{});
  ASSERT_FALSE(t.trace.iterates.empty());
  EXPECT_EQ(t.trace.iterates.back().trial.size(), 0);
  EXPECT_EQ(t.trace.iterates.back().state.size(), t.model.points.size());
}

}  // namespace
}  // namespace stickslip::trace_test
