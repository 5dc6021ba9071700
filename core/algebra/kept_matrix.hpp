/// The matrix that was last factorised, kept to hold solutions against: scaling, norm, backward errors. Private to
/// core/algebra.
#pragma once

#include <memory>
#include <optional>
#include <vector>

#include "core/algebra/linear_solver.hpp"

namespace stickslip {

/// Above this backward error one step of iterative refinement is worth a solve.
inline constexpr double refine_above = 1e-10;

/// Powers of two that bring the largest entry of each row of diag(row) A diag(column) near one, and then of each
/// column: what is said of that matrix does not depend on the units of equations and unknowns.
struct Scaling {
  Eigen::VectorXd row, column;
};

template <class T>
class KeptMatrix {
 public:
  KeptMatrix() = default;
  KeptMatrix(std::shared_ptr<const Pattern> pattern, Symmetry symmetry)
      : pattern_(std::move(pattern)), symmetry_(symmetry) {}

  /// Copies the values: the caller's may be overwritten by the time of a solve.
  void take(const T* values);
  const T* values() const { return values_.data(); }
  /// Which entry is not finite, in words; empty where all are.
  std::string not_finite() const;
  const Scaling& scaling();
  /// Largest sum of |a_ij| over a column, of the scaled matrix where `scaling` is not null.
  double one_norm(const Scaling* scaling) const;
  /// Oettli and Prager's backward error of X; not a number where rows of an unsymmetric pattern are not at hand.
  double backward_error(const Matrix<T>& x, const Matrix<T>& b, Taken taken);

  struct Check {
    double error = 0;
    Matrix<T> residual;
  };
  /// Backward error of X and the residual B - A X. Oettli and Prager's |r|_i / (|A||x| + |b|)_i says nothing where a
  /// row holds rounding noise alone (displacements that are zero by symmetry); there the denominator is that of
  /// M. Arioli, J. W. Demmel, I. S. Duff, SIAM J. Matrix Anal. Appl. 10 (1989) 165-190, with the matrix equilibrated.
  Check check(const Matrix<T>& solution, const Matrix<T>& b, Taken taken);

 private:
  static constexpr int checked_together = 8;  // that fit into registers
  bool is_stored_by_rows(Taken taken) const { return taken == Taken::transposed || symmetry_ != Symmetry::general; }
  Check check_columns(const Matrix<T>& solution, const Matrix<T>& b, Taken taken);

  std::shared_ptr<const Pattern> pattern_;
  Symmetry symmetry_ = Symmetry::general;
  std::vector<T> values_;
  std::optional<std::vector<int>> by_rows_;  ///< where the entries of A^T are in A, made on demand
  std::optional<Scaling> scaling_;           ///< made on demand
};

}  // namespace stickslip
