/// Finite strain of revolution: the closed form of a cylinder between a support and a plane, and derivatives against
/// the complex step of the whole run.
#include <gtest/gtest.h>

#include <numbers>

#include "tests/support/blocks.hpp"
#include "tests/support/finite_strain.hpp"

namespace stickslip::finite_revolution_test {
namespace {

using namespace scenes;
using Kind = Response::Kind;

/// A cylinder of radius and height 1, pressed to `stretch` on a smooth floor.
Scene cylinder(double stretch, NeoHookean::Volumetric kind) {
  Scene s;
  s.space = Space::axisymmetric;
  s.finite_strain = true;
  s.legs = {{1, 4}};
  auto body = scenes::box_body("cylinder", {0, 0}, {1, 1}, {3, 4});
  body.material = NeoHookean{1000.0, 0.3, kind};
  s.bodies = {body};
  s.obstacles = {{"floor", Plane{{0.0, 0.0}, {0.0, 1.0}}}};
  s.contacts = {scenes::contact("sole", "cylinder.bottom", "floor")};
  s.supports = {scenes::support("cylinder.top", {{'y', table({{0, 0.0}, {1, stretch - 1}})}})};
  s.responses = {response("press", Kind::reaction, "cylinder.top", "y"),
                 response("wide", Kind::displacement, "cylinder.right", "x"),
                 response("sunk", Kind::displacement, "cylinder.bottom", "y"),
                 response("energy", Kind::strain_energy, "")};
  return s;
}

TEST(FiniteRevolution, HasForceRadiusAndEnergyOfTheClosedForm) {
  // r: free, P_r = G (r - 1/r) + J U'(J)/r = 0; z: P_z = G (z - 1/z) + J U'(J)/z over the initial area pi; J = r^2 z
  constexpr double lame = 1000 * 0.3 / (1.3 * 0.4), G = 1000 / 2.6;
  using Volumetric = NeoHookean::Volumetric;
  for (auto kind : {Volumetric::quadratic, Volumetric::log})
    for (double stretch : {0.9, 0.6})
      for (const auto& method : finite_methods()) {
        const auto s = run(cylinder(stretch, kind), method);
        ASSERT_TRUE(is_converged(s.trajectory.status)) << name_of(method) << s.trajectory.message;
        const double z = stretch - s.value("sunk"), r = 1 + s.value("wide"), J = r * r * z;
        // (areas grow with the radius, and overlaps of a penalty with them: the cylinder then has not one stretch)
        const double overlap = std::abs(s.value("sunk")), allowed = 1e-9 * lame + 1e3 * overlap;
        const bool log = kind == Volumetric::log;
        const double JU = lame * (log ? std::log(J) : (J - 1) * J);
        EXPECT_NEAR(G * (r - 1 / r) + JU / r, 0, allowed) << name_of(method);
        EXPECT_NEAR(s.value("press") / std::numbers::pi, G * (z - 1 / z) + JU / z, allowed) << name_of(method);
        const double U = lame / 2 * (log ? std::pow(std::log(J), 2) : std::pow(J - 1, 2));
        EXPECT_NEAR(s.value("energy") / std::numbers::pi, G * ((2 * r * r + z * z - 3) / 2 - std::log(J)) + U, allowed)
            << name_of(method);
        EXPECT_LE(overlap, std::holds_alternative<Penalty>(method) ? 1e-4 : 1e-11);
      }
}

/// A rubber ring pressed onto a rough floor by its top and widened there.
Scene ring() {
  Scene s;
  s.space = Space::axisymmetric;
  s.finite_strain = true;
  s.legs = {{1, 3}, {2, 3}};
  BoxMesh box;
  box.min = {0.5, 0.0};
  box.max = {parameter(s, "outer", 1.5), 0.8};
  box.cells = {6, 3};
  s.bodies = {{"ring", box, NeoHookean{parameter(s, "E", 100), parameter(s, "nu", 0.3)}, "", 1.0}};
  s.obstacles = {{"floor", Plane{{0.0, 0.0}, {0.0, 1.0}}}};
  s.contacts = {scenes::contact("sole", "ring.bottom", "floor")};
  s.contacts[0].friction = parameter(s, "mu", 0.2);
  const Number down = parameter(s, "down", -0.2), wide = parameter(s, "wide", 0.1);
  s.supports = {scenes::support("ring.top",
                                {{'y', table({{0, 0.0}, {1, down}})}, {'x', table({{0, 0.0}, {1, 0.0}, {2, wide}})}})};
  s.responses = {response("press", Kind::reaction, "ring.top", "y"),
                 response("drag", Kind::reaction, "ring.top", "x"),
                 response("side", Kind::displacement, "ring.right", "x"),
                 response("energy", Kind::strain_energy, ""),
                 response("slid", Kind::slip, "sole"),
                 response("heat", Kind::dissipation, "sole")};
  return s;
}

TEST(FiniteRevolution, DerivativesEqualTheComplexStepOfTheWholeRun) {
  for (const char* element : {"Q4", "Q4_mean_dilatation"}) {
    Scene scene = ring();
    scene.bodies[0].element = element;
    for (const Method& method : finite_schemes()) scenes::expect_derivatives_in_both_modes(scene, method);
  }
}

}  // namespace
}  // namespace stickslip::finite_revolution_test
