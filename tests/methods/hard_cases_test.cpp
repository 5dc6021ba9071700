/// Hard cases of bodies, loads and obstacles, by every method (cases named in brackets).
#include <gtest/gtest.h>

#include <random>

#include "tests/support/blocks.hpp"

namespace stickslip::hard_cases_test {
namespace {

using scenes::absolute;
using scenes::all_methods;
using scenes::box_body;
using scenes::contact;
using scenes::exact;
using scenes::exact_methods;
using scenes::ramp;
using scenes::response;
using scenes::run;
using scenes::support;
using scenes::table;
using Kind = Response::Kind;

Scene stop_again(int copies) {
  Scene s = scenes::stop();
  const Contact touch = s.contacts[0];
  s.contacts.clear();
  s.responses.resize(1);
  for (int i = 0; i < copies; ++i) {
    s.contacts.push_back(touch);
    s.contacts.back().name = "touch" + std::to_string(i);
    s.responses.push_back(response("press" + std::to_string(i), Kind::contact_force, s.contacts.back().name, "normal"));
  }
  return s;
}

double sum_of_presses(const scenes::Solved& s, int copies, const char* derivative = nullptr) {
  double sum = 0;
  for (int i = 0; i < copies; ++i) {
    const std::string name = "press" + std::to_string(i);
    sum += derivative ? s.derivative(name, derivative) : s.value(name);
  }
  return sum;
}

TEST(Redundant, ConstraintsThatRepeatOneAnotherShareTheForce) {  // (C6)
  const double k = 1000, rho = 1e4, lambda = 5;
  for (int n : {2, 5}) {
    const auto penalty = run(stop_again(n), Penalty{absolute(rho)});
    EXPECT_NEAR(sum_of_presses(penalty, n), lambda * n * rho / (k + n * rho), exact);
    UzawaAL method;
    method.scale = absolute(rho);
    method.adapt = false;
    method.tolerance = 1e-12;
    const auto uzawa = run(stop_again(n), method);
    EXPECT_NEAR(sum_of_presses(uzawa, n), lambda, exact);
    method.tolerance = 1e-7;  // the last updates above their rounding
    EXPECT_NEAR(run(stop_again(n), method).trajectory.increments.back().contraction, k / (k + n * rho), 1e-6);
    const auto monolithic = run(stop_again(n), MonolithicAL{});
    ASSERT_TRUE(is_converged(monolithic.trajectory.status));
    EXPECT_NEAR(sum_of_presses(monolithic, n), lambda, exact);
    EXPECT_NEAR(monolithic.value("u"), 0.01, exact * 0.01);
    EXPECT_NE(monolithic.trajectory.increments.back().message.find("repeat one another"), std::string::npos);
    for (const auto* s : {&uzawa, &monolithic}) {
      EXPECT_NEAR(sum_of_presses(*s, n, "F"), 1, exact);
      EXPECT_NEAR(sum_of_presses(*s, n, "g0"), -k, exact * k);
    }
  }
}

TEST(Redundant, ACornerThatASupportHoldsMayBeInContactToo) {  // (C7)
  double pull = 0;
  for (const auto& method : all_methods()) {
    Scene s;
    s.legs = {{2, 4}};
    s.bodies = {box_body("block", {0, 0}, {2, 1}, {4, 2})};
    s.obstacles = {{"floor", Plane{{0.0, 0.0}, {0.0, 1.0}}}};
    s.contacts = {contact("sole", "block.bottom", "floor")};
    s.contacts[0].friction = 0.3;
    s.supports = {support("block.left", {{'x', table({{0, 0.0}})}, {'y', table({{0, 0.0}})}})};
    s.loads = {{"block.top", Load::Kind::pressure, {10.0}, ramp(1.0)},
               {"block.right", Load::Kind::traction, {1.0, 0.0}, table({{1, 0.0}, {2, 1.0}})}};
    for (const char* axis : {"x", "y"}) {
      s.responses.push_back(response(std::string("R") + axis, Kind::reaction, "block.left", axis));
      s.responses.push_back(response(std::string("C") + axis, Kind::contact_force, "sole", axis));
    }
    const auto r = run(s, method);
    ASSERT_TRUE(is_converged(r.trajectory.status)) << name_of(method) << r.trajectory.message;
    // the reaction balances everything at the corner, contact included: the sum is that of the loads
    EXPECT_NEAR(r.value("Rx") + r.value("Cx"), -1, 1e-8) << name_of(method);
    EXPECT_NEAR(r.value("Ry") + r.value("Cy"), 20, 1e-8) << name_of(method);
    if (!std::holds_alternative<Penalty>(method)) {
      if (pull != 0) {
        EXPECT_NEAR(r.value("Cx"), pull, 1e-6) << "Uzawa's tolerance";
      }
      pull = r.value("Cx");
    }
  }
}

TEST(HardCases, AnInitialPenetrationIsPushedOutInAnyNumberOfSteps) {  // (C11)
  for (const auto& method : exact_methods())
    for (int steps : {1, 10}) {
      Scene s = scenes::stop(15, 1000, -0.01);
      s.legs = {{1, steps}};
      const auto r = run(s, method);
      EXPECT_NEAR(r.value("press"), 25, exact * 25) << name_of(method);
      EXPECT_NEAR(r.value("u"), -0.01, exact * 0.01);
    }
}

TEST(HardCases, JustTouchingToTheLastBitNeitherFlipsNorPushes) {  // (C12)
  std::mt19937 random(7);
  std::uniform_real_distribution<double> g0(0.001, 0.1), k(1, 1e4), bit(-1, 1);
  for (const auto& method : all_methods())
    for (int i = 0; i < 100; ++i) {
      const double gap = g0(random), stiffness = k(random), force = stiffness * gap * (1 + 1e-14 * bit(random));
      const auto s = run(scenes::stop(force, stiffness, gap), method);
      ASSERT_TRUE(is_converged(s.trajectory.status)) << name_of(method);
      EXPECT_LE(s.trajectory.increments.back().newton, 3) << name_of(method) << " " << force << " " << stiffness;
      EXPECT_LE(s.value("press"), 1e-12 * force) << name_of(method);
      EXPECT_NEAR(s.value("u"), gap, 1e-12 * gap);
    }
}

TEST(HardCases, BeyondTheEdgeOfAMasterThereIsNoGhostForce) {  // (C13; small strain: by the place at the start)
  for (const auto& method : exact_methods())
    for (double x : {0.9, 1.0, 1.1}) {
      Scene s;
      s.legs = {{1, 2}};
      s.bodies = {{"p", PointMesh{{x, 0.0}}, GroundedSpring{{{1000.0, 0.0}, {0.0, 1000.0}}}, "", 1.0}};
      s.obstacles = {{"ledge", Polyline{{{{0.0, 0.0}}, {{1.0, 0.0}}}}}};
      s.contacts = {contact("touch", "p.node", "ledge")};
      s.loads = {scenes::force("p.node", {0.0, -10.0})};
      s.responses = {response("press", Kind::contact_force, "touch", "normal"),
                     response("u", Kind::displacement, "p.node", "y")};
      const auto r = run(s, method);
      EXPECT_EQ(r.model.points.size(), x > 1 ? 0u : 1u);
      EXPECT_NEAR(r.value("press"), x > 1 ? 0 : 10, exact * 10) << x;
      EXPECT_NEAR(r.value("u"), x > 1 ? -0.01 : 0, exact * 0.01) << x;
    }
}

TEST(HardCases, ATinyFrictionIsNone) {  // (C20)
  for (const auto& method : all_methods()) {
    const auto none = run(scenes::greco_plate(8, 0), method);
    for (double mu : {1e-300, 1e-100, 1e-16, 1e-8}) {
      const auto s = run(scenes::greco_plate(8, mu), method);
      // a point at its apex sticks first, however small its friction, so that friction may hold a body: two more
      EXPECT_LE(s.trajectory.increments.back().newton, none.trajectory.increments.back().newton + 2)
          << name_of(method) << " " << mu;
      for (const char* name : {"u0", "u4", "reaction"})
        EXPECT_NEAR(s.value(name), none.value(name), (1e-12 + 10 * mu) * std::abs(none.value(name))) << mu;
      EXPECT_TRUE(std::isfinite(s.derivative("u0", "mu"))) << mu;
    }
  }
}

TEST(HardCases, AnIncrementInWhichNothingHappensChangesNothing) {  // (C21)
  for (const auto& method : all_methods()) {
    auto scene = scenes::slider({{0, 0}, {1, 0.1}, {2, 0.1}}, 4);
    const auto s = run(scene, method);
    ASSERT_EQ(s.trajectory.increments.size(), 4u);
    const auto &before = s.trajectory.increments[1], &after = s.trajectory.increments[3];
    EXPECT_LE(after.newton, 1) << name_of(method);
    if (after.newton == 0) {
      EXPECT_EQ(after.state.displacement, before.state.displacement) << "to the last bit";
    }
    for (const auto& r : scene.responses) {
      EXPECT_NEAR(s.value(r.name), s.value(r.name, 1), 1e-9 * std::abs(s.value(r.name)))
          << "1e3 times Newton's 1e-12: it moves by its own conditioning";
      for (const char* of : {"mu", "N", "k"})
        EXPECT_NEAR(s.derivative(r.name, of), s.derivative(r.name, of, 1),
                    1e-9 * std::max(1e-3, std::abs(s.derivative(r.name, of, 1))))
            << name_of(method) << " " << r.name << "/" << of;
    }
  }
}

TEST(HardCases, ASlaveAtTheCentreOfACircleIsRefusedForItFacesNoPlaceOfIt) {  // (C23)
  Scene s = scenes::stop();
  s.obstacles = {{"stop", Circle{{0.0, 0.0}, 1.0, true}, {}}};
  try {
    make_model(s);
    FAIL() << "no direction is nearer than another";
  } catch (const ModelError& error) {
    EXPECT_EQ(error.pointer, "/obstacles/stop/circle/center");
  }
}

TEST(HardCases, AWholeFaceThatLandsInOneStepLandsAtOnce) {  // (C33)
  for (const auto& method : all_methods()) {
    Scene s;
    s.legs = {{1, 1}};
    s.bodies = {box_body("upper", {0, 1.001}, {1, 2}, {8, 4}), box_body("lower", {0, 0}, {1, 1}, {8, 4})};
    s.contacts = {contact("touch", "upper.bottom", "lower.top")};
    s.supports = {support("lower.bottom", {{'y', table({{0, 0.0}})}}), support("upper.top", {{'y', ramp(-0.011)}})};
    for (const char* side : {"lower.left", "upper.left"})
      s.supports.push_back(support(side, {{'x', table({{0, 0.0}})}}));
    s.responses = {response("P", Kind::contact_force, "touch", "normal")};
    const auto r = run(s, method);
    const auto& last = r.trajectory.increments.back();
    EXPECT_LE(last.newton / std::max(1, last.augmentations), 4) << name_of(method);
    EXPECT_EQ(last.cutbacks, 0);
    for (ContactState state : last.state.contact.state) EXPECT_EQ(state, ContactState::slip) << "closed, frictionless";
    const double stress = 0.01 / 1.999 * 1000 / (1 - 0.09);
    EXPECT_NEAR(r.value("P"), stress, (std::holds_alternative<Penalty>(method) ? 1e-3 : 1e-7) * stress);
  }
}

TEST(HardCases, ABodyThatNothingHoldsButTheContactItIsAboutToMakeLands) {  // (C33, by its load)
  for (double gap : {1e-12, 1e-3, 0.3})
    for (const auto& method : all_methods()) {
      Scene s;
      s.legs = {{1, 1}};
      s.bodies = {box_body("upper", {0, 1 + gap}, {1, 2 + gap}, {8, 4}), box_body("lower", {0, 0}, {1, 1}, {8, 4})};
      s.contacts = {contact("touch", "upper.bottom", "lower.top")};
      s.contacts[0].friction = 0.3;
      s.supports = {support("lower.bottom", {{'y', table({{0, 0.0}})}}),
                    support("lower.left", {{'x', table({{0, 0.0}})}})};
      s.loads = {{"upper.top", Load::Kind::pressure, {10.0}, {}}};
      s.responses = {response("P", Kind::contact_force, "touch", "normal"),
                     response("fall", Kind::displacement, "upper.top", "y")};
      const auto r = run(s, method);
      const auto& last = r.trajectory.increments.back();
      EXPECT_TRUE(is_converged(r.trajectory.status)) << name_of(method) << gap << r.trajectory.message;
      EXPECT_EQ(last.cutbacks, 0);
      EXPECT_LE(last.history[0].open, 9);
      const auto first = std::count_if(last.history.begin(), last.history.end(),
                                       [](const IterationRecord& i) { return i.augmentation <= 1; });
      EXPECT_LE(first, 6) << name_of(method) << gap;  // with the start: one to land, one or two to stick, one to see it
      for (ContactState state : last.state.contact.state) EXPECT_EQ(state, ContactState::stick);
      EXPECT_NEAR(r.value("P"), 10, 1e-10 * 10);  // the load, whatever the method
      // two blocks of height 1 in plane strain, free to widen alike
      const double fall = gap + 2 * 10 * (1 - 0.09) / 1000;
      EXPECT_NEAR(r.value("fall"), -fall, (std::holds_alternative<Penalty>(method) ? 1e-3 : 1e-9) * fall);
    }
}

TEST(HardCases, ABodyThatNothingPressesSlidesWithoutTraction) {
  // (all forces of a penalty are rounding then, which has nothing to be measured by: not in every step count)
  for (const auto& method : exact_methods())
    for (int steps : {1, 2, 7}) {
      Scene s;
      s.legs = {{1, steps}};
      s.bodies = {box_body("block", {0, 0}, {4, 2}, {4, 2})};
      s.obstacles = {{"floor", Plane{{0.0, 0.0}, {0.0, 1.0}}, {}}};
      s.contacts = {contact("sole", "block.bottom", "floor")};
      s.contacts[0].friction = 0.3;
      s.supports = {support("block.left", {{'x', ramp(0.001)}})};
      s.responses = {response("press", Kind::contact_force, "sole", "normal"),
                     response("u", Kind::displacement, "block.right", "x")};
      const auto r = run(s, method);
      EXPECT_TRUE(is_converged(r.trajectory.status)) << name_of(method) << steps << r.trajectory.message;
      EXPECT_NEAR(r.value("press"), 0, 1e-10 * 1000 * 0.001) << "of E u, what a unit depth could bear";
      EXPECT_NEAR(r.value("u"), 0.001, 1e-10);
      // that of the floor and one a little above it; branches that differ in the rounding of tractions are not counted
      for (const auto& increment : r.trajectory.increments) EXPECT_LE(increment.others.size(), 1u);
    }
}

TEST(HardCases, APointThatSupportsDriveIntoAnObstacleIsNamed) {  // (C8)
  Scene s;
  s.legs = {{1, 1}};
  s.bodies = {box_body("block", {0, 0}, {4, 2}, {4, 2})};
  s.obstacles = {{"floor", Plane{{0.0, 0.0}, {0.0, 1.0}}, {}}};
  s.contacts = {contact("sole", "block.bottom", "floor")};
  s.supports = {support("block.top", {{'x', table({{0, 0.0}})}}), support("block.bottom", {{'y', ramp(-0.001)}})};
  s.responses = {response("press", Kind::contact_force, "sole", "normal")};
  for (const auto& method : exact_methods()) {
    const auto r = run(s, method);
    EXPECT_EQ(r.trajectory.status, Status::infeasible) << name_of(method) << r.trajectory.message;
    EXPECT_NE(r.trajectory.message.find("sole at (0, 0) penetrates by 0.001, and supports prescribe"),
              std::string::npos)
        << r.trajectory.message;
  }
}

TEST(HardCases, ABodyThatApproachesNeedsNoForceByEitherEngine) {
  for (const auto engine : {LinearAlgebra::Engine::sparse, LinearAlgebra::Engine::condensed})
    for (const auto& method : all_methods()) {
      Scene s;
      s.legs = {{1, 5}};
      s.bodies = {box_body("block", {0, 0}, {2, 1}, {8, 4})};
      s.obstacles = {{"floor", Plane{{0.0, -0.02}, {0.0, 1.0}}, {}}};
      s.contacts = {contact("sole", "block.bottom", "floor")};
      s.supports = {support("block.top", {{'x', table({{0, 0.0}})}, {'y', table({{0, 0.0}, {1, -0.05}})}})};
      s.responses = {response("N", Kind::contact_force, "sole", "normal"),
                     response("v", Kind::displacement, "block.bottom", "y")};
      RunOptions options;
      options.linear_algebra.engine = engine;
      const auto r = run(s, method, options);
      ASSERT_TRUE(is_converged(r.trajectory.status)) << name_of(method) << r.trajectory.message;
      EXPECT_EQ(r.trajectory.counters.cutbacks, 0);
      EXPECT_LE(r.trajectory.increments[0].newton, 3) << "one, and two to see that nothing falls any more";
      // one fifth of the way, where it touches nothing, all of it has moved alike
      EXPECT_EQ(r.value("N", 0), 0);
      EXPECT_NEAR(r.value("v", 0), -0.01, 1e-13);
      EXPECT_GT(r.value("N"), 60);
    }
}

TEST(HardCases, ANodeAtTheEndOfItsMasterKeepsItWhereRoundedCoordinatesEndShort) {
  const auto force = [](double width) {
    Scene s;
    s.legs = {{1, 1}};
    s.bodies = {box_body("lower", {0, 0}, {width, 1}, {4, 3}), box_body("upper", {0, 1}, {2, 2}, {4, 3})};
    s.contacts = {contact("touch", "upper.bottom", "lower.top")};
    s.contacts[0].friction = 0.3;
    s.supports = {support("lower.bottom", {{'x', table({{0, 0.0}})}, {'y', table({{0, 0.0}})}}),
                  support("upper.top", {{'x', table({{0, 0.001}})}, {'y', table({{0, -0.01}})}})};
    s.responses = {response("N", Kind::contact_force, "touch", "normal")};
    return run(s, MonolithicAL{}).value("N");
  };
  const double flush = force(2);
  for (const double short_by : {1e-12, 1e-9, 1e-7, -1e-9})
    EXPECT_NEAR(force(2 - short_by), flush, 10 * std::abs(short_by) * flush + 1e-11 * flush) << short_by;
  EXPECT_LT(force(2 - 1e-3), 0.95 * flush) << "beyond rounding the last node faces nothing";
}

}  // namespace
}  // namespace stickslip::hard_cases_test
