/// Elastoplastic bodies in contact: closed forms by every method, derivatives by every scheme against the complex step
/// of the whole program, and the adjoint against those.
#include <gtest/gtest.h>

#include <numbers>

#include "tests/support/blocks.hpp"
#include "tests/support/finite_strain.hpp"

namespace stickslip::plasticity_test {
namespace {

using namespace scenes;
using Kind = Response::Kind;

// --- A16 (1): a bar pushed against a wall beyond its yield stress and withdrawn --------------------------------------

/// E = 1000, hardening 100, yield 10, length and area 1, gap .005: pushed by .035 in seven steps, withdrawn in
/// fourteen.
Scene bar_on_a_wall() {
  Scene s;
  s.legs = {{1, 9}, {2, 20}};
  LineMesh line;
  line.from = {0.0, 0.0};
  line.to = {1.0, 0.0};
  line.cells = 3;
  const J2Plastic material{parameter(s, "E", 1000), 0.3, parameter(s, "sy", 10), parameter(s, "H", 100)};
  s.bodies = {{"bar", line, material, "bar", 1.0}};
  s.obstacles = {{"wall", Plane{{-0.005, 0.0}, {1.0, 0.0}}}};
  s.contacts = {scenes::contact("stop", "bar.start", "wall")};
  s.supports = {scenes::support("bar.nodes", {{'y', table({{0, 0.0}})}}),
                scenes::support("bar.end", {{'x', table({{0, 0.0}, {1, -0.035}, {2, 0.0}})}})};
  s.responses = {response("force", Kind::contact_force, "stop", "normal"), response("gap", Kind::gap, "stop"),
                 response("energy", Kind::strain_energy, "")};
  return s;
}

TEST(Plasticity, OfABarOnAWallHasTheForceOfTheClosedForm) {
  const double E = 1000, H = 100, yield = 10, Et = E * H / (E + H), top = yield + Et * (0.03 - yield / E);
  EXPECT_NEAR(top, 11.8181818, 1e-7);
  for (const Method& method : scenes::exact_methods()) {
    const auto s = run(bar_on_a_wall(), method);
    ASSERT_TRUE(is_converged(s.trajectory.status)) << name_of(method) << s.trajectory.message;
    for (std::size_t n = 0; n < s.trajectory.increments.size(); ++n) {
      const double t = s.trajectory.increments[n].time, pushed = t <= 1 ? 0.035 * t : 0.035 * (2 - t);
      const double strain = pushed - 0.005;
      double force = strain <= 0 ? 0 : strain <= yield / E ? E * strain : yield + Et * (strain - yield / E);
      if (t > 1) force = std::max(0.0, top - E * (0.035 - pushed));
      EXPECT_NEAR(s.value("force", n), force, 1e-9 * top) << name_of(method) << " at " << t;
      // by the yield stress: 1 - Et / E once it flows, and while contact lasts; then the gap left by plastic strain
      const bool flows = strain > yield / E || t > 1;
      EXPECT_NEAR(s.gradients.of_responses[n](0, 1), flows && force > 0 ? 1 - Et / E : 0, 1e-9)
          << name_of(method) << " at " << t;
      if (t > 1 && force == 0) {
        EXPECT_NEAR(s.gradients.of_responses[n](1, 1), -(1 - Et / E) / E, 1e-12) << name_of(method) << " at " << t;
      }
    }
    const Vector<double>& remembered = s.trajectory.increments.back().state.history.bodies;
    ASSERT_EQ(remembered.size(), 6);
    for (int e = 0; e < 3; ++e) {
      EXPECT_NEAR(remembered[2 * e], -0.0181818181818, 1e-12);  // shortened
      EXPECT_NEAR(remembered[2 * e + 1], 0.0181818181818, 1e-12);
    }
  }
}

TEST(Plasticity, OfABarFollowsAHardeningTable) {
  // force over strain is straight between corners at a + stress / E; the run ends between the last two
  Scene scene = bar_on_a_wall();
  scene.legs = {{1, 13}};  // (none of which ends at a corner)
  scene.parameters.clear();
  scene.bodies[0].material = J2Plastic{
      1000.0,
      0.3,
      parameter(scene, "sy", 10),
      0.0,
      {{parameter(scene, "a1", 0.002), parameter(scene, "s1", 12)}, {0.006, parameter(scene, "s2", 13)}, {0.05, 15.0}}};
  const double E = 1000, strains[] = {0.01, 0.002 + 0.012, 0.006 + 0.013, 0.05 + 0.015}, forces[] = {10, 12, 13, 15};
  for (const Method& method : scenes::exact_methods()) {
    const auto s = run(scene, method);
    ASSERT_TRUE(is_converged(s.trajectory.status)) << name_of(method) << s.trajectory.message;
    for (std::size_t n = 0; n < s.trajectory.increments.size(); ++n) {
      const double strain = 0.035 * s.trajectory.increments[n].time - 0.005;
      int k = 0;
      while (strain > strains[k]) ++k;
      double force = larger(0.0, E * strain), by_yield = 0, by_first = 0, by_second = 0, by_strain = 0;
      if (k > 0) {  // a share x of the way between corners, whose places on both axes move with the rows
        const double across = strains[k] - strains[k - 1], slope = (forces[k] - forces[k - 1]) / across;
        const double x = (strain - strains[k - 1]) / across;
        force = forces[k - 1] + slope * (strain - strains[k - 1]);
        const double lower = (1 - x) * (1 - slope / E), upper = x * (1 - slope / E);
        by_yield = k == 1 ? lower : 0;
        by_first = k == 1 ? upper : k == 2 ? lower : 0;
        by_second = k == 2 ? upper : k == 3 ? lower : 0;
        by_strain = k == 1 ? -x * slope : k == 2 ? -(1 - x) * slope : 0;
      }
      EXPECT_NEAR(s.value("force", n), force, 1e-9 * 13) << name_of(method) << " at " << strain;
      const auto& gradient = s.gradients.of_responses[n];
      EXPECT_NEAR(gradient(0, 0), by_yield, 1e-9) << name_of(method) << " at " << strain;
      EXPECT_NEAR(gradient(0, 1), by_strain, 1e-9 * E) << name_of(method) << " at " << strain;
      EXPECT_NEAR(gradient(0, 2), by_first, 1e-9) << name_of(method) << " at " << strain;
      EXPECT_NEAR(gradient(0, 3), by_second, 1e-9) << name_of(method) << " at " << strain;
    }
  }
}

// --- A16 (2): a thick cylinder widened until it is plastic up to a radius --------------------------------------------

TEST(Plasticity, OfAThickCylinderReachesTheRadiusOfTheClosedForm) {
  // Hill's solution, of a plastic zone in which the axial stress is the middle one: exact but for 1 %
  const double a = 100, b = 200, E = 210, nu = 0.3, yield = 0.24;
  Scene s;
  s.space = Space::axisymmetric;
  s.legs = {{1, 20}};
  BoxMesh box;
  box.min = {a, 0.0};
  box.max = {b, 5.0};
  box.cells = {30, 1};
  s.bodies = {{"wall", box, J2Plastic{E, nu, yield, 0.0}, "Q4_mean_dilatation", 1.0}};
  s.supports = {scenes::support("wall.left", {{'x', scenes::ramp(0.4)}}),
                scenes::support("wall.bottom", {{'y', table({{0, 0.0}})}}),
                scenes::support("wall.top", {{'y', table({{0, 0.0}})}})};
  s.responses = {response("force", Kind::reaction, "wall.left", "x"),
                 response("outside", Kind::displacement, "wall.right", "x")};
  const auto r = run(s, MonolithicAL{});
  ASSERT_TRUE(is_converged(r.trajectory.status)) << r.trajectory.message;
  const double elastic = yield * a * a / std::sqrt(3) * 2 * (1 - nu * nu) / (E * b);  // u(b) at first yield
  int plastic = 0;
  for (std::size_t n = 0; n < r.trajectory.increments.size(); ++n) {
    const double u = r.value("outside", n), p = r.value("force", n) / (2 * std::numbers::pi * a * 5);
    const double c = a * std::sqrt(u / elastic);
    if (u <= 1.01 * elastic || c >= b) continue;
    ++plastic;
    const double closed = yield / std::sqrt(3) * (1 - c * c / (b * b) + 2 * std::log(c / a));
    EXPECT_NEAR(p, closed, 0.01 * closed) << "c = " << c;
  }
  EXPECT_GE(plastic, 5);
}

// --- derivatives -----------------------------------------------------------------------------------------------------

struct Setting {
  Space space;
  bool finite;
  const char* element;
  bool table = false;  ///< of hardening
};

/// A soft metal block (its ring, of revolution) pressed onto a disk that is rough, drawn along it, and lifted a bit: it
/// flows below, on its way back too, sticks and slips.
Scene pressed(const Setting& setting) {
  Scene s;
  s.space = setting.space;
  s.finite_strain = setting.finite;
  s.legs = {{1, 3}, {2, 3}, {3, 2}};
  const double left = setting.space == Space::axisymmetric ? 1.0 : 0.0;
  BoxMesh box;
  box.min = {left, 0.0};
  box.max = {left + 2, parameter(s, "height", 0.8)};
  box.cells = {4, 2};
  const J2Plastic material{parameter(s, "E", 100), parameter(s, "nu", 0.3), parameter(s, "yield", 2.3),
                           parameter(s, "hardening", 12)};
  s.bodies = {{"block", box, material, setting.element, 1.0}};
  if (setting.table) {
    auto& table = std::get<J2Plastic>(s.bodies[0].material).table;
    table = {{parameter(s, "a1", 0.004), parameter(s, "s1", 2.36)}, {0.015, 2.41}, {0.03, parameter(s, "s3", 2.45)}};
  }
  s.obstacles = {{"disk", Circle{{left + 1.07, -1.5}, parameter(s, "R", 1.5)}}};
  s.contacts = {scenes::contact("sole", "block.bottom", "disk")};
  s.contacts[0].friction = parameter(s, "mu", 0.3);
  const Number down = parameter(s, "down", -0.11), along = parameter(s, "along", 0.06);
  s.supports = {scenes::support("block.top", {{'y', table({{0, 0.0}, {1, down}, {2, down}, {3, -0.098}})},
                                              {'x', table({{0, 0.0}, {1, 0.0}, {2, along}})}})};
  s.responses = {response("press", Kind::reaction, "block.top", "y"),
                 response("drag", Kind::reaction, "block.top", "x"),
                 response("side", Kind::displacement, "block.right", "x"),
                 response("energy", Kind::strain_energy, ""),
                 response("slid", Kind::slip, "sole"),
                 response("heat", Kind::dissipation, "sole")};
  return s;
}

class PlasticBlocks : public testing::TestWithParam<Setting> {};

TEST_P(PlasticBlocks, FlowAndHaveTheDerivativesOfTheWholeRun) {
  const Scene scene = pressed(GetParam());
  const auto s = run(scene, MonolithicAL{});
  ASSERT_TRUE(is_converged(s.trajectory.status)) << s.trajectory.message;
  EXPECT_GT(largest_entry(s.trajectory.increments[4].state.history.bodies), 0.01);
  for (const Method& method : finite_schemes()) scenes::expect_derivatives_in_both_modes(scene, method);
}

INSTANTIATE_TEST_SUITE_P(
    Settings, PlasticBlocks,
    testing::Values(Setting{Space::plane_strain, false, "Q4_mean_dilatation"},
                    Setting{Space::plane_strain, false, "T6"}, Setting{Space::plane_stress, false, "Q4"},
                    Setting{Space::axisymmetric, false, "Q4_mean_dilatation"}, Setting{Space::plane_strain, true, "Q4"},
                    Setting{Space::plane_strain, true, "Q4_mean_dilatation"}, Setting{Space::axisymmetric, true, "T3"},
                    Setting{Space::plane_stress, false, "Q8", true}, Setting{Space::plane_stress, true, "Q4"},
                    Setting{Space::plane_stress, true, "T6", true},
                    Setting{Space::plane_strain, true, "Q4_mean_dilatation", true}));

/// A truss of two bars, elastoplastic, pushed down on a stop that is rough.
Scene plastic_truss(bool finite) {
  Scene s;
  s.finite_strain = finite;
  s.legs = {{1, 4}, {2, 4}};
  const J2Plastic material{parameter(s, "E", 1000), 0.3, parameter(s, "yield", 2), parameter(s, "hardening", 90)};
  LineMesh line;
  line.from = {-10.0, 0.0};
  line.to = {0.3, parameter(s, "rise", 1.0)};
  line.cells = 1;
  s.bodies = {{"bar", line, material, "bar", parameter(s, "area", 2)}};
  s.obstacles = {{"stop", Plane{{0.0, 0.8}, {0.2, 1.0}}}};
  s.contacts = {scenes::contact("sole", "bar.end", "stop")};
  s.contacts[0].friction = parameter(s, "mu", 0.1);
  s.supports = {
      scenes::support("bar.start", {{'x', scenes::ramp(parameter(s, "push", 0.8))}, {'y', table({{0, 0.0}})}})};
  s.loads = {scenes::force("bar.end", {-14.0, -40.0})};
  s.responses = {response("press", Kind::contact_force, "sole", "normal"), response("slid", Kind::slip, "sole"),
                 response("energy", Kind::strain_energy, ""), response("push", Kind::reaction, "bar.start", "x")};
  return s;
}

TEST(Plasticity, OfBarsHasTheDerivativesOfTheWholeRun) {
  for (bool finite : {false, true})
    for (const Method& method : finite_schemes()) {
      const Scene scene = plastic_truss(finite);
      const auto s = run(scene, method);
      ASSERT_TRUE(is_converged(s.trajectory.status)) << name_of(method) << s.trajectory.message;
      EXPECT_GT(s.trajectory.increments.back().state.history.bodies[1], 1e-4) << finite;
      scenes::expect_derivatives_in_both_modes(scene, method);
    }
}

TEST(Plasticity, BeyondWhatABarBearsIsNamed) {
  Scene s = bar_on_a_wall();
  s.bodies[0].material = J2Plastic{1000.0, 0.3, 10.0, 0.0};  // perfect: no more than 10
  s.supports = {scenes::support("bar.nodes", {{'y', table({{0, 0.0}})}}),
                scenes::support("bar.start", {{'x', table({{0, 0.0}})}})};
  s.loads = {scenes::force("bar.end", {12.0, 0.0})};
  s.loads[0].history = table({{0, 0.0}, {1, 1.0}});
  s.legs = {{1, 9}};
  for (const Method& method : {Method(MonolithicAL{}), Method(UzawaAL{}), Method(Penalty{})}) {
    const auto r = run(s, method);
    EXPECT_FALSE(is_converged(r.trajectory.status)) << name_of(method);
    EXPECT_NE(r.trajectory.message.find("bar flows: its loads may be more than it bears"), std::string::npos)
        << r.trajectory.message;
    EXPECT_NEAR(r.trajectory.increments.back().time, 7.0 / 9, 1e-9 + 1.0 / 9) << name_of(method);
  }
}

// --- only where a scene calls for it ---------------------------------------------------------------------------------

TEST(Plasticity, OfAMaterialThatNeverFlowsIsElasticity) {  // D2
  RunOptions same_engine;                                  // (the elastic one would be condensed)
  same_engine.linear_algebra.engine = LinearAlgebra::Engine::sparse;
  for (const Setting& setting : {Setting{Space::plane_strain, false, "Q4"}, Setting{Space::plane_stress, false, "Q8"},
                                 Setting{Space::axisymmetric, false, "Q4_mean_dilatation"}}) {
    Scene hard = pressed(setting), elastic = hard;
    auto& material = std::get<J2Plastic>(hard.bodies[0].material);
    material.yield = 1e30;
    elastic.bodies[0].material = LinearElastic{material.E, material.nu};
    for (const Method& method : finite_methods()) {
      // a penalty of 1e5 nodal stiffnesses makes that much of rounding, and Uzawa's loop ends at 1e-12 of the largest
      const double same = std::holds_alternative<MonolithicAL>(method) ? 1e-12 : 1e-10;
      const auto a = run(hard, method), b = run(elastic, method, same_engine);
      ASSERT_TRUE(is_converged(a.trajectory.status)) << a.trajectory.message;
      for (std::size_t n = 0; n < a.trajectory.increments.size(); ++n)
        for (const auto& r : hard.responses)
          EXPECT_NEAR(a.value(r.name, n), b.value(r.name, n), same * std::abs(b.value(r.name)))
              << name_of(method) << r.name;
      EXPECT_EQ(largest_entry(a.trajectory.increments.back().state.history.bodies), 0);
      EXPECT_EQ(b.trajectory.increments.back().state.history.bodies.size(), 0);
      EXPECT_FALSE(b.model.effects.plasticity);
      EXPECT_TRUE(b.model.effects.linear_bulk);
    }
  }
}

}  // namespace
}  // namespace stickslip::plasticity_test
