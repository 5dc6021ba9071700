/// The projection on the friction cone, with one and two tangents: what makes it a projection, ties, and the derivative
/// of each branch.
#include "core/contact/friction_cone.hpp"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <limits>
#include <vector>

#include "tests/support/derivatives.hpp"

namespace stickslip::friction_cone_test {
namespace {

constexpr double epsilon = std::numeric_limits<double>::epsilon();
constexpr double nan = std::numeric_limits<double>::quiet_NaN();

template <int Tangents>
Traction<double, Tangents> traction(double normal, const Vec<double, Tangents>& tangential) {
  Traction<double, Tangents> t;
  t.normal = normal;
  t.tangential = tangential;
  return t;
}

template <int Tangents>
struct Projected {
  ContactState state;
  Traction<double, Tangents> traction;
};

/// Classified and projected, the cone's radius from the trial itself.
template <int Tangents>
Projected<Tangents> project(const Traction<double, Tangents>& trial, double mu) {
  const double bound = -mu * trial.normal;
  const ContactState state = classify(trial, bound, 0);
  return {state, project_onto_cone(trial, bound, state)};
}

/// A trial traction and a coefficient of friction.
template <int Tangents>
struct Case {
  Traction<double, Tangents> trial;
  double mu;
};

/// Trials in every branch and on every border, over many orders of magnitude.
template <int Tangents>
std::vector<Case<Tangents>> cases() {
  std::vector<Case<Tangents>> all;
  for (double mu : {0.0, 1e-3, 0.3, 1.0, 7.0})
    for (double normal : {-1e9, -3.7, -1e-8, 0.0, 1e-8, 2.5})
      for (double size : {0.0, 1e-8, 0.3 * 3.7, 3.7, 1e10})
        for (unsigned seed : {1u, 2u, 3u}) {
          Vec<double, Tangents> direction = derivatives::arbitrary(Tangents, seed);
          direction /= direction.norm();
          all.push_back({traction<Tangents>(normal, size * direction), mu});
        }
  return all;
}

template <class Count>
class Projection : public testing::Test {};
using Tangents = testing::Types<std::integral_constant<int, 1>, std::integral_constant<int, 2>>;
TYPED_TEST_SUITE(Projection, Tangents);

TYPED_TEST(Projection, LiesInTheCone) {
  for (const auto& [trial, mu] : cases<TypeParam::value>()) {
    const auto t = project(trial, mu).traction;
    EXPECT_LE(t.normal, 0);
    // the band in which a tie sticks, and three roundings of a scaled direction
    EXPECT_LE(t.tangential.norm(), -mu * t.normal * (1 + tie_band + 3 * epsilon));
  }
}

TYPED_TEST(Projection, ChangesNothingWhenRepeated) {
  for (const auto& [trial, mu] : cases<TypeParam::value>()) {
    const auto once = project(trial, mu).traction, twice = project(once, mu).traction;
    EXPECT_EQ(twice.normal, once.normal);
    // where the norm of the first result rounds up, the second scales it by one rounding
    EXPECT_LE((twice.tangential - once.tangential).norm(), 3 * epsilon * once.tangential.norm());
  }
}

TYPED_TEST(Projection, IsTheNearestTractionOfTheDiskAndSoDissipatesTheMost) {
  constexpr int n = TypeParam::value;
  for (const auto& [trial, mu] : cases<n>()) {
    const auto t = project(trial, mu).traction;
    EXPECT_EQ(t.normal * (trial.normal - t.normal), 0);  // Signorini: either no traction or no correction
    if (t.normal == 0) continue;
    const Vec<double, n> slip = trial.tangential - t.tangential;  // plastic slip times rho
    const double bound = -mu * t.normal;
    EXPECT_GE(t.tangential.dot(slip), 0);  // friction never gives work
    for (unsigned seed : {4u, 5u, 6u, 7u}) {
      const Vec<double, n> other = bound * derivatives::arbitrary(n, seed) / std::sqrt(double(n));
      // a difference of products: roundings of their size
      EXPECT_GE((t.tangential - other).dot(slip), -8 * epsilon * bound * slip.norm() - tie_band * bound * bound);
    }
  }
}

TYPED_TEST(Projection, ScalesWithItsTrialToTheLastBit) {
  for (const auto& [trial, mu] : cases<TypeParam::value>())
    for (double factor : {0.125, 4096.0}) {  // powers of two, so that scaling itself is exact
      const auto t = project(trial, mu),
                 scaled = project(traction<TypeParam::value>(factor * trial.normal, factor * trial.tangential), mu);
      EXPECT_EQ(scaled.state, t.state);
      EXPECT_EQ(scaled.traction.normal, factor * t.traction.normal);
      EXPECT_EQ(scaled.traction.tangential, factor * t.traction.tangential);
    }
}

TYPED_TEST(Projection, IsTheSameInBothBranchesOnTheCone) {
  constexpr int n = TypeParam::value;
  Vec<double, n> direction = derivatives::arbitrary(n);
  direction /= direction.norm();
  const double bound = 0.3 * 2.5;
  const auto trial = traction<n>(-2.5, bound * direction);
  const auto stick = project_onto_cone(trial, bound, ContactState::stick);
  const auto slip = project_onto_cone(trial, bound, ContactState::slip);
  EXPECT_LE((stick.tangential - slip.tangential).norm(), 3 * epsilon * bound);  // one direction scaled anew
  EXPECT_EQ(stick.normal, slip.normal);
}

TYPED_TEST(Projection, ReadsNothingThatItsBranchDoesNotNeed) {
  constexpr int n = TypeParam::value;
  const Vec<double, n> unknown = Vec<double, n>::Constant(nan), known = Vec<double, n>::Constant(0.5);
  const auto open = project_onto_cone(traction<n>(nan, unknown), nan, ContactState::open);
  EXPECT_EQ(open.normal, 0);
  EXPECT_TRUE(open.tangential.isZero(0));
  const auto stick = project_onto_cone(traction<n>(-1, known), nan, ContactState::stick);
  EXPECT_EQ(stick.tangential, known);
}

TYPED_TEST(Projection, ClosesAndSticksInATie) {
  constexpr int n = TypeParam::value;
  const Vec<double, n> none = Vec<double, n>::Zero(), some = Vec<double, n>::Unit(n - 1);
  EXPECT_NE(classify(traction<n>(0, none), 0, 0), ContactState::open);  // a body that just rests
  EXPECT_NE(classify(traction<n>(1e-3, none), 0, 1e-3), ContactState::open);
  EXPECT_EQ(classify(traction<n>(1.001e-3, none), 0, 1e-3), ContactState::open);
  EXPECT_EQ(classify(traction<n>(-2, some), 1, 0), ContactState::stick);
  EXPECT_EQ(classify(traction<n>(-2, (1 + 0.5 * tie_band) * some), 1, 0), ContactState::stick);
  EXPECT_EQ(classify(traction<n>(-2, (1 + 2 * tie_band) * some), 1, 0), ContactState::slip);
}

TYPED_TEST(Projection, NeverSticksWithoutABound) {
  constexpr int n = TypeParam::value;
  for (double size : {0.0, 1.0}) {
    const Vec<double, n> tangential = Vec<double, n>::Constant(size);
    EXPECT_EQ(classify(traction<n>(-5, tangential), 0, 0), ContactState::slip);  // mu = 0
    EXPECT_EQ(classify(traction<n>(0, tangential), 0, 0), ContactState::slip);   // the apex
    const auto t = project(traction<n>(-5, tangential), 0).traction;
    EXPECT_EQ(t.normal, -5);
    EXPECT_TRUE(t.tangential.isZero(0));
  }
}

TYPED_TEST(Projection, HasNoDirectionAndNoNotANumberAtTheApex) {
  constexpr int n = TypeParam::value;
  Traction<Dual<1 + n>, n> trial;
  trial.normal = Dual<1 + n>::seed(0.0, 0);
  for (int a = 0; a < n; ++a) trial.tangential[a] = Dual<1 + n>::seed(0.0, 1 + a);
  const auto t = project_onto_cone(trial, Dual<1 + n>(-0.3) * trial.normal, ContactState::slip);
  EXPECT_EQ(t.normal.d[0], 1);
  for (int a = 0; a < n; ++a) {
    EXPECT_EQ(t.tangential[a].v, 0);
    EXPECT_TRUE(t.tangential[a].d.isZero(0));
  }
}

/// (z_N, z_T, mu) -> t in one branch, in any scalar.
template <int n>
auto in_branch(ContactState state) {
  return [state](const auto& x) {
    using T = typename std::decay_t<decltype(x)>::Scalar;
    Traction<T, n> trial;
    trial.normal = x[0];
    for (int a = 0; a < n; ++a) trial.tangential[a] = x[1 + a];
    const T bound = -x[1 + n] * x[0];
    const auto t = project_onto_cone(trial, bound, state);
    Vector<T> out(1 + n);
    out[0] = t.normal;
    for (int a = 0; a < n; ++a) out[1 + a] = t.tangential[a];
    return out;
  };
}

TYPED_TEST(Projection, HasTheDerivativeOfTheComplexStepInEachBranch) {
  constexpr int n = TypeParam::value;
  Vector<double> x(2 + n);
  x << -2.5, derivatives::arbitrary(n), 0.3;
  for (ContactState state : {ContactState::open, ContactState::stick, ContactState::slip}) {
    const auto dual = derivatives::by_dual(in_branch<n>(state), x);
    const auto exact = derivatives::by_complex_step(in_branch<n>(state), x);
    EXPECT_LE(derivatives::relative_difference(dual, exact), 10 * epsilon);  // ten operations at most
  }
}

TYPED_TEST(Projection, HasTheTangentOfTheFormulaWhereItSlips) {
  constexpr int n = TypeParam::value;
  const double normal = -2.5, mu = 0.3, bound = -mu * normal;
  const Vec<double, n> z = derivatives::arbitrary(n);
  const Vec<double, n> m = z / z.norm();
  Matrix<double> expected = Matrix<double>::Zero(1 + n, 2 + n);  // columns z_N, z_T, mu
  expected(0, 0) = 1;
  expected.block(1, 0, n, 1) = -mu * m;
  expected.block(1, 1, n, n) = bound / z.norm() * (Mat<double, n>::Identity() - m * m.transpose());
  expected.block(1, 1 + n, n, 1) = -normal * m;
  Vector<double> x(2 + n);
  x << normal, z, mu;
  EXPECT_LE(derivatives::relative_difference(derivatives::by_dual(in_branch<n>(ContactState::slip), x), expected),
            10 * epsilon);  // ten operations at most
}

TEST(PlaneProjection, TurnsWithItsFrame) {
  const Eigen::Rotation2D<double> turn(0.7);
  for (const auto& [trial, mu] : cases<2>()) {
    const auto t = project(trial, mu);
    const auto turned = project(traction<2>(trial.normal, turn * trial.tangential), mu);
    EXPECT_EQ(turned.state, t.state);
    // four products and a sum, and the direction scaled anew
    EXPECT_LE((turned.traction.tangential - turn * t.traction.tangential).norm(),
              8 * epsilon * t.traction.tangential.norm());
  }
}

TEST(FrictionlessProjection, SlidesWhereverItIsClosed) {
  Traction<double, 0> trial;
  for (double normal : {-1.0, 0.0}) {
    trial.normal = normal;
    EXPECT_EQ(classify(trial, 0, 0), ContactState::slip);
    EXPECT_EQ(project_onto_cone(trial, 0.0, ContactState::slip).normal, normal);
  }
  trial.normal = 1;
  EXPECT_EQ(classify(trial, 0, 0), ContactState::open);
}

}  // namespace
}  // namespace stickslip::friction_cone_test
