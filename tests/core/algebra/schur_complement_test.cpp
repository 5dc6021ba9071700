/// LinearSolver::schur_complement against dense algebra.
#include <gtest/gtest.h>

#include <Eigen/Dense>

#include "core/algebra/linear_solver.hpp"
#include "tests/support/derivatives.hpp"

namespace stickslip::schur_complement_test {
namespace {

using Eigen::MatrixXd;

/// Two sheets of side x side nodes that do not touch, each held at one corner by a spring, with `kept` nodes in all
/// ordered last: half of one edge of each.
struct Sheets {
  std::shared_ptr<Pattern> pattern = std::make_shared<Pattern>();
  std::vector<double> values;
  MatrixXd dense;
  int kept = 0;

  explicit Sheets(int side, double stiffer = 1) : kept(2 * (side / 2)) {
    const int n = 2 * side * side;
    std::vector<int> row(n, -1);
    int next = 0;
    const auto is_kept = [&](int i) { return i % (side * side) < side / 2; };
    for (bool last : {false, true})
      for (int i = 0; i < n; ++i)
        if (is_kept(i) == last) row[i] = next++;
    dense = MatrixXd::Zero(n, n);
    const auto join = [&](int i, int j, double k) {
      dense(row[i], row[i]) += k;
      dense(row[j], row[j]) += k;
      dense(row[i], row[j]) -= k;
      dense(row[j], row[i]) -= k;
    };
    for (int i = 0; i < n; ++i) {
      const int within = i % (side * side);
      const double k = i < side * side ? 1 : stiffer;
      if (within % side + 1 < side) join(i, i + 1, k);
      if (within + side < side * side) join(i, i + side, k);
      if (within == side * side - 1) dense(row[i], row[i]) += k;
    }
    pattern->size = n;
    pattern->column_start.push_back(0);
    for (int j = 0; j < n; ++j) {
      for (int i = 0; i < n; ++i)
        if (i == j || dense(i, j) != 0) {
          pattern->row.push_back(i);
          values.push_back(dense(i, j));
        }
      pattern->column_start.push_back(pattern->nonzeros());
    }
  }
  MatrixXd expected() const {
    const auto others = dense.rows() - kept;
    return dense.bottomRightCorner(kept, kept) -
           dense.bottomLeftCorner(kept, others) *
               dense.topLeftCorner(others, others).ldlt().solve(dense.topRightCorner(others, kept));
  }
};

TEST(SchurComplement, IsThatOfDenseAlgebraByEveryBackend) {
  // rounding of the entries times a condition number of the sheets of some 1e3
  constexpr double rounding = 1e-12;
  for (Backend backend : {Backend::automatic, Backend::cholmod, Backend::mumps, Backend::eigen})
    for (double stiffer : {1.0, 1e9})
      for (int side : {2, 5, 12}) {
        if (!has_backend(backend)) continue;
        const Sheets sheets(side, stiffer);
        LinearSolver<double> solver(backend);
        solver.analyse(sheets.pattern, Symmetry::positive_definite, sheets.kept);
        ASSERT_TRUE(solver.factorise(sheets.values.data())) << solver.message();
        const MatrixXd schur = solver.schur_complement(), expected = sheets.expected();
        const Eigen::VectorXd size = expected.diagonal().cwiseSqrt();  // each sheet against its own stiffness
        for (int i = 0; i < sheets.kept; ++i)
          for (int j = 0; j < sheets.kept; ++j)
            EXPECT_NEAR(schur(i, j), expected(i, j), rounding * size[i] * size[j]) << solver.name() << " " << side;
      }
}

TEST(SchurComplement, StandsBetweenTheHalvesOfASolveByEveryBackend) {
  constexpr double rounding = 1e-12;  // times a condition number of the sheets of some 1e3
  for (Backend backend : {Backend::automatic, Backend::cholmod, Backend::mumps, Backend::eigen})
    for (double stiffer : {1.0, 1e9})
      for (int side : {2, 5, 12}) {
        if (!has_backend(backend)) continue;
        const Sheets sheets(side, stiffer);
        const int n = sheets.pattern->size, kept = sheets.kept, others = n - kept;
        const Eigen::VectorXd scale = sheets.dense.diagonal().cwiseSqrt();  // each sheet in its own units
        const int columns = side == 2 ? 3 : side == 5 ? 7 : 21;  // which go through a factor in panels of 4, 8 and 16
        MatrixXd b(n, columns), x_kept(kept, columns);
        for (int j = 0; j < columns; ++j) {
          b.col(j) = scale.cwiseProduct(derivatives::arbitrary(n, 10 + j));
          x_kept.col(j) = derivatives::arbitrary(kept, 40 + j).cwiseQuotient(scale.tail(kept));
        }
        LinearSolver<double> solver(backend);
        solver.analyse(sheets.pattern, Symmetry::positive_definite, kept);
        ASSERT_TRUE(solver.factorise(sheets.values.data())) << solver.message();
        const auto reduction = solver.reduce(b);
        const MatrixXd x = solver.expand(x_kept, reduction.others);
        const std::vector<int> wanted{0, others / 2};
        const MatrixXd few = solver.expand(x_kept, reduction.others, &wanted);
        EXPECT_EQ(few(wanted, Eigen::all), x(wanted, Eigen::all)) << solver.name() << " " << side;
        const Eigen::LDLT<MatrixXd> inside(sheets.dense.topLeftCorner(others, others));
        const MatrixXd coupling = sheets.dense.topRightCorner(others, kept), load = b.topRows(others);
        const MatrixXd reduced = b.bottomRows(kept) - coupling.transpose() * inside.solve(load);
        const MatrixXd expanded = inside.solve(load - coupling * x_kept);
        const MatrixXd unit = scale.head(others).asDiagonal(), kept_unit = scale.tail(kept).cwiseInverse().asDiagonal();
        EXPECT_LT((kept_unit * (reduction.kept - reduced)).norm(), rounding * (kept_unit * reduced).norm())
            << solver.name() << " " << side;
        EXPECT_LT((unit * (x - expanded)).norm(), rounding * (unit * expanded).norm()) << solver.name() << " " << side;
        const auto& counters = solver.counters();
        EXPECT_EQ(counters.half_solves > 0, counters.backsolves == 0);
        EXPECT_GE(counters.half_solves + counters.backsolves, 2 * columns);
      }
}

TEST(SchurComplement, HasAFactorOfTheSizeThatIsPredicted) {
  const Sheets sheets(12);
  const FactorSize predicted = predict_factor(sheets.pattern, sheets.kept);
  for (Backend backend : {Backend::automatic, Backend::cholmod, Backend::eigen}) {
    if (!has_backend(backend)) continue;
    LinearSolver<double> solver(backend);
    solver.analyse(sheets.pattern, Symmetry::positive_definite, sheets.kept);
    EXPECT_EQ(solver.factor_size().flops, predicted.flops);
    EXPECT_EQ(solver.factor_size().entries, predicted.entries);
  }
}

TEST(SchurComplement, LeavesTheSolutionsWhatTheyAre) {
  const Sheets sheets(9);
  LinearSolver<double> solver;
  solver.analyse(sheets.pattern, Symmetry::positive_definite, sheets.kept);
  ASSERT_TRUE(solver.factorise(sheets.values.data()));
  solver.schur_complement();
  const MatrixXd b = derivatives::arbitrary(static_cast<int>(sheets.dense.rows()), 1);
  const MatrixXd x = solver.solve(b);
  EXPECT_LT((sheets.dense * x - b).norm(), 1e-12 * b.norm());  // rounding times a condition number of some 1e3
}

TEST(SchurComplement, OfAComplexMatrixHasTheDerivativeOfTheRealOne) {
  const Sheets sheets(6);
  constexpr double h = 1e-30;
  std::vector<std::complex<double>> values(sheets.values.begin(), sheets.values.end());
  MatrixXd change = MatrixXd::Zero(sheets.dense.rows(), sheets.dense.rows());
  for (int j = 0; j < sheets.pattern->size; ++j)
    for (int e = sheets.pattern->column_start[j]; e < sheets.pattern->column_start[j + 1]; ++e) {
      const int i = sheets.pattern->row[e];
      change(i, j) = std::cos(i + j);
      values[e] += std::complex<double>(0, h * change(i, j));
    }
  LinearSolver<std::complex<double>> solver;
  solver.analyse(sheets.pattern, Symmetry::positive_definite, sheets.kept);
  ASSERT_TRUE(solver.factorise(values.data()));
  const MatrixXd derivative = solver.schur_complement().imag() / h;
  // S = [-X; I]^T A [-X; I] with X = A_oo^-1 A_ok, and dS has no term of dX
  const auto others = sheets.dense.rows() - sheets.kept;
  MatrixXd shape(sheets.dense.rows(), sheets.kept);
  shape << -sheets.dense.topLeftCorner(others, others).ldlt().solve(sheets.dense.topRightCorner(others, sheets.kept)),
      MatrixXd::Identity(sheets.kept, sheets.kept);
  const MatrixXd expected = shape.transpose() * change * shape;
  EXPECT_LT((derivative - expected).norm(), 1e-12 * expected.norm());
}

}  // namespace
}  // namespace stickslip::schur_complement_test
