/// One-sided derivatives where points that slide along a curve are just at a vertex of it: against the complex step of
/// the whole run on either side.
#include "sensitivity/ties/vertex_tie.hpp"
#include "tests/support/both_modes.hpp"
#include "tests/support/extruded.hpp"
#include "tests/support/sides.hpp"

namespace stickslip::vertex_ties_test {
namespace {

using namespace scenes;
using Kind = Response::Kind;

/// Two blocks between walls, pressed flat on one another by an even motion: nodes face nodes, and facets stay in line.
/// A push of the upper one's left wall takes its nodes off them.
Scene matching_blocks(Smoothing smoothing) {
  Scene s;
  s.finite_strain = true;
  s.legs = {{1, 1}};
  const Number E = 100.0;
  for (const auto& [name, y] : {std::pair("upper", 0.0), std::pair("lower", -1.0)}) {
    BoxMesh box;
    box.min = {0.0, y};
    box.max = {3.0, y + 1};
    box.cells = {3, 1};
    s.bodies.push_back({name, box, NeoHookean{E, 0.3}, "Q4", 1.0});
  }
  s.contacts = {contact("sole", "upper.bottom", "lower.top")};
  s.contacts[0].smoothing = smoothing;
  const Number down = parameter(s, "down", -0.1), push = parameter(s, "push", 0);
  const Table still = table({{0, 0.0}});
  s.supports = {support("lower.bottom", {{'y', still}}),
                support("lower.left", {{'x', still}}),
                support("lower.right", {{'x', still}}),
                support("upper.top", {{'y', table({{0, 0.0}, {1, down}})}}),
                support("upper.left", {{'x', table({{0, 0.0}, {1, push}})}}),
                support("upper.right", {{'x', still}})};
  s.responses = {response("press", Kind::reaction, "upper.top", "y"),
                 response("drag", Kind::reaction, "upper.left", "x"),
                 response("sinks", Kind::displacement, "lower.top", "y")};
  return s;
}

std::vector<Named> named_methods() {
  std::vector<Named> chosen;
  for (const auto& scheme : schemes())
    if (scheme.name == "monolithic" || scheme.name == "iterated") chosen.push_back(scheme);
  return chosen;
}

TEST(VertexTies, OfFacetsInLineHaveTheSidesOfTheRun) {
  Scene scene = matching_blocks(Smoothing::none);
  for (const auto& scheme : named_methods()) {
    SCOPED_TRACE(scheme.name);
    EXPECT_GT(expect_sides(scene, scheme), 1);
  }
  ask_for_objectives(scene);
  EXPECT_LE(difference_of_modes(scene, MonolithicAL{}), 1e-11);  // rounding, as where nothing ties
}

TEST(EdgeTies, OfFacesInLineHaveTheSidesOfTheRun) {
  const Scene scene = extruded(matching_blocks(Smoothing::none));  // each node at a corner of two faces, at the border
  for (const auto& scheme : named_methods()) {
    SCOPED_TRACE(scheme.name);
    EXPECT_GT(expect_sides(scene, scheme), 1);
  }
}

TEST(VertexTies, AreNoneOfABSpline) {
  const Scene scene = matching_blocks(Smoothing::b_spline);
  EXPECT_FALSE(both(scene, MonolithicAL{}).sides);
}

/// A point on springs that its friction holds at the ridge of a roof: pressed on it, then pulled along a slope.
Scene point_on_a_ridge() {
  Scene s;
  s.finite_strain = true;
  s.legs = {{1, 1}, {2, 1}};
  s.bodies = {{"point", PointMesh{{0.0, 0.0}}, GroundedSpring{{{parameter(s, "k", 100), 0.0}, {0.0, 50.0}}}, "", 1.0}};
  const Number ridge = parameter(s, "ridge", 0);
  Polyline roof;
  roof.points = {{-2.0, -0.2}, {ridge, 0.0}, {2.0, -0.2}};
  s.obstacles = {{"roof", roof}};
  s.contacts = {contact("sole", "point.node", "roof")};
  s.contacts[0].friction = 0.5;
  s.supports = {support("point.anchor", {{'x', table({{0, 0.0}, {1, 0.0}, {2, 0.001}})}})};
  s.loads = {force("point.node", {0.0, parameter(s, "N", -10)})};
  s.responses = {response("drag", Kind::reaction, "point.anchor", "x"),
                 response("high", Kind::displacement, "point.node", "y")};
  return s;
}

TEST(VertexTies, AtACornerThatIsPressedHaveTheSideOnWhichThePointStays) {
  const Scene scene = point_on_a_ridge();
  const auto b = both(scene, MonolithicAL{});
  ASSERT_TRUE(b.sides);
  const int facing = b.solved.trajectory.increments[0].state.contact.facing[0].patch;
  const bool on_second = facing == 1;
  for (int i : {0, 1}) {
    // (the ridge moves to the right: the point is left behind it, on the first slope)
    const double below = b.sides->backward[0](i, 1), above = b.sides->forward[0](i, 1);
    EXPECT_EQ(std::isnan(below), !on_second) << i;
    EXPECT_EQ(std::isnan(above), on_second) << i;
    for (int j : {0, 2}) {  // (nothing moves the point along the roof)
      EXPECT_NEAR(b.sides->backward[0](i, j), b.sides->forward[0](i, j), 1e-12) << i << j;
    }
  }
}

}  // namespace
}  // namespace stickslip::vertex_ties_test
