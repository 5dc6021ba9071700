/// Bodies that slide along one another, and along polylines, by any distance: closed forms by every method, invariance,
/// what happens at corners and ends, tangents and derivatives against the complex step.
#include <gtest/gtest.h>

#include <numbers>

#include "core/model/contact_assembly.hpp"
#include "core/model/point_tangent.hpp"
#include "tests/support/blocks.hpp"
#include "tests/support/compiled_slots.hpp"
#include "tests/support/finite_strain.hpp"

namespace stickslip::finite_curves_test {
namespace {

using namespace scenes;
using Kind = Response::Kind;

Body rubber(Body body, Scene& s, const std::string& name, double E) {
  body.material = NeoHookean{parameter(s, name, E), 0.3, NeoHookean::Volumetric::log};
  return body;
}

// --- A13: two blocks, pressed on one another by meshes that do not match ---------------------------------------------

Scene stacked(double stretch, double mu) {
  Scene s;
  s.finite_strain = true;
  s.legs = {{1, 4}};
  s.bodies = {rubber(scenes::box_body("lower", {0, 0}, {2, 0.5}, {4, 2}), s, "E", 1000),
              rubber(scenes::box_body("upper", {0, 0.5}, {2, 1}, {8, 2}), s, "E_upper", 1000)};
  s.contacts = {scenes::contact("joint", "upper.bottom", "lower.top")};
  if (mu > 0) s.contacts[0].friction = parameter(s, "mu", mu);
  const Number down = parameter(s, "down", stretch - 1);
  s.supports = {scenes::support("lower.bottom", {{'y', table({{0, 0.0}})}}),
                scenes::support("upper.top", {{'y', table({{0, 0.0}, {1, down}})}}),
                scenes::support("lower.left", {{'x', table({{0, 0.0}})}}),
                scenes::support("upper.left", {{'x', table({{0, 0.0}})}})};
  s.responses = {response("press", Kind::reaction, "upper.top", "y"),
                 response("wide", Kind::displacement, "upper.right", "x"),
                 response("gap", Kind::gap, "joint", "", Response::Take::min)};
  return s;
}

TEST(FiniteCurves, PassAUniformPressureBetweenNestedMeshes) {
  for (const auto& [l1, l2, P1] : {std::array{0.9, 1.0449972898, -120.5210836}, {0.7, 1.1507960463, -458.4239232}})
    for (const double mu : {0.0, 0.2})  // (both sides stretch alike: nothing slips)
      for (const auto& method : finite_methods()) {
        // (the overlap of a penalty bends the master, and a frictionless node at its vertices has no equilibrium)
        if (std::holds_alternative<Penalty>(method) && l1 == 0.7 && mu == 0) continue;
        const auto s = run(stacked(l1, mu), method);
        ASSERT_TRUE(is_converged(s.trajectory.status)) << name_of(method) << s.trajectory.message;
        const double overlap = std::abs(s.value("gap"));
        EXPECT_LE(overlap, std::holds_alternative<Penalty>(method) ? 1e-4 : 1e-11) << name_of(method);
        // by its overlap a penalty stretches less, and its weights are those of other stretches
        EXPECT_NEAR(s.value("press") / 2, P1, 1e-7 + 2e4 * overlap) << name_of(method);
        EXPECT_NEAR(s.value("wide") / 2 + 1, l2, 1e-8 + 10 * overlap) << name_of(method);
      }
}

// --- a die pressed into a slab and dragged along it ------------------------------------------------------------------

/// `turned`: the whole scene about the origin, radians.
Scene ironing(Smoothing smoothing, double mu = 0.3, double turned = 0) {
  Scene s;
  s.finite_strain = true;
  s.legs = {{1, 3}, {2, 5}};
  const double c = std::cos(turned), sn = std::sin(turned);
  const auto corner = [&](double x, double y) { return std::array<Number, 2>{c * x - sn * y, sn * x + c * y}; };
  QuadMesh slab;
  slab.corners = {corner(0, 0), corner(4, 0), corner(4, 1), corner(0, 1)};
  slab.cells = {12, 3};
  s.bodies = {rubber({"slab", slab, LinearElastic{1.0, 0.0}, "", 1.0}, s, "E", 1)};
  QuadMesh die;
  die.corners = {corner(0.9, 1.05), corner(1.7, 1.0), corner(1.8, 1.6), corner(0.8, 1.6)};
  die.cells = {4, 2};
  s.bodies.push_back(rubber({"die", die, LinearElastic{1.0, 0.0}, "", 1.0}, s, "E_die", 5));
  s.contacts = {scenes::contact("sole", "die.bottom", "slab.top")};
  s.contacts[0].smoothing = smoothing;
  if (mu > 0) s.contacts[0].friction = parameter(s, "mu", mu);
  const double down = -0.15, along = 0.7;
  const auto moves = [&](double x1, double y1, double x2, double y2) {
    return std::map<char, Table>{{'x', table({{0, 0.0}, {1, c * x1 - sn * y1}, {2, c * x2 - sn * y2}})},
                                 {'y', table({{0, 0.0}, {1, sn * x1 + c * y1}, {2, sn * x2 + c * y2}})}};
  };
  s.supports = {scenes::support("slab.bottom", moves(0, 0, 0, 0)),
                scenes::support("die.top", moves(0, down, along, down))};
  s.responses = {response("x", Kind::reaction, "die.top", "x"), response("y", Kind::reaction, "die.top", "y"),
                 response("energy", Kind::strain_energy, ""),
                 response("normal", Kind::contact_force, "sole", "normal")};
  if (mu > 0) {
    s.responses.push_back(response("slid", Kind::slip, "sole"));
    s.responses.push_back(response("heat", Kind::dissipation, "sole"));
  }
  return s;
}

/// How often a point of a run passes to another patch from one increment to the next.
int crossings(const scenes::Solved& s) {
  int count = 0;
  for (std::size_t n = 1; n < s.trajectory.increments.size(); ++n) {
    const auto &now = s.trajectory.increments[n].state.contact.facing,
               &before = s.trajectory.increments[n - 1].state.contact.facing;
    for (std::size_t p = 0; p < now.size(); ++p) count += now[p].patch != before[p].patch;
  }
  return count;
}

/// Those on which a point has an equilibrium wherever it slides; on facets it may have none at a vertex.
constexpr std::array<Smoothing, 2> kinds{Smoothing::catmull_rom, Smoothing::b_spline};

TEST(FiniteCurves, MethodsAgreeOnADieThatCrossesFacets) {
  for (const Smoothing kind : {Smoothing::b_spline}) {
    auto methods = finite_methods();
    std::get<Penalty>(methods[0]).stiffness = relative(100);
    const auto exact = run(ironing(kind), methods[2]);
    ASSERT_TRUE(is_converged(exact.trajectory.status)) << exact.trajectory.message;
    EXPECT_GE(crossings(exact), 5);
    for (int m : {0, 1}) {
      const auto s = run(ironing(kind), methods[m]);
      ASSERT_TRUE(is_converged(s.trajectory.status)) << name_of(methods[m]) << s.trajectory.message;
      for (const char* name : {"x", "y", "energy", "heat"})  // (a penalty's overlap is some 1 / 100 of the depth)
        EXPECT_NEAR(s.value(name), exact.value(name), (m == 0 ? 0.03 : 1e-9) * std::abs(exact.value("y")))
            << name_of(methods[m]) << " " << name;
    }
  }
}

TEST(FiniteCurves, FrictionWorkAndStrainEnergyAddUpToTheWorkDone) {
  // What 24 and 48 steps lose is of the first order: friction works at the tractions of the end of a step.
  for (const Smoothing kind : kinds) {
    std::array<double, 2> lost;
    for (int k : {0, 1}) {
      Scene scene = ironing(kind);
      scene.legs = {{1, 12 << k}, {2, 12 << k}};
      const auto s = run(scene, MonolithicAL{});
      ASSERT_TRUE(is_converged(s.trajectory.status)) << s.trajectory.message;
      double work = 0, x = 0, y = 0, at_x = 0, at_y = 0;
      for (int n = 0; n < static_cast<int>(s.trajectory.increments.size()); ++n) {
        const double t = s.trajectory.increments[n].time;
        const double to_x = t <= 1 ? 0 : 0.7 * (t - 1), to_y = t <= 1 ? -0.15 * t : -0.15;
        work += 0.5 * ((x + s.value("x", n)) * (to_x - at_x) + (y + s.value("y", n)) * (to_y - at_y));
        x = s.value("x", n);
        y = s.value("y", n);
        at_x = to_x;
        at_y = to_y;
      }
      lost[k] = std::abs(work - s.value("energy") - s.value("heat")) / work;
    }
    EXPECT_GE(std::log2(lost[0] / lost[1]), 0.8);
  }
}

TEST(FiniteCurves, DoNotKnowDirectionsInSpace) {
  // (the method that solves in few iterations: the others take hundreds a step)
  for (const Smoothing kind : kinds)
    for (const Method& method : {Method(MonolithicAL{})}) {
      const auto s = run(ironing(kind), method);
      for (double turned : {0.5, 2.9}) {
        const auto t = run(ironing(kind, 0.3, turned), method);
        ASSERT_TRUE(is_converged(t.trajectory.status)) << t.trajectory.message;
        const double c = std::cos(turned), sn = std::sin(turned), size = std::abs(s.value("y"));
        EXPECT_NEAR(t.value("x"), c * s.value("x") - sn * s.value("y"), 1e-10 * size) << name_of(method);
        EXPECT_NEAR(t.value("y"), sn * s.value("x") + c * s.value("y"), 1e-10 * size) << name_of(method);
        for (const char* name : {"energy", "heat", "slid", "normal"})
          EXPECT_NEAR(t.value(name), s.value(name), 1e-10 * size) << name_of(method) << name;
      }
    }
}

TEST(FiniteCurves, TangentsAreTheComplexStepOfForcesAndRows) {
  using C = std::complex<double>;
  constexpr double step = 1e-30;
  for (const Smoothing kind : kinds) {
    const auto s = run(ironing(kind), MonolithicAL{});
    const Model& model = s.model;
    const auto slots = make_slots<C>(model, model.scene.as<C>());
    const auto& before = s.trajectory.increments[3].state;
    const auto& at = s.trajectory.increments[4].state;
    const RegularisationField<double> rho(model.points.size(), {2.0, 3.0});
    const RegularisationField<C> rho_complex(model.points.size(), {C(2.0), C(3.0)});
    History<C> previous;
    for_each_part([](const Vector<double>& part, Vector<C>& out) { out = part.cast<C>(); }, before.history, previous);
    previous.patch = before.history.patch;
    previous.faced = before.history.faced;
    const double time = s.trajectory.increments[4].time;
    const auto facing = &at.contact.facing;
    const ContactInput<double> input{model, s.slots, rho, before.history, ConeRadius::augmented, time, facing};
    const ContactInput<C> moved{model, slots, rho_complex, previous, ConeRadius::augmented, time, facing};
    const Vector<double> compact = to_compact(model, at.displacement);
    Matrix<double> K = Matrix<double>::Zero(compact.size(), compact.size());
    Matrix<double> rows = Matrix<double>::Zero(model.multiplier_count, compact.size());
    for (int p = 0; p < static_cast<int>(model.points.size()); ++p) {
      const auto tangent = point_tangent<double>(input, p, compact, at.multiplier, at.contact.state[p], *facing);
      for (std::size_t m = 0; m < tangent.places.size(); ++m)
        for (int j = 0; j < 2; ++j) {
          const auto column = static_cast<Eigen::Index>(2 * m + j);
          for (std::size_t n = 0; n < tangent.places.size(); ++n)
            for (int i = 0; i < 2; ++i)
              K(2 * tangent.places[n] + i, 2 * tangent.places[m] + j) +=
                  tangent.force_w(static_cast<Eigen::Index>(2 * n + i), column);
          for (int c = 0; c < model.points[p].components(); ++c)
            rows(model.points[p].multiplier + c, 2 * tangent.places[m] + j) += tangent.row_w(c, column);
        }
    }
    for (Eigen::Index j = 0; j < compact.size(); ++j) {
      Vector<C> u = compact.cast<C>();
      u[j] += C(0, step);
      const Vector<C> lambda = at.multiplier.cast<C>();
      const auto field = evaluate_contact<C>(moved, u, lambda, &at.contact.state);
      const Vector<C> forces = contact_forces(model, slots, field);
      const Vector<C> of_lambda = multiplier_residual(model, slots, field.traction, lambda);
      for (Eigen::Index i = 0; i < forces.size(); ++i)
        EXPECT_NEAR(K(i, j), forces[i].imag() / step, 1e-12 * largest_entry(K));
      for (Eigen::Index i = 0; i < of_lambda.size(); ++i)
        EXPECT_NEAR(rows(i, j), of_lambda[i].imag() / step, 1e-12 * largest_entry(rows));
    }
  }
}

TEST(FiniteCurves, DerivativesEqualTheComplexStepAndTheAdjoint) {
  for (const Method& method : finite_schemes())
    scenes::expect_derivatives_in_both_modes(ironing(Smoothing::b_spline, 0.3), method);
  for (double mu : {0.0, 0.3})
    scenes::expect_derivatives_in_both_modes(ironing(Smoothing::catmull_rom, mu), MonolithicAL{});
}

// --- what needs no smoothing, corners and ends -----------------------------------------------------------------------

/// A point pressed on an edge by a force, and led along it by the anchor of a spring, over its end.
Scene led_over_the_edge(bool rigid) {
  Scene s;
  s.finite_strain = true;
  s.legs = {{1, 1}, {2, 20}};
  s.bodies = {{"point", PointMesh{{0.9, 0.0}}, GroundedSpring{{{1000.0, 0.0}, {0.0, 1000.0}}}, "", 1.0}};
  if (rigid) {
    s.obstacles = {{"edge", Polyline{{{0.0, 0.0}, {1.0, 0.0}}}}};
    s.contacts = {scenes::contact("tip", "point.node", "edge")};
  } else {
    s.bodies.push_back(rubber(scenes::box_body("block", {0, -1}, {1, 0}, {3, 3}), s, "E", 1e6));
    s.contacts = {scenes::contact("tip", "point.node", "block.top")};
    s.supports = {scenes::support("block.top", {{'x', table({{0, 0.0}})}, {'y', table({{0, 0.0}})}})};
  }
  s.supports.push_back(
      scenes::support("point.anchor", {{'x', table({{0, 0.0}, {1, 0.0}, {2, 0.2}})}, {'y', table({{0, 0.0}})}}));
  s.loads = {scenes::force("point.node", {0.0, -10.0})};
  s.responses = {response("x", Kind::displacement, "point.node", "x"),
                 response("y", Kind::displacement, "point.node", "y"),
                 response("press", Kind::contact_force, "tip", "normal")};
  return s;
}

TEST(FiniteCurves, APointSlidesOffTheEndOfItsMasterOnce) {  // C13
  for (bool rigid : {true, false})
    for (const Method& method : finite_methods()) {
      const auto s = run(led_over_the_edge(rigid), method);
      ASSERT_TRUE(is_converged(s.trajectory.status)) << name_of(method) << s.trajectory.message;
      bool off = false;
      for (int n = 0; n < static_cast<int>(s.trajectory.increments.size()); ++n) {
        const double place = 0.9 + s.value("x", n);
        if (std::abs(place - 1) < 1e-6) continue;  // at the very end either holds
        off |= place > 1;
        const double sunk = std::holds_alternative<Penalty>(method) ? 1e-3 : 1e-9;
        EXPECT_NEAR(s.value("press", n), off ? 0 : 10, 10 * sunk) << name_of(method) << n;
        EXPECT_NEAR(s.value("y", n), off ? -0.01 : 0, sunk) << name_of(method) << n;
      }
      EXPECT_TRUE(off);
    }
}

TEST(FiniteCurves, PolylinesMoveAndTurnWithTheirFriction) {
  // A block between a support and a flat polyline of many facets, which turns and drags it: as on a plane that does.
  const auto scene = [](bool plane, double mu, Smoothing smoothing = Smoothing::none) {
    Scene s;
    s.finite_strain = true;
    s.legs = {{1, 2}, {2, 5}};
    s.bodies = {rubber(scenes::box_body("block", {-1, 0}, {1, 1}, {4, 2}), s, "E", 100)};
    Obstacle floor{"floor", Plane{{0.0, 0.0}, {0.0, 1.0}}};
    if (!plane) {
      Polyline line;
      for (int k = 0; k <= 10; ++k) line.points.push_back({-4 + 0.83 * k, 0.0});
      floor.shape = line;
    }
    const Number angle = parameter(s, "angle", 6);
    floor.rotate = Rotation{{0.0, -2.0}, {}, table({{0, 0.0}, {1, 0.0}, {2, angle}})};
    s.obstacles = {floor};
    s.contacts = {scenes::contact("sole", "block.bottom", "floor")};
    s.contacts[0].friction = parameter(s, "mu", mu);
    s.contacts[0].smoothing = smoothing;
    s.supports = {scenes::support("block.top", {{'x', table({{0, 0.0}})}, {'y', table({{0, 0.0}, {1, -0.1}})}})};
    s.responses = {response("x", Kind::reaction, "block.top", "x"), response("y", Kind::reaction, "block.top", "y"),
                   response("slid", Kind::slip, "sole"), response("heat", Kind::dissipation, "sole")};
    return s;
  };
  for (const Method& method : finite_methods()) {
    const auto on_plane = run(scene(true, 0.1), method), on_line = run(scene(false, 0.1), method);
    ASSERT_TRUE(is_converged(on_line.trajectory.status)) << on_line.trajectory.message;
    for (const char* name : {"x", "y", "slid", "heat"}) {
      EXPECT_NEAR(on_line.value(name), on_plane.value(name), 1e-9 * std::abs(on_plane.value("y"))) << name;
      for (const char* of : {"mu", "angle", "E"})
        EXPECT_NEAR(on_line.derivative(name, of), on_plane.derivative(name, of),
                    1e-8 * (std::abs(on_plane.derivative("y", of)) + std::abs(on_plane.derivative(name, of))))
            << name << " by " << of;
    }
  }
  scenes::expect_derivatives_in_both_modes(scene(false, 0.1), MonolithicAL{});
  for (Method method : finite_methods()) {  // D4
    // (two runs that end at residuals of 1e-12 differ by ten times that: these end at rounding)
    std::visit([](auto& m) { m.newton.tolerance = 1e-16; }, method);
    if (auto* uzawa = std::get_if<UzawaAL>(&method)) uzawa->tolerance = 1e-14;
    for (const Smoothing kind : {Smoothing::catmull_rom, Smoothing::b_spline}) {
      const auto flat = run(scene(false, 0.1), method), smooth = run(scene(false, 0.1, kind), method);
      ASSERT_TRUE(is_converged(smooth.trajectory.status)) << name_of(method) << smooth.trajectory.message;
      for (const char* name : {"x", "y", "slid", "heat"})
        EXPECT_NEAR(smooth.value(name), flat.value(name), 1e-12 * std::abs(flat.value("y"))) << name_of(method) << name;
    }
  }
}

// --- A14: a ring in a ring, its bore too small by D, between fixed walls ---------------------------------------------

/// `around`: cells of the inner ring. `turned`: its wall, degrees.
Scene fitted(int around, Smoothing smoothing, bool finite, double turned = 0, double mu = 0) {
  Scene s;
  s.finite_strain = finite;
  s.legs = {{1, 1}};
  if (turned != 0) s.legs.push_back({2, 6});
  const Material material = finite ? Material(NeoHookean{1000.0, 0.3}) : Material(LinearElastic{1000.0, 0.3});
  RingMesh inner, outer;
  inner.center = outer.center = {0.0, 0.0};
  inner.inner = 1.0;
  inner.outer = outer.inner = 2.0;
  outer.outer = 4.0;
  inner.cells = {around / 6, around};
  outer.cells = {around / 4, around * 32 / 25};
  s.bodies = {{"inner", inner, material, "", 1.0}, {"outer", outer, material, "", 1.0}};
  s.contacts = {scenes::contact("fit", "outer.inner", "inner.outer")};
  s.contacts[0].offset = parameter(s, "offset", -0.01);
  s.contacts[0].smoothing = smoothing;
  if (mu > 0) s.contacts[0].friction = parameter(s, "mu", mu);
  Support wall = scenes::support("inner.inner", {});
  wall.rotate = Rotation{{0.0, 0.0}, {}, table({{0, 0.0}, {1, 0.0}, {2, turned}})};
  s.supports = {wall, scenes::support("outer.outer", {{'x', table({{0, 0.0}})}, {'y', table({{0, 0.0}})}})};
  s.responses = {response("p", Kind::contact_pressure, "fit"),
                 response("torque", Kind::reaction, "inner.inner", "moment")};
  s.responses[1].about = {0.0, 0.0};
  return s;
}

/// Lame's solution between walls at 1 and 4: u = A r + B / r in each ring.
double fitted_pressure() {
  constexpr double C = 1000 / (1.3 * 0.4), free = 0.4;  // E / ((1 + nu) (1 - 2 nu)), 1 - 2 nu
  const double inner = (2 - 0.5) / (C * (1 + free / 4)), outer = (8 - 2) / (C * (1 + free * 4));
  return 0.01 / (inner + outer);
}

TEST(SmoothMasters, HaveLamesPressureInSecondOrder) {
  std::array<double, 2> error;
  for (int k : {0, 1})
    error[k] = run(fitted(25 << k, Smoothing::catmull_rom, false), MonolithicAL{}).value("p") / fitted_pressure() - 1;
  EXPECT_LE(std::abs(error[1]), 0.005);
  EXPECT_GE(std::log2(std::abs(error[0] / error[1])), 1.7);
  const double on_facets = run(fitted(50, Smoothing::none, false), MonolithicAL{}).value("p") / fitted_pressure() - 1;
  EXPECT_GT(std::abs(on_facets), 0.05);
}

TEST(SmoothMasters, TakeTheRippleOutOfATurningFit) {
  const auto ripple = [](Smoothing smoothing) {
    const auto s = run(fitted(50, smoothing, true, 10), MonolithicAL{});
    EXPECT_TRUE(is_converged(s.trajectory.status)) << s.trajectory.message;
    double most = 0;
    for (int n = 1; n < static_cast<int>(s.trajectory.increments.size()); ++n)
      most = larger(most, std::abs(s.value("torque", n)));
    return most;
  };
  const double on_facets = ripple(Smoothing::none);
  for (const Smoothing kind : {Smoothing::catmull_rom, Smoothing::b_spline}) EXPECT_LE(ripple(kind), 0.1 * on_facets);
}

TEST(SmoothMasters, AreCrossedWithoutChatter) {  // C14
  // A step takes each node to the facet that it ends on, by one change for each facet's end that it passes.
  for (const Smoothing kind : {Smoothing::catmull_rom, Smoothing::b_spline}) {
    const auto s = run(fitted(50, kind, true, 10), MonolithicAL{});
    ASSERT_TRUE(is_converged(s.trajectory.status)) << s.trajectory.message;
    EXPECT_EQ(s.trajectory.counters.cutbacks, 0);
    for (std::size_t n = 1; n < s.trajectory.increments.size(); ++n) {
      const auto &now = s.trajectory.increments[n], &before = s.trajectory.increments[n - 1];
      int crossed = 0, changed = 0;
      for (std::size_t p = 0; p < now.state.contact.facing.size(); ++p)
        crossed += now.state.contact.facing[p].patch != before.state.contact.facing[p].patch;
      for (const auto& iteration : now.history) changed += iteration.changed;
      EXPECT_GT(crossed, 0);
      EXPECT_LE(changed, crossed) << n;
    }
  }
}

TEST(SmoothMasters, SlipAllAroundAtTheTorqueOfFriction) {
  // 2 pi R^2 mu p; p is nominal, of the bore that was 2 - 0.01 / 2 or so: what finite strain changes is of order D / R
  const auto s = run(fitted(50, Smoothing::catmull_rom, true, 3, 0.2), MonolithicAL{});
  ASSERT_TRUE(is_converged(s.trajectory.status)) << s.trajectory.message;
  const double torque = 2 * std::numbers::pi * 4 * 0.2 * s.value("p");
  EXPECT_NEAR(std::abs(s.value("torque")), torque, 0.01 * torque);
  EXPECT_NEAR(std::abs(s.derivative("torque", "mu")), torque / 0.2, 0.02 * torque / 0.2);
}

TEST(FiniteCurves, BodiesTouchWithTheirWholeBoundaries) {
  // two blocks side by side, pushed on one another; nothing but the faces between them ever touches
  const auto scene = [](bool whole) {
    Scene s;
    s.finite_strain = true;
    s.legs = {{1, 3}};
    s.bodies = {rubber(scenes::box_body("a", {0, 0}, {1, 1}, {3, 3}), s, "E", 10),
                rubber(scenes::box_body("b", {1.1, -0.25}, {2.1, 0.75}, {5, 5}), s, "E_b", 20)};
    s.contacts = {whole ? scenes::contact("pile/b~a", "b.boundary", "a.boundary")
                        : scenes::contact("pile", "b.left", "a.right")};
    if (whole) s.contacts[0].group = "pile";
    s.contacts[0].friction = parameter(s, "mu", 0.2);
    s.supports = {scenes::support("a.left", {{'x', table({{0, 0.0}})}, {'y', table({{0, 0.0}})}}),
                  scenes::support("b.right", {{'x', table({{0, 0.0}, {1, -0.25}})}, {'y', table({{0, 0.0}})}})};
    s.responses = {response("push", Kind::contact_force, "pile", "normal"), response("heat", Kind::dissipation, "pile"),
                   response("x", Kind::reaction, "a.left", "x")};
    return s;
  };
  const auto face = run(scene(false), MonolithicAL{}), whole = run(scene(true), MonolithicAL{});
  ASSERT_TRUE(is_converged(whole.trajectory.status)) << whole.trajectory.message;
  EXPECT_GT(face.value("push"), 1);
  // (the ends of the slave side have the areas of both their facets: their pressure is another, their force is not)
  for (const char* name : {"push", "x"})
    EXPECT_NEAR(whole.value(name), face.value(name), 1e-9 * face.value("push")) << name;
}

TEST(FiniteCurves, SmallStrainIsTheirLimit) {  // D3
  const auto press = [](bool finite, double down) {
    Scene s = ironing(Smoothing::none);
    s.finite_strain = finite;
    for (auto& body : s.bodies)
      if (!finite) body.material = LinearElastic{body.name == "die" ? 5.0 : 1.0, 0.3};
    QuadMesh die;
    die.corners = {{{0.9, 1.0}, {1.7, 1.0}, {1.8, 1.6}, {0.8, 1.6}}};
    die.cells = {4, 2};
    s.bodies[1].mesh = die;
    s.supports[1] = scenes::support("die.top", {{'x', table({{0, 0.0}})}, {'y', table({{0, 0.0}, {1, down}})}});
    s.legs = {{1, 2}};
    s.parameters.clear();
    const auto solved = run(s, MonolithicAL{});
    EXPECT_TRUE(is_converged(solved.trajectory.status)) << solved.trajectory.message;
    return solved.value("y") / down;
  };
  double last = 0;
  for (double down : {-1e-2, -1e-3, -1e-4, -1e-5, -1e-6}) {  // the difference falls with the strain
    const double difference = std::abs(press(true, down) / press(false, down) - 1);
    EXPECT_LE(difference, 10 * std::abs(down));
    if (last > 0) {
      EXPECT_NEAR(std::log10(last / difference), 1, 0.02);  // (that of second order at 1e-2: 0.006)
    }
    last = difference;
  }
}

}  // namespace
}  // namespace stickslip::finite_curves_test
