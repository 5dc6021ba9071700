/// Singular tangents: of constraints that repeat one another, which leave derivatives as they are, and of a balance
/// that is about to be lost, where there are none.
#include "sensitivity/redundancy.hpp"

#include <gtest/gtest.h>

#include <random>

#include "sensitivity/differentiate.hpp"
#include "tests/support/largest.hpp"
#include "tests/support/random_contacts.hpp"
#include "tests/support/solved.hpp"
#include "tests/support/solved_run.hpp"

namespace stickslip::redundancy_test {
namespace {

bool repeat(const Scene& scene, ContactState state) {
  const Model model = make_model(scene);
  const auto slots = make_slots<double>(model, scene.as<double>());
  ContactField<double> field;
  field.state.assign(model.points.size(), state);
  return constraints_repeat(model, slots, field, {});
}

TEST(Constraints, RepeatOneAnotherWhereANodeIsHeldMoreThanItCanMove) {
  std::mt19937 random(1);
  const Scene corner = scenes::random_corner(random, 0.3);
  EXPECT_TRUE(repeat(corner, ContactState::stick)) << "four constraints of one node in the plane";
  EXPECT_FALSE(repeat(corner, ContactState::slip)) << "two walls, one node";
  EXPECT_FALSE(repeat(corner, ContactState::open));
  EXPECT_FALSE(repeat(scenes::two_boxes(6, 4), ContactState::stick)) << "each slave node moves alone";
  EXPECT_FALSE(repeat(scenes::segment_boxes(5, 7), ContactState::slip)) << "pieces share nodes";
}

// In slip, u (k + mu c) = push - mu press: with mu = -k / c and a push at the limit any u, and no derivative.
TEST(CriticalFriction, LeavesNoDerivativeOfAnySize) {
  for (const double push : {20.0, 20.0 * (1 + 1e-15)}) {
    const Scene scene = scenes::wedge(2, push, 10, 100, -50);
    for (const Method& method : {Method(Penalty{}), Method(UzawaAL{}), Method(MonolithicAL{})}) {
      const auto gradients = scenes::SolvedRun(scene, method).direct();
      for (const auto& of : gradients.of_responses)  // a stick's, or of a spring: u is 0.4 at most, by a push of 20
        EXPECT_LE(largest_entry(of), 1e3) << name_of(method) << push;
    }
  }
}

}  // namespace
}  // namespace stickslip::redundancy_test
