// A bar on a rough floor, pulled at one end until slip has run two thirds of its length, let go, and
// cycled. Nodes carry lumped friction, so the discrete solution is known for every number of cells:
//   force in bar i while loading   N_i = max(0, P - f h (i - 1/2)),     f = mu w
//   of which letting go takes      M_i = max(0, P - 2 f h (i - 1/2))    (slip reverses against twice the cap)
#include <gtest/gtest.h>

#include <cmath>

#include "tests/support/solved.hpp"

namespace stickslip::pull_out_test {
namespace {

using namespace scenes;

constexpr double EA = 1000, L = 1, mu = 0.3, w = 100, P = 20;  // those of scenes::pull_out

/// Discrete closed form, per unit of the load factors of loading (1) and of letting go (reversed).
struct Discrete {
  double u = 0, du_dmu = 0, du_dP = 0, heat = 0;

  /// `caps` times the friction, `load` on the end.
  Discrete(int n, double caps, double load) {
    const double h = L / n;
    std::vector<double> at(n + 1, 0.0);
    for (int i = n; i >= 1; --i) {
      const double force = load - caps * mu * w * h * (i - 0.5);
      at[i - 1] = at[i];
      if (force <= 0) continue;
      at[i - 1] += h * force / EA;
      du_dmu -= h / EA * caps * w * h * (i - 0.5);
      du_dP += h / EA;
    }
    u = at[0];
    for (int i = 0; i <= n; ++i) heat += mu * w * h * (i == 0 || i == n ? 0.5 : 1) * at[i];
  }
};

/// Relative to the size of the answer. Errors of 1e-12 (Newton) to 1e-10 (Uzawa) meet the condition of the chain, n^2
/// at worst.
constexpr double same = 1e-8;

class PullOut : public testing::TestWithParam<int> {};

std::vector<Method> enforcing_methods() {
  UzawaAL uzawa;
  uzawa.tolerance = 1e-12;
  return {MonolithicAL{}, uzawa};
}

TEST_P(PullOut, IsExactUnderLoadForAnyStepCount) {
  const int n = GetParam();
  const Discrete exact(n, 1, P);
  for (const auto& method : enforcing_methods())
    for (int steps : {1, 4, 7}) {
      const auto s = run(pull_out(n, {0, 1}, steps), method);
      ASSERT_TRUE(is_converged(s.trajectory.status)) << name_of(method) << " " << steps << s.trajectory.message;
      EXPECT_EQ(s.trajectory.counters.cutbacks, 0) << name_of(method) << " " << steps;
      EXPECT_NEAR(s.value("u"), -exact.u, same * exact.u);
      EXPECT_NEAR(s.derivative("u", "mu"), -exact.du_dmu, same * exact.u / mu);
      EXPECT_NEAR(s.derivative("u", "P"), -exact.du_dP, same * exact.u / P);
      EXPECT_NEAR(s.derivative("u", "EA"), exact.u / EA, same * exact.u / EA);
      EXPECT_NEAR(s.value("heat"), exact.heat, same * exact.heat);
    }
}

TEST_P(PullOut, LeavesTheExactResidualDisplacementWhenLetGo) {
  const int n = GetParam();
  const Discrete forth(n, 1, P), back(n, 2, P);
  for (const auto& method : enforcing_methods())
    for (int steps : {1, 4}) {
      const auto s = run(pull_out(n, {0, 1, 0}, steps), method);
      ASSERT_TRUE(is_converged(s.trajectory.status)) << name_of(method) << " " << steps << s.trajectory.message;
      EXPECT_NEAR(s.value("u"), -(forth.u - back.u), same * forth.u) << name_of(method) << " " << steps;
      EXPECT_NEAR(s.derivative("u", "mu"), -(forth.du_dmu - back.du_dmu), same * forth.u / mu);
      EXPECT_NEAR(s.derivative("u", "P"), -(forth.du_dP - back.du_dP), same * forth.u / P);
    }
}

TEST_P(PullOut, ClosesItsCycle) {
  const int n = GetParam();
  const Discrete forth(n, 1, P), reversed(n, 2, 2 * P);
  for (const auto& method : enforcing_methods())
    for (int steps : {1, 4}) {
      const auto s = run(pull_out(n, {0, 1, -1, 1}, steps), method);
      ASSERT_TRUE(is_converged(s.trajectory.status)) << name_of(method) << " " << steps << s.trajectory.message;
      EXPECT_NEAR(s.value("u"), -forth.u, same * forth.u) << name_of(method) << " " << steps;
      EXPECT_NEAR(s.derivative("u", "P"), -forth.du_dP, same * forth.u / P);
      // twice the slip of the first load, twice over: D1 + 4 D1 = the first load and one cycle
      EXPECT_NEAR(s.value("heat"), forth.heat + 2 * reversed.heat, same * 5 * forth.heat);
      // the continuum's 2 P^3 / 3 EA f a cycle, reached as the square of the mesh size: half of (f h / P)^2 was
      // measured
      const double f = mu * w, cycle = 2 * P * P * P / (3 * EA * f), mesh = f * L / n / P;
      EXPECT_LT(std::abs(s.value("heat") - forth.heat - cycle), mesh * mesh * cycle);
    }
}

TEST_P(PullOut, PenaltyErrsByTheInverseOfItsStiffness) {
  const int n = GetParam();
  const Discrete exact(n, 1, P);
  double before = 0;
  for (double stiffness : {1e3, 1e4, 1e5}) {
    Penalty penalty;
    penalty.stiffness = relative(stiffness);
    const auto s = run(pull_out(n, {0, 1}, 4), penalty);
    ASSERT_TRUE(is_converged(s.trajectory.status)) << stiffness << s.trajectory.message;
    const double error = std::abs(s.value("u") / -exact.u - 1);
    if (before > 0) {
      EXPECT_NEAR(std::log10(before / error), 1, 0.05) << stiffness;  // slope -1 within 5 %
    }
    before = error;
  }
  const auto cycled = run(pull_out(n, {0, 1, -1, 1, 0}, 4), Penalty{});
  EXPECT_TRUE(is_converged(cycled.trajectory.status));
}

TEST_P(PullOut, CostsAboutAFactorisationForEachNodeTheFrontPasses) {
  const int n = GetParam();
  const auto s = run(pull_out(n, {0, 1}, 4), MonolithicAL{});
  // the front passes 2 n / 3 nodes, one an iteration, and a step adds one to find that it has stopped
  EXPECT_LE(s.trajectory.counters.newton, 2 * n / 3 + 2 * 4);
}

INSTANTIATE_TEST_SUITE_P(A4, PullOut, testing::Values(10, 30, 100));

}  // namespace
}  // namespace stickslip::pull_out_test
