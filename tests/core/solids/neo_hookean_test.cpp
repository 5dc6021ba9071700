/// The neo-Hookean law against its energy, Hooke's law, and rotations.
#include "core/solids/neo_hookean.hpp"

#include <gtest/gtest.h>

#include "core/solids/linear_elastic.hpp"
#include "tests/support/derivatives.hpp"
#include "tests/support/tensors.hpp"

namespace stickslip::neo_hookean_test {
namespace {

constexpr double epsilon = std::numeric_limits<double>::epsilon();
constexpr double E = 1000, nu = 0.3;
using Volumetric = NeoHookean::Volumetric;

template <class T>
NeoHookeanLaw<T> law(Volumetric kind, const T& modulus = T(E), const T& ratio = T(nu)) {
  const LinearElasticLaw<T> small(modulus, ratio, Space::plane_strain);
  return {small.lame, small.shear, kind};
}

Mat<double, 2> some_gradient(double size) {
  Mat<double, 2> H;
  H << 0.3, -0.5, 0.2, -0.4;
  return size * H;
}

class NeoHookeanLaws : public testing::TestWithParam<Volumetric> {};

TEST_P(NeoHookeanLaws, HasTheStressOfItsEnergy) {
  const auto energy = [](const auto& v) {
    using T = typename std::decay_t<decltype(v)>::Scalar;
    const Mat<T, 2> H = v.reshaped(2, 2);
    return Vector<T>::Constant(1, law<T>(GetParam()).energy(in_plane(H))).eval();
  };
  const auto stress = [](const auto& v) {
    using T = typename std::decay_t<decltype(v)>::Scalar;
    const Mat<T, 2> H = v.head(4).reshaped(2, 2);
    return Vector<T>(law<T>(GetParam(), v[4], v[5]).stress(in_plane(H)).full().reshaped());
  };
  Vector<double> v(6);
  v << some_gradient(1).reshaped(), 1.0, nu;
  const Vector<double> H = v.head(4);
  Vector<double> of_stiff = v;
  of_stiff[4] = E;
  EXPECT_LE(derivatives::relative_difference(derivatives::by_dual(energy, H).transpose(), stress(of_stiff)),
            100 * epsilon);  // some twenty operations, and a logarithm
  EXPECT_LE(derivatives::relative_difference(derivatives::by_dual(stress, v), derivatives::by_complex_step(stress, v)),
            100 * epsilon);
}

TEST_P(NeoHookeanLaws, IsHookesAtSmallStrainToTheLastDigits) {
  for (double size : {1e-3, 1e-8, 1e-14}) {
    const Mat<double, 2> H = some_gradient(size);
    const Mat<double, 2> small = LinearElasticLaw<double>(E, nu, Space::plane_strain).stress(in_plane(H)).full();
    const Mat<double, 2> P = law<double>(GetParam()).stress(in_plane(H)).full();
    EXPECT_LE(derivatives::relative_difference(P, small), 3 * size + 20 * epsilon) << size;
  }
}

TEST_P(NeoHookeanLaws, TurnsWithARotation) {
  Mat<double, 2> Q;
  Q << std::cos(1.2), -std::sin(1.2), std::sin(1.2), std::cos(1.2);
  const Mat<double, 2> H = some_gradient(1), I = Mat<double, 2>::Identity();
  const Mat<double, 2> P = law<double>(GetParam()).stress(in_plane(H)).full();
  const Mat<double, 2> turned = law<double>(GetParam()).stress(in_plane(Q * (I + H) - I)).full();
  EXPECT_LE(derivatives::relative_difference(turned, Q * P), 100 * epsilon);
}

TEST_P(NeoHookeanLaws, HasNoStressWhereTheElementIsInverted) {
  Mat<double, 2> H = Mat<double, 2>::Zero();
  for (double h : {-1.0, -1.5}) {
    H(0, 0) = h;
    EXPECT_TRUE(std::isnan(law<double>(GetParam()).stress(in_plane(H))(0, 0)));
    EXPECT_TRUE(std::isnan(
        std::real(law<derivatives::Complex>(GetParam()).stress(in_plane(H.cast<derivatives::Complex>()))(0, 0))));
  }
}

/// H of revolution by its five components.
template <class V>
auto of_revolution(const V& v) {
  using T = typename V::Scalar;
  Tensor<T, TensorLayout::hoop5> H;
  for (int k = 0; k < 5; ++k) H[k] = v[k];
  return H;
}

TEST_P(NeoHookeanLaws, HasTheStressOfItsEnergyOfRevolution) {
  const auto energy = [](const auto& v) {
    using T = typename std::decay_t<decltype(v)>::Scalar;
    return Vector<T>::Constant(1, law<T>(GetParam()).energy(of_revolution(v))).eval();
  };
  Vector<double> v(5);
  v << some_gradient(1).reshaped(), 0.35;
  const auto P = law<double>(GetParam()).stress(of_revolution(v));
  Vector<double> stress(5);
  for (int k = 0; k < 5; ++k) stress[k] = P[k];
  // (some thirty operations, and a logarithm)
  EXPECT_LE(derivatives::relative_difference(derivatives::by_dual(energy, v).transpose(), stress), 100 * epsilon);
  for (double size : {1e-3, 1e-8, 1e-14}) {
    const auto H = of_revolution(Vector<double>(size * v));
    const Mat<double, 3> small = LinearElasticLaw<double>(E, nu, Space::axisymmetric).stress(H).full();
    EXPECT_LE(derivatives::relative_difference(law<double>(GetParam()).stress(H).full(), small),
              3 * size + 20 * epsilon)
        << size;
  }
  v[4] = -1;
  EXPECT_TRUE(std::isnan(law<double>(GetParam()).stress(of_revolution(v))(0, 0)));
}

INSTANTIATE_TEST_SUITE_P(Volumetric, NeoHookeanLaws, testing::Values(Volumetric::quadratic, Volumetric::log));

}  // namespace
}  // namespace stickslip::neo_hookean_test
