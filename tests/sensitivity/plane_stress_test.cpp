/// Plane stress at finite strain: closed forms by every method, objectivity, the limit of small strain, Newton's order,
/// derivatives by every scheme against the complex step of the whole program, and the adjoint against those.
#include <gtest/gtest.h>

#include <numbers>

#include "tests/support/blocks.hpp"
#include "tests/support/finite_strain.hpp"

namespace stickslip::plane_stress_test {
namespace {

using namespace scenes;
using Kind = Response::Kind;
using Volumetric = NeoHookean::Volumetric;

/// The zero of a function that grows.
template <class F>
double zero_of(F&& f, double low, double high) {
  for (int i = 0; i < 200; ++i) {
    const double x = (low + high) / 2;
    (f(x) > 0 ? high : low) = x;
  }
  return low;
}

/// Rubber under stretches: the equations of [W06], written for principal stretches.
struct Rubber {
  double E, nu;
  Volumetric kind;
  double G = E / (2 * (1 + nu)), lame = E * nu / ((1 + nu) * (1 - 2 * nu));
  /// J U'(J).
  double pressure(double J) const { return kind == Volumetric::log ? lame * std::log(J) : lame * (J - 1) * J; }
  /// Nominal stress along l of the volume J.
  double stress(double l, double J) const { return (G * (l * l - 1) + pressure(J)) / l; }
  /// Of a block that is stretched by l and free to both sides: the stretch there.
  double across(double l) const {
    return zero_of([&](double q) { return stress(q, l * q * q); }, 0.05, 5);
  }
  double energy(double a, double b, double c) const {
    const double J = a * b * c, change = kind == Volumetric::log ? std::log(J) : J - 1;
    return G * ((a * a + b * b + c * c - 3) / 2 - std::log(J)) + lame / 2 * change * change;
  }
};

/// A block of 2 x 1 whose top is moved, on a floor, or held below where it is pulled. Free to its right.
Scene stretched(const Material& material, const char* element, double stretch, double thickness) {
  Scene s;
  s.space = Space::plane_stress;
  s.finite_strain = true;
  s.legs = {{1, 4}};
  BoxMesh box;
  box.min = {0.0, 0.0};
  box.max = {2.0, 1.0};
  box.cells = {3, 2};
  s.bodies = {{"block", box, material, element, 1.0}};
  s.bodies[0].thickness = parameter(s, "thickness", thickness);
  const Number moved = parameter(s, "moved", stretch - 1);
  s.supports = {scenes::support("block.top", {{'y', table({{0, 0.0}, {1, moved}})}}),
                scenes::support("block.left", {{'x', table({{0, 0.0}})}})};
  if (stretch < 1) {
    s.obstacles = {{"floor", Plane{{0.0, 0.0}, {0.0, 1.0}}}};
    s.contacts = {scenes::contact("sole", "block.bottom", "floor")};
  } else {
    s.supports.push_back(scenes::support("block.bottom", {{'y', table({{0, 0.0}})}}));
  }
  s.responses = {
      response("press", Kind::reaction, "block.top", "y"), response("wide", Kind::displacement, "block.right", "x"),
      response("sunk", Kind::displacement, "block.bottom", "y"), response("energy", Kind::strain_energy, "")};
  return s;
}

TEST(PlaneStress, OfABlockHasTheStretchesAndForceOfTheClosedForm) {
  constexpr double E = 1000, thickness = 0.7;
  for (const Volumetric kind : {Volumetric::quadratic, Volumetric::log})
    for (const auto& [l, nu] : {std::pair(0.6, 0.3), {0.5, 0.495}, {1.8, 0.4}})
      for (const auto& method : finite_methods()) {
        const Rubber rubber{E, nu, kind};
        const auto s = run(stretched(NeoHookean{E, nu, kind}, "Q4", l, thickness), method);
        ASSERT_TRUE(is_converged(s.trajectory.status)) << name_of(method) << s.trajectory.message;
        // of the stretch that there is: the penalty sinks in
        const double found = l - s.value("sunk"), q = rubber.across(found), scale = E * thickness;
        const double force = 2 * thickness * rubber.stress(found, found * q * q);
        EXPECT_NEAR(1 + s.value("wide") / 2, q, 1e-10) << name_of(method) << l;
        EXPECT_NEAR(s.value("press"), force, 1e-9 * scale) << name_of(method) << l;
        EXPECT_NEAR(s.value("energy"), 2 * thickness * rubber.energy(found, q, q), 1e-9 * scale) << name_of(method);
        EXPECT_NEAR(s.derivative("press", "thickness") * thickness, force, 1e-9 * scale) << name_of(method) << l;
        if (std::holds_alternative<Penalty>(method)) continue;
        const auto at = [&](double x) { return 2 * thickness * rubber.stress(x, x * std::pow(rubber.across(x), 2)); };
        // (a central difference of the closed form, by 1e-5: 1e-10 of its third derivative, 1e-11 of rounding)
        EXPECT_NEAR(s.derivative("press", "moved"), (at(l + 1e-5) - at(l - 1e-5)) / 2e-5, 1e-7 * scale)
            << name_of(method);
        EXPECT_NEAR(s.derivative("energy", "moved"), force, 1e-9 * scale) << name_of(method) << l;
      }
}

TEST(PlaneStress, OfEveryElementIsThatOfACylinder) {
  // pressed without friction a block of plane stress and a cylinder are in the same state of one stress
  for (const Material& material :
       {Material(NeoHookean{1000.0, 0.4, Volumetric::log}), Material(J2Plastic{1000.0, 0.3, 60.0, 200.0})}) {
    Scene round = stretched(material, "Q4", 0.6, 1);
    round.space = Space::axisymmetric;
    round.bodies[0].thickness = 1.0;
    round.parameters.clear();
    const auto cylinder = run(round, MonolithicAL{});
    ASSERT_TRUE(is_converged(cylinder.trajectory.status)) << cylinder.trajectory.message;
    for (const char* element : {"Q4", "T3", "Q8", "T6"})
      for (const auto& method : scenes::exact_methods()) {
        const auto s = run(stretched(material, element, 0.6, 0.7), method);
        ASSERT_TRUE(is_converged(s.trajectory.status)) << element << s.trajectory.message;
        for (int n = 0; n < 4; ++n) {  // per area of the start
          const double stress = cylinder.value("press", n) / (4 * std::numbers::pi);
          EXPECT_NEAR(s.value("press", n) / (2 * 0.7), stress, 1e-9 * std::abs(stress)) << element << n;
          EXPECT_NEAR(s.value("wide", n), cylinder.value("wide", n), 1e-9) << element << n;
        }
      }
  }
}

TEST(PlaneStress, OfAMetalBarIsStraightFromCornerToCornerInLogarithms) {
  constexpr double E = 1000, thickness = 0.7;
  struct Corner {
    double strain, stress;
  };
  const std::vector<HardeningRow> rows{{0.05, 75.0}, {0.2, 90.0}, {0.6, 95.0}};
  for (bool tabulated : {false, true}) {
    const J2Plastic metal{E, 0.3, 60.0, tabulated ? 0.0 : 150.0, tabulated ? rows : std::vector<HardeningRow>{}};
    std::vector<Corner> corners{{0, 0}, {60 / E, 60}};
    if (tabulated)
      for (const auto& row : rows) corners.push_back({row.strain.value + row.stress.value / E, row.stress.value});
    else
      corners.push_back({1 + 210 / E, 210});
    for (double l : {0.6, 1.5})
      for (const auto& method : scenes::exact_methods()) {
        const auto s = run(stretched(metal, "Q4", l, thickness), method);
        ASSERT_TRUE(is_converged(s.trajectory.status)) << name_of(method) << s.trajectory.message;
        for (int n = 0; n < 4; ++n) {
          const double now = 1 + (l - 1) * (n + 1) / 4, strain = std::abs(std::log(now));
          int k = 1;
          while (strain > corners[k].strain) ++k;
          const double slope =
              (corners[k].stress - corners[k - 1].stress) / (corners[k].strain - corners[k - 1].strain);
          const double stress = corners[k - 1].stress + slope * (strain - corners[k - 1].strain);
          const double force = (l > 1 ? 1 : -1) * 2 * thickness * stress / now;
          EXPECT_NEAR(s.value("press", n), force, 1e-9 * E) << name_of(method) << l << n;
          // d (tau / l) / dl = (slope - |tau|) / l^2, of its last amplitude by the share of the way
          EXPECT_NEAR(s.derivative("press", "moved", n),
                      2 * thickness * (slope - (l > 1 ? 1 : -1) * stress) / (now * now) * (n + 1) / 4, 1e-8 * E)
              << name_of(method) << l << n;
        }
      }
  }
}

// --- pressure --------------------------------------------------------------------------------------------------------

TEST(PlaneStress, UnderAPressureBearsItOnThePresentThickness) {
  // Cauchy's stress is -p along both axes, of the stretch l: G (l^2 - 1) + J U'(J) = -p J, J = l^2 h
  constexpr double E = 100, nu = 0.3, p = 20;
  for (const Volumetric kind : {Volumetric::quadratic, Volumetric::log})
    for (const char* element : {"Q4", "T3", "Q8", "T6"})
      for (const auto& method : finite_methods()) {
        const Rubber rubber{E, nu, kind};
        const auto thickness = [&](double l) {
          return zero_of([&](double h) { return rubber.stress(h, l * l * h); }, 0.05, 5);
        };
        Scene s = stretched(NeoHookean{E, nu, kind}, element, 0.9, 0.7);
        s.supports.erase(s.supports.begin());
        for (const char* side : {"block.right", "block.top"}) {
          Load load;
          load.on = side;
          load.kind = Load::Kind::pressure;
          load.vector = {p};
          load.history = table({{0, 0.0}, {1, 1.0}});
          s.loads.push_back(load);
        }
        s.parameters.pop_back();  // (nothing is moved)
        s.responses[0] = response("high", Kind::displacement, "block.top", "y");
        const double l = zero_of(
            [&](double x) {
              const double h = thickness(x);
              return rubber.G * (x * x - 1) + rubber.pressure(x * x * h) + p * x * x * h;
            },
            0.3, 1);
        EXPECT_GT(thickness(l), 1.05);  // it bulges: without that the stretch would be another
        const auto r = run(s, method);
        ASSERT_TRUE(is_converged(r.trajectory.status)) << name_of(method) << element << r.trajectory.message;
        const double overlap = std::abs(r.value("sunk"));
        EXPECT_NEAR(1 + r.value("wide") / 2, l, 1e-9 + overlap) << name_of(method) << element;
        EXPECT_NEAR(1 + r.value("high"), l, 1e-9 + 2 * overlap) << name_of(method) << element;
        for (std::size_t i = 1; i < r.trajectory.increments.size(); ++i)
          EXPECT_LE(r.trajectory.increments[i].newton, std::holds_alternative<MonolithicAL>(method) ? 8 : 200);
      }
}

TEST(PlaneStress, OfWhatFlowsTakesNoPressure) {
  Scene s = stretched(J2Plastic{1000.0, 0.3, 60.0, 200.0}, "Q4", 0.9, 1);
  s.loads = {scenes::force("block.right", {1.0, 0.0})};
  s.loads[0].kind = Load::Kind::pressure;
  s.loads[0].vector = {1.0};
  EXPECT_THROW(make_model(s), ModelError);
  s.space = Space::plane_strain;
  EXPECT_NO_THROW(make_model(s));
}

// --- a block on a rough disk -----------------------------------------------------------------------------------------

/// A block, thick at the start, pressed onto a rigid rough disk and drawn along it: it sticks, slips, and opens.
Scene draped_sheet(const Material& material, const char* element, double size = 1) {
  Scene s;
  s.space = Space::plane_stress;
  s.finite_strain = true;
  s.legs = {{1, 2}, {2, 2}};
  BoxMesh box;
  box.min = {-1.0, 0.0};
  box.max = {1.0, parameter(s, "height", 0.8)};
  box.cells = {4, 2};
  s.bodies = {{"block", box, material, element, 1.0}};
  s.bodies[0].thickness = parameter(s, "thickness", 0.6);
  s.obstacles = {{"disk", Circle{{0.07, -1.5}, parameter(s, "R", 1.5)}}};
  s.contacts = {scenes::contact("sole", "block.bottom", "disk")};
  s.contacts[0].friction = parameter(s, "mu", 0.3);
  const Number down = parameter(s, "down", -0.25 * size), along = parameter(s, "along", 0.17 * size);
  s.supports = {scenes::support("block.top",
                                {{'y', table({{0, 0.0}, {1, down}})}, {'x', table({{0, 0.0}, {1, 0.0}, {2, along}})}})};
  s.responses = {response("press", Kind::reaction, "block.top", "y"),
                 response("drag", Kind::reaction, "block.top", "x"),
                 response("side", Kind::displacement, "block.right", "x"),
                 response("energy", Kind::strain_energy, ""),
                 response("slid", Kind::slip, "sole"),
                 response("heat", Kind::dissipation, "sole")};
  return s;
}

/// Its numbers are parameters too.
Scene draped_rubber(Volumetric kind, const char* element) {
  Scene s = draped_sheet(NeoHookean{}, element);
  s.bodies[0].material = NeoHookean{parameter(s, "E", 100), parameter(s, "nu", 0.35), kind};
  return s;
}

TEST(PlaneStress, HasTheDerivativesOfTheWholeRunInBothModes) {
  for (const auto& [kind, element] : {std::pair(Volumetric::quadratic, "Q4"), {Volumetric::log, "T6"}})
    for (const Method& method : finite_schemes())
      scenes::expect_derivatives_in_both_modes(draped_rubber(kind, element), method);
  for (const auto& [kind, element] : {std::pair(Volumetric::log, "T3"), {Volumetric::quadratic, "Q8"}})
    scenes::expect_derivatives_in_both_modes(draped_rubber(kind, element), MonolithicAL{});
}

TEST(PlaneStress, ConvergesWithTheOrderOfNewton) {
  // Of three residuals in a row in settled states, c / b = (b / a)^order, a below 1e-3 and c above a thousand
  // roundings.
  Penalty penalty;
  penalty.stiffness = scenes::relative(1);
  int looked_at = 0;
  for (const Material& material : {Material(NeoHookean{100.0, 0.35, Volumetric::log}),
                                   Material(NeoHookean{100.0, 0.45}), Material(J2Plastic{100.0, 0.3, 4.0, 30.0})})
    for (const Method& method : {Method(penalty), Method(MonolithicAL{})})
      for (int steps : {1, 2, 3, 4, 5, 6}) {
        Scene scene = draped_sheet(material, "Q4");
        scene.legs = {{1, steps}, {2, steps}};
        const auto s = run(scene, method);
        ASSERT_TRUE(is_converged(s.trajectory.status)) << name_of(method) << s.trajectory.message;
        for (const auto& increment : s.trajectory.increments) {
          const auto& h = increment.history;
          for (std::size_t i = 2; i < h.size(); ++i) {
            const double a = h[i - 2].residual, b = h[i - 1].residual, c = h[i].residual;
            bool settled = c < b && b < a;
            for (std::size_t k = i - 2; k <= i; ++k) settled &= h[k].changed == 0 && h[k].step_length == 1;
            if (!settled || a > 1e-3 || c < 1e-13) continue;
            ++looked_at;
            EXPECT_GE(std::log(c / b) / std::log(b / a), 1.8) << name_of(method) << " " << a << " " << b << " " << c;
          }
        }
      }
  EXPECT_GE(looked_at, 3);
}

TEST(PlaneStress, IsThatOfSmallStrainToFirstOrder) {
  // a block that a rough floor holds, and a press that it sticks to
  const auto pressed = [](bool finite, bool metal, double strain) {
    Scene s = draped_sheet(NeoHookean{100.0, 0.35}, "Q4");
    s.finite_strain = finite;
    s.parameters.clear();
    if (!finite) s.bodies[0].material = LinearElastic{100.0, 0.35};
    if (metal) s.bodies[0].material = J2Plastic{100.0, 0.3, 60 * strain, 30.0};
    s.obstacles = {{"floor", Plane{{0.0, 0.0}, {0.0, 1.0}}}};
    s.contacts[0].master = "floor";
    s.supports = {
        scenes::support("block.top", {{'y', scenes::ramp(-0.8 * strain)}, {'x', scenes::ramp(0.2 * strain)}})};
    s.legs = {{1, 2}};
    return run(s, MonolithicAL{});
  };
  for (bool metal : {false, true})
    for (const char* name : {"press", "drag", "side", "energy"}) {
      double apart[2];
      for (int k : {0, 1}) {
        const double strain = k == 0 ? 1e-3 : 1e-4;
        const auto finite = pressed(true, metal, strain), small = pressed(false, metal, strain);
        apart[k] = std::abs(finite.value(name) / small.value(name) - 1);
      }
      EXPECT_LT(apart[0], 1e-2) << name << metal;
      EXPECT_NEAR(std::log10(apart[0] / apart[1]), 1, 0.1)
          << name << metal;  // (the next order is a tenth of it or less)
    }
}

TEST(PlaneStress, OfAWholeSceneThatTurnsChangesNothing) {
  // the press and the floor turn about a place by 40 degrees, in steps; what presses turns too
  constexpr double down = -0.15, along = 0.05, degrees = 40;
  constexpr int steps = 8;
  for (const Material& material :
       {Material(NeoHookean{100.0, 0.4, Volumetric::log}), Material(J2Plastic{100.0, 0.3, 5.0, 30.0})})
    for (const Method& method : scenes::exact_methods()) {
      Scene s = draped_sheet(material, "Q4");
      s.parameters.clear();
      s.obstacles = {{"floor", Plane{{0.0, 0.0}, {0.0, 1.0}}}};
      s.contacts[0].master = "floor";
      s.legs = {{2, 4}, {2 + steps, steps}};
      Table x = table({{0, 0.0}, {1, 0.0}, {2, along}}), y = table({{0, 0.0}, {1, down}, {2, down}}),
            angle = table({{0, 0.0}, {2, 0.0}});
      for (int n = 1; n <= steps; ++n) {
        const double turned = degrees * n / steps, radians = turned * std::numbers::pi / 180;
        x.points.emplace_back(2 + n, along * std::cos(radians) - down * std::sin(radians));
        y.points.emplace_back(2 + n, along * std::sin(radians) + down * std::cos(radians));
        angle.points.emplace_back(2 + n, turned);
      }
      s.supports = {scenes::support("block.top", {{'x', x}, {'y', y}})};
      s.supports[0].rotate = s.obstacles[0].rotate = Rotation{{0.3, -0.2}, {}, angle};
      s.responses = {response("energy", Kind::strain_energy, ""), response("heat", Kind::dissipation, "sole"),
                     response("force", Kind::contact_force, "sole", "normal")};
      const auto r = run(s, method);
      ASSERT_TRUE(is_converged(r.trajectory.status)) << name_of(method) << r.trajectory.message;
      ASSERT_EQ(r.trajectory.counters.cutbacks, 0);
      const int last = static_cast<int>(r.trajectory.increments.size()) - 1;
      for (const char* name : {"energy", "heat", "force"})
        EXPECT_NEAR(r.value(name, last), r.value(name, 3), 1e-10 * std::abs(r.value(name, 3)))
            << name_of(method) << name;
      const Vector<double>&was = r.trajectory.increments[3].state.contact.traction,
            &is = r.trajectory.increments[last].state.contact.traction;
      EXPECT_LE(largest_entry(was - is), 1e-10 * largest_entry(was)) << name_of(method);
    }
}

TEST(PlaneStress, KnowsNoUnit) {
  // forces in a unit 2^80 times as large: the same motion but for what Newton's method leaves
  for (const Volumetric kind : {Volumetric::quadratic, Volumetric::log}) {
    const auto a = run(draped_sheet(NeoHookean{100.0, 0.35, kind}, "Q4"), MonolithicAL{});
    const auto b = run(draped_sheet(NeoHookean{100 * 0x1p-80, 0.35, kind}, "Q4"), MonolithicAL{});
    ASSERT_TRUE(is_converged(a.trajectory.status)) << a.trajectory.message;
    EXPECT_LE(largest_entry(a.trajectory.increments.back().state.displacement -
                            b.trajectory.increments.back().state.displacement),
              1e-12);
    EXPECT_NEAR(b.value("press") * 0x1p80, a.value("press"), 1e-11 * std::abs(a.value("press")));
  }
}

TEST(PlaneStress, WithoutAThicknessNamesTheElement) {
  // nu < 0, widened to more than what the quadratic law has a thickness for
  Scene s = stretched(NeoHookean{1000.0, -0.3}, "Q4", 1.7, 1);
  s.supports.push_back(scenes::support("block.right", {{'x', table({{0, 0.0}, {1, 1.4}})}}));
  const auto r = run(s, MonolithicAL{});
  EXPECT_EQ(r.trajectory.status, Status::inverted_element) << r.trajectory.message;
  EXPECT_NE(r.trajectory.message.find("of block is inverted"), std::string::npos) << r.trajectory.message;
  for (const auto& increment : r.trajectory.increments) EXPECT_TRUE(increment.state.displacement.allFinite());
}

}  // namespace
}  // namespace stickslip::plane_stress_test
