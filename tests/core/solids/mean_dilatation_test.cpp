/// Elements with mean dilatation at finite strain: forces and tangent of their energy, and their limits.
#include "core/solids/mean_dilatation.hpp"

#include <gtest/gtest.h>

#include <Eigen/Geometry>

#include "core/solids/elements.hpp"
#include "core/solids/materials.hpp"
#include "tests/support/derivatives.hpp"
#include "tests/support/largest.hpp"

namespace stickslip::mean_dilatation_test {
namespace {

using Places = Mat<double, 2, 4>;

const Places X{{1.1, 2.9, 3.2, 0.9}, {0.1, -0.1, 2.2, 1.8}};
const Places u = 0.15 * derivatives::arbitrary(8, 3).reshaped(2, 4);

template <class F>
void for_each_setting(F&& f) {
  f.template operator()<Kinematics::plane_mean_dilatation>();
  f.template operator()<Kinematics::revolution_mean_dilatation>();
}

/// Two rubbers, and a metal that remembers but does not flow.
template <class F>
void for_each_law(F&& f) {
  f(NeoHookeanLaw<double>(3.0, 2.0, NeoHookean::Volumetric::quadratic), Vector<double>());
  f(NeoHookeanLaw<double>(3.0, 2.0, NeoHookean::Volumetric::log), Vector<double>());
  f(J2Law<double>{3.0, 2.0, {100.0, 1.0}, Space::plane_strain, true},
    Vector<double>(0.02 * derivatives::arbitrary(16, 5).cwiseAbs()));
}

TEST(MeanDilatation, HasForcesAndASymmetricTangentOfItsEnergy) {
  for_each_setting([&]<Kinematics kinematics>() {
    for_each_law([&](const auto& law, const Vector<double>& memory) {
      using Probe = Dual<8>;
      Mat<Probe, 2, 4> moved, places;
      for (int k = 0; k < 8; ++k) moved.data()[k] = Probe::seed(u.data()[k], k);
      for (int k = 0; k < 8; ++k) places.data()[k] = Probe(X.data()[k]);
      const Vector<Probe> constant = memory.unaryExpr([](double x) { return Probe(x); });
      const auto energy = element_energy<Probe, Quad4, kinematics>(law, places, moved, Probe(0.7), constant.data());
      const Places forces = element_forces<double, Quad4, kinematics>(law, X, u, 0.7, memory.data());
      const double size = largest_entry(forces);
      for (int k = 0; k < 8; ++k) EXPECT_NEAR(forces.data()[k], energy.d[k], 1e-13 * size);
      const auto K = element_tangent<double, Quad4, kinematics>(law, X, u, 0.7, memory.data());
      EXPECT_LE(largest_entry(K - K.transpose()), 1e-13 * largest_entry(K));
      for (int k = 0; k < 8; ++k) {
        constexpr double h = 1e-5;
        Places up = u, down = u;
        up.data()[k] += h;
        down.data()[k] -= h;
        const Places slope = (element_forces<double, Quad4, kinematics>(law, X, up, 0.7, memory.data()) -
                              element_forces<double, Quad4, kinematics>(law, X, down, 0.7, memory.data())) /
                             (2 * h);
        EXPECT_LE(largest_entry(K.col(k) - slope.reshaped()), 1e-8 * largest_entry(K));  // differences: h^2, and u / h
      }
    });
  });
}

TEST(MeanDilatation, IsThatOfSmallStrainToTheLastDigitsWhereMotionsAreSmall) {
  const NeoHookeanLaw<double> finite(3.0, 2.0, NeoHookean::Volumetric::log);
  const LinearElasticLaw<double> linear(3.0, 2.0);
  for_each_setting([&]<Kinematics kinematics>() {
    const Places tiny = 1e-9 * u;
    const Places a = element_forces<double, Quad4, kinematics>(finite, X, tiny, 0.7);
    const Places b = element_forces<double, Quad4, kinematics>(linear, X, tiny, 0.7);
    EXPECT_LE(largest_entry(a - b), 1e-8 * largest_entry(b));
  });
}

TEST(MeanDilatation, TurnsWithARotation) {
  const Eigen::Rotation2Dd turned(1.1);
  const NeoHookeanLaw<double> law(3.0, 2.0, NeoHookean::Volumetric::quadratic);
  const Places moved = turned.toRotationMatrix() * (X + u) - X;
  const Places still = element_forces<double, Quad4, Kinematics::plane_mean_dilatation>(law, X, u);
  const Places found = element_forces<double, Quad4, Kinematics::plane_mean_dilatation>(law, X, moved);
  EXPECT_LE(largest_entry(found - turned.toRotationMatrix() * still), 1e-13 * largest_entry(still));
}

TEST(MeanDilatation, HasOneVolumeAndNoForceWhereItIsInverted) {
  const MeanDilatation<double, double, Quad4, Kinematics::plane_mean_dilatation> element(X, 1.0, u);
  std::array<double, 4> J;
  for (std::size_t q = 0; q < 4; ++q) {
    const Mat<double, 3> F = Mat<double, 3>::Identity() + element.strain(q).full();
    J[q] = F(2, 2) * (F(0, 0) * F(1, 1) - F(0, 1) * F(1, 0));
    EXPECT_NEAR(J[q], J[0], 1e-14);
  }
  EXPECT_GT(std::abs(J[0] - 1), 1e-3);
  Places folded = u;
  folded(0, 1) -= 3;
  const NeoHookeanLaw<double> law(3.0, 2.0, NeoHookean::Volumetric::quadratic);
  EXPECT_TRUE(std::isnan(element_forces<double, Quad4, Kinematics::plane_mean_dilatation>(law, X, folded)(0, 0)));
}

}  // namespace
}  // namespace stickslip::mean_dilatation_test
