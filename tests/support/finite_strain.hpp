/// What the tests of finite strain share: methods and schemes, and derivatives held against the complex step.
#pragma once

#include <gtest/gtest.h>

#include "core/model/response.hpp"
#include "tests/support/both_modes.hpp"
#include "tests/support/derivatives.hpp"
#include "tests/support/largest.hpp"
#include "tests/support/oracle.hpp"
#include "tests/support/solved.hpp"

namespace stickslip::scenes {

/// Penalties that leave 1e-5 of an overlap; closed forms are held against the stretch that is there.
inline std::vector<Method> finite_methods() {
  Penalty penalty;
  penalty.stiffness = relative(1e5);
  UzawaAL uzawa;
  uzawa.tolerance = 1e-12;
  return {penalty, uzawa, MonolithicAL{}};
}

inline std::vector<Method> finite_schemes() {
  UzawaAL iterated, truncated, preconditioned;
  iterated.tolerance = truncated.tolerance = preconditioned.tolerance = 1e-12;
  truncated.sensitivity = UzawaAL::Sensitivity::truncated;
  preconditioned.sensitivity = UzawaAL::Sensitivity::preconditioned;
  Penalty penalty;  // (ten times as stiff, its overlap is less than what a step leaves a disk by along its tangent)
  penalty.stiffness = relative(100);
  return {penalty, iterated, truncated, preconditioned, MonolithicAL{}};
}

/// Sizes of the derivatives of responses by parameters: the largest of all increments, and the response at the end over
/// the parameter.
inline Matrix<double> sizes_of_derivatives(const Solved& s) {
  const auto last = evaluate_responses(s.model, s.slots, s.trajectory.increments.back().state, s.model.times.back());
  const auto& parameters = s.model.scene.parameters;
  Matrix<double> sizes(last.size(), parameters.size());
  for (Eigen::Index j = 0; j < sizes.cols(); ++j)
    sizes.col(j) = parameters[j].value != 0 ? Vector<double>(last.cwiseAbs() / std::abs(parameters[j].value))
                                            : Vector<double>(Vector<double>::Zero(last.size()));
  for (const auto& gradient : s.gradients.of_responses)
    for (Eigen::Index k = 0; k < sizes.size(); ++k)
      sizes.data()[k] = larger(sizes.data()[k], std::abs(gradient.data()[k]));
  return sizes;
}

/// Derivatives of all responses at all increments equal the complex step of the whole run: to 1e-10 of their sizes
/// where the scheme is exact, to 1e-9 where it is iterated to 1e-10, and to 50 u cond where that is more. One run moves
/// all parameters, each by so much that some response changes as much as by another, so that a wrong derivative is lost
/// in no other. Where it differs, a run for each parameter says which is wrong.
inline void expect_derivatives_of_the_oracle(const Scene& scene, const Method& method) {
  const auto s = run(scene, method);
  ASSERT_TRUE(is_converged(s.trajectory.status)) << name_of(method) << s.trajectory.message;
  ASSERT_EQ(s.gradients.of_responses.size(), s.trajectory.increments.size()) << s.gradients.message;
  const double allowed =
      std::max(std::holds_alternative<UzawaAL>(method) ? 1e-9 : 1e-10, 50 * unit_roundoff * s.condition);
  const Matrix<double> sizes = sizes_of_derivatives(s);
  // Largest difference along a motion of the parameters, over what is allowed.
  const auto difference = [&](const Vector<double>& motion) {
    const auto exact = oracle::complex_step(s.model, method, s.trajectory.step_table(), motion);
    const Vector<double> scale = sizes * motion.cwiseAbs();
    double worst = 0;
    for (Eigen::Index n = 0; n < exact.cols(); ++n) {
      const Vector<double> found = s.gradients.of_responses[n] * motion;
      for (Eigen::Index r = 0; r < exact.rows(); ++r)
        if (found[r] != exact(r, n)) worst = larger(worst, std::abs(found[r] - exact(r, n)) / (allowed * scale[r]));
    }
    return worst;
  };
  const auto& parameters = s.model.scene.parameters;
  const Eigen::Index count = sizes.cols();
  Vector<double> values(count), motion = derivatives::arbitrary(static_cast<int>(count));
  for (Eigen::Index j = 0; j < count; ++j) values[j] = std::abs(parameters[j].value);
  const Matrix<double> changes = sizes * values.asDiagonal();
  for (Eigen::Index j = 0; j < count; ++j) {
    double relative = 0;
    for (Eigen::Index r = 0; r < sizes.rows(); ++r)
      if (const double change = largest_entry(changes.row(r)); change > 0)
        relative = larger(relative, sizes(r, j) / change);
    motion[j] = (motion[j] + std::copysign(1.0, motion[j])) / relative;  // 1 to 2 either way
  }
  const double worst = difference(motion);
  if (worst <= 1) return;
  ADD_FAILURE() << name_of(method) << ": the derivatives differ by " << worst << " times what is allowed";
  for (Eigen::Index j = 0; j < count; ++j)
    EXPECT_LE(difference(Vector<double>::Unit(count, j)), 1) << name_of(method) << ": by " << parameters[j].name;
}

/// The same, and the adjoint of all objectives equals the direct derivatives: to 1e-11 of the largest by what is
/// rounding, to 1e-9 by schemes that are iterated to 1e-10.
inline void expect_derivatives_in_both_modes(Scene scene, const Method& method) {
  expect_derivatives_of_the_oracle(scene, method);
  ask_for_objectives(scene);
  EXPECT_LE(difference_of_modes(scene, method), std::holds_alternative<UzawaAL>(method) ? 1e-9 : 1e-11)
      << name_of(method);
}

}  // namespace stickslip::scenes
