/// Extrapolated difference quotients: their error estimate covers what a noisy function leaves, and hides no more.
#include "sensitivity/quotients.hpp"

#include <gtest/gtest.h>

#include <random>

namespace stickslip::quotients_test {
namespace {

constexpr double steps[] = {1e-2, 1e-3, 1e-4, 1e-5, 1e-6, 1e-7};

/// exp(x + 0.1 n) at x = 1, of increments n, with noise of one deviation `size`; `order` 2: central, 1: from above.
Quotients noisy_quotients(int order, int increments, double size, unsigned seed) {
  std::mt19937 chance(seed);
  std::normal_distribution<double> noise(0, size);
  Quotients quotients{order, {}, {}};
  const auto f = [&](double x, int n) { return std::exp(x + 0.1 * n) + noise(chance); };
  std::vector<double> base;
  for (int n = 0; n < increments; ++n) base.push_back(f(1, n));
  for (double h : steps) {
    quotients.step.push_back(h);
    quotients.values.emplace_back(1, increments);
    for (int n = 0; n < increments; ++n)
      quotients.values.back()(0, n) = order == 2 ? (f(1 + h, n) - f(1 - h, n)) / (2 * h) : (f(1 + h, n) - base[n]) / h;
  }
  return quotients;
}

double derivative(int n) { return std::exp(1 + 0.1 * n); }

TEST(Quotients, EstimateCoversTheErrorWhateverTheNoise) {
  // 6000 derivatives: one deviation of noise in 2 deviations allowed leaves none outside but by the spread's own chance
  int outside = 0;
  for (int order : {2, 1})
    for (double size : {0.0, 1e-16, 1e-14, 1e-12})
      for (int increments : {1, 5})
        for (unsigned seed = 0; seed < 250; ++seed) {
          const auto quotients = noisy_quotients(order, increments, size, seed);
          const double level = std::max(1e-15, noise(quotients, 0));  // rounding of the values
          for (int n = 0; n < increments; ++n) {
            const auto best = extrapolate(quotients, 0, n, level);
            outside += std::abs(best.value - derivative(n)) > std::max(best.estimate, 1e-8);
          }
        }
  EXPECT_EQ(outside, 0);
}

TEST(Quotients, EstimateSeesADerivativeThatIsWrongByAMillionth) {
  for (int order : {2, 1})
    for (double size : {1e-16, 1e-14, 1e-13})
      for (unsigned seed = 0; seed < 250; ++seed) {
        const auto quotients = noisy_quotients(order, 3, size, seed);
        const auto best = extrapolate(quotients, 0, 1, std::max(1e-15, noise(quotients, 0)));
        EXPECT_GT(std::abs(best.value - (1 + 1e-6) * derivative(1)), best.estimate) << order << " " << size;
      }
}

TEST(Quotients, StepsWithoutAQuotientAreLeftOut) {
  auto quotients = noisy_quotients(2, 2, 1e-16, 1);
  for (int k : {0, 1, 5}) quotients.values[k](0, 1) = std::numeric_limits<double>::quiet_NaN();
  EXPECT_EQ(quotients.count(0, 0), 6);
  EXPECT_EQ(quotients.count(0, 1), 3);
  const auto best = extrapolate(quotients, 0, 1, 1e-15);
  EXPECT_NEAR(best.value, derivative(1), best.estimate);
  EXPECT_LT(best.estimate, 1e-8);  // noise over the step of 1e-5 or 1e-4
}

TEST(Quotients, OfWhatDoesNotChangeAreExact) {
  Quotients quotients{2, {1e-2, 1e-3, 1e-4}, {}};
  for (int k = 0; k < 3; ++k) quotients.values.push_back(Matrix<double>::Constant(1, 1, 5));
  EXPECT_EQ(noise(quotients, 0), 0);
  EXPECT_EQ(extrapolate(quotients, 0, 0, 0).value, 5);
  EXPECT_EQ(extrapolate(quotients, 0, 0, 0).estimate, 0);
}

}  // namespace
}  // namespace stickslip::quotients_test
