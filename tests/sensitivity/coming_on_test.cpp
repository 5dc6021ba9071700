/// Points that come to face a master which they did not face before: over its end, with overlap. Closed forms by every
/// method and in any number of steps, and derivatives of steps in which a point comes on.
#include <gtest/gtest.h>

#include "tests/support/blocks.hpp"
#include "tests/support/finite_strain.hpp"

namespace stickslip::coming_on_test {
namespace {

using namespace scenes;
using Kind = Response::Kind;

constexpr double k = 1000, overlap = 0.05, press = k * overlap;

/// A point on a spring, `overlap` below the level y = 1 of its master, whose anchor goes along x.
Scene pin(double from, Table along, FrictionLaw<Number> friction) {
  Scene s;
  s.finite_strain = true;
  s.bodies = {{"pin", PointMesh{{from, 1 - overlap}}, GroundedSpring{{{k, 0.0}, {0.0, k}}}, "", 1.0}};
  s.supports = {scenes::support("pin.anchor", {{'x', std::move(along)}, {'y', table({{0, 0.0}})}})};
  s.contacts = {scenes::contact("t", "pin.node", "slab")};
  s.contacts[0].friction = std::move(friction);
  s.responses = {response("N", Kind::contact_force, "t", "normal"), response("T", Kind::contact_force, "t", "x"),
                 response("x", Kind::displacement, "pin.node", "x"), response("slid", Kind::slip, "t")};
  return s;
}

/// From x = `from` to `from` + 0.6 in `steps`, onto or off a polyline from x = 0 to x = 2.
Scene pin_on_polyline(double from, FrictionLaw<Number> friction, int steps) {
  Scene s = pin(from, table({{0, 0.0}, {1, 0.6}}), std::move(friction));
  s.legs = {{1, steps}};
  s.obstacles = {{"slab", Polyline{{{0.0, 1.0}, {2.0, 1.0}}}}};
  return s;
}

/// What a penalty yields by, and what an equilibrium is solved to, over the force.
double accuracy(const Method& method) { return std::holds_alternative<Penalty>(method) ? 3e-5 : 1e-9; }

/// The anchor is at x = a. A point that has come on over the end at x = 0 sticks there until its spring pulls by
/// `bound`, and slides from there. (Within a hundredth of the facet, 0.02, past the end it is drawn onto it.)
void expect_onto_the_end(const scenes::Solved& s, const Method& method, double bound, int steps) {
  ASSERT_TRUE(is_converged(s.trajectory.status)) << name_of(method) << steps << s.trajectory.message;
  for (int n = 0; n < steps; ++n) {
    const double a = -0.3 + 0.6 * s.trajectory.increments[n].time;
    if (std::abs(a) < 0.0201) continue;
    const double T = a < 0 ? 0 : -std::min(bound, k * a);
    EXPECT_NEAR(s.value("N", n), a < 0 ? 0 : press, accuracy(method) * press) << name_of(method) << steps << " " << n;
    EXPECT_NEAR(s.value("T", n), T, accuracy(method) * press) << name_of(method) << steps << " " << n;
    // (slip counts along e = (-n_y, n_x), here against x; a penalty's stick is elastic)
    EXPECT_NEAR(s.value("slid", n), a < 0 ? 0 : -(a + T / k), accuracy(method)) << name_of(method) << steps << " " << n;
  }
}

TEST(ComingOn, APointOverAnEndBearsItsFrictionInAnyNumberOfSteps) {
  for (const Method& method : finite_methods())
    for (const int steps : {1, 2, 3, 4, 6, 7, 10, 13, 20})
      for (const double mu : {0.0, 0.05, 0.4, 1.7})
        expect_onto_the_end(run(pin_on_polyline(-0.3, mu, steps), method), method, mu * press, steps);
}

TEST(ComingOn, APointOverAnEndBearsTrescasFriction) {
  for (const Method& method : finite_methods())
    for (const int steps : {1, 2, 6, 20})
      expect_onto_the_end(run(pin_on_polyline(-0.3, Tresca<Number>{20.0}, steps), method), method, 20, steps);
}

TEST(ComingOn, AnObstacleThatMovesUnderAPointIsTheSame) {
  for (const Method& method : finite_methods())
    for (const int steps : {1, 6, 20}) {
      Scene s = pin_on_polyline(-0.3, 0.4, steps);
      s.supports[0].move['x'] = table({{0, 0.0}});
      s.obstacles[0].move = {{'x', table({{0, 0.0}, {1, -0.6}})}};
      expect_onto_the_end(run(s, method), method, 0.4 * press, steps);
    }
}

TEST(ComingOn, APointGoesOffAnEndAndComesBack) {
  for (const Method& method : finite_methods())
    for (const int steps : {1, 2, 3, 5, 10})
      for (const double mu : {0.05, 0.4}) {
        Scene scene = pin_on_polyline(1.7, mu, steps);
        scene.supports[0].move['x'] = table({{0, 0.0}, {1, 0.6}, {2, 0.0}});
        scene.legs = {{1, steps}, {2, steps}};
        const auto s = run(scene, method);
        ASSERT_TRUE(is_converged(s.trajectory.status)) << name_of(method) << steps << s.trajectory.message;
        EXPECT_NEAR(s.value("N", steps - 1), 0, accuracy(method)) << name_of(method) << steps;
        EXPECT_NEAR(s.value("N"), press, accuracy(method) * press) << name_of(method) << steps;
        EXPECT_NEAR(s.value("T"), mu * press, accuracy(method) * press) << name_of(method) << steps;
      }
}

TEST(ComingOn, APointOntoOneElementOfAStiffBody) {
  for (const Method& method : finite_methods())
    for (const Smoothing kind : {Smoothing::none, Smoothing::catmull_rom, Smoothing::b_spline})
      for (const int steps : {1, 3, 6, 20}) {
        Scene scene = pin(-0.3, table({{0, 0.0}, {1, 0.6}}), 0.4);
        scene.legs = {{1, steps}};
        scene.bodies.push_back(scenes::box_body("block", {0, 0}, {1, 1}, {1, 1}));
        scene.bodies[1].material = NeoHookean{1e7, 0.3, NeoHookean::Volumetric::log};
        scene.contacts[0].master = "block.top";
        scene.contacts[0].smoothing = kind;
        scene.supports.push_back(scenes::support("block.bottom", {{'x', table({{0, 0.0}})}, {'y', table({{0, 0.0}})}}));
        const auto s = run(scene, method);
        ASSERT_TRUE(is_converged(s.trajectory.status)) << name_of(method) << steps << s.trajectory.message;
        EXPECT_NEAR(s.value("N"), press, 1e-3 * press) << name_of(method);  // the body yields by some k / E
        EXPECT_NEAR(s.value("T"), -0.4 * press, 1e-3 * press) << name_of(method);
      }
}

/// A block whose sole is drawn onto a polyline over its end at x = 0, its top led level.
Scene block_on_polyline(bool segment, int cells, int steps, double mu) {
  Scene s;
  s.finite_strain = true;
  s.legs = {{1, steps}};
  s.bodies = {scenes::box_body("block", {-1.3, 0}, {-0.3, 0.5}, {cells, 1})};
  s.bodies[0].material = NeoHookean{parameter(s, "E", 100), 0.2, NeoHookean::Volumetric::log};
  s.obstacles = {{"table", Polyline{{{0.0, 0.01}, {0.9, 0.01}, {4.0, 0.01}}}}};
  s.contacts = {scenes::contact("t", "block.bottom", "table")};
  s.contacts[0].segment = segment;
  s.contacts[0].friction = parameter(s, "mu", mu);
  s.supports = {scenes::support("block.top",
                                {{'x', table({{0, 0.0}, {1, parameter(s, "along", 2.1)}})}, {'y', table({{0, 0.0}})}})};
  s.responses = {response("N", Kind::contact_force, "t", "normal"), response("T", Kind::contact_force, "t", "x")};
  return s;
}

TEST(ComingOn, ASoleOverAnEndBearsItsFrictionOnNodesAndSegments) {
  // A step is longer than the sole yields by: all that touches slips, whether it came on in that step or before. (No
  // step ends where a point is drawn onto the end: a node up to a hundredth of a facet past it, or a segment of which
  // one to two hundredths face the table.)
  for (const Method& method : finite_methods())
    for (const bool segment : {false, true})
      for (const int cells : {1, 3})
        for (const int steps : {1, 2, 4, 8})
          for (const double mu : {0.05, 0.4}) {
            const auto s = run(block_on_polyline(segment, cells, steps, mu), method);
            ASSERT_TRUE(is_converged(s.trajectory.status))
                << name_of(method) << segment << cells << steps << mu << s.trajectory.message;
            for (int n = 0; n < steps; ++n)
              EXPECT_NEAR(s.value("T", n), -mu * s.value("N", n), 1e-8 * s.value("N"))
                  << name_of(method) << segment << cells << steps << n;
            EXPECT_GT(s.value("N"), 0.5);
          }
}

/// A block pressed onto a longer slab, whose nodes are the slaves, and drawn over nodes that it did not touch.
Scene block_over_nodes(Smoothing kind, bool segment) {
  Scene s;
  s.finite_strain = true;
  s.legs = {{1, 1}, {2, 3}};
  s.bodies = {scenes::box_body("block", {0, 0}, {1, 0.5}, {2, 1}),
              scenes::box_body("slab", {-1, -0.5}, {2, 0}, {7, 1})};
  for (Body& body : s.bodies) body.material = NeoHookean{parameter(s, "E_" + body.name, 100), 0.3};
  s.contacts = {scenes::contact("t", "slab.top", "block.bottom")};
  s.contacts[0].smoothing = kind;
  s.contacts[0].segment = segment;
  s.contacts[0].friction = parameter(s, "mu", 0.2);
  const Table still = table({{0, 0.0}});
  s.supports = {scenes::support("slab.bottom", {{'x', still}, {'y', still}}),
                scenes::support("block.top", {{'x', table({{0, 0.0}, {1, 0.0}, {2, parameter(s, "along", 0.6)}})},
                                              {'y', table({{0, 0.0}, {1, parameter(s, "down", -0.03)}})}})};
  s.responses = {response("y", Kind::reaction, "slab.bottom", "y"), response("x", Kind::reaction, "slab.bottom", "x"),
                 response("slid", Kind::slip, "t"), response("heat", Kind::dissipation, "t")};
  return s;
}

/// How many points bear a force at the end of a step before which they faced nothing.
int came_on(const scenes::Solved& s) {
  int count = 0;
  for (std::size_t n = 1; n < s.trajectory.increments.size(); ++n) {
    const auto &now = s.trajectory.increments[n].state.contact, &before = s.trajectory.increments[n - 1].state.contact;
    for (std::size_t p = 0; p < now.facing.size(); ++p)
      count += before.facing[p].patch == no_patch && now.state[p] != ContactState::open;
  }
  return count;
}

TEST(ComingOn, MethodsAgreeOnABlockThatIsDrawnOverNodes) {
  for (const Smoothing kind : {Smoothing::none, Smoothing::catmull_rom, Smoothing::b_spline})
    for (const bool segment : {false, true}) {
      if (segment && kind != Smoothing::none) continue;
      const auto methods = finite_methods();
      const auto exact = run(block_over_nodes(kind, segment), methods[2]);
      ASSERT_TRUE(is_converged(exact.trajectory.status)) << exact.trajectory.message;
      EXPECT_GE(came_on(exact), 1);
      for (int m : {0, 1}) {
        const auto s = run(block_over_nodes(kind, segment), methods[m]);
        ASSERT_TRUE(is_converged(s.trajectory.status)) << name_of(methods[m]) << s.trajectory.message;
        for (const char* name : {"x", "y", "heat"})
          EXPECT_NEAR(s.value(name), exact.value(name), (m == 0 ? 1e-3 : 1e-8) * std::abs(exact.value("y")))
              << name_of(methods[m]) << " " << name;
      }
    }
}

TEST(ComingOn, DerivativesEqualTheComplexStepAndTheAdjoint) {
  // A point that sticks where it came on, and one that slips from there and turns back: both remember the end.
  for (const Method& method : {Method(Penalty{scenes::relative(100)}), Method(UzawaAL{}), Method(MonolithicAL{})}) {
    for (const double mu : {0.3, 5.0}) {
      Scene s = pin(-0.3, {}, 0.0);
      s.contacts[0].friction = parameter(s, "mu", mu);
      s.obstacles = {{"slab", Polyline{{{parameter(s, "end", 0.07), 1.0}, {2.0, parameter(s, "level", 1.02)}}}}};
      s.supports[0].move['x'] = table({{0, 0.0}, {1, parameter(s, "to", 0.45)}, {2, parameter(s, "back", 0.44)}});
      s.legs = {{1, 3}, {2, 2}};
      if (mu > 1) s.responses.pop_back();  // (a point that sticks slides by rounding)
      const auto solved = run(s, method);
      ASSERT_GE(came_on(solved), 1) << name_of(method);
      scenes::expect_derivatives_in_both_modes(s, method);
    }
    for (const bool segment : {false, true})
      scenes::expect_derivatives_in_both_modes(
          block_over_nodes(segment ? Smoothing::none : Smoothing::catmull_rom, segment), method);
  }
}

TEST(ComingOn, APointThatSticksAtTheEndHasTheSpringsSlope) {
  // mu N = 250: at the anchor's x = 0.1 + 0.07 the spring's 100 hold it at the end, x = 0.07.
  for (const Method& method : finite_methods()) {
    Scene scene = pin(-0.3, table({{0, 0.0}, {1, 0.47}}), 5.0);
    scene.obstacles = {{"slab", Polyline{{{parameter(scene, "end", 0.07), 1.0}, {2.0, 1.0}}}}};
    scene.legs = {{1, 2}};
    const auto s = run(scene, method);
    ASSERT_TRUE(is_converged(s.trajectory.status)) << name_of(method) << s.trajectory.message;
    EXPECT_NEAR(s.value("T"), -100, 100 * accuracy(method)) << name_of(method);
    EXPECT_NEAR(s.derivative("T", "end"), k, k * accuracy(method)) << name_of(method);
  }
}

}  // namespace
}  // namespace stickslip::coming_on_test
