/// A strip a thousand times as long as thick between two walls (C25): its faces are nearer to one another than to what
/// they touch, and each may touch its own wall alone.
#include <gtest/gtest.h>

#include "tests/support/blocks.hpp"
#include "tests/support/largest.hpp"

namespace stickslip::thin_strip_test {
namespace {

using scenes::parameter;
using scenes::response;
using scenes::run;
using scenes::table;
using Kind = Response::Kind;

constexpr double length = 10, thickness = 0.01, gap = 0.002, E = 1e6;
constexpr double bending = E * thickness * thickness * thickness / 12;

/// Clamped at its left, between floor and ceiling at `gap` from it; `weight` over the length presses its whole boundary
/// on the floor.
Scene strip(double weight, int cells) {
  Scene s;
  s.finite_strain = true;
  s.legs = {{1, 2}};
  Body body = scenes::box_body("strip", {0, 0}, {length, thickness}, {cells, 1});
  body.material = NeoHookean{E, 0.0};
  body.element = "Q8";
  s.bodies = {body};
  s.obstacles = {{"floor", Polyline{{{-1.0, -gap}, {length + 1, -gap}}}},
                 {"ceiling", Polyline{{{length + 1, thickness + gap}, {-1.0, thickness + gap}}}}};
  s.contacts = {scenes::contact("below", "strip.boundary", "floor"),
                scenes::contact("above", "strip.boundary", "ceiling")};
  const Table still = table({{0, 0.0}});
  s.supports = {scenes::support("strip.left", {{'x', still}, {'y', still}})};
  s.loads = {scenes::force("strip.top", {0.0, -weight * length})};
  s.responses = {response("clamp", Kind::reaction, "strip.left", "y"),
                 response("floor", Kind::contact_force, "below", "normal"),
                 response("ceiling", Kind::contact_force, "above", "normal")};
  return s;
}

TEST(ThinStrip, TouchesItsOwnWallByEachOfItsFaces) {  // C25
  // Lift-off a = (72 EI g / q)^(1/4); the clamp bears what lies before it, less a third: q a 2/3.
  constexpr double a = 6;
  const double weight = 72 * bending * gap / (a * a * a * a);
  for (const Method& method : scenes::exact_methods()) {
    const auto s = run(strip(weight, 100), method);
    ASSERT_TRUE(is_converged(s.trajectory.status)) << name_of(method) << s.trajectory.message;
    EXPECT_NEAR(s.value("clamp"), weight * a * 2 / 3, 0.03 * weight * a * 2 / 3) << name_of(method);
    EXPECT_NEAR(std::abs(s.value("floor")), weight * (length - a * 2 / 3), 0.03 * weight * length) << name_of(method);
    EXPECT_EQ(s.value("ceiling"), 0) << name_of(method);
    const auto& contact = s.trajectory.increments.back().state.contact;
    double first = length;
    for (std::size_t p = 0; p < s.model.points.size(); ++p) {
      if (contact.state[p] == ContactState::open) continue;
      const auto X = s.model.points[p].nodes[0];
      EXPECT_LE(s.slots.points(1, X), 1e-12) << name_of(method);
      first = smaller(first, s.slots.points(0, X));
    }
    EXPECT_NEAR(first, a, 0.03 * a + length / 100) << name_of(method);
  }
}

}  // namespace
}  // namespace stickslip::thin_strip_test
