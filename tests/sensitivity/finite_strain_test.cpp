/// Finite strain on rigid obstacles, the thin path: closed forms by every method, derivatives by every scheme against
/// the complex step of the whole program, and the adjoint against those.
#include "tests/support/finite_strain.hpp"

#include <gtest/gtest.h>

#include <numbers>

#include "tests/support/blocks.hpp"
#include "tests/support/both_modes.hpp"

namespace stickslip::finite_strain_test {
namespace {

using namespace scenes;
using Kind = Response::Kind;

Obstacle plane(const std::string& name, std::array<Number, 2> point, std::array<double, 2> normal) {
  return {name, Plane{{point[0], point[1]}, {normal[0], normal[1]}}};
}

// --- A13: a block between a moved support and a plane, stretched by l1 across ----------------------------------------

Scene patch(double stretch, NeoHookean::Volumetric kind) {
  Scene s;
  s.finite_strain = true;
  s.legs = {{1, 4}};
  auto block = scenes::box_body("block", {0, 0}, {2, 1}, {4, 3});
  block.material = NeoHookean{parameter(s, "E", 1000), parameter(s, "nu", 0.3), kind};
  s.bodies = {block};
  s.obstacles = {plane("floor", {0.0, 0.0}, {0, 1})};
  s.contacts = {scenes::contact("sole", "block.bottom", "floor")};
  const Number down = parameter(s, "down", stretch - 1);
  s.supports = {scenes::support("block.top", {{'y', table({{0, 0.0}, {1, down}})}}),
                scenes::support("block.left", {{'x', table({{0, 0.0}})}})};
  s.responses = {
      response("press", Kind::reaction, "block.top", "y"), response("wide", Kind::displacement, "block.right", "x"),
      response("sunk", Kind::displacement, "block.bottom", "y"), response("energy", Kind::strain_energy, "")};
  return s;
}

TEST(FinitePatch, HasTheStretchAndTheForceOfTheClosedForm) {
  struct Case {
    double l1, l2, P1;
  };
  for (const auto& c : {Case{0.9, 1.0449972898, -120.5210836}, Case{0.7, 1.1507960463, -458.4239232},
                        Case{0.5, 1.2883049724, -1084.4074629}})
    for (const auto& method : finite_methods()) {
      const auto s = run(patch(c.l1, NeoHookean::Volumetric::log), method);
      ASSERT_TRUE(is_converged(s.trajectory.status)) << name_of(method) << s.trajectory.message;
      EXPECT_EQ(s.trajectory.counters.cutbacks, 0) << name_of(method);
      // of the stretch that there is: the penalty sinks in, by dP/dl1 some E times that
      const double overlap = std::abs(s.value("sunk"));
      EXPECT_NEAR(s.value("wide") / 2 + 1, c.l2, 1e-9 + overlap) << name_of(method);
      EXPECT_NEAR(s.value("press") / 2, c.P1, 1e-7 + 2e4 * overlap) << name_of(method);
      EXPECT_LE(overlap, std::holds_alternative<Penalty>(method) ? 1e-4 : 1e-11) << name_of(method);
    }
}

TEST(FinitePatch, IsThatOfItsOwnStretchToRounding) {
  constexpr double lame = 1000 * 0.3 / (1.3 * 0.4), G = 1000 / 2.6;
  for (const auto& method : finite_methods()) {
    const auto s = run(patch(0.6, NeoHookean::Volumetric::log), method);
    const double l1 = 0.6 - s.value("sunk"), l2 = 1 + s.value("wide") / 2;
    EXPECT_NEAR(G * (l2 - 1 / l2) + lame * std::log(l1 * l2) / l2, 0, 1e-9 * lame) << name_of(method);
    EXPECT_NEAR(s.value("press") / 2, G * (l1 - 1 / l1) + lame * std::log(l1 * l2) / l1, 1e-9 * lame)
        << name_of(method);
    const double squares = l1 * l1 + l2 * l2 - 2, J = std::log(l1 * l2);
    EXPECT_NEAR(s.value("energy") / 2, G * (squares / 2 - J) + lame / 2 * J * J, 1e-9 * lame) << name_of(method);
  }
}

// --- A15: half of a von Mises truss, pushed through by an obstacle ---------------------------------------------------

Scene truss(double push) {
  Scene s;
  s.finite_strain = true;
  s.legs = {{1, 8}};
  s.bodies = {{"bar", LineMesh{{0.0, 0.0}, {10.0, parameter(s, "rise", 1)}, 1},
               LinearElastic{parameter(s, "E", 1e4), 0.0}, "", 1.0}};
  const Number down = parameter(s, "down", -push);
  s.obstacles = {plane("ram", {0.0, 1.0}, {0, -1})};
  s.obstacles[0].move = {{'y', table({{0, 0.0}, {1, down}})}};
  s.contacts = {scenes::contact("top", "bar.end", "ram")};
  s.supports = {scenes::support("bar.start", {{'x', table({{0, 0.0}})}, {'y', table({{0, 0.0}})}}),
                scenes::support("bar.end", {{'x', table({{0, 0.0}})}})};
  s.responses = {response("press", Kind::contact_force, "top", "normal"),
                 response("w", Kind::displacement, "bar.end", "y")};
  return s;
}

double truss_force(double w) {
  const double s = 1 - w;
  return 1e4 / std::pow(101, 1.5) * (s - s * s * s) / 2;
}

TEST(Truss, HasTheForceOfTheClosedFormUpToItsLimitPointAndBeyond) {
  constexpr double at_limit = 0.4226497308;
  for (const auto& method : finite_methods())
    for (double push : {0.2, at_limit, 0.9}) {
      const auto s = run(truss(push), method);
      ASSERT_TRUE(is_converged(s.trajectory.status)) << name_of(method) << s.trajectory.message;
      EXPECT_NEAR(s.value("press"), truss_force(-s.value("w")), 1e-9 * 1.9) << name_of(method) << push;
      const double most = std::holds_alternative<Penalty>(method) ? 1e-6 : 1e-9;  // (its overlap moves w)
      if (push == at_limit) {
        EXPECT_NEAR(2 * s.value("press"), 3.7919801295, most) << name_of(method);
      }
    }
}

TEST(Truss, UnderAForceBeyondItsLimitPointJumpsAndSaysWhen) {
  constexpr double most = 3.7919801295 / 2, load = 2.5;
  for (const auto& method : finite_methods()) {
    Scene scene = truss(0.0);
    scene.obstacles[0] = plane("floor", {0.0, -1.1}, {0, 1});  // which the bar falls on
    scene.contacts[0].master = "floor";
    scene.loads = {scenes::force("bar.end", {0.0, -load})};
    scene.loads[0].history = table({{0, 0.0}, {1, 1.0}});
    scene.legs = {{1, 20}};
    const auto s = run(scene, method);
    ASSERT_TRUE(is_converged(s.trajectory.status)) << name_of(method) << s.trajectory.message;
    int jumps = 0;
    for (const auto& increment : s.trajectory.increments) {
      if (!increment.jump) continue;
      ++jumps;
      EXPECT_NEAR(*increment.jump, most / load, 0.05 / 1000) << name_of(method);
    }
    EXPECT_EQ(jumps, 1) << name_of(method);
    EXPECT_GT(s.value("press"), 0) << name_of(method);
  }
  for (const auto& increment : run(truss(0.9), MonolithicAL{}).trajectory.increments) EXPECT_FALSE(increment.jump);
}

/// The half truss under a force on its end, of twice that the whole one, above a floor at w = 1.2.
Scene loaded_truss(double whole) {
  Scene scene = truss(0.0);
  scene.parameters.clear();
  scene.obstacles[0] = plane("floor", {0.0, -0.2}, {0, 1});
  scene.contacts[0].master = "floor";
  scene.loads = {scenes::force("bar.end", {0.0, parameter(scene, "load", -whole / 2)})};
  scene.loads[0].history = table({{0, 0.0}, {1, 1.0}});
  scene.legs = {{1, 20}};
  return scene;
}

TEST(Truss, UnderAForceBelowItsLimitPointStandsAndJustAboveItLiesOnTheFloor) {  // C26
  for (const auto& method : finite_methods()) {
    const auto below = run(loaded_truss(3.79), method), above = run(loaded_truss(3.8), method);
    ASSERT_TRUE(is_converged(below.trajectory.status)) << name_of(method) << below.trajectory.message;
    ASSERT_TRUE(is_converged(above.trajectory.status)) << name_of(method) << above.trajectory.message;
    EXPECT_LT(-below.value("w"), 0.4226497308) << name_of(method);
    EXPECT_NEAR(truss_force(-below.value("w")), 3.79 / 2, 1e-9) << name_of(method);
    EXPECT_FALSE(below.trajectory.increments.back().jump) << name_of(method);
    EXPECT_TRUE(above.trajectory.increments.back().jump) << name_of(method);
    // (a penalty sinks in, by dP/dw of its overlap)
    const double sunk = std::abs(above.value("w") + 1.2);
    EXPECT_LE(sunk, std::holds_alternative<Penalty>(method) ? 1e-4 : 1e-9) << name_of(method);
    EXPECT_NEAR(above.value("press"), 5.6915558 / 2, 1e-7 + 10 * sunk) << name_of(method);
  }
}

TEST(Truss, JustBelowItsLimitPointHasTheSlopeOfTheClosedForm) {  // C27
  const double whole = 3.7919801295 * (1 - 1e-6), scale = 1e4 / std::pow(101, 1.5) / 2;
  for (const auto& method : finite_methods()) {
    const auto s = run(loaded_truss(whole), method);
    ASSERT_TRUE(is_converged(s.trajectory.status)) << name_of(method) << s.trajectory.message;
    const double w = -s.value("w"), slope = -scale * (1 - 3 * (1 - w) * (1 - w));  // dP/dw, which nearly vanishes
    EXPECT_LT(slope, 0.01 * scale);
    EXPECT_NEAR(truss_force(w), whole / 2, 1e-11) << name_of(method);
    EXPECT_NEAR(s.derivative("w", "load"), 1 / slope, 1e-6 / slope) << name_of(method);  // w is right to 1e-11 / slope
    const auto moved = [&](double share) { return run(loaded_truss(whole * (1 + share)), method).value("w"); };
    const double h = 1e-8, difference = (moved(-h) - moved(h)) / (h * whole);  // by -load, of half the force
    EXPECT_NEAR(s.derivative("w", "load"), difference, 0.01 * difference) << name_of(method);
  }
}

// --- a point that a spring leads around a disk: large sliding on a normal that turns ---------------------------------

/// The anchor goes around the centre by an angle, at `radius`; the disk has the radius 1.
Scene led_around(double mu, double radius, double angle, int steps) {
  Scene s;
  s.finite_strain = true;
  s.legs = {{1, steps}};
  const Number k = parameter(s, "k", 100);
  s.bodies = {{"point", PointMesh{{0.0, 1.0}}, GroundedSpring{{{k, 0.0}, {0.0, k}}}, "", 1.0}};
  s.obstacles = {{"disk", Circle{{0.0, 0.0}, parameter(s, "R", 1.0)}}};
  s.contacts = {scenes::contact("rim", "point.node", "disk")};
  s.contacts[0].friction = parameter(s, "mu", mu);
  Table x, y;
  for (int n = 0; n <= steps; ++n) {
    const double t = static_cast<double>(n) / steps, turned = angle * t;
    x.points.emplace_back(t, radius * std::sin(turned));
    y.points.emplace_back(t, radius * std::cos(turned) - 1);
  }
  s.supports = {scenes::support("point.anchor", {{'x', x}, {'y', y}})};
  s.responses = {response("x", Kind::displacement, "point.node", "x"),
                 response("y", Kind::displacement, "point.node", "y"), response("slid", Kind::slip, "rim"),
                 response("press", Kind::contact_force, "rim", "normal")};
  return s;
}

TEST(LedAround, StaysBehindItsAnchorByTheAngleOfFriction) {
  constexpr double radius = 0.5, angle = 2.5;
  for (double mu : {0.0, 0.2})
    for (const auto& method : finite_methods()) {
      if (std::holds_alternative<Penalty>(method)) continue;  // (its overlap is another radius)
      const auto s = run(led_around(mu, radius, angle, 20), method);
      ASSERT_TRUE(is_converged(s.trajectory.status)) << name_of(method) << s.trajectory.message;
      // triangle of centre, anchor and point: the spring leans against the normal by atan mu at the point
      const double friction = std::atan(mu), at_anchor = std::numbers::pi - std::asin(std::sin(friction) / radius);
      const double lag = std::numbers::pi - friction - at_anchor, place = angle - lag;
      EXPECT_NEAR(s.value("x"), std::sin(place), 1e-9) << name_of(method) << mu;
      EXPECT_NEAR(s.value("y") + 1, std::cos(place), 1e-9) << name_of(method) << mu;
      // sums of chords: each is shorter than its arc by some phi^3 / 6
      EXPECT_NEAR(std::abs(s.value("slid")), place, 20 * std::pow(angle / 20, 3) / 6) << name_of(method) << mu;
    }
}

// --- derivatives -----------------------------------------------------------------------------------------------------

/// A block pressed onto a rigid disk from above and dragged along it: it sticks, slips, opens at its ends, and the
/// normals turn.
Scene draped(double mu) {
  Scene s;
  s.finite_strain = true;
  s.legs = {{1, 3}, {2, 5}};
  BoxMesh box;
  box.min = {-1.0, 0.0};
  box.max = {1.0, parameter(s, "height", 0.8)};
  box.cells = {8, 3};
  s.bodies = {{"block", box, NeoHookean{parameter(s, "E", 100), parameter(s, "nu", 0.3)}, "", 1.0}};
  s.obstacles = {{"disk", Circle{{parameter(s, "centre", 0.1), -1.5}, parameter(s, "R", 1.5)}}};
  s.contacts = {scenes::contact("sole", "block.bottom", "disk")};
  if (mu > 0) s.contacts[0].friction = parameter(s, "mu", mu);
  const Number down = parameter(s, "down", -0.25), along = parameter(s, "along", 0.2);
  s.supports = {scenes::support("block.top",
                                {{'y', table({{0, 0.0}, {1, down}})}, {'x', table({{0, 0.0}, {1, 0.0}, {2, along}})}})};
  s.responses = {
      response("press", Kind::reaction, "block.top", "y"),       response("drag", Kind::reaction, "block.top", "x"),
      response("moment", Kind::contact_force, "sole", "moment"), response("gap", Kind::gap, "sole"),
      response("side", Kind::displacement, "block.right", "x"),  response("energy", Kind::strain_energy, "")};
  s.responses[2].about = {0.0, 0.0};
  if (mu > 0) {
    s.responses.push_back(response("slid", Kind::slip, "sole"));
    s.responses.push_back(response("heat", Kind::dissipation, "sole"));
  }
  return s;
}

TEST(FiniteStrain, DerivativesEqualTheComplexStepOfTheWholeRun) {
  for (double mu : {0.0, 0.3})
    for (const Method& method : finite_schemes()) scenes::expect_derivatives_of_the_oracle(draped(mu), method);
}

TEST(FiniteStrain, AdjointEqualsDirect) {
  Scene scene = draped(0.3);
  scenes::ask_for_objectives(scene);
  // iterated schemes end at 1e-10 of the largest; the rest is rounding
  for (const Method& method : finite_schemes())
    EXPECT_LE(scenes::difference_of_modes(scene, method), std::holds_alternative<UzawaAL>(method) ? 1e-9 : 1e-11)
        << name_of(method);
}

TEST(FiniteStrain, FeetBeginAsFunctionsOfTheScene) {
  // the first touch is in the first step: what history begins with carries a derivative by radius, place and height
  Scene s = draped(0.3);
  s.legs = {{1, 1}};
  for (const Method& method : {Method(Penalty{}), Method(MonolithicAL{})}) {
    const auto r = run(s, method);
    for (int j = 0; j < static_cast<int>(s.parameters.size()); ++j) {
      const auto exact = oracle::complex_step(r.model, method, r.trajectory.step_table(), j);
      for (Eigen::Index i = 0; i < exact.rows(); ++i)
        EXPECT_NEAR(
            r.gradients.of_responses[0](i, j), exact(i, 0),
            1e-9 * std::max(std::abs(exact(i, 0)), std::abs(r.value(s.responses[i].name, 0) / s.parameters[j].value)))
            << name_of(method) << " " << s.responses[i].name << " by " << s.parameters[j].name;
    }
  }
}

TEST(FiniteStrain, NewtonConvergesQuadratically) {
  // c <= 30 b^2 of residuals b, c in settled states, b <= 1e-3, c above a hundred roundings. (A penalty of 1e3 nodal
  // stiffnesses on a curve begins to at 1e-5 only: along the tangent its overlap changes by a thousand times itself.)
  Penalty penalty;
  penalty.stiffness = relative(1);
  int looked_at = 0;
  for (const auto& [method, rounding] : {std::pair(Method(penalty), 1e-14), std::pair(Method(MonolithicAL{}), 1e-14)})
    for (int steps : {1, 2, 5}) {
      Scene scene = draped(0.3);
      scene.legs = {{1, steps}, {2, 2 * steps}};
      const auto s = run(scene, method);
      ASSERT_TRUE(is_converged(s.trajectory.status)) << name_of(method) << s.trajectory.message;
      for (const auto& increment : s.trajectory.increments) {
        const auto& h = increment.history;
        for (std::size_t i = 1; i < h.size(); ++i) {
          const double b = h[i - 1].residual, c = h[i].residual;
          const bool settled = h[i].changed + h[i - 1].changed == 0 && h[i].step_length == 1 && c < b;
          if (!settled || b > 1e-3 || c < 100 * rounding) continue;
          ++looked_at;
          EXPECT_LE(c, 30 * b * b) << name_of(method) << " " << b << " " << c;
        }
      }
    }
  EXPECT_GE(looked_at, 10);
}

TEST(FiniteStrain, MeanDilatationDoesNotLock) {
  // A rubber block of nu = 0.4995 that is held by its floor and pressed by a ram that it sticks to: Q8 on the finer
  // mesh is soft enough to tell; Q4 is a sixth too stiff or more.
  const auto press = [](const std::string& element, std::array<int, 2> cells) {
    Scene s;
    s.finite_strain = true;
    s.legs = {{1, 4}};
    BoxMesh box;
    box.min = {0.0, 0.0};
    box.max = {2.0, 1.0};
    box.cells = {cells[0], cells[1]};
    s.bodies = {{"block", box, NeoHookean{100.0, 0.4995}, element, 1.0}};
    s.obstacles = {plane("floor", {0.0, 0.0}, {0, 1})};
    s.contacts = {scenes::contact("sole", "block.bottom", "floor")};
    s.contacts[0].friction = FrictionLaw<Number>(50.0);
    s.supports = {scenes::support("block.top", {{'x', table({{0, 0.0}})}, {'y', table({{0, 0.0}, {1, -0.2}})}})};
    s.responses = {response("press", Kind::reaction, "block.top", "y")};
    const auto r = run(s, MonolithicAL{});
    EXPECT_TRUE(is_converged(r.trajectory.status)) << element << r.trajectory.message;
    return r.value("press");
  };
  const double fine = press("Q8", {16, 8});
  EXPECT_NEAR(press("Q4_mean_dilatation", {8, 4}), fine, 0.05 * std::abs(fine));
  EXPECT_GT(std::abs(press("Q4", {8, 4})), 1.15 * std::abs(fine));
}

TEST(FiniteStrain, NamesTheElementThatIsInverted) {
  Scene s = patch(0.5, NeoHookean::Volumetric::quadratic);
  s.supports[0] = scenes::support("block.top", {{'y', table({{0, 0.0}, {1, -1.2}})}});
  s.legs = {{1, 1}};
  const auto r = run(s, MonolithicAL{});
  EXPECT_EQ(r.trajectory.status, Status::inverted_element) << r.trajectory.message;
  EXPECT_NE(r.trajectory.message.find("of block is inverted"), std::string::npos) << r.trajectory.message;
}

TEST(FiniteStrain, IsSmallStrainWhereMotionsAreSmall) {
  const auto scaled = [](bool finite) {
    Scene s = patch(1 - 1e-7, NeoHookean::Volumetric::quadratic);
    s.finite_strain = finite;
    if (!finite) s.bodies[0].material = LinearElastic{1000.0, 0.3};
    return s;
  };
  for (const auto& method : finite_methods()) {
    const auto finite = run(scaled(true), method), small = run(scaled(false), method);
    EXPECT_NEAR(finite.value("press"), small.value("press"), 1e-6 * std::abs(small.value("press"))) << name_of(method);
    EXPECT_NEAR(finite.value("wide"), small.value("wide"), 1e-6 * small.value("wide")) << name_of(method);
  }
}

}  // namespace
}  // namespace stickslip::finite_strain_test
