/// Supports and obstacles that turn by finite angles: nothing of a turned scene changes, a drum drags a point along,
/// and derivatives go through all of it.
#include <gtest/gtest.h>

#include <numbers>

#include "tests/support/blocks.hpp"
#include "tests/support/finite_strain.hpp"

namespace stickslip::finite_rotation_test {
namespace {

using namespace scenes;
using Kind = Response::Kind;

/// A block pressed onto a rough floor by its top, sheared there, and then turned with the floor by `degrees` in `steps`
/// about (0.3, -0.2). What presses it turns too, step by step.
Scene turned_block(double degrees, int steps) {
  constexpr double down = -0.1, along = 0.04, start = 2;
  Scene s;
  s.finite_strain = true;
  s.legs = {{start, 4}, {start + steps, steps}};
  auto block = scenes::box_body("block", {-1, 0}, {1, 1}, {6, 3});
  block.material = NeoHookean{100.0, 0.3};
  s.bodies = {block};
  s.obstacles = {{"floor", Plane{{0.0, 0.0}, {0.0, 1.0}}}};
  s.contacts = {scenes::contact("sole", "block.bottom", "floor")};
  s.contacts[0].friction = 0.3;
  Table x, y, angle = table({{0, 0.0}, {start, 0.0}});
  x = table({{0, 0.0}, {1, 0.0}, {start, along}});
  y = table({{0, 0.0}, {1, down}, {start, down}});
  for (int n = 1; n <= steps; ++n) {
    const double turned = degrees * n / steps, radians = turned * std::numbers::pi / 180;
    x.points.emplace_back(start + n, along * std::cos(radians) - down * std::sin(radians));
    y.points.emplace_back(start + n, along * std::sin(radians) + down * std::cos(radians));
    angle.points.emplace_back(start + n, turned);
  }
  const Rotation rotation{{0.3, -0.2}, {}, angle};
  s.obstacles[0].rotate = rotation;
  s.supports = {scenes::support("block.top", {{'x', x}, {'y', y}})};
  s.supports[0].rotate = rotation;
  s.responses = {response("press", Kind::contact_force, "sole", "normal"), response("energy", Kind::strain_energy, ""),
                 response("heat", Kind::dissipation, "sole"), response("slid", Kind::slip, "sole")};
  return s;
}

TEST(FiniteRotation, OfAWholeSceneChangesNothing) {
  for (const auto& method : finite_schemes())
    for (const auto& [degrees, steps] : {std::pair(30.0, 6), std::pair(-170.0, 34)}) {
      const auto s = run(turned_block(degrees, steps), method);
      ASSERT_TRUE(is_converged(s.trajectory.status)) << name_of(method) << s.trajectory.message;
      ASSERT_EQ(s.trajectory.counters.cutbacks, 0);  // (within a step what presses it moves on a chord)
      const int before = 3, after = static_cast<int>(s.trajectory.increments.size()) - 1;
      const auto& was = s.trajectory.increments[before].state;
      const auto& is = s.trajectory.increments[after].state;
      const double largest = largest_entry(was.contact.traction);
      // (Uzawa's multipliers are right to 1e-12 of themselves, an increment)
      EXPECT_LE(largest_entry(was.contact.traction - is.contact.traction), 1e-10 * largest) << name_of(method);
      for (const char* name : {"press", "energy", "heat", "slid"})
        EXPECT_NEAR(s.value(name, after), s.value(name, before), 1e-10 * std::abs(s.value(name, before)))
            << name_of(method) << " " << name << " " << degrees;
    }
}

/// A die pressed into a slab of rubber, or of metal that flows, and drawn along it; then both are turned, by 30 degrees
/// in six steps.
Scene turned_ironing(bool metal, Smoothing smoothing) {
  constexpr double down = -0.15, along = 0.4, start = 2;
  constexpr int steps = 6;
  Scene s;
  s.finite_strain = true;
  s.legs = {{1, 3}, {start, 4}, {start + steps, steps}};
  QuadMesh die;
  die.corners = {{{0.9, 1.05}, {1.7, 1.0}, {1.8, 1.6}, {0.8, 1.6}}};
  die.cells = {4, 2};
  auto slab = scenes::box_body("slab", {0, 0}, {4, 1}, {12, 3});
  slab.material =
      metal ? Material(J2Plastic{1.0, 0.3, 0.03, 0.1}) : Material(NeoHookean{1.0, 0.3, NeoHookean::Volumetric::log});
  s.bodies = {slab, {"die", die, NeoHookean{5.0, 0.3, NeoHookean::Volumetric::log}, "", 1.0}};
  s.contacts = {scenes::contact("touch", "die.bottom", "slab.top")};
  s.contacts[0].friction = 0.3;
  s.contacts[0].smoothing = smoothing;
  Table x = table({{0, 0.0}, {1, 0.0}, {start, along}}), y = table({{0, 0.0}, {1, down}, {start, down}});
  Table angle = table({{0, 0.0}, {start, 0.0}});
  for (int n = 1; n <= steps; ++n) {
    const double radians = std::numbers::pi / 6 * n / steps;
    x.points.emplace_back(start + n, along * std::cos(radians) - down * std::sin(radians));
    y.points.emplace_back(start + n, along * std::sin(radians) + down * std::cos(radians));
    angle.points.emplace_back(start + n, 30.0 * n / steps);
  }
  s.supports = {scenes::support("slab.bottom", {{'x', table({{0, 0.0}})}, {'y', table({{0, 0.0}})}}),
                scenes::support("die.top", {{'x', x}, {'y', y}})};
  for (auto& support : s.supports) support.rotate = Rotation{{0.3, -0.2}, {}, angle};
  s.responses = {response("press", Kind::contact_force, "touch", "normal"), response("energy", Kind::strain_energy, ""),
                 response("heat", Kind::dissipation, "touch")};
  return s;
}

TEST(FiniteRotation, OfBodiesThatFlowAndSlideAlongCurvesChangesNothing) {
  for (const bool metal : {false, true})
    for (const Smoothing smoothing : {Smoothing::catmull_rom, Smoothing::b_spline})
      for (const Method& method : scenes::all_methods()) {
        // (Uzawa's inner solves cut a step there, within which what presses moves on a chord)
        if (!metal && smoothing == Smoothing::catmull_rom && std::holds_alternative<UzawaAL>(method)) continue;
        const auto s = run(turned_ironing(metal, smoothing), method);
        ASSERT_TRUE(is_converged(s.trajectory.status)) << name_of(method) << s.trajectory.message;
        ASSERT_EQ(s.trajectory.counters.cutbacks, 0) << name_of(method) << metal;
        const int before = 6, after = static_cast<int>(s.trajectory.increments.size()) - 1;
        const auto &was = s.trajectory.increments[before].state, &is = s.trajectory.increments[after].state;
        EXPECT_GT(s.value("heat", before), 0);
        EXPECT_LE(largest_entry(was.contact.traction - is.contact.traction), 1e-9 * largest_entry(was.contact.traction))
            << name_of(method) << metal;  // (a single point's is of softer modes than their sum)
        if (metal) {
          EXPECT_GT(largest_entry(was.history.bodies), 0.1);
          EXPECT_LE(largest_entry(was.history.bodies - is.history.bodies), 1e-10 * largest_entry(was.history.bodies))
              << name_of(method);
        }
        for (const char* name : {"press", "energy", "heat"})
          EXPECT_NEAR(s.value(name, after), s.value(name, before), 1e-10 * std::abs(s.value(name, before)))
              << name_of(method) << " " << name << metal;
      }
}

/// A point on a spring, pressed onto the top of a drum that turns under it.
Scene on_a_drum(double mu, double degrees, int steps) {
  Scene s;
  s.finite_strain = true;
  s.legs = {{1, 1}, {2, steps}};
  const Number k = parameter(s, "k", 100);
  s.bodies = {{"point", PointMesh{{0.0, 1.0}}, GroundedSpring{{{k, 0.0}, {0.0, k}}}, "", 1.0}};
  s.obstacles = {{"drum", Circle{{0.0, 0.0}, parameter(s, "R", 1.0)}}};
  s.obstacles[0].rotate = Rotation{
      {parameter(s, "centre", 0.0), 0.0}, {}, table({{0, 0.0}, {1, 0.0}, {2, parameter(s, "angle", degrees)}})};
  s.contacts = {scenes::contact("rim", "point.node", "drum")};
  s.contacts[0].friction = parameter(s, "mu", mu);
  const Number down = parameter(s, "down", -0.5);
  s.supports = {scenes::support("point.anchor", {{'y', table({{0, 0.0}, {1, down}})}, {'x', table({{0, 0.0}})}})};
  s.responses = {response("x", Kind::displacement, "point.node", "x"),
                 response("y", Kind::displacement, "point.node", "y"),
                 response("press", Kind::contact_force, "rim", "normal"), response("heat", Kind::dissipation, "rim")};
  return s;
}

TEST(FiniteRotation, OfADrumCarriesAPointToTheAngleOfFriction) {
  // the spring from (0, 1/2) to the point leans against the normal by atan mu; then the drum slides on under it
  constexpr double mu = 0.2, radius = 1, anchor = 0.5;
  const double friction = std::atan(mu), at_point = friction;
  const double at_anchor = std::numbers::pi - std::asin(radius * std::sin(at_point) / anchor);
  const double place = std::numbers::pi - at_anchor - at_point;  // at the centre, from the anchor's ray
  for (const auto& method : finite_methods()) {
    if (std::holds_alternative<Penalty>(method)) continue;  // (its overlap is another radius)
    for (double sense : {1.0, -1.0}) {
      const auto s = run(on_a_drum(mu, sense * 200, 20), method);
      ASSERT_TRUE(is_converged(s.trajectory.status)) << name_of(method) << s.trajectory.message;
      EXPECT_NEAR(s.value("x"), -sense * std::sin(place), 1e-9) << name_of(method);
      EXPECT_NEAR(s.value("y") + 1, std::cos(place), 1e-9) << name_of(method);
    }
    // as long as it sticks it goes round with the drum: by 3 degrees, which is less than the angle of slip
    const auto stuck = run(on_a_drum(mu, 3, 2), method);
    const double turned = 3 * std::numbers::pi / 180;
    EXPECT_NEAR(stuck.value("x"), -std::sin(turned), 1e-9) << name_of(method);
    EXPECT_NEAR(stuck.value("y") + 1, std::cos(turned), 1e-9) << name_of(method);
  }
}

TEST(FiniteRotation, OfADrumHasTheDerivativesOfTheWholeRun) {
  for (const Method& method : finite_schemes()) scenes::expect_derivatives_in_both_modes(on_a_drum(0.2, 40, 4), method);
}

/// A block whose top is turned by a support, while its bottom stands on a rough floor.
Scene twisted_block() {
  Scene s;
  s.finite_strain = true;
  s.legs = {{1, 2}, {2, 3}};
  BoxMesh box;
  box.min = {-1.0, 0.0};
  box.max = {1.0, parameter(s, "height", 1.0)};
  box.cells = {6, 3};
  s.bodies = {{"block", box, NeoHookean{parameter(s, "E", 100), 0.3}, "", 1.0}};
  s.obstacles = {{"floor", Plane{{0.0, 0.0}, {0.0, 1.0}}}};
  s.contacts = {scenes::contact("sole", "block.bottom", "floor")};
  s.contacts[0].friction = parameter(s, "mu", 0.3);
  s.supports = {scenes::support("block.top", {{'x', table({{0, 0.0}})}, {'y', table({{0, 0.0}, {1, -0.2}})}})};
  s.supports[0].rotate =
      Rotation{{parameter(s, "centre", 0.1), 1.0}, {}, table({{0, 0.0}, {1, 0.0}, {2, parameter(s, "angle", 12)}})};
  s.responses = {response("press", Kind::reaction, "block.top", "y"),
                 response("drag", Kind::reaction, "block.top", "x"), response("energy", Kind::strain_energy, ""),
                 response("heat", Kind::dissipation, "sole")};
  return s;
}

TEST(FiniteRotation, OfASupportHasTheDerivativesOfTheWholeRun) {
  for (const Method& method : finite_schemes()) scenes::expect_derivatives_in_both_modes(twisted_block(), method);
}

TEST(FiniteRotation, OfSmallAnglesIsThatOfSmallStrain) {
  const auto scene = [](bool finite) {
    Scene s = turned_block(0, 1);
    s.parameters.clear();
    s.finite_strain = finite;
    if (!finite) s.bodies[0].material = LinearElastic{100.0, 0.3};
    s.supports = {scenes::support("block.top", {{'x', table({{0, 0.0}})}, {'y', table({{0, 0.0}, {1, -1e-7}})}})};
    s.supports[0].rotate = Rotation{{0.3, -0.2}, {}, table({{0, 0.0}, {1, 1e-6}})};
    s.obstacles[0].rotate = Rotation{{0.5, 0.0}, {}, table({{0, 0.0}, {1, 2e-6}})};
    s.legs = {{1, 2}};
    return s;
  };
  const auto finite = run(scene(true), MonolithicAL{}), small = run(scene(false), MonolithicAL{});
  // (terms of second order in motions of some 1e-7)
  EXPECT_NEAR(finite.value("press"), small.value("press"), 1e-5 * std::abs(small.value("press")));
  EXPECT_NEAR(finite.value("energy"), small.value("energy"), 1e-5 * small.value("energy"));
}

}  // namespace
}  // namespace stickslip::finite_rotation_test
