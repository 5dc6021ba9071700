/// The bar in the plane and in space, linear and of Green strain.
#include "core/solids/bar.hpp"

#include <gtest/gtest.h>

#include <limits>

#include "tests/support/derivatives.hpp"
#include "tests/support/largest.hpp"

namespace stickslip::bar_test {
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
  const Vec<double, D> force = BarLaw<double>{axial, 1}.template force<D>(X, stretch * along);
  const double rounding = 20 * epsilon * axial * stretch / length;  // some ten operations
  EXPECT_LE((force - axial * stretch / length * along).norm(), rounding);
}

TYPED_TEST(Bar, DoesNotResistMotionAcrossIt) {
  constexpr int D = TypeParam::value;
  const Mat<double, D, 2> X = derivatives::arbitrary(2 * D, 2).reshaped(D, 2);
  const Mat<double, D> k = BarLaw<double>{500, 1}.template stiffness<D>(X, Vec<double, D>::Zero());
  const double rounding = 20 * epsilon * largest_entry(k);  // products that cancel
  const Vec<double, D> along = (X.col(1) - X.col(0)).normalized();
  for (int i = 0; i < D; ++i) EXPECT_LE((k * (Vec<double, D>::Unit(i) - along[i] * along)).norm(), rounding);
  EXPECT_LE(largest_entry(k - k.transpose()), rounding);  // products in another order
}

TYPED_TEST(Bar, HasTheDerivativesOfTheComplexStep) {
  constexpr int D = TypeParam::value;
  auto stiffness = [](const auto& x) {  // coordinates, EA
    using T = typename std::decay_t<decltype(x)>::Scalar;
    const Mat<T, D, 2> X = x.head(2 * D).reshaped(D, 2);
    const Vec<T, D> none = Vec<T, D>::Constant(T(0));
    return Vector<T>(BarLaw<T>{x[2 * D], T(1)}.template stiffness<D>(X, none).reshaped());
  };
  Vector<double> x(2 * D + 1);
  x << derivatives::arbitrary(2 * D, 3), 2.0;
  EXPECT_LE(
      derivatives::relative_difference(derivatives::by_dual(stiffness, x), derivatives::by_complex_step(stiffness, x)),
      50 * epsilon);  // some twenty operations
}

TYPED_TEST(Bar, HasForceAndStiffnessOfItsEnergy) {
  constexpr int D = TypeParam::value;
  const Mat<double, D, 2> X = derivatives::arbitrary(2 * D, 4).reshaped(D, 2);
  const Vector<double> d = derivatives::arbitrary(D, 5);
  for (bool green : {false, true}) {
    const auto of = [&](auto&& f) {
      return [&X, f, green](const auto& stretch) {
        using T = typename std::decay_t<decltype(stretch)>::Scalar;
        const Mat<T, D, 2> places = X.unaryExpr([](double x) { return T(x); });
        return f(BarLaw<T>{T(7.0), T(1.0), green}, places, Vec<T, D>(stretch));
      };
    };
    const auto energy = of([](const auto& law, const auto& places, const auto& stretch) {
      using T = typename std::decay_t<decltype(stretch)>::Scalar;
      return Vector<T>::Constant(1, law.template energy<D>(places, stretch)).eval();
    });
    const auto force = of([](const auto& law, const auto& places, const auto& stretch) {
      using T = typename std::decay_t<decltype(stretch)>::Scalar;
      return Vector<T>(law.template force<D>(places, stretch));
    });
    const Matrix<double> stiffness = BarLaw<double>{7, 1, green}.template stiffness<D>(X, Vec<double, D>(d));
    // (some thirty operations each)
    EXPECT_LE(derivatives::relative_difference(derivatives::by_dual(energy, d).transpose(), force(d)), 50 * epsilon);
    EXPECT_LE(derivatives::relative_difference(stiffness, derivatives::by_dual(force, d)), 50 * epsilon);
  }
}

}  // namespace
}  // namespace stickslip::bar_test
