/// Plane stress at finite strain: the thickness that leaves no stress across, against the laws of three dimensions.
#include <gtest/gtest.h>

#include "core/algebra/reverse.hpp"
#include "core/solids/j2_plastic.hpp"
#include "core/solids/neo_hookean.hpp"
#include "tests/support/derivatives.hpp"
#include "tests/support/largest.hpp"
#include "tests/support/tensors.hpp"

namespace stickslip::plane_stress_test {
namespace {

constexpr double epsilon = std::numeric_limits<double>::epsilon();
using Volumetric = NeoHookean::Volumetric;

template <class T>
NeoHookeanLaw<T> law(Volumetric kind, const T& E, const T& nu, Space space = Space::plane_stress) {
  const LinearElasticLaw<T> small(E, nu, Space::plane_strain);
  return {small.lame, small.shear, kind, space};
}

/// Gradients of either sign: sheared, and of a plane that shrinks to a quarter and grows to twice its area.
std::vector<Mat<double, 2>> gradients() {
  Mat<double, 2> sheared, squeezed, widened;
  sheared << 0.3, -0.5, 0.2, -0.4;
  squeezed << -0.7, 0.1, -0.2, -0.2;
  widened << 0.4, 0.1, -0.2, 0.4;
  return {sheared, squeezed, widened};
}

Mat<double, 3> with_thickness(const Mat<double, 2>& H, double h) {
  Mat<double, 3> in_space = Mat<double, 3>::Zero();
  in_space.topLeftCorner<2, 2>() = H;
  in_space(2, 2) = h;
  return in_space;
}

class ThinRubber : public testing::TestWithParam<std::tuple<Volumetric, double>> {
 protected:
  static Volumetric kind() { return std::get<0>(GetParam()); }
  static double nu() { return std::get<1>(GetParam()); }
};

TEST_P(ThinRubber, IsThatOfThreeDimensionsWithNoStressAcross) {
  // the thickness by halving. The law of three dimensions has its pressure from lame times a growth that is small where
  // lame is large, and rounds it by lame times epsilon; the one of plane stress does not.
  const auto thin = law(kind(), 1000.0, nu()), solid = law(kind(), 1000.0, nu(), Space::axisymmetric);
  for (const Mat<double, 2>& H : gradients()) {
    double low = -0.99, high = 10;
    for (int i = 0; i < 200; ++i) {
      const double h = (low + high) / 2;
      (solid.stress(with_hoop(with_thickness(H, h)))(2, 2) > 0 ? high : low) = h;
    }
    const double allowed = 100 * epsilon * (1 + std::abs(solid.lame / solid.shear));
    EXPECT_NEAR(thin.stretch_across(in_plane(H)), 1 + low, allowed * (1 + low));
    const Mat<double, 3> in_space = with_thickness(H, thin.stretch_across(in_plane(H)) - 1),
                         P = solid.stress(with_hoop(in_space)).full();
    const Mat<double, 2> found = thin.stress(in_plane(H)).full();
    EXPECT_LE(largest_entry(found - P.topLeftCorner<2, 2>()), allowed * 1000);
    EXPECT_LE(std::abs(P(2, 2)), allowed * 1000);
    EXPECT_NEAR((thin.energy(in_plane(H))), (solid.energy(with_hoop(in_space))), allowed * 1000);
    EXPECT_EQ(thin.stress_across(in_plane(H)), 0);
  }
}

TEST_P(ThinRubber, HasTheStressOfItsEnergyAndDerivativesInAllScalars) {
  const auto energy = [&](const auto& v) {
    using T = typename std::decay_t<decltype(v)>::Scalar;
    const Mat<T, 2> H = v.reshaped(2, 2);
    return Vector<T>::Constant(1, law<T>(kind(), T(1), T(nu())).energy(in_plane(H))).eval();
  };
  const auto stress = [&](const auto& v) {
    using T = typename std::decay_t<decltype(v)>::Scalar;
    const Mat<T, 2> H = v.head(4).reshaped(2, 2);
    return Vector<T>(law<T>(kind(), v[4], v[5]).stress(in_plane(H)).full().reshaped());
  };
  for (const Mat<double, 2>& H : gradients()) {
    Vector<double> v(6);
    v << H.reshaped(), 1.0, nu();
    const Vector<double> in = v.head(4), P = stress(v);
    // some fifty operations; the energy's pressure is lame times a growth
    const double allowed = 200 * epsilon;
    EXPECT_LE(derivatives::relative_difference(derivatives::by_dual(energy, in).transpose(), P),
              allowed / (1 - 2 * nu()));
    const auto by_dual = derivatives::by_dual(stress, v);
    EXPECT_LE(derivatives::relative_difference(by_dual, derivatives::by_complex_step(stress, v)),
              allowed / (1 - 2 * nu()));
    for (int i = 0; i < 4; ++i)
      for (int k = 0; k < i; ++k) EXPECT_NEAR(by_dual(i, k), by_dual(k, i), allowed * largest_entry(by_dual));
    Tape tape;
    const Vector<Reverse> leaf = leaves(v, tape);
    const Vector<Reverse> out = stress(leaf);
    for (int i = 0; i < 4; ++i) {
      std::vector<double> by(tape.size(), 0);
      by[out[i].entry] = 1;
      tape.pull_back(by, 0);
      for (int k = 0; k < 6; ++k)
        EXPECT_NEAR(by[leaf[k].entry], by_dual(i, k), allowed / (1 - 2 * nu()) * largest_entry(by_dual)) << i << k;
    }
  }
}

TEST_P(ThinRubber, IsHookesOfPlaneStressAtSmallStrainToTheLastDigits) {
  for (const Mat<double, 2>& shape : gradients())
    for (double size : {1e-3, 1e-8, 1e-14}) {
      const Mat<double, 2> H = size * shape;
      const LinearElasticLaw<double> hooke(1000, nu(), Space::plane_stress);
      const auto thin = law(kind(), 1000.0, nu());
      // (of the second order the largest factor is that of the thickness, which a nu near -1/2 lets grow)
      EXPECT_LE(derivatives::relative_difference(thin.stress(in_plane(H)).full(), hooke.stress(in_plane(H)).full()),
                6 * size + 30 * epsilon)
          << size;
      EXPECT_NEAR(thin.stretch_across(in_plane(H)) - 1, hooke.stretch_across(in_plane(H)) - 1,
                  6 * size * size + 2 * epsilon);
      const auto rest = thin.at_rest();
      EXPECT_LE(largest_entry(rest.stress(in_plane(H)).full() - hooke.stress(in_plane(H)).full()),
                10 * epsilon * 1000 * size);
    }
}

TEST_P(ThinRubber, TurnsWithARotationAndKnowsNoUnit) {
  Mat<double, 2> Q;
  Q << std::cos(1.2), -std::sin(1.2), std::sin(1.2), std::cos(1.2);
  const Mat<double, 2> I = Mat<double, 2>::Identity();
  for (const Mat<double, 2>& H : gradients()) {
    const auto thin = law(kind(), 1000.0, nu());
    const Mat<double, 2> P = thin.stress(in_plane(H)).full();
    EXPECT_LE(derivatives::relative_difference(thin.stress(in_plane(Q * (I + H) - I)).full(), Q * P),
              300 * epsilon / (1 - 2 * nu()));
    for (double unit : {0x1p-100, 0x1p100}) {  // (powers of two round nothing)
      const Mat<double, 2> scaled = law(kind(), 1000 * unit, nu()).stress(in_plane(H)).full();
      EXPECT_EQ(largest_entry(scaled / unit - P), 0);
    }
  }
}

TEST_P(ThinRubber, OfAnInvertedElementIsNotANumber) {
  Mat<double, 2> H = Mat<double, 2>::Zero();
  for (double h : {-1.0, -1.5}) {
    H(0, 0) = h;
    EXPECT_TRUE(std::isnan(law(kind(), 1000.0, nu()).stress(in_plane(H))(0, 0))) << h;
  }
}

INSTANTIATE_TEST_SUITE_P(Laws, ThinRubber,
                         testing::Combine(testing::Values(Volumetric::quadratic, Volumetric::log),
                                          testing::Values(-0.15, 0.0, 0.3, 0.49, 0.4999)));

TEST(ThinRubber, WithoutAThicknessIsNotANumber) {
  // nu < 0: widened it thickens, the quadratic law without end; pressed together the logarithmic one has none
  const double nu = -0.3;
  Mat<double, 2> H;
  H << 0.6, 0, 0, 0.6;
  const auto quadratic = law(Volumetric::quadratic, 1000.0, nu), logarithmic = law(Volumetric::log, 1000.0, nu);
  EXPECT_TRUE(std::isnan(quadratic.stress(in_plane(H))(0, 0)));
  EXPECT_TRUE(std::isnan(quadratic.stretch_across(in_plane(H))));
  EXPECT_GT(logarithmic.stretch_across(in_plane(H)), 1);
  H << -0.6, 0, 0, -0.6;
  EXPECT_TRUE(std::isnan(logarithmic.stress(in_plane(H))(0, 0)));
  EXPECT_LT(quadratic.stretch_across(in_plane(H)), 1);
  // up to where there is one: the stress across has no slope there any more
  double low = 0, high = 0.6;
  const auto widened = [](double h) -> Mat<double, 2> { return h * Mat<double, 2>::Identity(); };
  for (int i = 0; i < 100; ++i) {
    const double h = (low + high) / 2;
    (std::isnan(quadratic.stretch_across(in_plane(widened(h)))) ? high : low) = h;
  }
  const double J = (1 + low) * (1 + low), G = quadratic.shear, lame = quadratic.lame,
               F = quadratic.stretch_across(in_plane(widened(low)));
  EXPECT_NEAR(2 * (G + lame * J * J) * F - lame * J, 0, 1e-6 * G);  // (a root of what rounding leaves)
  double least = 0, most = 0.6;
  for (int i = 0; i < 100; ++i) {
    const double h = (least + most) / 2;
    (std::isnan(logarithmic.stretch_across(in_plane(widened(-h)))) ? most : least) = h;
  }
  EXPECT_NEAR(2 * G * std::pow(logarithmic.stretch_across(in_plane(widened(-least))), 2) + lame, 0, 1e-6 * G);
}

// --- metal -----------------------------------------------------------------------------------------------------------

using Memory = Vec<double, 4>;
using Table = std::vector<HardeningRow>;

J2Law<double> metal(Space space, bool finite, const Table& table) {
  Numbers<double> none;
  return law_of<double>(J2Plastic{200.0, 0.3, 1.5, table.empty() ? 9.0 : 0.0, table}, space, strains_of(finite), none);
}

const Table rows{{0.02, 1.7}, {0.1, 1.9}, {0.25, 2.2}};

TEST(ThinMetal, IsThatOfRevolutionWithNoStressAcrossWhileItFlowsOnAndBack) {
  Mat<double, 2> shape;
  shape << 0.11, -0.13, 0.2, -0.17;
  for (const Table& table : {Table{}, rows}) {
    const auto thin = metal(Space::plane_stress, true, table), solid = metal(Space::axisymmetric, true, table);
    Memory memory = Memory::Zero(), reference = Memory::Zero();
    for (double size : {0.02, 0.5, 1.5, 2.0, -1.2}) {
      const Mat<double, 2> H = size * shape;
      double low = -0.6, high = 2;
      for (int i = 0; i < 100; ++i) {
        const double h = (low + high) / 2;
        const Mat<double, 3> in_space = with_thickness(H, h);
        const auto flown = solid.flow(with_hoop(in_space), reference);
        (solid.stress(with_hoop(in_space), flown)(2, 2) > 0 ? high : low) = h;
      }
      const Mat<double, 3> in_space = with_thickness(H, low);
      reference = solid.flow(with_hoop(in_space), reference);
      memory = thin.flow(in_plane(H), memory);
      EXPECT_LE(largest_entry(memory - reference), 1e-13 * (1 + largest_entry(memory))) << size;
      EXPECT_NEAR(thin.stretch_across(in_plane(H), memory), 1 + low, 1e-13) << size;
      const Mat<double, 2> P = thin.stress(in_plane(H), memory).full();
      EXPECT_LE(largest_entry(P - solid.stress(with_hoop(in_space), reference).matrix()), 1e-12 * 200) << size;
      EXPECT_NEAR((thin.energy(in_plane(H), memory)), (solid.energy(with_hoop(in_space), reference)), 1e-13 * 200);
      // it is on its bound: what logarithms round may pass that, as they were rounded before
      EXPECT_LE(largest_entry(thin.flow(in_plane(H), memory) - memory), 1e-13 * (1 + largest_entry(memory))) << size;
    }
    EXPECT_GT(memory[3], 0.3);
  }
}

TEST(ThinMetal, IsThatOfSmallStrainInLogarithms) {
  // stretches along the axes: Kirchhoff's stress and the plastic strains are those of small strain of their logarithms
  for (const Table& table : {Table{}, rows}) {
    const auto finite = metal(Space::plane_stress, true, table), small = metal(Space::plane_stress, false, table);
    Memory memory = Memory::Zero(), reference = Memory::Zero();
    for (const auto& [a, b] : {std::pair(1.003, 0.999), {1.3, 0.9}, {1.1, 1.4}, {0.7, 1.0}}) {
      Mat<double, 2> H = Mat<double, 2>::Zero(), e = H;
      H.diagonal() << a - 1, b - 1;
      e.diagonal() << std::log(a), std::log(b);
      memory = finite.flow(in_plane(H), memory);
      reference = small.flow(in_plane(e), reference);
      const Mat<double, 2> P = finite.stress(in_plane(H), memory).full(),
                           sigma = small.stress(in_plane(e), reference).full();
      EXPECT_NEAR(P(0, 0) * a, sigma(0, 0), 1e-13 * 200);
      EXPECT_NEAR(P(1, 1) * b, sigma(1, 1), 1e-13 * 200);
      EXPECT_NEAR(memory[3], reference[3], 1e-13);
      for (int k : {0, 1}) EXPECT_NEAR(std::log1p(memory[k]) / -2, reference[k], 1e-13);  // C_p^-1 = exp(-2 e_p)
      EXPECT_NEAR(std::log(finite.stretch_across(in_plane(H), memory)),
                  small.stretch_across(in_plane(e), reference) - 1, 1e-13);
    }
    EXPECT_GT(memory[3], 0.5);
  }
}

}  // namespace
}  // namespace stickslip::plane_stress_test
