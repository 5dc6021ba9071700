#include "core/algebra/dense_factor.hpp"

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <limits>
#include <random>

#include "tests/support/largest.hpp"

namespace stickslip::dense_factor_test {
namespace {

using Eigen::MatrixXd;

MatrixXd arbitrary_matrix(int n, unsigned seed) {
  std::mt19937 generator(seed);
  std::uniform_real_distribution<double> uniform(-1, 1);
  return MatrixXd::NullaryExpr(n, n, [&] { return uniform(generator); });
}

/// Rounding times a condition number of some 1e3.
constexpr double solved = 1e-12;

TEST(DenseFactor, SolvesWithTheMatrixAndWithItsTranspose) {
  const MatrixXd a = arbitrary_matrix(9, 1), spd = a * a.transpose() + MatrixXd::Identity(9, 9);
  const MatrixXd b = arbitrary_matrix(9, 20).leftCols(3);
  for (const auto& [matrix, symmetry] :
       {std::pair{a, Symmetry::general}, {spd, Symmetry::positive_definite}, {spd, Symmetry::general}}) {
    DenseFactor<double> factor;
    long factorizations = 0;
    ASSERT_TRUE(factor.factorise(matrix, symmetry, factorizations)) << factor.message();
    EXPECT_EQ(factorizations, 1);
    EXPECT_LT((matrix * factor.solve(b) - b).norm(), solved * b.norm());
    EXPECT_LT((matrix.transpose() * factor.solve(b, Taken::transposed) - b).norm(), solved * b.norm());
    EXPECT_EQ(factor.determinant_sign(), matrix.determinant() > 0 ? 1 : -1);
  }
}

TEST(DenseFactor, FallsBackToLUWhereAMatrixIsNotPositiveDefinite) {
  MatrixXd a = MatrixXd::Identity(4, 4);
  a(2, 2) = -3;
  DenseFactor<double> factor;
  long factorizations = 0;
  ASSERT_TRUE(factor.factorise(a, Symmetry::positive_definite, factorizations));
  EXPECT_EQ(factorizations, 2);
  EXPECT_EQ(factor.determinant_sign(), -1);
  EXPECT_LT((a * factor.solve(a) - a).norm(), solved);
}

TEST(DenseFactor, DependsOnNoUnits) {
  const MatrixXd a = arbitrary_matrix(8, 3), spd = a * a.transpose() + MatrixXd::Identity(8, 8);
  const MatrixXd b = arbitrary_matrix(8, 30).leftCols(2);
  Eigen::VectorXd rows(8), columns(8);
  for (int i = 0; i < 8; ++i) {
    rows[i] = std::exp2(11 * i - 40);
    columns[i] = std::exp2(35 - 9 * i);
  }
  for (const auto symmetry : {Symmetry::general, Symmetry::positive_definite}) {
    const bool symmetric = symmetry == Symmetry::positive_definite;
    const MatrixXd matrix = symmetric ? spd : a;
    const Eigen::VectorXd right = symmetric ? rows : columns;
    const MatrixXd scaled = rows.asDiagonal() * matrix * right.asDiagonal();
    DenseFactor<double> factor, of_scaled;
    long factorizations = 0;
    ASSERT_TRUE(factor.factorise(matrix, symmetry, factorizations));
    ASSERT_TRUE(of_scaled.factorise(scaled, symmetry, factorizations)) << of_scaled.message();
    EXPECT_EQ(factorizations, 2);
    const MatrixXd x = factor.solve(b), y = right.asDiagonal() * of_scaled.solve(rows.asDiagonal() * b);
    EXPECT_LT((x - y).norm(), solved * x.norm());
    EXPECT_EQ(of_scaled.determinant_sign(), factor.determinant_sign());
  }
}

TEST(DenseFactor, EstimatesTheConditionOfTheMatrixAsItIs) {
  for (const double scale : {1.0, 1e6}) {
    MatrixXd a = arbitrary_matrix(7, 11);
    a.row(2) *= scale;
    DenseFactor<double> factor;
    long factorizations = 0;
    ASSERT_TRUE(factor.factorise(a, Symmetry::general, factorizations));
    const auto norm = [](const MatrixXd& m) { return largest_entry(m.cwiseAbs().colwise().sum()); };
    const double exact = norm(a) * norm(a.inverse());
    EXPECT_LE(factor.condition_estimate(), 1.0001 * exact);  // Higham: a lower bound
    EXPECT_GE(factor.condition_estimate(), exact / 3);       // rarely off by more
  }
}

TEST(DenseFactor, RefusesWhatIsSingularOrNotFinite) {
  long factorizations = 0;
  for (const auto symmetry : {Symmetry::general, Symmetry::positive_definite}) {
    DenseFactor<double> factor;
    MatrixXd a = MatrixXd::Constant(5, 5, 1.0);
    EXPECT_FALSE(factor.factorise(a, symmetry, factorizations));
    EXPECT_EQ(factor.message(), "the tangent is singular to working precision");
    EXPECT_EQ(factor.condition_estimate(), 0);
    EXPECT_FALSE(factor.factorise(1e-200 * a, symmetry, factorizations));
    EXPECT_FALSE(factor.factorise(MatrixXd::Zero(3, 3), symmetry, factorizations));
    a(1, 2) = std::numeric_limits<double>::quiet_NaN();
    EXPECT_FALSE(factor.factorise(a, symmetry, factorizations));
    EXPECT_EQ(factor.message(), "the tangent is not finite");
    ASSERT_TRUE(factor.factorise(MatrixXd::Identity(5, 5), symmetry, factorizations));
    EXPECT_TRUE(factor.message().empty());
  }
}

TEST(DenseFactor, OfNothingSolvesNothing) {
  DenseFactor<double> factor;
  long factorizations = 0;
  ASSERT_TRUE(factor.factorise(-MatrixXd::Identity(3, 3), Symmetry::general, factorizations));
  ASSERT_TRUE(factor.factorise(MatrixXd(0, 0), Symmetry::general, factorizations));
  EXPECT_EQ(factor.determinant_sign(), 1);
  EXPECT_EQ(factor.solve(MatrixXd(0, 2)).cols(), 2);
}

TEST(DenseFactor, OfAComplexMatrixCarriesTheDerivative) {
  const MatrixXd a = arbitrary_matrix(6, 5), spd = a * a.transpose() + MatrixXd::Identity(6, 6);
  const MatrixXd change = a + a.transpose(), b = arbitrary_matrix(6, 50).leftCols(1);
  constexpr double h = 1e-30;
  DenseFactor<std::complex<double>> factor;
  long factorizations = 0;
  ASSERT_TRUE(factor.factorise(spd.cast<std::complex<double>>() + std::complex<double>(0, h) * change,
                               Symmetry::positive_definite, factorizations));
  const Matrix<std::complex<double>> x = factor.solve(b.cast<std::complex<double>>());
  const MatrixXd derivative = -spd.ldlt().solve(change * spd.ldlt().solve(b));
  EXPECT_LT((x.imag() / h - derivative).norm(), solved * derivative.norm());
}

}  // namespace
}  // namespace stickslip::dense_factor_test
