/// J2 plasticity at a point: its bound, its flow, and the same numbers by ways that share nothing with the return.
#include "core/solids/j2_plastic.hpp"

#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>
#include <Eigen/LU>

#include "tests/support/largest.hpp"
#include "tests/support/tensors.hpp"

namespace stickslip::j2_plastic_test {
namespace {

constexpr double E = 200, nu = 0.3, G = E / 2.6, yield = 1.5, hardening = 9;
using Memory = Vec<double, 4>;

using Table = std::vector<HardeningRow>;

template <class T = double>
J2Law<T> law(Space space, bool finite, const Table& table = {}) {
  Numbers<T> none;
  return law_of<T>(J2Plastic{E, nu, yield, table.empty() ? hardening : 0.0, table}, space, strains_of(finite), none);
}

/// Rows that the gradients below pass.
const Table rows{{0.002, 1.52}, {0.006, 1.6}, {0.011, 1.61}};

/// The stress at a plastic strain, between rows from the last backwards.
double stress_in_table(double strain) {
  for (int k = 2; k >= 0; --k) {
    const double from = k == 0 ? 0 : rows[k - 1].strain.value, low = k == 0 ? yield : rows[k - 1].stress.value;
    if (strain >= rows[2].strain.value) return rows[2].stress.value;
    if (strain >= from) return low + (rows[k].stress.value - low) * (strain - from) / (rows[k].strain.value - from);
  }
  return yield;
}

/// q of a stress with zz: sqrt(3 J2).
double mises(double xx, double yy, double zz, double xy) {
  return std::sqrt(((xx - yy) * (xx - yy) + (yy - zz) * (yy - zz) + (zz - xx) * (zz - xx)) / 2 + 3 * xy * xy);
}

Mat<double, 2> gradient(int k) {
  Mat<double, 2> H;
  H << 0.011, -0.013, 0.02, -0.017;
  return H * (0.3 + 0.4 * k);
}

TEST(J2Plastic, EndsOnItsBoundAndKeepsTheVolume) {
  for (const Space space : {Space::plane_strain, Space::plane_stress}) {
    const auto metal = law(space, false);
    Memory memory = Memory::Zero();
    for (int k : {1, 2, 3, -3}) {  // on, and back
      const Memory before = memory;
      memory = metal.flow(in_plane(gradient(k)), before);
      const auto s = metal.stress(in_plane(gradient(k)), memory).full();
      const double q = mises(s(0, 0), s(1, 1), metal.stress_across(in_plane(gradient(k)), memory), s(0, 1));
      EXPECT_GT(memory[3], before[3]);
      EXPECT_NEAR(q, yield + hardening * memory[3], 1e-13 * q);
      // the plastic strain is along the deviator: its size is 3/2 of q per q
      const Memory flown = memory - before;
      EXPECT_NEAR(
          2.0 / 3 *
              (flown[0] * flown[0] + flown[1] * flown[1] + 2 * flown[2] * flown[2] + std::pow(flown[0] + flown[1], 2)),
          flown[3] * flown[3], 1e-13 * flown[3] * flown[3]);
      EXPECT_NEAR(flown[2] / flown[3], 1.5 * s(0, 1) / q, 1e-12);
      // once there it stays: an increment that moves nothing flows no more
      EXPECT_EQ(largest_entry(metal.flow(in_plane(gradient(k)), memory) - memory), 0);
    }
  }
}

TEST(J2Plastic, EndsOnItsTable) {
  for (const Space space : {Space::plane_strain, Space::plane_stress}) {
    const auto metal = law(space, false, rows);
    int pieces = 0;
    double last = 0;
    for (double size : {0.1, 0.5, 0.7, 0.9, 1.1, 1.5}) {
      const Mat<double, 2> H = size * gradient(2);
      const Memory memory = metal.flow(in_plane(H), Memory::Zero());
      const auto s = metal.stress(in_plane(H), memory).full();
      const double q = mises(s(0, 0), s(1, 1), metal.stress_across(in_plane(H), memory), s(0, 1));
      if (memory[3] > 0) {
        EXPECT_NEAR(q, stress_in_table(memory[3]), 1e-13 * q) << size;
      }
      for (const auto& row : rows) pieces += last < row.strain.value && memory[3] >= row.strain.value;
      last = memory[3];
    }
    EXPECT_EQ(pieces, 3) << "all corners were passed";
  }
  // along a straight path of deviators one large increment is a thousand small ones
  const auto metal = law(Space::plane_strain, false, rows);
  Mat<double, 2> H;
  H << 0.022, 0.004, -0.002, -0.022;
  const Memory once = metal.flow(in_plane(H), Memory::Zero());
  Memory many = Memory::Zero();
  for (int k = 1; k <= 1000; ++k) many = metal.flow(in_plane(H * (k / 1000.0)), many);
  EXPECT_GT(once[3], rows[2].strain.value);
  EXPECT_LE(largest_entry(once - many), 1e-13 * once[3] * 1000);  // a rounding each
}

TEST(J2Plastic, TellsHowFarItIsFromACorner) {
  const auto metal = law(Space::plane_stress, false, rows);
  Mat<double, 2> H = Mat<double, 2>::Zero();
  double low = 0, high = 0.04;  // a shear that ends at the second row
  for (int k = 0; k < 200; ++k) {
    H(0, 1) = (low + high) / 2;
    (metal.flow(in_plane(H), Memory::Zero())[3] < rows[1].strain.value ? low : high) = H(0, 1);
  }
  EXPECT_LE(metal.margin(in_plane(H), Memory::Zero()), 1e-13);
  H(0, 1) *= 1.01;
  EXPECT_GT(metal.margin(in_plane(H), Memory::Zero()), 1e-3);
}

TEST(J2Plastic, OfPlaneStressIsThatOfRevolutionWithNoStressAcross) {
  // the strain across is sought by halving until the radial return of three stresses leaves none across
  const auto plane = law(Space::plane_stress, false), solid = law(Space::axisymmetric, false);
  Memory memory = Memory::Zero(), reference = Memory::Zero();
  for (int k : {0, 2, 3, -2}) {
    Mat<double, 3> H = Mat<double, 3>::Zero();
    H.topLeftCorner<2, 2>() = gradient(k);
    double low = -1, high = 1;
    for (int i = 0; i < 60; ++i) {
      H(2, 2) = (low + high) / 2;
      (solid.stress(with_hoop(H), solid.flow(with_hoop(H), reference))(2, 2) > 0 ? high : low) = H(2, 2);
    }
    reference = solid.flow(with_hoop(H), reference);
    memory = plane.flow(in_plane(gradient(k)), memory);
    EXPECT_LE(largest_entry(memory - reference), 1e-13) << k;
    EXPECT_LE(largest_entry(plane.stress(in_plane(gradient(k)), memory).full() -
                            solid.stress(with_hoop(H), reference).matrix()),
              1e-12 * E)
        << k;
  }
}

/// Stress after flow, and the memory, of H and a memory before: eight numbers of as many.
template <class T>
Vector<T> outcome(const J2Law<T>& metal, const Vector<T>& in) {
  const auto H = in_plane(in.head(4).reshaped(2, 2));
  const Vec<T, 4> before = in.tail(4), after = metal.flow(H, before);
  Vector<T> out(8);
  out << metal.stress(H, after).full().reshaped(), after;
  return out;
}

/// `table`: rows of the law's hardening, empty where it is linear.
void expect_derivatives_of_complex_step(const Table& table) {
  using Complex = std::complex<double>;
  constexpr int n = 8;
  for (const Space space : {Space::plane_strain, Space::plane_stress})
    for (bool finite : {false, true}) {
      Vector<double> in(n);
      in << gradient(2).reshaped(), 0.002, -0.001, 0.003, 0.004;
      Vector<Dual<n>> seeded(n);
      for (int k = 0; k < n; ++k) seeded[k] = Dual<n>::seed(in[k], k);
      const auto out = outcome<Dual<n>>(law<Dual<n>>(space, finite, table), seeded);
      EXPECT_GT(value(out[7]), 0.0041);
      for (int k = 0; k < n; ++k) {
        Vector<Complex> shifted = in.cast<Complex>();
        shifted[k] += Complex(0, 1e-30);
        const auto exact = outcome<Complex>(law<Complex>(space, finite, table), shifted);
        for (int i = 0; i < n; ++i) EXPECT_NEAR(out[i].d[k], exact[i].imag() / 1e-30, 1e-12 * E) << i << k;
      }
      for (int i = 0; i < 4; ++i)
        for (int k = 0; k < i; ++k) EXPECT_NEAR(out[i].d[k], out[k].d[i], 1e-12 * E) << i << k;
    }
}

TEST(J2Plastic, HasTheDerivativesOfTheComplexStepAndASymmetricTangent) {
  expect_derivatives_of_complex_step({});
  expect_derivatives_of_complex_step({{0.005, 1.52}, {0.03, 2.1}});
}

void expect_turning(Space space) {
  const auto metal = law(space, true);
  const Eigen::Rotation2Dd turned(0.7);
  Memory still = Memory::Zero(), moved = Memory::Zero();
  for (int k : {1, 3, 8, -5}) {
    const Mat<double, 2> F = Mat<double, 2>::Identity() + gradient(k), RF = turned.toRotationMatrix() * F;
    still = metal.flow(in_plane(gradient(k)), still);
    moved = metal.flow(in_plane(RF - Mat<double, 2>::Identity()), moved);
    EXPECT_LE(largest_entry(moved - still), 1e-14) << k;
    const auto P = metal.stress(in_plane(gradient(k)), still).full();
    EXPECT_LE(largest_entry(metal.stress(in_plane(RF - Mat<double, 2>::Identity()), moved).full() -
                            turned.toRotationMatrix() * P),
              1e-13 * E)
        << k;
    // principal stretches of F (I + C) F^T give the Kirchhoff stress: logarithms, by an eigensolver
    Mat<double, 2> C;
    C << 1 + still[0], still[2], still[2], 1 + still[1];
    const Eigen::SelfAdjointEigenSolver<Mat<double, 2>> spectrum(F * C * F.transpose());
    const double stretch = metal.stretch_across(in_plane(gradient(k)), still);
    const double across = std::log(stretch) - std::log(C.determinant()) / 2;
    const Vec<double, 2> e = spectrum.eigenvalues().array().log() / 2;
    const double lame = E * nu / ((1 + nu) * (1 - 2 * nu)), pressure = lame * (e.sum() + across);
    const Vec<double, 2> principal = (pressure + 2 * G * e.array()).matrix();
    const Mat<double, 2> tau = spectrum.eigenvectors() * principal.asDiagonal() * spectrum.eigenvectors().transpose();
    EXPECT_LE(largest_entry(P * F.transpose() - tau), 1e-12 * E) << k;
    EXPECT_NEAR(mises(tau(0, 0), tau(1, 1), pressure + 2 * G * across, tau(0, 1)), yield + hardening * still[3],
                1e-12 * E);
    if (space == Space::plane_stress) {
      EXPECT_NEAR(pressure + 2 * G * across, 0, 1e-12 * E) << k;
    }
  }
}

TEST(J2Plastic, OfFiniteStrainTurnsWithARotationAndKeepsTheVolume) {
  for (const Space space : {Space::plane_strain, Space::plane_stress}) expect_turning(space);
}

void expect_limit_of_small_strain(Space space) {
  std::array<double, 2> apart;
  for (int level : {0, 1}) {
    const double share = level == 0 ? 1e-3 : 1e-4;
    Numbers<double> none;
    auto soft = law_of<double>(J2Plastic{E, nu, yield * share, hardening}, space, Strains::finite, none);
    auto like = law_of<double>(J2Plastic{E, nu, yield * share, hardening}, space, Strains::small, none);
    const Mat<double, 2> H = gradient(2) * share;
    const auto a = soft.stress(in_plane(H), soft.flow(in_plane(H), Memory::Zero())).full();
    const auto b = like.stress(in_plane(H), like.flow(in_plane(H), Memory::Zero())).full();
    apart[level] = largest_entry(a - b) / largest_entry(b);
  }
  EXPECT_NEAR(std::log10(apart[0] / apart[1]), 1, 0.05);
  EXPECT_LT(apart[1], 1e-4);
}

TEST(J2Plastic, OfFiniteStrainIsThatOfSmallStrainToFirstOrder) {
  for (const Space space : {Space::plane_strain, Space::plane_stress}) expect_limit_of_small_strain(space);
}

void expect_stress_of_energy(Space space) {
  const auto metal = law<Dual<4>>(space, true);
  const auto plain = law(space, true);
  const Memory memory(0.01, -0.02, 0.005, 0.03);
  Mat<Dual<4>, 2> H;
  for (int k = 0; k < 4; ++k) H.data()[k] = Dual<4>::seed(gradient(1).data()[k], k);
  const auto energy = metal.energy(in_plane(H), memory.cast<Dual<4>>());
  const auto P = plain.stress(in_plane(gradient(1)), memory);
  for (int k = 0; k < 4; ++k) EXPECT_NEAR(energy.d[k], P[k], 1e-13 * E);
  Mat<double, 2> inverted = Mat<double, 2>::Zero();
  inverted(0, 0) = -2;
  EXPECT_TRUE(std::isnan(plain.stress(in_plane(inverted), memory)(0, 0)));
  EXPECT_EQ(largest_entry(plain.flow(in_plane(inverted), memory) - memory), 0);
}

TEST(J2Plastic, OfFiniteStrainHasTheStressOfItsEnergyWhereNothingFlows) {
  for (const Space space : {Space::plane_strain, Space::plane_stress}) expect_stress_of_energy(space);
}

TEST(Logarithms, OfPlaneTensorsAreThoseOfAnEigensolver) {
  for (double size : {1e-9, 1e-3, 0.15, 0.2, 0.6, 3.0})
    for (double apart : {0.0, 1e-9, 0.3, 1.0}) {
      const Symmetric<double, 2> A(size * (1 + apart), size * (1 - apart), 0.4 * size * apart);
      Mat<double, 2> matrix;
      matrix << A[0], A[2], A[2], A[1];
      const Eigen::SelfAdjointEigenSolver<Mat<double, 2>> spectrum(matrix);
      const auto expect = [&](const Symmetric<double, 2>& got, auto&& f) {
        const Mat<double, 2> wanted = spectrum.eigenvectors() *
                                      Vec<double, 2>(spectrum.eigenvalues().unaryExpr(f)).asDiagonal() *
                                      spectrum.eigenvectors().transpose();
        const double scale = 4e-15 * largest_entry(wanted);
        EXPECT_NEAR(got[0], wanted(0, 0), scale) << size << " " << apart;
        EXPECT_NEAR(got[1], wanted(1, 1), scale) << size << " " << apart;
        EXPECT_NEAR(got[2], wanted(0, 1), scale) << size << " " << apart;
      };
      expect(log_of_one_plus<double>(A), [](double x) { return std::log1p(x); });
      expect(exp_minus_one<double>(A), [](double x) { return std::expm1(x); });
    }
}

}  // namespace
}  // namespace stickslip::j2_plastic_test
