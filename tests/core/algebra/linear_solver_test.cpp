#include "core/algebra/linear_solver.hpp"

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <cmath>
#include <limits>
#include <random>
#include <stdexcept>

namespace stickslip::linear_solver_test {
namespace {

using Eigen::MatrixXd;
using Complex = std::complex<double>;

/// A matrix as the solver takes it: every entry that `stored` marks, zero or not, in a symmetric structure.
template <class T>
struct Stored {
  std::shared_ptr<Pattern> pattern = std::make_shared<Pattern>();
  std::vector<T> values;
  const T* data() const { return values.data(); }
};

template <class T>
Stored<T> store(const Matrix<T>& a, bool whole = false) {
  Stored<T> result;
  result.pattern->size = static_cast<int>(a.rows());
  result.pattern->column_start.push_back(0);
  for (int j = 0; j < a.cols(); ++j) {
    for (int i = 0; i < a.rows(); ++i)
      if (whole || i == j || a(i, j) != T(0) || a(j, i) != T(0)) {
        result.pattern->row.push_back(i);
        result.values.push_back(a(i, j));
      }
    result.pattern->column_start.push_back(result.pattern->nonzeros());
  }
  return result;
}

/// Stiffness of a membrane of side x side nodes: SPD where `spring` > 0, else singular (it floats).
MatrixXd membrane(int side, double spring) {
  const int n = side * side;
  MatrixXd a = MatrixXd::Zero(n, n);
  const auto join = [&](int i, int j) {
    a(i, i) += 1;
    a(j, j) += 1;
    a(i, j) -= 1;
    a(j, i) -= 1;
  };
  for (int i = 0; i < n; ++i) {
    if (i % side + 1 < side) join(i, i + 1);
    if (i + side < n) join(i, i + side);
    a(i, i) += spring;
  }
  return a;
}

/// Random entries in a random symmetric structure, no dominant diagonal.
template <class T = double>
Matrix<T> random_sparse(int n, unsigned seed) {
  std::mt19937 generator(seed);
  std::uniform_real_distribution<double> uniform(-1, 1);
  const auto number = [&] {
    if constexpr (std::is_same_v<T, double>)
      return uniform(generator);
    else
      return T(uniform(generator), uniform(generator));
  };
  Matrix<T> a = Matrix<T>::Zero(n, n);
  for (int i = 0; i < n; ++i) a(i, i) = number();
  for (int k = 0; k < 3 * n; ++k) {
    const int i = static_cast<int>(generator() % n), j = static_cast<int>(generator() % n);
    a(i, j) = number();
    a(j, i) = number();
  }
  return a;
}

/// Two floating membranes tied node by node by multipliers, the first held by springs: symmetric, zero diagonal in the
/// multiplier rows. With `slip` those rows lose their symmetry, as those of sliding nodes do.
MatrixXd saddle(int side, bool slip) {
  const int n = side * side;
  MatrixXd a = MatrixXd::Zero(2 * n + side, 2 * n + side);
  a.topLeftCorner(n, n) = membrane(side, 0.1);
  a.block(n, n, n, n) = membrane(side, 0);
  for (int i = 0; i < side; ++i) {
    const int upper = n - 1 - i, lower = n + i, multiplier = 2 * n + i;
    a(multiplier, upper) = 1;
    a(multiplier, lower) = -1;
    const double friction = slip ? 0.3 : 1;
    a(upper, multiplier) = friction;
    a(lower, multiplier) = -friction;
  }
  return a;
}

MatrixXd right_hand_sides(const MatrixXd& a, int columns = 3) {
  std::srand(7);
  return MatrixXd::Random(a.rows(), columns);
}

double relative_error(const MatrixXd& x, const MatrixXd& exact) { return (x - exact).norm() / exact.norm(); }

double dense_condition(const MatrixXd& a) {
  return a.cwiseAbs().colwise().sum().maxCoeff<Eigen::PropagateNaN>() *
         a.inverse().cwiseAbs().colwise().sum().maxCoeff<Eigen::PropagateNaN>();
}

/// Forward error to expect of a backward stable solve: condition number times rounding. (Measured: half of it at most.)
double tolerance_for(const MatrixXd& a) { return std::numeric_limits<double>::epsilon() * dense_condition(a); }

class EveryBackend : public testing::TestWithParam<Backend> {
 protected:
  /// Solves with A and with A^T and compares both with dense LU.
  void expect_solves(const MatrixXd& a, Symmetry symmetry) {
    LinearSolver<double> solver(GetParam());
    const auto stored = store<double>(a);
    solver.analyse(stored.pattern, symmetry);
    ASSERT_TRUE(solver.factorise(stored.data())) << solver.message();
    const MatrixXd b = right_hand_sides(a);
    EXPECT_LT(relative_error(solver.solve(b), a.partialPivLu().solve(b)), tolerance_for(a)) << solver.name();
    EXPECT_LT(solver.backward_error(), 1e-11);  // what every backend is held to without refinement
    EXPECT_LT(relative_error(solver.solve(b, Taken::transposed), a.transpose().partialPivLu().solve(b)),
              tolerance_for(a));
    EXPECT_LT(solver.backward_error(), 1e-11);
    EXPECT_GT(solver.factor_nonzeros(), a.rows());
    const auto stored_entries = solver.factor_nonzeros() - a.rows();  // a diagonal of ones need not be stored
    EXPECT_GE(solver.factor_bytes(), static_cast<long>(sizeof(double)) * stored_entries);
  }

  /// Expects factorise() to refuse the matrix, say why, and to take a good one afterwards.
  void expect_refused(const MatrixXd& a, Symmetry symmetry, const std::string& part_of_message) {
    LinearSolver<double> solver(GetParam());
    auto stored = store<double>(a);
    solver.analyse(stored.pattern, symmetry);
    EXPECT_FALSE(solver.factorise(stored.data())) << solver.name();
    EXPECT_NE(solver.message().find(part_of_message), std::string::npos) << solver.name() << ": " << solver.message();
    EXPECT_THROW(solver.solve(right_hand_sides(a)), std::logic_error);
    const int n = stored.pattern->size;
    for (int j = 0; j < n; ++j)
      for (int e = stored.pattern->column_start[j]; e < stored.pattern->column_start[j + 1]; ++e)
        stored.values[e] = stored.pattern->row[e] == j ? 2 : 0;
    ASSERT_TRUE(solver.factorise(stored.data())) << solver.name() << ": " << solver.message();
    EXPECT_TRUE(solver.message().empty());
    // Two roundings of sqrt(2) in a Cholesky, nothing elsewhere.
    EXPECT_LT((solver.solve(MatrixXd::Ones(n, 1)).array() - 0.5).abs().maxCoeff<Eigen::PropagateNaN>(),
              4 * std::numeric_limits<double>::epsilon());
  }
};

std::string name_of(const testing::TestParamInfo<Backend>& backend) {
  constexpr const char* names[] = {"automatic", "cholmod", "mumps", "eigen"};
  return names[static_cast<int>(backend.param)];
}

/// Those of this build (the listing test holds them to what it says of itself).
std::vector<Backend> built_backends() {
  std::vector<Backend> built;
  for (auto each : {Backend::automatic, Backend::cholmod, Backend::mumps, Backend::eigen})
    if (has_backend(each)) built.push_back(each);
  return built;
}

INSTANTIATE_TEST_SUITE_P(LinearSolver, EveryBackend, testing::ValuesIn(built_backends()), name_of);

TEST_P(EveryBackend, SolvesARandomSparseMatrixAndItsTranspose) {
  for (unsigned seed : {1u, 2u, 3u}) expect_solves(random_sparse(60, seed), Symmetry::general);
  expect_solves(random_sparse(400, 4), Symmetry::general);  // above the size below which automatic means Eigen
}

TEST_P(EveryBackend, SolvesASymmetricPositiveDefiniteMatrix) {
  expect_solves(membrane(12, 0.01), Symmetry::positive_definite);
  expect_solves(membrane(12, 0.01), Symmetry::general);
}

TEST_P(EveryBackend, SolvesASymmetricSaddlePointWithZeroDiagonal) {
  expect_solves(saddle(6, false), Symmetry::indefinite);
  expect_solves(saddle(13, false), Symmetry::indefinite);
}

TEST_P(EveryBackend, SolvesAnUnsymmetricSaddlePointWithZeroDiagonal) {
  expect_solves(saddle(6, true), Symmetry::general);
  expect_solves(saddle(13, true), Symmetry::general);
}

TEST_P(EveryBackend, SolvesWithExplicitZerosInThePattern) {
  LinearSolver<double> solver(GetParam());
  const MatrixXd a = saddle(4, true);
  const auto stored = store<double>(a, true);
  solver.analyse(stored.pattern, Symmetry::general);
  ASSERT_TRUE(solver.factorise(stored.data())) << solver.message();
  const MatrixXd b = right_hand_sides(a);
  EXPECT_LT(relative_error(solver.solve(b), a.partialPivLu().solve(b)), tolerance_for(a));
}

TEST_P(EveryBackend, SolvesEmptyAndOneByOneSystems) {
  LinearSolver<double> solver(GetParam());
  for (const Symmetry symmetry : {Symmetry::positive_definite, Symmetry::indefinite, Symmetry::general}) {
    solver.analyse(store<double>(MatrixXd(0, 0)).pattern, symmetry);
    EXPECT_TRUE(solver.factorise(nullptr));
    EXPECT_EQ(solver.solve(MatrixXd(0, 2)).cols(), 2);
    EXPECT_EQ(solver.condition_estimate(), 1);
    const double four = 4;
    solver.analyse(store<double>(MatrixXd::Constant(1, 1, four)).pattern, symmetry);
    ASSERT_TRUE(solver.factorise(&four)) << solver.message();
    EXPECT_EQ(solver.solve(MatrixXd::Constant(1, 1, 2.0))(0, 0), 0.5);
    EXPECT_EQ(solver.condition_estimate(), 1);
  }
}

TEST_P(EveryBackend, SolvesManyRightHandSidesAsItSolvesOne) {
  LinearSolver<double> solver(GetParam());
  const MatrixXd a = saddle(13, true), b = right_hand_sides(a, 70);  // more than two blocks of MUMPS
  const auto stored = store<double>(a);
  solver.analyse(stored.pattern, Symmetry::general);
  ASSERT_TRUE(solver.factorise(stored.data()));
  const MatrixXd x = solver.solve(b);
  for (int c : {0, 31, 32, 69}) EXPECT_LT(relative_error(x.col(c), solver.solve(b.col(c))), tolerance_for(a));
  EXPECT_EQ(solver.solve(MatrixXd(a.rows(), 0)).cols(), 0);
}

TEST_P(EveryBackend, RefusesAnEmptyRow) {
  MatrixXd a = random_sparse(30, 5);
  a.row(17).setZero();
  expect_refused(a, Symmetry::general, "singular");
  a.col(17).setZero();
  expect_refused(a, Symmetry::general, "singular");
  MatrixXd s = membrane(6, 0.1);
  s.row(17).setZero();
  s.col(17).setZero();
  expect_refused(s, Symmetry::indefinite, "singular");
  expect_refused(s, Symmetry::positive_definite, "singular");
}

TEST_P(EveryBackend, NamesTheUnknownThatNothingHolds) {
  MatrixXd a = membrane(20, 0.1);
  a.row(123).setZero();
  a.col(123).setZero();
  expect_refused(a, Symmetry::general, "123");
  expect_refused(a, Symmetry::positive_definite, "123");
}

TEST_P(EveryBackend, RefusesAFloatingBody) {
  for (int side : {2, 5, 20})
    for (const Symmetry symmetry : {Symmetry::positive_definite, Symmetry::indefinite, Symmetry::general})
      expect_refused(membrane(side, 0), symmetry, "singular");
  // In units in which unknowns and equations differ by ten decades the same body floats as freely.
  MatrixXd scaled = membrane(10, 0) * 1e7;
  scaled.topRows(50) *= 1e-6;
  scaled.rightCols(30) *= 1e4;
  expect_refused(scaled, Symmetry::general, "singular");
}

TEST_P(EveryBackend, RefusesARankDeficientMatrix) {
  // Decimal entries, so that elimination leaves rounding noise, not zero, where the pivot vanishes.
  for (unsigned seed : {1u, 2u, 3u, 4u}) {
    MatrixXd a = random_sparse(50, seed);
    a.row(20) = 0.3 * a.row(4) - 0.7 * a.row(40);
    expect_refused(a, Symmetry::general, "singular");
  }
}

TEST_P(EveryBackend, RefusesTwoMultipliersForOneConstraint) {
  const MatrixXd once = saddle(5, false);
  const int n = static_cast<int>(once.rows());
  MatrixXd a = MatrixXd::Zero(n + 1, n + 1);
  a.topLeftCorner(n, n) = once;
  a.row(n).head(n) = once.row(n - 1);
  a.col(n).head(n) = once.col(n - 1);
  expect_refused(a, Symmetry::indefinite, "singular");
  expect_refused(a, Symmetry::general, "singular");
}

TEST_P(EveryBackend, AcceptsAStiffPenalty) {
  // Two floating membranes, one spring of stiffness p between each pair of nodes, one weak support: condition ~ 100 p.
  const int side = 6, n = side * side;
  for (const double penalty : {1e4, 1e8, 1e11}) {
    MatrixXd a = MatrixXd::Zero(2 * n, 2 * n);
    a.topLeftCorner(n, n) = membrane(side, 0.1);
    a.bottomRightCorner(n, n) = membrane(side, 0);
    for (int i = 0; i < side; ++i) {
      a(i, i) += penalty;
      a(n + i, n + i) += penalty;
      a(i, n + i) -= penalty;
      a(n + i, i) -= penalty;
    }
    for (const Symmetry symmetry : {Symmetry::positive_definite, Symmetry::general}) {
      LinearSolver<double> solver(GetParam());
      const auto stored = store<double>(a);
      solver.analyse(stored.pattern, symmetry);
      EXPECT_TRUE(solver.factorise(stored.data())) << penalty << " " << solver.name() << ": " << solver.message();
      EXPECT_EQ(solver.counters().fallbacks, 0);
    }
  }
}

TEST_P(EveryBackend, AcceptsAMatrixWhoseUnitsAreFarApart) {
  // Multipliers and displacements ten decades apart, as stresses in Pa and lengths in m are.
  MatrixXd a = saddle(8, true);
  const int u = 128;
  a.topRows(u) *= 1e11;
  a.rightCols(8) *= 1e-10;
  const MatrixXd x = right_hand_sides(a), b = a * x;
  LinearSolver<double> solver(GetParam());
  const auto stored = store<double>(a);
  solver.analyse(stored.pattern, Symmetry::general);
  ASSERT_TRUE(solver.factorise(stored.data())) << solver.message();
  const MatrixXd solved = solver.solve(b);
  EXPECT_LT(solver.backward_error(), 1e-12);
  // The membrane's own condition number, about 1e3, times rounding and the rounding of b.
  EXPECT_LT(relative_error(solved.topRows(u), x.topRows(u)), 1e-10);
}

TEST_P(EveryBackend, RefusesEntriesThatAreNotFinite) {
  for (const double bad : {std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::infinity(),
                           -std::numeric_limits<double>::infinity()}) {
    MatrixXd a = membrane(5, 0.1);
    a(7, 2) = a(2, 7) = bad;
    for (const Symmetry symmetry : {Symmetry::positive_definite, Symmetry::indefinite, Symmetry::general})
      expect_refused(a, symmetry, "row 7, column 2 is not finite");
  }
}

TEST_P(EveryBackend, RefusesAMatrixWhoseFactorOverflows) {
  MatrixXd a = random_sparse(12, 9);
  a.diagonal().setConstant(1e-200);
  a *= 1e300;
  a(3, 3) = 1e-300;
  LinearSolver<double> solver(GetParam());
  const auto stored = store<double>(a);
  solver.analyse(stored.pattern, Symmetry::general);
  // Either outcome is fine; what must not come out is a solution with a nan or infinity in it.
  if (solver.factorise(stored.data())) {
    EXPECT_TRUE(solver.solve(MatrixXd::Ones(12, 1)).allFinite()) << solver.name();
  } else {
    EXPECT_FALSE(solver.message().empty());
  }
}

TEST_P(EveryBackend, CountsItsWork) {
  LinearSolver<double> solver(GetParam());
  const MatrixXd a = membrane(8, 0.5);
  const auto stored = store<double>(a);
  solver.analyse(stored.pattern, Symmetry::positive_definite);
  for (int i = 0; i < 3; ++i) ASSERT_TRUE(solver.factorise(stored.data()));
  solver.solve(right_hand_sides(a, 5));
  solver.solve(right_hand_sides(a, 1), Taken::transposed);
  solver.condition_estimate();
  EXPECT_EQ(solver.counters().analyses, 1);
  EXPECT_EQ(solver.counters().factorizations, 3);
  EXPECT_EQ(solver.counters().backsolves, 6);
  EXPECT_EQ(solver.counters().fallbacks, 0);
  solver.analyse(stored.pattern, Symmetry::general);
  EXPECT_EQ(solver.counters().analyses, 2);
}

TEST_P(EveryBackend, EstimatesTheConditionNumber) {
  // Higham's estimate is a lower bound, within a factor 3 of the truth but for contrived matrices.
  const auto expect_estimate = [&](const MatrixXd& a, Symmetry symmetry) {
    LinearSolver<double> solver(GetParam());
    const auto stored = store<double>(a);
    solver.analyse(stored.pattern, symmetry);
    ASSERT_TRUE(solver.factorise(stored.data()));
    const double exact = dense_condition(a), estimate = solver.condition_estimate();
    EXPECT_LT(estimate, exact * (1 + tolerance_for(a)));
    EXPECT_GT(estimate, exact / 3);
  };
  expect_estimate(membrane(10, 1e-3), Symmetry::positive_definite);
  expect_estimate(saddle(6, false), Symmetry::indefinite);
  expect_estimate(saddle(6, true), Symmetry::general);
  for (unsigned seed : {1u, 2u, 3u}) expect_estimate(random_sparse(40, seed), Symmetry::general);
  MatrixXd scaled = random_sparse(40, 4);
  scaled.row(3) *= 1e9;
  expect_estimate(scaled, Symmetry::general);
}

TEST_P(EveryBackend, SolvesAMatrixThatWasNotPositiveDefiniteAfterAll) {
  MatrixXd a = membrane(9, 0.1);
  a.diagonal().array() -= 1;  // some eigenvalues of both signs
  for (const bool zero_diagonal : {false, true}) {
    if (zero_diagonal) a(40, 40) = 0;
    LinearSolver<double> solver(GetParam());
    const auto stored = store<double>(a), good = store<double>(membrane(9, 0.1));
    solver.analyse(good.pattern, Symmetry::positive_definite);
    ASSERT_TRUE(solver.factorise(good.data()));
    EXPECT_EQ(solver.counters().fallbacks, 0);
    const std::string cholesky = solver.name();
    ASSERT_TRUE(solver.factorise(stored.data())) << solver.message();
    const MatrixXd b = right_hand_sides(a);
    EXPECT_LT(relative_error(solver.solve(b), a.partialPivLu().solve(b)), tolerance_for(a)) << solver.name();
    if (solver.counters().fallbacks > 0) {
      EXPECT_NE(solver.name(), cholesky);
      EXPECT_EQ(solver.counters().fallbacks, 1);
      EXPECT_EQ(solver.counters().factorizations, 3);
      EXPECT_EQ(solver.counters().analyses, 2);
    }
    if (GetParam() == Backend::cholmod || GetParam() == Backend::mumps) {
      EXPECT_EQ(solver.counters().fallbacks, 1);
    }
    // The next matrix that is positive definite is Cholesky's again.
    ASSERT_TRUE(solver.factorise(good.data()));
    EXPECT_EQ(solver.name(), cholesky);
    const MatrixXd k = membrane(9, 0.1);
    EXPECT_LT(relative_error(solver.solve(b), k.partialPivLu().solve(b)), tolerance_for(k));
  }
}

TEST_P(EveryBackend, GivesTheSameBitsInEveryRun) {
  const MatrixXd a = saddle(13, true), b = right_hand_sides(a);
  const auto stored = store<double>(a);
  MatrixXd first;
  for (int run = 0; run < 3; ++run) {
    LinearSolver<double> solver(GetParam());
    solver.analyse(stored.pattern, Symmetry::general);
    ASSERT_TRUE(solver.factorise(stored.data()));
    ASSERT_TRUE(solver.factorise(stored.data()));
    const MatrixXd x = solver.solve(b);
    if (run == 0) first = x;
    EXPECT_EQ(x, first);
  }
}

TEST_P(EveryBackend, KeepsTheValuesItWasGiven) {
  const MatrixXd a = saddle(6, true), b = right_hand_sides(a);
  auto stored = store<double>(a);
  LinearSolver<double> solver(GetParam());
  solver.analyse(stored.pattern, Symmetry::general);
  ASSERT_TRUE(solver.factorise(stored.data()));
  std::fill(stored.values.begin(), stored.values.end(), std::numeric_limits<double>::quiet_NaN());
  EXPECT_LT(relative_error(solver.solve(b), a.partialPivLu().solve(b)), tolerance_for(a));
  EXPECT_LT(solver.backward_error(), 1e-12);
}

TEST_P(EveryBackend, SolvesAnotherPatternAfterANewAnalysis) {
  LinearSolver<double> solver(GetParam());
  for (int side : {4, 13, 7}) {
    const MatrixXd a = saddle(side, true), b = right_hand_sides(a);
    const auto stored = store<double>(a);
    solver.analyse(stored.pattern, Symmetry::general);
    EXPECT_THROW(solver.solve(b), std::logic_error);
    ASSERT_TRUE(solver.factorise(stored.data()));
    EXPECT_LT(relative_error(solver.solve(b), a.partialPivLu().solve(b)), tolerance_for(a));
  }
}

TEST_P(EveryBackend, DoesNotTakeNoiseInUnloadedRowsForAnError) {
  // Two bodies without a joint, one of them loaded: whatever noise the other holds is no error of the solve.
  const int n = 25;
  MatrixXd a = MatrixXd::Zero(2 * n, 2 * n);
  a.topLeftCorner(n, n) = a.bottomRightCorner(n, n) = membrane(5, 0.1);
  a(n, 0) = a(0, n) = 1e-18;
  MatrixXd b = MatrixXd::Zero(2 * n, 1);
  b.topRows(n).setRandom();
  LinearSolver<double> solver(GetParam());
  const auto stored = store<double>(a);
  solver.analyse(stored.pattern, Symmetry::general);
  ASSERT_TRUE(solver.factorise(stored.data()));
  solver.solve(b);
  EXPECT_LT(solver.backward_error(), 1e-12);
  EXPECT_EQ(solver.counters().backsolves, 1);
}

TEST(LinearSolver, RefinesASolveThatPivotGrowthHasSpoilt) {
  // Wilkinson's matrix: partial pivoting lets the last column double in each of 40 steps, so that a solve is wrong by
  // 2^39 epsilon = 1e-4; one step of refinement brings that to its square.
  const int n = 40;
  MatrixXd a = MatrixXd::Identity(n, n);
  a.triangularView<Eigen::StrictlyLower>().setConstant(-1);
  a.col(n - 1).setOnes();
  const MatrixXd b = right_hand_sides(a, 1);
  LinearSolver<double> solver(Backend::eigen);
  const auto stored = store<double>(a, true);
  solver.analyse(stored.pattern, Symmetry::general);
  ASSERT_TRUE(solver.factorise(stored.data()));
  const MatrixXd x = solver.solve(b);
  EXPECT_EQ(solver.counters().backsolves, 2);
  EXPECT_LT(solver.backward_error(), 1e-7);
  EXPECT_LT((b - a * x).norm() / b.norm(), 1e-7);
}

TEST(LinearSolver, SolvesComplexMatricesWithoutConjugating) {
  const Matrix<Complex> a = random_sparse<Complex>(60, 11), b = Matrix<Complex>::Random(60, 2);
  const auto stored = store<Complex>(a);
  for (const Backend backend : {Backend::automatic, Backend::eigen}) {
    LinearSolver<Complex> solver(backend);
    solver.analyse(stored.pattern, Symmetry::general);
    ASSERT_TRUE(solver.factorise(stored.data())) << solver.message();
    const auto error = [&](const Matrix<Complex>& x, const Matrix<Complex>& m) {
      return (m * x - b).norm() / b.norm();
    };
    EXPECT_LT(error(solver.solve(b), a), 1e-12);  // a residual: rounding, whatever the condition number
    EXPECT_LT(error(solver.solve(b, Taken::transposed), a.transpose()), 1e-12);
    EXPECT_LT(solver.backward_error(), 1e-12);
    const double exact = a.cwiseAbs().colwise().sum().maxCoeff<Eigen::PropagateNaN>() *
                         a.inverse().cwiseAbs().colwise().sum().maxCoeff<Eigen::PropagateNaN>();
    const double estimate = solver.condition_estimate();
    EXPECT_GT(estimate, exact / 3);
    EXPECT_LT(estimate, exact * (1 + 1e-10));  // a lower bound, but for rounding
    EXPECT_EQ(solver.counters().backsolves, 4);
  }
}

TEST(LinearSolver, CarriesAComplexStepThroughASolve) {
  const double h = 1e-100;
  const MatrixXd a = saddle(5, true), da = random_sparse(static_cast<int>(a.rows()), 12), b = right_hand_sides(a, 1);
  const Matrix<Complex> shifted = a.cast<Complex>() + Complex(0, h) * da.cast<Complex>();
  const auto stored = store<Complex>(shifted);
  LinearSolver<Complex> solver;
  solver.analyse(stored.pattern, Symmetry::general);
  ASSERT_TRUE(solver.factorise(stored.data()));
  const Matrix<Complex> x = solver.solve(b.cast<Complex>());
  const auto lu = a.partialPivLu();
  const MatrixXd exact = -lu.solve(MatrixXd(da * lu.solve(b)));
  // The derivative passes A^-1 twice.
  EXPECT_LT(relative_error(x.imag() / h, exact), 10 * tolerance_for(a));
}

TEST(LinearSolver, RefusesSingularAndNonFiniteComplexMatrices) {
  Matrix<Complex> a = random_sparse<Complex>(20, 13);
  a.row(4) = Complex(0, 2) * a.row(9);
  LinearSolver<Complex> solver;
  auto stored = store<Complex>(a);
  solver.analyse(stored.pattern, Symmetry::general);
  EXPECT_FALSE(solver.factorise(stored.data()));
  EXPECT_NE(solver.message().find("singular"), std::string::npos) << solver.message();
  stored.values[0] = Complex(0, std::numeric_limits<double>::quiet_NaN());
  EXPECT_FALSE(solver.factorise(stored.data()));
  EXPECT_NE(solver.message().find("row 0, column 0 is not finite"), std::string::npos) << solver.message();
}

TEST(LinearSolver, NamesWhatIsBuiltIn) {
  EXPECT_TRUE(has_backend(Backend::automatic));
  EXPECT_TRUE(has_backend(Backend::eigen));
  const auto libraries = linear_solver_libraries();
  const auto listed = [&](const std::string& name) {
    for (const auto& library : libraries)
      if (library.rfind(name + " ", 0) == 0) return true;
    return false;
  };
  EXPECT_TRUE(listed("Eigen"));
  EXPECT_EQ(listed("CHOLMOD"), has_backend(Backend::cholmod));
  EXPECT_EQ(listed("MUMPS"), has_backend(Backend::mumps));
  for (const Backend backend : {Backend::cholmod, Backend::mumps}) {
    if (!has_backend(backend)) {
      EXPECT_THROW(LinearSolver<double>{backend}, std::invalid_argument);
    }
  }
}

TEST(LinearSolver, KnowsItsBlas) {
  EXPECT_FALSE(blas_name().empty());
  // Threads can be set just where the BLAS that is loaded is one we know by name.
  EXPECT_EQ(set_blas_threads(1), blas_name().rfind("OpenBLAS", 0) == 0) << blas_name();
}

TEST(LinearSolver, RefusesToSolveOutOfOrder) {
  LinearSolver<double> solver;
  const double one = 1;
  EXPECT_THROW(solver.factorise(&one), std::logic_error);
  EXPECT_THROW(solver.solve(MatrixXd::Ones(1, 1)), std::logic_error);
}

/// A run that ends without an answer may have a last factorisation that failed, and is recorded all the same.
TEST(LinearSolver, KnowsNoConditionWithoutAFactorisation) {
  LinearSolver<double> solver;
  EXPECT_EQ(solver.condition_estimate(), 0);
  const auto stored = store<double>(MatrixXd::Ones(2, 2));
  solver.analyse(stored.pattern, Symmetry::general);
  ASSERT_FALSE(solver.factorise(stored.data()));
  EXPECT_EQ(solver.condition_estimate(), 0);
}

TEST(LinearSolver, CanBeMoved) {
  const MatrixXd a = saddle(4, true), b = right_hand_sides(a);
  const auto stored = store<double>(a);
  LinearSolver<double> source;
  source.analyse(stored.pattern, Symmetry::general);
  ASSERT_TRUE(source.factorise(stored.data()));
  LinearSolver<double> solver(std::move(source));
  EXPECT_LT(relative_error(solver.solve(b), a.partialPivLu().solve(b)), tolerance_for(a));
}

}  // namespace
}  // namespace stickslip::linear_solver_test
