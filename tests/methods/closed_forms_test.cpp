/// A1 to A3: one point, closed forms of the solution, of each method's own error and of its derivatives, for the
/// printed parameters and for others.
#include <gtest/gtest.h>

#include "tests/support/solved.hpp"

namespace stickslip::closed_forms_test {
namespace {

using scenes::absolute;
using scenes::relative;
using scenes::run;

/// Agreement demanded of closed forms: a few roundings in a system of one or two unknowns, with room for the factor
/// rho/k between a traction and the gap it is made of.
constexpr double closed = 1e-10;

void expect_close(double computed, double exact, double scale, const std::string& what) {
  EXPECT_NEAR(computed, exact, closed * std::max(std::abs(exact), std::abs(scale))) << what;
}

struct StopCase {
  double F, k, g0, rho;
};

class Stop : public testing::TestWithParam<StopCase> {};

TEST_P(Stop, PenaltyMeetsItsOwnClosedFormAndDerivatives) {
  const auto [F, k, g0, eps] = GetParam();
  const auto s = run(scenes::stop(F, k, g0), Penalty{absolute(eps)});
  const double u = (F + eps * g0) / (k + eps), lambda = F - k * g0;
  expect_close(s.value("u"), u, 0, "u");
  expect_close(s.value("press"), lambda * eps / (k + eps), 0, "force");
  expect_close(s.derivative("u", "F"), 1 / (k + eps), 0, "du/dF");
  expect_close(s.derivative("u", "k"), -u / (k + eps), 0, "du/dk");
  expect_close(s.derivative("u", "g0"), eps / (k + eps), 0, "du/dg0");
  expect_close(s.derivative("press", "F"), eps / (k + eps), 0, "dlambda/dF");
  expect_close(s.derivative("press", "k"), -eps * u / (k + eps), 0, "dlambda/dk");
  expect_close(s.derivative("press", "g0"), -eps * k / (k + eps), 0, "dlambda/dg0");
}

TEST_P(Stop, PenaltyKnowsTheDerivativeWithRespectToItsStiffness) {
  const auto [F, k, g0, eps] = GetParam();
  auto scene = scenes::stop(F, k, g0);
  Penalty method;
  method.stiffness = {Regularisation::Kind::absolute, scenes::parameter(scene, "eps", eps)};
  const auto s = run(scene, method);
  const double lambda = F - k * g0;
  expect_close(s.derivative("press", "eps"), k * lambda / ((k + eps) * (k + eps)), 0, "dlambda/deps");
}

TEST_P(Stop, UzawaIteratesAndTruncatedDerivativesFollowTheGeometricSeries) {
  const auto [F, k, g0, rho] = GetParam();
  const double lambda = F - k * g0, theta = k / (k + rho);
  for (int i = 1; i <= 8; ++i) {
    UzawaAL method;
    method.scale = absolute(rho);
    method.adapt = false;
    method.tolerance = 1e-15;
    method.max_augmentations = i;
    method.sensitivity = UzawaAL::Sensitivity::truncated;
    const auto s = run(scenes::stop(F, k, g0), method);
    ASSERT_EQ(s.trajectory.status, Status::cap);
    ASSERT_EQ(s.trajectory.increments.back().augmentations, i);
    const double left = std::pow(theta, i);
    expect_close(s.value("press"), lambda * (1 - left), 0, "lambda_i");
    expect_close(s.value("u") - g0, lambda * std::pow(theta, i - 1) / (k + rho), g0, "penetration_i");
    expect_close(s.derivative("press", "F"), 1 - left, 0, "dlambda_i/dF");
    expect_close(s.derivative("press", "k"),
                 -g0 * (1 - left) - lambda * i * std::pow(theta, i - 1) * rho / ((k + rho) * (k + rho)), 0,
                 "dlambda_i/dk");
    expect_close(s.derivative("press", "g0"), -k * (1 - left), 0, "dlambda_i/dg0");
  }
}

TEST_P(Stop, UzawaContractsByThetaAndItsIteratedDerivativesAreExact) {
  const auto [F, k, g0, rho] = GetParam();
  UzawaAL method;
  method.scale = absolute(rho);
  method.adapt = false;
  method.tolerance = 1e-9;
  method.max_augmentations = 5000;
  const auto coarse = run(scenes::stop(F, k, g0), method);
  ASSERT_TRUE(is_converged(coarse.trajectory.status));
  // the last ratio is formed from updates of about 1e-9 of lambda: a rounding of it is 1e-7 of an update
  EXPECT_NEAR(coarse.trajectory.increments.back().contraction, k / (k + rho), 1e-6);
  method.tolerance = 1e-13;
  const auto s = run(scenes::stop(F, k, g0), method);
  expect_close(s.derivative("press", "F"), 1, 0, "dlambda/dF");
  expect_close(s.derivative("press", "k"), -g0, 0, "dlambda/dk");
  expect_close(s.derivative("press", "g0"), -k, 0, "dlambda/dg0");
  expect_close(s.derivative("u", "F"), 0, 1 / k, "du/dF");
  expect_close(s.derivative("u", "g0"), 1, 0, "du/dg0");
}

TEST_P(Stop, OversizedIsOneGiantStepOfTheRecursion) {
  const auto [F, k, g0, rho] = GetParam();
  for (double kappa : {1e1, 1e3, 1e5}) {
    UzawaAL method;
    method.scale = absolute(rho);
    method.adapt = false;
    method.tolerance = 1e-13;
    method.max_augmentations = 10000;
    method.sensitivity = UzawaAL::Sensitivity::oversized;
    method.oversize = kappa;
    const auto s = run(scenes::stop(F, k, g0), method);
    expect_close(s.derivative("u", "g0"), kappa * rho / (k + kappa * rho), 0, "du/dg0");
    expect_close(s.derivative("press", "F"), kappa * rho / (k + kappa * rho), 0, "dlambda/dF");
    ASSERT_EQ(s.gradients.counters.sensitivity_backsolves, 3);
  }
}

TEST_P(Stop, MonolithicIsExactForEveryScaleInTwoSteps) {
  const auto [F, k, g0, unused] = GetParam();
  for (double scale = 1e-6; scale < 2e6; scale *= 10) {
    const auto s = run(scenes::stop(F, k, g0), MonolithicAL{relative(scale)});
    ASSERT_EQ(s.trajectory.status, Status::converged) << scale;
    EXPECT_LE(s.trajectory.increments.back().newton, 3) << scale;
    expect_close(s.value("u"), g0, 0, "u");
    expect_close(s.value("press"), F - k * g0, 0, "lambda");
    expect_close(s.derivative("u", "F"), 0, 1 / k, "du/dF");
    expect_close(s.derivative("u", "k"), 0, g0 / k, "du/dk");
    expect_close(s.derivative("u", "g0"), 1, 0, "du/dg0");
    expect_close(s.derivative("press", "F"), 1, 0, "dlambda/dF");
    expect_close(s.derivative("press", "k"), -g0, 0, "dlambda/dk");
    expect_close(s.derivative("press", "g0"), -k, 0, "dlambda/dg0");
  }
}

// C11: an interference closes in one increment; the others are A1 and two of other sizes
INSTANTIATE_TEST_SUITE_P(A1, Stop,
                         testing::Values(StopCase{15, 1000, 0.01, 1e4}, StopCase{7.25, 310, 0.004, 155},
                                         StopCase{2e-3, 1e-2, 0.1, 0.37}, StopCase{15, 1000, -0.01, 2.5e3}));

TEST(Stop, MonolithicDerivativeWithRespectToItsOwnScaleVanishesAndOfATruncatedSolveThereIsNone) {
  for (int cap : {50, 1}) {
    auto scene = scenes::stop();
    MonolithicAL method;
    method.scale = {Regularisation::Kind::relative, scenes::parameter(scene, "scale", 0.7)};
    method.newton.max_iterations = cap;
    const auto s = run(scene, method);
    if (cap == 1) {
      EXPECT_EQ(s.trajectory.status, Status::cap);
      EXPECT_TRUE(s.gradients.of_responses.empty());
    } else {
      EXPECT_LE(std::abs(s.derivative("press", "scale")) * 0.7, 1e-12 * 5);  // of the response
    }
  }
}

// --- A2 --------------------------------------------------------------------------------------------------------------

const std::vector<Method>& exact_methods() {
  static const std::vector<Method> all = [] {
    UzawaAL uzawa;
    uzawa.tolerance = 1e-13;
    return std::vector<Method>{uzawa, MonolithicAL{}};
  }();
  return all;
}

TEST(Slider, FollowsItsCycleWithAnyNumberOfSteps) {  // (C16: one a leg)
  const double k = 100, mu = 0.3, N = 10, U0 = 0.1, lag = mu * N / k;
  for (const auto& method : exact_methods())
    for (int steps : {3, 30, 3000}) {
      const auto s = run(scenes::slider({{0, 0}, {1, U0}, {2, -U0}, {3, U0}}, steps), method);
      ASSERT_TRUE(is_converged(s.trajectory.status)) << name_of(method);
      const int leg = steps / 3;
      for (int turn = 0; turn < 3; ++turn)
        EXPECT_NEAR(s.value("u", (turn + 1) * leg - 1), (turn == 1 ? -1 : 1) * (U0 - lag), 1e-12) << name_of(method);
      EXPECT_NEAR(s.value("heat"), mu * N * (U0 - lag) + 4 * mu * N * (U0 - lag), closed);
      EXPECT_NEAR(s.derivative("u", "mu"), -N / k, closed);
      EXPECT_NEAR(s.derivative("u", "N"), -mu / k, closed);
      EXPECT_NEAR(s.derivative("u", "k"), mu * N / (k * k), closed);
      EXPECT_NEAR(s.derivative("u", "U0"), 1, closed);
    }
}

TEST(Slider, SensitivityRemembersTheReversal) {
  for (const auto& method : exact_methods()) {
    const auto stuck = run(scenes::slider({{0, 0}, {1, 0.05}, {2, 0}}, 8), method);
    EXPECT_NEAR(stuck.value("u"), 0.02, 1e-12);
    EXPECT_NEAR(stuck.derivative("u", "U0"), 1, closed);
    EXPECT_NEAR(stuck.derivative("u", "mu"), -0.1, closed);
    const auto slid = run(scenes::slider({{0, 0}, {1, 0.1}, {2, 0}}, 8), method);
    EXPECT_NEAR(slid.value("u"), 0.03, 1e-12);
    EXPECT_NEAR(slid.derivative("u", "U0"), 0, closed);
    EXPECT_NEAR(slid.derivative("u", "mu"), 0.1, closed);
  }
}

TEST(Slider, PenaltyCreepsByItsOwnClosedForm) {
  // The floor gives way too: the normal force is N eps / (k + eps). First loading slips to U - mu N' / k; on the way
  // back the block sticks and only the elastic slip stored there is taken back.
  const double k = 100, mu = 0.3, N = 10, eps = 2500, U = 0.05, share = eps / (k + eps);
  const auto s = run(scenes::slider({{0, 0}, {1, U}, {2, 0}}, 10), Penalty{absolute(eps)});
  const double bound = mu * N * share, slipped = U - bound / k;
  EXPECT_NEAR(s.value("press"), N * share, closed * N);
  EXPECT_NEAR(s.value("u", 4), slipped, closed);
  EXPECT_NEAR(s.value("u"), (eps * slipped - bound) / (k + eps), closed);
  EXPECT_NEAR(s.derivative("u", "U0"), share, closed);
  EXPECT_NEAR(s.derivative("u", "mu"), (eps / k + 1) * -N * share / (k + eps), closed);
  EXPECT_NEAR(s.derivative("u", "N"), (eps / k + 1) * -mu * share / (k + eps), closed);
}

// --- A3 --------------------------------------------------------------------------------------------------------------

TEST(DraggedPoint, FollowsTheTractrixToFirstOrder) {
  // start (0, 0.6), driver along x from the origin: exact end and derivative with respect to c = mu N / k
  const double exact_x = 2.0027245810, exact_y = 0.0737681415 - 0.6, dx = -0.98530359, dy = 0.23561588;
  for (const auto& method : exact_methods()) {
    std::vector<double> position, derivative;
    for (int n : {30, 300, 3000}) {
      // the anchor first goes straight down within the stick range, then along x; only the end of the path matters
      const auto s = run(scenes::dragged_point({{0, 0, 0}, {1, 0, -0.6}, {4, 3, -0.6}}, n + n / 3, 1), method);
      ASSERT_TRUE(is_converged(s.trajectory.status)) << name_of(method) << " " << n;
      position.push_back(std::hypot(s.value("x") - exact_x, s.value("y") - exact_y));
      const double dmu = 10.0;  // c = 10 mu
      derivative.push_back(std::hypot(s.derivative("x", "mu") / dmu - dx, s.derivative("y", "mu") / dmu - dy));
    }
    EXPECT_NEAR(position[0], 7.61e-3, 0.02e-3) << name_of(method);  // printed to three digits
    EXPECT_NEAR(position[1], 7.72e-4, 0.01e-4);
    EXPECT_NEAR(position[2], 7.73e-5, 0.01e-5);
    EXPECT_NEAR(std::log10(derivative[1] / derivative[2]), 1, 0.05);  // order 1, with its second-order remainder
  }
}

TEST(DraggedPoint, CirclesAtTheExactDiscreteRadius) {
  const double c = 0.6, R = 1;
  for (int N : {20, 100}) {
    std::vector<std::array<double, 3>> path{{0, 0, 0}};
    const int turns = 6;
    for (int i = 1; i <= N * turns; ++i) {
      const double angle = 2 * M_PI * i / N;
      path.push_back({double(i), R * std::cos(angle) - R, R * std::sin(angle)});
    }
    const auto s = run(scenes::dragged_point(path, N * turns, c), MonolithicAL{});
    const double step = std::sin(M_PI / N);
    const double radius = -c * step + std::sqrt(c * c * step * step + R * R - c * c);
    // the centre of the driver is at (-R, 0); the transient has died out by a factor below 1e-12 after six turns
    EXPECT_NEAR(std::hypot(s.value("x") + R, s.value("y")), radius, 1e-9) << N;
  }
}

}  // namespace
}  // namespace stickslip::closed_forms_test
