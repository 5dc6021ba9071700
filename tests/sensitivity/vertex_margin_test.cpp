/// How far points are from the vertices of a faceted master.
#include "sensitivity/vertex_margin.hpp"

#include <gtest/gtest.h>

#include "tests/support/solved.hpp"

namespace stickslip::vertex_margin_test {
namespace {

/// A point at x on a roof of two slopes of 0.1, pressed down, whose friction holds it there.
scenes::Solved on_a_roof(double x) {
  Scene s;
  s.finite_strain = true;
  s.legs = {{1, 1}};
  s.bodies = {{"point", PointMesh{{x, -0.1 * std::abs(x)}}, GroundedSpring{{{100.0, 0.0}, {0.0, 50.0}}}, "", 1.0}};
  Polyline roof;
  roof.points = {{-2.0, -0.2}, {0.0, 0.0}, {2.0, -0.2}};
  s.obstacles = {{"roof", roof}};
  s.contacts = {scenes::contact("sole", "point.node", "roof")};
  s.contacts[0].friction = 2.0;
  s.loads = {scenes::force("point.node", {0.0, -10.0})};
  return scenes::run(s, MonolithicAL{});
}

double margin(const scenes::Solved& s) { return vertex_margin(s.model, s.slots, s.trajectory.increments[0].state, 1); }

TEST(VertexMargin, IsTheWayToTheNextVertexOverTheFacet) {
  const double length = std::hypot(2, 0.2);
  for (double x : {-1.5, -0.5, 0.5, 1.5}) {  // (free ends are no vertices; the line that halves the slopes is upright)
    const auto s = on_a_roof(x);
    ASSERT_TRUE(is_converged(s.trajectory.status)) << s.trajectory.message;
    EXPECT_NEAR(margin(s), std::abs(x) / length, 1e-9) << x;  // of a point that sticks, to the tolerance of Newton
  }
  EXPECT_LE(margin(on_a_roof(0)), 1e-9);
}

TEST(VertexMargin, IsOfPointsThatTouchFacetsAlone) {
  EXPECT_FALSE(slides_along_facets(make_model(scenes::stop())));
  auto s = on_a_roof(0.5);
  EXPECT_TRUE(slides_along_facets(s.model));
  s.trajectory.increments[0].state.contact.state[0] = ContactState::open;
  EXPECT_TRUE(std::isinf(margin(s)));
}

}  // namespace
}  // namespace stickslip::vertex_margin_test
