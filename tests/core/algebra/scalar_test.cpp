#include "core/algebra/scalar.hpp"

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <cmath>
#include <limits>
#include <type_traits>

#include "tests/core/algebra/every_operation.hpp"

namespace stickslip::scalar_test {
namespace {

using Complex = std::complex<double>;
constexpr double epsilon = std::numeric_limits<double>::epsilon();

// A derivative that is dropped without a word must not compile.
static_assert(!std::is_convertible_v<Dual<2>, double>);
static_assert(!std::is_convertible_v<Dual<2, Complex>, Complex>);
static_assert(!std::is_convertible_v<Dual<2, Complex>, double>);
static_assert(!std::is_convertible_v<Complex, double>);
static_assert(std::is_convertible_v<double, Dual<2>>);
static_assert(std::is_convertible_v<int, Dual<2>>);
static_assert(std::is_convertible_v<double, Dual<2, Complex>>);

TEST(Dual, HasTheKnownDerivativesOfEachFunction) {
  const double x = 1.3;
  const auto expect = [&](const Dual<1>& f, double primal, double derivative) {
    // One or two roundings each.
    EXPECT_NEAR(f.v, primal, 2 * epsilon * std::abs(primal));
    EXPECT_NEAR(f.d[0], derivative, 4 * epsilon * std::abs(derivative));
  };
  const auto t = Dual<1>::seed(x, 0);
  expect(t + t, 2 * x, 2);
  expect(t - Dual<1>(3.0), x - 3, 1);
  expect(Dual<1>(3.0) - t, 3 - x, -1);
  expect(-t, -x, -1);
  expect(t * t * t, x * x * x, 3 * x * x);
  expect(Dual<1>(1) / t, 1 / x, -1 / (x * x));
  expect(t / Dual<1>(4), x / 4, 0.25);
  expect(sqrt(t), std::sqrt(x), 0.5 / std::sqrt(x));
  expect(exp(t), std::exp(x), std::exp(x));
  expect(log(t), std::log(x), 1 / x);
  expect(sin(t), std::sin(x), std::cos(x));
  expect(cos(t), std::cos(x), -std::sin(x));
  expect(pow(t, 2.5), std::pow(x, 2.5), 2.5 * std::pow(x, 1.5));
}

TEST(Dual, AssignsInPlaceAsItComputes) {
  const auto a = Dual<2>::seed(1.7, 0), b = Dual<2>::seed(-0.6, 1);
  const auto same = [](const Dual<2>& p, const Dual<2>& q) { return p.v == q.v && (p.d == q.d).all(); };
  Dual<2> sum = a, difference = a, product = a, quotient = a, square = a, one = a;
  EXPECT_TRUE(same(sum += b, a + b));
  EXPECT_TRUE(same(difference -= b, a - b));
  EXPECT_TRUE(same(product *= b, a * b));
  EXPECT_TRUE(same(quotient /= b, a / b));
  EXPECT_TRUE(same(square *= square, a * a));  // the operand is the target
  EXPECT_TRUE(same(one /= one, a / a));
}

TEST(Dual, SeedsOneDirectionAndHoldsConstantsWithNone) {
  const auto x = Dual<3>::seed(2.0, 1);
  EXPECT_EQ(x.v, 2.0);
  EXPECT_TRUE((x.d == Eigen::Array3d(0, 1, 0)).all());
  EXPECT_TRUE((Dual<3>(5.0).d == 0).all());
  EXPECT_EQ(Dual<3>().v, 0.0);
  EXPECT_TRUE((Dual<3>().d == 0).all());
}

TEST(Dual, AgreesWithTheComplexStep) {
  const double h = 1e-100;  // the complex step subtracts nothing, so that it has no least step
  for (const double x : {0.6, 1.0, 1.9})
    for (const double y : {0.7, 1.2, 1.8}) {
      const auto f = everything(Dual<2>::seed(x, 0), Dual<2>::seed(y, 1));
      const double by_x = everything(Complex(x, h), Complex(y)).imag() / h;
      const double by_y = everything(Complex(x), Complex(y, h)).imag() / h;
      EXPECT_NEAR(f.v, everything(x, y), 10 * epsilon * std::abs(f.v));
      // Some twenty operations, each with a rounding or two.
      EXPECT_NEAR(f.d[0], by_x, 100 * epsilon * std::max(1.0, std::abs(by_x)));
      EXPECT_NEAR(f.d[1], by_y, 100 * epsilon * std::max(1.0, std::abs(by_y)));
    }
}

TEST(Dual, CarriesSecondDerivativesOnComplexNumbers) {
  // The imaginary part of a Dual over complex numbers is the derivative of value and gradient alike.
  const double x = 1.1, y = 0.8, h = 1e-100;
  using Second = Dual<2, Complex>;
  const auto f = everything(Second::seed(Complex(x, h), 0), Second::seed(Complex(y), 1));
  const auto first = everything(Dual<2>::seed(x, 0), Dual<2>::seed(y, 1));
  EXPECT_NEAR(f.v.real(), first.v, 10 * epsilon * std::abs(first.v));
  EXPECT_NEAR(f.v.imag() / h, first.d[0], 100 * epsilon * std::abs(first.d[0]));
  EXPECT_NEAR(f.d[1].real(), first.d[1], 100 * epsilon * std::abs(first.d[1]));
  const auto g = everything(Second::seed(Complex(x), 0), Second::seed(Complex(y, h), 1));
  // The mixed derivative, taken in either order.
  EXPECT_NEAR(f.d[1].imag() / h, g.d[0].imag() / h, 1000 * epsilon * std::abs(g.d[0].imag() / h));
  // Against central differences of the gradient: step^2 and rounding over step are both about 1e-10.
  const double step = 1e-5;
  const auto up = everything(Dual<2>::seed(x + step, 0), Dual<2>::seed(y, 1));
  const auto down = everything(Dual<2>::seed(x - step, 0), Dual<2>::seed(y, 1));
  EXPECT_NEAR(f.d[0].imag() / h, (up.d[0] - down.d[0]) / (2 * step), 1e-7 * std::abs(f.d[0].imag() / h));
}

TEST(Dual, WorksOnComplexNumbersAsOnReal) {
  const auto real = everything(Dual<2>::seed(1.4, 0), Dual<2>::seed(0.9, 1));
  const auto complex = everything(Dual<2, Complex>::seed(1.4, 0), Dual<2, Complex>::seed(0.9, 1));
  for (int i = 0; i < 2; ++i) {
    EXPECT_NEAR(complex.d[i].real(), real.d[i], 100 * epsilon * std::abs(real.d[i]));
    EXPECT_NEAR(complex.d[i].imag(), 0, 100 * epsilon * std::abs(real.d[i]));
  }
}

TEST(Dual, FillsEigenMatrices) {
  // x = A^-1 b by Cramer's rule and d(det A)/dA = cofactors, with the entries of A as the directions.
  using D = Dual<4>;
  Mat<D, 2> a;
  a << D::seed(2.0, 0), D::seed(1.0, 1), D::seed(-0.5, 2), D::seed(3.0, 3);
  const Vec<D, 2> x(D(1.0), D(2.0));
  const Vec<D, 2> y = a * x;
  EXPECT_EQ(y[0].v, 4.0);
  EXPECT_TRUE((y[0].d == Eigen::Array4d(1, 2, 0, 0)).all());
  EXPECT_TRUE((y[1].d == Eigen::Array4d(0, 0, 1, 2)).all());
  const D determinant = a(0, 0) * a(1, 1) - a(0, 1) * a(1, 0);
  EXPECT_EQ(determinant.v, 6.5);
  EXPECT_TRUE((determinant.d == Eigen::Array4d(3.0, 0.5, -1.0, 2.0)).all());
  const Vec<D, 2> scaled = y * 2.0;  // a plain number on a Dual expression
  EXPECT_EQ(scaled[0].d[1], 4.0);
  const Mat<D, 2> product = a.transpose() * a;
  EXPECT_EQ(product(0, 1).v, 2.0 * 1.0 - 0.5 * 3.0);
  EXPECT_TRUE((product(0, 1).d == Eigen::Array4d(1.0, 2.0, 3.0, -0.5)).all());
}

TEST(Value, IsThePrimalPartAtAnyDepth) {
  EXPECT_EQ(value(1.5), 1.5);
  EXPECT_EQ(value(Complex(1.5, 9)), 1.5);
  EXPECT_EQ(value(Dual<2>::seed(1.5, 1)), 1.5);
  EXPECT_EQ(value(Dual<2, Complex>::seed(Complex(1.5, 9), 1)), 1.5);
  const Vec<Dual<2>, 2> x(Dual<2>::seed(1.5, 0), Dual<2>(-4.0));
  EXPECT_EQ(values(x), Eigen::Vector2d(1.5, -4.0));
}

TEST(DotAndNorm, DoNotConjugate) {
  const double h = 1e-100;
  const Vec<Complex, 2> x(Complex(3, h), Complex(4, 0));
  EXPECT_EQ(dot(x, x).imag() / h, 6.0);  // 2 x_0: conjugation would leave zero
  EXPECT_EQ(norm(x).real(), 5.0);
  EXPECT_NEAR(norm(x).imag() / h, 0.6, epsilon);  // x_0 / |x|
  const Vec<Dual<2>, 2> y(Dual<2>::seed(3.0, 0), Dual<2>::seed(4.0, 1));
  EXPECT_EQ(norm(y).v, 5.0);
  EXPECT_NEAR(norm(y).d[0], 0.6, epsilon);
  EXPECT_NEAR(norm(y).d[1], 0.8, epsilon);
}

}  // namespace
}  // namespace stickslip::scalar_test
