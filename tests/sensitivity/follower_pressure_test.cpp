/// Pressures that follow the sides that they act on, at finite strain: a closed form, objectivity, derivatives.
#include <gtest/gtest.h>

#include <Eigen/Geometry>

#include "tests/support/blocks.hpp"
#include "tests/support/compiled_slots.hpp"
#include "tests/support/finite_strain.hpp"

namespace stickslip::follower_pressure_test {
namespace {

using namespace scenes;
using Kind = Response::Kind;

Load pressure(const std::string& on, const Number& value) {
  Load load;
  load.on = on;
  load.kind = Load::Kind::pressure;
  load.vector = {value};
  load.history = table({{0, 0.0}, {1, 1.0}});
  return load;
}

TEST(FollowerPressure, AllAroundGivesTheStretchOfTheClosedForm) {
  // Cauchy's stress of a stretch l along both axes is -p: G (l^2 - 1) / J + lame ln J / J, J = l^2
  const double E = 100, nu = 0.3, p = 40, G = E / 2.6, lame = E * nu / (1.3 * 0.4);
  double low = 0.3, high = 1;
  for (int i = 0; i < 100; ++i) {
    const double l = (low + high) / 2, J = l * l;
    (G * (J - 1) / J + lame * std::log(J) / J + p > 0 ? high : low) = l;
  }
  for (const char* element : {"Q4", "T6", "Q4_mean_dilatation"})
    for (const Method& method : finite_methods()) {
      Scene s;
      s.finite_strain = true;
      s.legs = {{1, 3}};
      BoxMesh box;
      box.min = {0.0, 0.0};
      box.max = {2.0, 1.0};
      box.cells = {3, 2};
      s.bodies = {{"block", box, NeoHookean{E, nu, NeoHookean::Volumetric::log}, element, 1.0}};
      s.obstacles = {{"floor", Plane{{0.0, 0.0}, {0.0, 1.0}}}};
      s.contacts = {scenes::contact("sole", "block.bottom", "floor")};
      s.supports = {scenes::support("block.left", {{'x', table({{0, 0.0}})}})};
      s.loads = {pressure("block.right", p), pressure("block.top", p)};
      s.responses = {response("x", Kind::displacement, "block.right", "x"),
                     response("y", Kind::displacement, "block.top", "y"), response("sunk", Kind::gap, "sole")};
      const auto r = run(s, method);
      ASSERT_TRUE(is_converged(r.trajectory.status)) << name_of(method) << element << r.trajectory.message;
      const double overlap = std::abs(r.value("sunk"));
      EXPECT_NEAR(1 + r.value("x") / 2, low, 1e-9 + overlap) << name_of(method) << element;
      EXPECT_NEAR(1 + r.value("y"), low, 1e-9 + 2 * overlap) << name_of(method) << element;
      for (std::size_t i = 1; i < r.trajectory.increments.size(); ++i)
        EXPECT_LE(r.trajectory.increments[i].newton, std::holds_alternative<MonolithicAL>(method) ? 8 : 200);
    }
}

/// A soft block on a rough disk that is blown against it from above and pushed by a pressure on its left side; it
/// hangs on its right side.
Scene blown(Space space, const std::string& element) {
  Scene s;
  s.finite_strain = true;
  s.space = space;
  s.legs = {{1, 3}};
  const double left = space == Space::axisymmetric ? 1.0 : 0.0;
  BoxMesh box;
  box.min = {left, 0.0};
  box.max = {left + 2, parameter(s, "height", 0.6)};
  box.cells = {5, 2};
  s.bodies = {{"block", box, NeoHookean{parameter(s, "E", 100), parameter(s, "nu", 0.3)}, element, 1.0}};
  s.obstacles = {{"disk", Circle{{left + 0.6, -1.52}, parameter(s, "R", 1.5)}}};
  s.contacts = {scenes::contact("sole", "block.bottom", "disk")};
  s.contacts[0].friction = parameter(s, "mu", 0.2);
  s.supports = {scenes::support("block.right", {{'x', table({{0, 0.0}})}, {'y', table({{0, 0.0}})}})};
  s.loads = {pressure("block.top", parameter(s, "p", 4)), pressure("block.left", parameter(s, "side", 3))};
  s.responses = {response("hang", Kind::reaction, "block.right", "y"),
                 response("push", Kind::reaction, "block.right", "x"),
                 response("tip", Kind::displacement, "block.left", "y"),
                 response("energy", Kind::strain_energy, ""),
                 response("slid", Kind::slip, "sole"),
                 response("press", Kind::contact_force, "sole", "normal")};
  return s;
}

TEST(FollowerPressure, HasTheDerivativesOfTheComplexStepInBothModes) {
  for (const auto& [space, element] : {std::pair(Space::plane_strain, "Q4"),
                                       {Space::plane_strain, "T6"},
                                       {Space::axisymmetric, "Q4"},
                                       {Space::plane_stress, "Q4"},
                                       {Space::plane_stress, "Q8"}})
    for (const Method& method : finite_schemes()) {
      const Scene scene = blown(space, element);
      const auto s = run(scene, method);
      ASSERT_TRUE(is_converged(s.trajectory.status)) << name_of(method) << s.trajectory.message;
      EXPECT_GT(s.value("press"), 0.1);
      EXPECT_LT(s.value("tip"), -0.05);
      scenes::expect_derivatives_in_both_modes(scene, method);
    }
}

void expect_turning(const Scene& scene) {
  const Model model = make_model(scene);
  const auto slots = make_slots<double>(model, scene.as<double>());
  Vector<double> u(model.dof_count());
  for (Eigen::Index i = 0; i < u.size(); ++i) u[i] = 0.1 * std::sin(1.3 * static_cast<double>(i));
  const Eigen::Rotation2Dd turned(0.8);
  Vector<double> moved = u;
  for (int n = 0; n < model.node_count; ++n) {
    const Vec<double, 2> x = slots.points.col(n) + u.segment<2>(2 * n);
    moved.segment<2>(2 * n) = turned * x - slots.points.col(n);
  }
  const Vector<double> still = follower_forces(model, slots, 1.0, u), found = follower_forces(model, slots, 1.0, moved);
  for (int n = 0; n < model.node_count; ++n)
    EXPECT_LE((found.segment<2>(2 * n) - turned * still.segment<2>(2 * n)).norm(), 1e-13 * largest_entry(still)) << n;
  EXPECT_GT(largest_entry(still), 0.1);
}

TEST(FollowerPressure, TurnsWithTheBody) {
  expect_turning(blown(Space::plane_strain, "Q4"));
  expect_turning(blown(Space::plane_stress, "T6"));
}

TEST(FollowerPressure, HasTheTangentOfItsForcesWhereTheThicknessChanges) {
  for (const char* element : {"T3", "Q4", "T6", "Q8"}) {
    const Model model = make_model(blown(Space::plane_stress, element));
    const auto slots = make_slots<double>(model, model.scene.as<double>());
    const auto of_complex = make_slots<std::complex<double>>(model, model.scene.as<std::complex<double>>());
    Vector<double> u(model.dof_count());
    for (Eigen::Index i = 0; i < u.size(); ++i) u[i] = 0.05 * std::sin(1.3 * static_cast<double>(i));
    Matrix<double> K = Matrix<double>::Zero(u.size(), u.size());
    for_each_follower_tangent(model, slots, {u, {}, 1.0}, [&](const std::vector<int>& nodes, const Matrix<double>& k) {
      for (Eigen::Index r = 0; r < k.rows(); ++r)
        for (Eigen::Index c = 0; c < k.cols(); ++c) K(nodes[r / 2] * 2 + r % 2, nodes[c / 2] * 2 + c % 2) += k(r, c);
    });
    for (Eigen::Index j = 0; j < u.size(); ++j) {
      Vector<std::complex<double>> moved = u.cast<std::complex<double>>();
      moved[j] += std::complex<double>(0, 1e-30);
      const auto exact = follower_forces(model, of_complex, 1.0, moved);
      for (Eigen::Index i = 0; i < u.size(); ++i)
        EXPECT_NEAR(K(i, j), exact[i].imag() / 1e-30, 1e-13 * largest_entry(K)) << element << i << j;
    }
  }
}

}  // namespace
}  // namespace stickslip::follower_pressure_test
