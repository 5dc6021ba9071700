/// B2: the GRECO plate (code_aster SSNV128), the best sourced friction test.
#include <gtest/gtest.h>

#include "tests/support/solved.hpp"

namespace stickslip::greco_plate_test {
namespace {

using scenes::run;

/// Values printed with four digits (displacements) and six (resultant) for n = 32.
constexpr double printed = 1e-3;

TEST(GrecoPlate, HasThePublishedStatesDisplacementsAndDerivatives) {
  UzawaAL tight;
  tight.tolerance = 1e-12;
  for (const Method& method : {Method(MonolithicAL{}), Method(tight)}) {
    const auto s = run(scenes::greco_plate(32), method);
    ASSERT_TRUE(is_converged(s.trajectory.status));
    int stick = 0, slip = 0;
    for (ContactState state : s.trajectory.increments.back().state.contact.state) {
      stick += state == ContactState::stick;
      slip += state == ContactState::slip;
    }
    EXPECT_EQ(stick, 8);
    EXPECT_EQ(slip, 21);
    const double expected[] = {2.859e-5, 2.722e-5, 2.285e-5, 1.980e-5, 1.541e-5};
    for (int i = 0; i < 5; ++i) EXPECT_NEAR(s.value("u" + std::to_string(i)), expected[i], printed * expected[i]);
    EXPECT_NEAR(-s.value("friction"), 1.40537e6, printed * 1.40537e6);
    EXPECT_NEAR(s.derivative("u0", "mu"), -5.7028e-6, printed * 5.7028e-6);
    EXPECT_NEAR(s.derivative("u0", "F"), 2.86775e-13, printed * 2.86775e-13);
    EXPECT_NEAR(-s.derivative("friction", "mu"), 4.7565e5, printed * 4.7565e5);
    // linearity: a single stiffness scales all displacements under dead loads, whatever the contact does
    EXPECT_NEAR(s.derivative("u0", "E"), -s.value("u0") / 1.3e11, 1e-9 * s.value("u0") / 1.3e11);
  }
}

TEST(GrecoPlate, NeedsFewIterationsOnEveryMeshFromAutomaticScales) {
  int before = 0;
  for (int n : {16, 32, 64, 128}) {
    for (const Method& method : {Method(MonolithicAL{}), Method(Penalty{})}) {
      const auto s = run(scenes::greco_plate(n), method);
      ASSERT_EQ(s.trajectory.status, Status::converged) << n;
      EXPECT_LE(s.trajectory.increments.back().newton, 12) << n << " " << name_of(method);
    }
    const auto s = run(scenes::greco_plate(n), MonolithicAL{});
    const int newton = s.trajectory.increments.back().newton;
    if (before > 0) {
      EXPECT_LE(newton, before + 2) << n;  // B9: nearly mesh independent
    }
    before = newton;
  }
}

TEST(GrecoPlate, MonolithicSolutionDoesNotDependOnItsScale) {
  const auto reference = run(scenes::greco_plate(16), MonolithicAL{});
  for (double scale : {1e-3, 1e-1, 1e1, 1e3}) {
    const auto s = run(scenes::greco_plate(16), MonolithicAL{scenes::relative(scale)});
    ASSERT_EQ(s.trajectory.status, Status::converged) << scale;
    for (const char* name : {"u0", "u3", "friction"})
      // rounding of the tangent's solves, magnified by a condition number of about 1e5 to 1e6
      EXPECT_NEAR(s.value(name), reference.value(name), 1e-9 * std::abs(reference.value(name))) << scale;
  }
}

TEST(GrecoPlate, PenaltyErrorOfResponseAndDerivativeFallsWithSlopeMinusOne) {
  const auto reference = run(scenes::greco_plate(16), MonolithicAL{});
  double response_before = 0, derivative_before = 0;
  for (double stiffness : {1e3, 1e4, 1e5, 1e6}) {
    const auto s = run(scenes::greco_plate(16), Penalty{scenes::relative(stiffness)});
    ASSERT_TRUE(is_converged(s.trajectory.status)) << stiffness;
    const double response = std::abs(s.value("friction") / reference.value("friction") - 1);
    const double derivative = std::abs(s.derivative("friction", "mu") / reference.derivative("friction", "mu") - 1);
    if (response_before > 0) {
      EXPECT_NEAR(std::log10(response_before / response), 1, 0.05) << stiffness;
      EXPECT_NEAR(std::log10(derivative_before / derivative), 1, 0.05) << stiffness;
    }
    response_before = response;
    derivative_before = derivative;
  }
}

}  // namespace
}  // namespace stickslip::greco_plate_test
