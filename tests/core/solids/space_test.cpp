/// The laws in space: against formulas of their own, against themselves in the plane and of revolution, and turned.
#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>
#include <Eigen/LU>

#include "core/solids/j2_plastic.hpp"
#include "core/solids/neo_hookean.hpp"
#include "tests/support/derivatives.hpp"
#include "tests/support/tensors.hpp"

namespace stickslip::space_test {
namespace {

constexpr double E = 200, nu = 0.3, G = E / 2.6, lame = E * nu / ((1 + nu) * (1 - 2 * nu));
using Volumetric = NeoHookean::Volumetric;
using Matrix3 = Mat<double, 3>;

const Matrix3 I = Matrix3::Identity();

Matrix3 some_gradient(double size) {
  Matrix3 H;
  H << 0.3, -0.5, 0.1, 0.2, -0.4, -0.3, 0.25, 0.15, 0.2;
  return size * H;
}

/// A turn by an arbitrary angle about an arbitrary axis.
Matrix3 arbitrary_turn(unsigned seed) {
  const Vector<double> x = derivatives::arbitrary(4, seed);
  return Eigen::Quaterniond(x[0], x[1], x[2], x[3]).normalized().toRotationMatrix();
}

template <class T>
NeoHookeanLaw<T> rubber(Volumetric kind) {
  return {T(lame), T(G), kind, Space::solid};
}

template <class T = double>
J2Law<T> metal(bool finite, const std::vector<HardeningRow>& table = {}, Space space = Space::solid) {
  Numbers<T> none;
  return law_of<T>(J2Plastic{E, nu, 1.5, table.empty() ? 9.0 : 0.0, table}, space, strains_of(finite), none);
}

class RubberInSpace : public testing::TestWithParam<Volumetric> {};

TEST_P(RubberInSpace, HasTheStressOfItsFormula) {
  const auto law = rubber<double>(GetParam());
  for (double size : {0.01, 0.3, 1.0}) {
    const Matrix3 H = some_gradient(size), F = I + H, inverse = F.inverse().transpose();
    const double J = F.determinant(),
                 slope = GetParam() == Volumetric::quadratic ? lame * (J - 1) : lame * std::log(J) / J;
    const Matrix3 P = G * (F - inverse) + J * slope * inverse;
    EXPECT_LE(derivatives::relative_difference(law.stress(in_space(H)).full(), P), 1e-13) << size;
    const double change = GetParam() == Volumetric::quadratic ? J - 1 : std::log(J);
    EXPECT_NEAR(law.energy(in_space(H)), G * ((F.squaredNorm() - 3) / 2 - std::log(J)) + lame / 2 * change * change,
                1e-13 * E);
  }
}

TEST_P(RubberInSpace, OfOneStretchAndOfSimpleShear) {
  const auto law = rubber<double>(GetParam());
  Matrix3 H = Matrix3::Zero();
  H(1, 1) = 0.25;
  const double a = 1.25, slope = GetParam() == Volumetric::quadratic ? lame * (a - 1) : lame * std::log(a) / a;
  auto P = law.stress(in_space(H));
  EXPECT_NEAR(P(1, 1), G * (a - 1 / a) + slope, 1e-13 * E);
  EXPECT_NEAR(P(0, 0), a * slope, 1e-13 * E);
  EXPECT_NEAR(P(2, 2), a * slope, 1e-13 * E);
  H(1, 1) = 0;
  H(0, 2) = 0.4;  // P = G (F - F^-T)
  P = law.stress(in_space(H));
  Matrix3 expected = Matrix3::Zero();
  expected(0, 2) = expected(2, 0) = 0.4 * G;
  EXPECT_LE(largest_entry(P.full() - expected), 1e-13 * E);
}

TEST_P(RubberInSpace, HasASymmetricTangentInAllScalars) {
  const auto energy = [](const auto& v) {
    using T = typename std::decay_t<decltype(v)>::Scalar;
    return Vector<T>::Constant(1, rubber<T>(GetParam()).energy(in_space(v.reshaped(3, 3)))).eval();
  };
  const auto stress = [](const auto& v) {
    using T = typename std::decay_t<decltype(v)>::Scalar;
    return Vector<T>(rubber<T>(GetParam()).stress(in_space(v.reshaped(3, 3))).full().reshaped());
  };
  const Vector<double> H = some_gradient(1).reshaped();
  EXPECT_LE(derivatives::relative_difference(derivatives::by_dual(energy, H).transpose(), stress(H)), 1e-13);
  const Matrix<double> tangent = derivatives::by_dual(stress, H);
  EXPECT_LE(derivatives::relative_difference(tangent, derivatives::by_complex_step(stress, H)), 1e-13);
  EXPECT_LE(derivatives::relative_difference(tangent.transpose(), tangent), 1e-13);
}

TEST_P(RubberInSpace, TurnsWithARotation) {
  const auto law = rubber<double>(GetParam());
  const Matrix3 H = some_gradient(1), P = law.stress(in_space(H)).full();
  for (unsigned seed = 0; seed < 5; ++seed) {
    const Matrix3 Q = arbitrary_turn(seed);
    EXPECT_LE(derivatives::relative_difference(law.stress(in_space(Q * (I + H) - I)).full(), Q * P), 1e-13);
    EXPECT_LE(
        derivatives::relative_difference(law.stress(in_space(Q * H * Q.transpose())).full(), Q * P * Q.transpose()),
        1e-13);
  }
  EXPECT_TRUE(std::isnan(law.stress(in_space(Matrix3(-1.5 * I)))(0, 0)));
}

/// `hoop`: across the plane.
Matrix3 about_plane(double size, double hoop) {
  Matrix3 H = Matrix3::Zero();
  H.topLeftCorner<2, 2>() << 0.3, -0.5, 0.2, -0.4;
  H(2, 2) = hoop;
  return size * H;
}

TEST_P(RubberInSpace, IsThatOfThePlaneAndOfRevolution) {
  const auto law = rubber<double>(GetParam());
  const Matrix3 plane = about_plane(1, 0), revolved = about_plane(1, 0.35);
  const auto flat = law.stress(in_plane(plane));
  const auto P = law.stress(in_space(plane));
  EXPECT_LE(largest_entry(P.full().topLeftCorner<2, 2>() - flat.matrix()), 1e-13 * E);
  EXPECT_LE(
      derivatives::relative_difference(law.stress(in_space(revolved)).full(), law.stress(with_hoop(revolved)).full()),
      1e-13);
  EXPECT_NEAR(law.energy(in_space(plane)), law.energy(in_plane(plane)), 1e-13 * E);
  EXPECT_NEAR(law.energy(in_space(revolved)), law.energy(with_hoop(revolved)), 1e-13 * E);
}

INSTANTIATE_TEST_SUITE_P(Volumetric, RubberInSpace, testing::Values(Volumetric::quadratic, Volumetric::log));

// --- metal -----------------------------------------------------------------------------------------------------------

using Memory = Vec<double, 7>;

double mises(const Matrix3& tau) {
  const Matrix3 deviator = tau - tau.trace() / 3 * I;
  return std::sqrt(1.5) * deviator.norm();
}

TEST(MetalInSpace, IsThatOfRevolutionOnItsWayOnAndBackAndTurned) {
  const std::vector<HardeningRow> rows{{0.02, 1.7}, {0.1, 1.9}, {0.25, 2.2}};
  for (bool finite : {false, true})
    for (const auto& table : {std::vector<HardeningRow>{}, rows}) {
      const auto law = metal(finite, table), plain = metal(finite, table, Space::axisymmetric);
      const Matrix3 Q = arbitrary_turn(7);
      Memory memory = Memory::Zero(), turned = memory;
      Vec<double, 4> reference = Vec<double, 4>::Zero();
      for (double size : {0.01, 0.3, 0.6, 0.8, -0.5}) {
        const Matrix3 H = about_plane(size, 0.35);
        const Matrix3 moved = Q * H * Q.transpose();
        memory = law.flow(in_space(H), memory);
        turned = law.flow(in_space(moved), turned);
        reference = plain.flow(with_hoop(H), reference);
        EXPECT_LE(largest_entry(memory.head<3>() - reference.head<3>()), 1e-13) << size;
        EXPECT_NEAR(memory[6], reference[3], 1e-13) << size;
        EXPECT_NEAR(turned[6], reference[3], 1e-13) << size;
        const Matrix3 P = law.stress(in_space(H), memory).full();
        EXPECT_LE(largest_entry(P - plain.stress(with_hoop(H), reference).full()), 1e-12 * E) << size;
        EXPECT_LE(largest_entry(law.stress(in_space(moved), turned).full() - Q * P * Q.transpose()), 1e-12 * E) << size;
        EXPECT_NEAR(law.energy(in_space(H), memory), plain.energy(with_hoop(H), reference), 1e-12 * E);
      }
      EXPECT_GT(memory[6], 0.3);
    }
}

TEST(MetalInSpace, EndsOnItsBoundKeepsTheVolumeAndTurns) {
  const auto law = metal(true);
  const Matrix3 Q = arbitrary_turn(3);
  Memory memory = Memory::Zero(), moved = memory;
  for (double size : {0.02, 0.3, 0.9, -0.4}) {
    const Matrix3 H = some_gradient(size), F = I + H;
    memory = law.flow(in_space(H), memory);
    moved = law.flow(in_space(Q * F - I), moved);
    EXPECT_LE(largest_entry(moved - memory), 1e-13) << size;
    const Matrix3 P = law.stress(in_space(H), memory).full();
    EXPECT_LE(largest_entry(law.stress(in_space(Q * F - I), moved).full() - Q * P), 1e-12 * E) << size;
    const Matrix3 tau = P * F.transpose();
    EXPECT_LE(largest_entry(tau - tau.transpose()), 1e-12 * E) << size;
    EXPECT_NEAR(mises(tau), 1.5 + 9 * memory[6], 1e-12 * E) << size;
    const Matrix3 C = I + matrix_of<double, 3>(memory.head<6>());
    EXPECT_NEAR(C.determinant(), 1, 1e-12) << size;
    // Hooke's law of the logarithms, by an eigensolver
    const Eigen::SelfAdjointEigenSolver<Matrix3> spectrum(F * C * F.transpose());
    const Vec<double, 3> e = spectrum.eigenvalues().array().log() / 2;
    const Vec<double, 3> principal = (lame * e.sum() + 2 * G * e.array()).matrix();
    const Matrix3 known = spectrum.eigenvectors() * principal.asDiagonal() * spectrum.eigenvectors().transpose();
    EXPECT_LE(largest_entry(tau - known), 1e-12 * E) << size;
  }
}

TEST(MetalInSpace, OfOneStretchAndOfSimpleShear) {
  const auto law = metal(false);
  Matrix3 H = Matrix3::Zero();
  H(1, 2) = 0.1;
  Memory memory = law.flow(in_space(H), Memory(Memory::Zero()));
  // tau = G (gamma - sqrt(3) a) = (yield + h a) / sqrt(3)
  const double a = (std::sqrt(3.0) * G * 0.1 - 1.5) / (3 * G + 9);
  EXPECT_NEAR(memory[6], a, 1e-14);
  EXPECT_NEAR(law.stress(in_space(H), memory)(2, 1), (1.5 + 9 * a) / std::sqrt(3.0), 1e-13 * E);
  H(1, 2) = 0;
  H(2, 2) = 0.1;
  memory = law.flow(in_space(H), Memory(Memory::Zero()));
  const auto sigma = law.stress(in_space(H), memory);
  const double along = (2 * G * 0.1 - 1.5) / (3 * G + 9);  // 2 G (e - 3/2 a) = yield + h a
  EXPECT_NEAR(memory[6], along, 1e-14);
  EXPECT_NEAR(sigma(2, 2) - sigma(0, 0), 1.5 + 9 * along, 1e-13 * E);
  EXPECT_NEAR(sigma.trace(), (3 * lame + 2 * G) * 0.1, 1e-13 * E);
}

/// Stress after flow, and the memory, of H and a memory before.
template <class T>
Vector<T> outcome(const J2Law<T>& law, const Vector<T>& in) {
  const auto H = in_space(in.head(9).reshaped(3, 3));
  const Vec<T, 7> before = in.tail(7), after = law.flow(H, before);
  Vector<T> out(16);
  out << law.stress(H, after).full().reshaped(), after;
  return out;
}

TEST(MetalInSpace, HasTheDerivativesOfTheComplexStepAndASymmetricTangent) {
  for (bool finite : {false, true})
    for (double size : {0.03, 0.6}) {
      const auto f = [&](const auto& v) {
        return outcome(metal<typename std::decay_t<decltype(v)>::Scalar>(finite), v);
      };
      Vector<double> in(16);
      in << some_gradient(size).reshaped(), 0.002, -0.001, 0.003, -0.0005, 0.001, -0.002, 0.004;
      const Matrix<double> by_dual = derivatives::by_dual(f, in), tangent = by_dual.topLeftCorner(9, 9);
      EXPECT_GT(f(in)[15], 0.0041);
      EXPECT_LE(largest_entry(by_dual - derivatives::by_complex_step(f, in)), 1e-12 * E) << finite << size;
      EXPECT_LE(largest_entry(tangent - tangent.transpose()), 1e-12 * E) << finite << size;
    }
}

TEST(Logarithms, OfTensorsOfSpaceAreThoseOfAnEigensolver) {
  for (double size : {1e-9, 1e-3, 0.15, 0.6, 3.0})
    for (double apart : {0.0, 1e-9, 0.3, 0.6}) {
      Symmetric<double, 3> A;
      A << size * (1 + apart), size * (1 - apart), 0.4 * size * apart, size, 0.2 * size * apart, -0.1 * size * apart;
      const Eigen::SelfAdjointEigenSolver<Matrix3> spectrum(matrix_of<double, 3>(A));
      const auto expect = [&](const Symmetric<double, 3>& got, auto&& f) {
        const Matrix3 wanted = spectrum.eigenvectors() *
                               Vec<double, 3>(spectrum.eigenvalues().unaryExpr(f)).asDiagonal() *
                               spectrum.eigenvectors().transpose();
        EXPECT_LE(derivatives::relative_difference(matrix_of<double, 3>(got), wanted), 1e-14) << size << " " << apart;
      };
      expect(log_of_one_plus<double>(A), [](double x) { return std::log1p(x); });
      expect(exp_minus_one<double>(A), [](double x) { return std::expm1(x); });
    }
}

}  // namespace
}  // namespace stickslip::space_test
