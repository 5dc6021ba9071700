/// What the tests of finite strain share: methods and schemes, and derivatives held against the complex step.
#pragma once

#include <gtest/gtest.h>

#include "core/model/response.hpp"
#include "tests/support/both_modes.hpp"
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

/// Derivatives of all responses at all increments equal the complex step of the whole run: to 1e-10 of the largest
/// where the scheme is exact, to 1e-9 where it is iterated to 1e-10, and to 50 u cond where that is more.
inline void expect_derivatives_of_the_oracle(const Scene& scene, const Method& method) {
  const auto s = run(scene, method);
  ASSERT_TRUE(is_converged(s.trajectory.status)) << name_of(method) << s.trajectory.message;
  ASSERT_EQ(s.gradients.of_responses.size(), s.trajectory.increments.size()) << s.gradients.message;
  const double allowed =
      std::max(std::holds_alternative<UzawaAL>(method) ? 1e-9 : 1e-10, 50 * unit_roundoff * s.condition);
  const auto last = evaluate_responses(s.model, s.slots, s.trajectory.increments.back().state, s.model.times.back());
  for (int j = 0; j < static_cast<int>(s.model.scene.parameters.size()); ++j) {
    const auto exact = oracle::complex_step(s.model, method, s.trajectory.step_table(), j);
    for (Eigen::Index r = 0; r < exact.rows(); ++r) {
      const double scale = std::max(largest_entry(exact.row(r)), std::abs(last[r] / s.model.scene.parameters[j].value));
      for (Eigen::Index n = 0; n < exact.cols(); ++n)
        EXPECT_NEAR(s.gradients.of_responses[n](r, j), exact(r, n), allowed * scale)
            << name_of(method) << " " << s.model.scene.responses[r].name << " by " << s.model.scene.parameters[j].name
            << ", increment " << n;
    }
  }
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
