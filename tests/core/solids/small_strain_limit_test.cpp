/// Laws of finite strain at strains far below the rounding of 1: they are Hooke's there, to all digits.
#include <gtest/gtest.h>

#include <cmath>

#include "core/solids/bar.hpp"
#include "core/solids/elements.hpp"
#include "core/solids/j2_plastic.hpp"
#include "core/solids/neo_hookean.hpp"
#include "tests/support/tensors.hpp"

namespace stickslip::small_strain_limit_test {
namespace {

constexpr double E = 1000, nu = 0.3;
/// Strains: the smallest beside which 1 + H is 1.
constexpr double sizes[] = {1e-4, 1e-7, 1e-10, 1e-13, 1e-16};
/// What a law may differ by from Hooke's, relative: by as much as the strain, some times over (stresses have up to 10
/// times the strain of second order), and some tens of roundings.
double difference_at(double size) { return 20 * size + 1e-14; }

template <TensorLayout layout>
Tensor<double, layout> gradient_of(double size) {
  Mat<double, 3> H;
  H << 0.3, -0.5, 0.1, 0.2, -0.7, -0.3, 0.6, 0.2, 0.4;
  return tensor_of<layout>(size * H);
}

/// `remembered...`: the memory of a law that has one.
template <TensorLayout layout, class Law, class... Memory>
void expect_hooke(const Law& law, const Memory&... remembered) {
  const auto small = law.at_rest();
  for (const double size : sizes) {
    SCOPED_TRACE(size);
    const auto H = gradient_of<layout>(size);
    const auto P = law.stress(H, remembered...).full(), sigma = small.stress(H).full();
    EXPECT_LE((P - sigma).norm(), difference_at(size) * sigma.norm());
    const double energy = small.energy(H);
    EXPECT_NEAR(law.energy(H, remembered...), energy, difference_at(size) * energy);
  }
}

NeoHookeanLaw<double> rubber(NeoHookean::Volumetric kind, Space space) {
  const LinearElasticLaw<double> small(E, nu, Space::plane_strain);
  return {small.lame, small.shear, kind, space};
}

J2Law<double> metal(Space space) {
  const LinearElasticLaw<double> small(E, nu, Space::plane_strain);
  return {small.lame, small.shear, {1.0, 0.0}, space, true};
}

TEST(SmallStrainLimit, OfNeoHookeanLawsIsHookesLaw) {
  for (const auto kind : {NeoHookean::Volumetric::quadratic, NeoHookean::Volumetric::log}) {
    SCOPED_TRACE(static_cast<int>(kind));
    expect_hooke<TensorLayout::plane4>(rubber(kind, Space::plane_strain));
    expect_hooke<TensorLayout::plane4>(rubber(kind, Space::plane_stress));
    expect_hooke<TensorLayout::hoop5>(rubber(kind, Space::axisymmetric));
    expect_hooke<TensorLayout::full9>(rubber(kind, Space::solid));
  }
}

TEST(SmallStrainLimit, OfMetalIsHookesLaw) {
  const Vec<double, 4> fresh = Vec<double, 4>::Zero();
  expect_hooke<TensorLayout::plane4>(metal(Space::plane_strain), fresh);
  expect_hooke<TensorLayout::plane4>(metal(Space::plane_stress), fresh);
  expect_hooke<TensorLayout::hoop5>(metal(Space::axisymmetric), fresh);
  expect_hooke<TensorLayout::full9>(metal(Space::solid), Vec<double, 7>(Vec<double, 7>::Zero()));
}

TEST(SmallStrainLimit, OfTheThicknessIsHookesLaw) {
  for (const double size : {1e-4, 1e-8}) {
    const auto H = gradient_of<TensorLayout::plane4>(size);
    const double thinner = -nu / (1 - nu) * H.trace();
    for (const auto kind : {NeoHookean::Volumetric::quadratic, NeoHookean::Volumetric::log})
      EXPECT_NEAR(rubber(kind, Space::plane_stress).stretch_across(H) - 1, thinner,
                  20 * size * std::abs(thinner) + 2 * unit_roundoff);  // (of a number near 1)
  }
}

template <Kinematics kinematics>
void expect_hooke_of_elements() {
  Mat<double, 2, 4> X, shape;
  X << 1, 2, 2.1, 0.9, 0, 0.1, 1, 1.2;
  shape << 0.1, -0.4, 0.2, 0.3, -0.2, 0.5, 0.1, -0.6;
  const auto law = rubber(NeoHookean::Volumetric::log, Space::plane_strain);
  const auto small = law.at_rest();
  for (const double size : sizes) {
    SCOPED_TRACE(size);
    const Mat<double, 2, 4> u = size * shape;
    const Mat<double, 2, 4> R = element_forces<double, Quad4, kinematics>(law, X, u, 1.0),
                            linear = element_forces<double, Quad4, kinematics>(small, X, u, 1.0);
    EXPECT_LE((R - linear).norm(), difference_at(size) * linear.norm());
    const double energy = element_energy<double, Quad4, kinematics>(small, X, u, 1.0);
    EXPECT_NEAR((element_energy<double, Quad4, kinematics>(law, X, u, 1.0)), energy, difference_at(size) * energy);
  }
}

TEST(SmallStrainLimit, OfElementsIsThatOfLinearOnes) {
  expect_hooke_of_elements<Kinematics::plane>();
  expect_hooke_of_elements<Kinematics::revolution>();
  expect_hooke_of_elements<Kinematics::plane_mean_dilatation>();
  expect_hooke_of_elements<Kinematics::revolution_mean_dilatation>();
}

TEST(SmallStrainLimit, OfBarsOfGreenStrainIsThatOfLinearOnes) {
  Mat<double, 2> X;
  X << 1, 3, 0, 1;
  const BarLaw<double> green{E, 1, true}, small{E, 1, false};
  for (const double size : sizes) {
    const Vec<double, 2> d(0.3 * size, -0.2 * size), N = small.force<2>(X, d);
    EXPECT_LE((green.force<2>(X, d) - N).norm(), difference_at(size) * N.norm());
    const double energy = small.energy<2>(X, d);
    EXPECT_NEAR(green.energy<2>(X, d), energy, difference_at(size) * energy);
  }
}

TEST(SmallStrainLimit, OfLogarithmsKeepsTheDigitsInAllScalars) {
  for (const double x : {1e-16, 1e-9, 1e-3, 0.3, 3.0, -1e-9, -0.3, -0.9}) {
    const auto exact =
        static_cast<double>(std::abs(x) < 1e-4 ? static_cast<long double>(x) * x * (0.5L - x / 3.0L + x * x / 4.0L)
                                               : static_cast<long double>(x) - std::log1p(static_cast<long double>(x)));
    EXPECT_NEAR(less_log1p(x), exact, 8 * unit_roundoff * exact) << x;
    const auto seeded = less_log1p(Dual<1>::seed(x, 0));
    EXPECT_NEAR(seeded.d[0], x / (1 + x), 32 * unit_roundoff * std::abs(x / (1 + x))) << x;
    const auto stepped = less_log1p(std::complex<double>(x, 1e-30));
    EXPECT_NEAR(stepped.real(), exact, 8 * unit_roundoff * exact) << x;
    EXPECT_NEAR(stepped.imag() / 1e-30, x / (1 + x), 32 * unit_roundoff * std::abs(x / (1 + x))) << x;
    EXPECT_NEAR(log1p(std::complex<double>(x, 1e-30)).real(), std::log1p(x),
                4 * unit_roundoff * std::abs(std::log1p(x)))
        << x;
  }
}

}  // namespace
}  // namespace stickslip::small_strain_limit_test
