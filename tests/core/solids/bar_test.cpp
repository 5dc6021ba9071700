/// The bar in the plane and in space.
#include "core/solids/bar.hpp"

#include <gtest/gtest.h>

#include <limits>

#include "tests/support/derivatives.hpp"
#include "tests/support/largest.hpp"

namespace stickslip {
namespace {

constexpr double epsilon = std::numeric_limits<double>::epsilon();

template <class D>
class Bar : public testing::Test {};
using Dimensions = testing::Types<std::integral_constant<int, 2>, std::integral_constant<int, 3>>;
TYPED_TEST_SUITE(Bar, Dimensions);

TYPED_TEST(Bar, PullsAlongItsDirectionByEAOverLength) {
  constexpr int D = TypeParam::value;
  const Mat<double, D, 2> X = derivatives::arbitrary(2 * D).reshaped(D, 2);
  const Vec<double, D> along = (X.col(1) - X.col(0)).normalized();
  const double length = (X.col(1) - X.col(0)).norm(), axial = 500, stretch = 0.01;
  Vector<double> u = Vector<double>::Zero(2 * D);
  u.tail(D) = stretch * along;
  const Vector<double> forces = bar_tangent<double, D>(X, axial) * u;
  const double rounding = 20 * epsilon * axial * stretch / length;  // some ten operations
  EXPECT_LE((forces.tail(D) - axial * stretch / length * along).norm(), rounding);
  EXPECT_LE((forces.head(D) + axial * stretch / length * along).norm(), rounding);
}

TYPED_TEST(Bar, ResistsNeitherTranslationNorMotionAcrossIt) {
  constexpr int D = TypeParam::value;
  const Mat<double, D, 2> X = derivatives::arbitrary(2 * D, 2).reshaped(D, 2);
  const Mat<double, 2 * D> K = bar_tangent<double, D>(X, 500.0);
  const double rounding = 20 * epsilon * largest_entry(K);  // products that cancel
  const Vec<double, D> along = (X.col(1) - X.col(0)).normalized();
  for (int i = 0; i < D; ++i) {
    Vector<double> both = Vector<double>::Zero(2 * D), across = both;
    both[i] = both[D + i] = 1;
    across.tail(D) = Vec<double, D>::Unit(i) - along[i] * along;
    EXPECT_LE((K * both).norm(), rounding);
    EXPECT_LE((K * across).norm(), rounding);
  }
  EXPECT_LE(largest_entry(K - K.transpose()), rounding);  // products in another order
}

TYPED_TEST(Bar, HasTheDerivativesOfTheComplexStep) {
  constexpr int D = TypeParam::value;
  auto tangent = [](const auto& x) {  // coordinates, EA
    using T = typename std::decay_t<decltype(x)>::Scalar;
    const Mat<T, D, 2> X = x.head(2 * D).reshaped(D, 2);
    return Vector<T>(bar_tangent<T, D>(X, x[2 * D]).reshaped());
  };
  Vector<double> x(2 * D + 1);
  x << derivatives::arbitrary(2 * D, 3), 2.0;
  EXPECT_LE(
      derivatives::relative_difference(derivatives::by_dual(tangent, x), derivatives::by_complex_step(tangent, x)),
      50 * epsilon);  // some twenty operations
}

}  // namespace
}  // namespace stickslip
