/// What a scene does not call for costs nothing: allocations counted, not timed.
#include <gtest/gtest.h>

#include "sensitivity/one_sided.hpp"
#include "tests/support/allocations.hpp"
#include "tests/support/solved.hpp"

namespace stickslip::effects_test {
namespace {

/// (Eigen's vectors call malloc themselves; those in a std::vector, and all else of ours, pass through operator new.)
template <class F>
long allocations_of(F&& f) {
  const long before = allocations();
  f();
  return allocations() - before;
}

TEST(Effects, RunsAllocateTheSameWhetherOrNotThereAreParameters) {
  for (const Method& method : {Method(Penalty{}), Method(UzawaAL{}), Method(MonolithicAL{})}) {
    const Scene with = scenes::two_boxes(6, 9);
    Scene without = with;
    without.parameters.clear();
    long count[2];
    int i = 0;
    for (const Scene* scene : std::initializer_list<const Scene*>{&with, &without}) {
      const Model model = make_model(*scene);
      const auto slots = make_slots<double>(model, scene->as<double>());
      solve(model, slots, method);  // what the libraries keep for good is there from here on
      count[i++] = allocations_of([&] { solve(model, slots, method); });
    }
    EXPECT_EQ(count[0], count[1]) << name_of(method);
    EXPECT_GT(count[0], 0);  // the counter counts
  }
}

TEST(Effects, DerivativesOfNothingAllocateNothing) {
  Scene scene = scenes::two_boxes(6, 9);
  scene.parameters.clear();
  const Model model = make_model(scene);
  const auto slots = make_slots<double>(model, scene.as<double>());
  Workspace<double> workspace;
  const Method method = MonolithicAL{};
  const auto trajectory = solve(model, slots, method, {}, workspace);
  EXPECT_EQ(allocations_of([&] { differentiate(model, slots, method, trajectory, workspace); }), 0);
  EXPECT_FALSE(one_sided_derivatives(model, slots, method, trajectory, workspace).has_value());
}

TEST(Effects, AnUntracedRunKeepsNoIterates) {
  const Scene scene = scenes::two_boxes(6, 9);
  const Model model = make_model(scene);
  const auto slots = make_slots<double>(model, scene.as<double>());
  Trace trace;
  RunOptions traced;
  traced.trace = &trace;
  solve(model, slots, MonolithicAL{});
  const long plain = allocations_of([&] { solve(model, slots, MonolithicAL{}); });
  EXPECT_GT(allocations_of([&] { solve(model, slots, MonolithicAL{}, traced); }), plain);
}

TEST(Effects, FrictionlessContactHasNoTangentialUnknownsStatesOrHistory) {
  Scene scene = scenes::two_boxes(6, 9);
  scene.contacts[0].friction.reset();
  const auto s = scenes::run(scene, MonolithicAL{});
  EXPECT_EQ(s.model.multiplier_count, static_cast<int>(s.model.points.size()));
  const auto& contact = s.trajectory.increments.back().state.contact;
  EXPECT_EQ(contact.slip.size() + s.trajectory.increments.back().state.history.placement.size(), 0);
  EXPECT_FALSE(s.model.effects.friction);
}

}  // namespace
}  // namespace stickslip::effects_test
