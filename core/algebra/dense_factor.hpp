/// Dense factorisation of an equilibrated matrix: rows and columns are scaled by powers of two first, so that neither
/// the pivots nor what counts as singular depend on the units of equations and unknowns.
#pragma once

#include <Eigen/Cholesky>
#include <Eigen/LU>
#include <string>

#include "core/algebra/linear_solver.hpp"

namespace stickslip {

/// LL^T where the matrix is symmetric positive definite, LU with partial pivoting elsewhere. T: double or complex.
template <class T>
class DenseFactor {
 public:
  /// Factorises A. Positive definite: LL^T is tried first. Returns false where A is not finite or singular to working
  /// precision (condition number of the scaled matrix beyond 0.1 / epsilon, the limit of LinearSolver); `message` then
  /// says which. Adds to `factorizations` how many were made.
  bool factorise(const Matrix<T>& A, Symmetry symmetry, long& factorizations);
  /// X of A X = B, or A^T X = B. pre: the last factorise() returned true.
  Matrix<T> solve(const Matrix<T>& B, Taken taken = Taken::as_is) const;
  /// Sign of the determinant, +1 or -1 (complex: by the real parts of the pivots).
  int determinant_sign() const;
  /// Whether the last factor is LL^T.
  bool is_cholesky() const { return cholesky_; }
  /// Estimate of the condition number in the 1-norm, of the matrix as it was given; 0 where there is no factor.
  double condition_estimate() const;
  const std::string& message() const { return message_; }
  /// Of the triangular factors; those of LL^T stay where LU took over.
  long bytes() const { return static_cast<long>((lu_.rows() * lu_.cols() + llt_.rows() * llt_.cols()) * sizeof(T)); }

 private:
  void equilibrate(const Matrix<T>& A);

  Vector<double> row_, column_;  ///< powers of two
  double norm_ = 0;              ///< 1-norm of the matrix
  Eigen::PartialPivLU<Matrix<T>> lu_;
  Eigen::LLT<Matrix<T>> llt_;
  bool cholesky_ = false, valid_ = false;
  std::string message_;
};

extern template class DenseFactor<double>;
extern template class DenseFactor<std::complex<double>>;

}  // namespace stickslip
