/// Inertia against the eigenvalues of dense matrices.
#include "core/algebra/inertia.hpp"

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <random>

namespace stickslip::inertia_test {
namespace {

using Eigen::MatrixXd;

/// The pattern and the values of a symmetric matrix, whole.
std::pair<std::shared_ptr<Pattern>, std::vector<double>> sparse(const MatrixXd& dense) {
  auto pattern = std::make_shared<Pattern>();
  std::vector<double> values;
  pattern->size = static_cast<int>(dense.rows());
  pattern->column_start.push_back(0);
  for (int j = 0; j < dense.cols(); ++j) {
    for (int i = 0; i < dense.rows(); ++i) {
      if (dense(i, j) == 0 && i != j) continue;
      pattern->row.push_back(i);
      values.push_back(dense(i, j));
    }
    pattern->column_start.push_back(pattern->nonzeros());
  }
  return {pattern, values};
}

TEST(Inertia, CountsTheNegativeEigenvalues) {
  std::mt19937 random(7);
  std::normal_distribution<double> normal;
  for (const int n : {1, 2, 9, 40})
    for (const double shift : {20.0, 3.0, 1.0, 0.0, -1.0, -20.0}) {  // from all positive to all negative
      MatrixXd A = MatrixXd::Zero(n, n);
      for (int j = 0; j < n; ++j)
        for (int i = std::max(0, j - 4); i < j; ++i) A(i, j) = A(j, i) = normal(random);
      for (int j = 0; j < n; ++j) A(j, j) = normal(random) + shift;
      const auto [pattern, values] = sparse(A);
      Inertia inertia(pattern);
      long factorizations = 0;
      const auto negative = inertia.negative_eigenvalues(values, factorizations);
      const auto expected = (A.selfadjointView<Eigen::Lower>().eigenvalues().array() < 0).count();
      ASSERT_TRUE(negative.has_value()) << n << ' ' << shift;
      EXPECT_EQ(*negative, expected) << n << ' ' << shift;
      EXPECT_GE(factorizations, 1);
    }
}

TEST(Inertia, IsCountedAnewForOtherValuesOfThePattern) {
  const auto [pattern, values] = sparse(MatrixXd{{2, 1, 0}, {1, 2, 1}, {0, 1, 2}});
  const auto [same, reversed] = sparse(MatrixXd{{-2, 1, 0}, {1, 2, 1}, {0, 1, -2}});
  Inertia inertia(pattern);
  long factorizations = 0;
  EXPECT_EQ(inertia.negative_eigenvalues(values, factorizations), 0);
  EXPECT_EQ(inertia.negative_eigenvalues(reversed, factorizations), 2);
  EXPECT_EQ(inertia.negative_eigenvalues(values, factorizations), 0);
}

TEST(Inertia, OfNothingIsZero) {
  long factorizations = 0;
  EXPECT_EQ(Inertia(std::make_shared<Pattern>()).negative_eigenvalues({}, factorizations), 0);
  EXPECT_EQ(factorizations, 0);
}

}  // namespace
}  // namespace stickslip::inertia_test
