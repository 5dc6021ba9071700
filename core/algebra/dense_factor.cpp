#include "core/algebra/dense_factor.hpp"

#include <cmath>
#include <limits>

#include "core/algebra/norm_estimate.hpp"

namespace stickslip {
namespace {

/// Power of two that brings a size near one.
double to_one(double size) { return size > 0 ? std::exp2(-std::ilogb(size)) : 1.0; }
/// The square root of that, a power of two as well.
double half_to_one(double size) { return size > 0 ? std::exp2(-std::floor(0.5 * std::ilogb(size))) : 1.0; }

}  // namespace

template <class T>
void DenseFactor<T>::equilibrate(const Matrix<T>& A) {
  row_ = Vector<double>::Zero(A.rows());  // column by column, as A is stored: along its rows each entry is far away
  for (Eigen::Index j = 0; j < A.cols(); ++j) row_ = row_.cwiseMax(A.col(j).cwiseAbs());
  row_ = row_.unaryExpr(&to_one).eval();
  column_ = (row_.asDiagonal() * A.cwiseAbs()).colwise().maxCoeff().transpose().unaryExpr(&to_one);
}

template <class T>
bool DenseFactor<T>::factorise(const Matrix<T>& A, Symmetry symmetry, long& factorizations) {
  cholesky_ = valid_ = false;
  message_.clear();
  row_.resize(0);
  ++factorizations;
  if (!A.allFinite()) {
    message_ = "the tangent is not finite";
    return false;
  }
  if (A.rows() == 0) return valid_ = true;
  norm_ = A.cwiseAbs().colwise().sum().maxCoeff();
  // (Eigen's LL^T of complex matrices is for Hermitian ones.)
  if (symmetry == Symmetry::positive_definite && std::is_same_v<T, double>) {
    row_ = column_ = A.diagonal().cwiseAbs().unaryExpr(&half_to_one);
    llt_.compute(row_.template cast<T>().asDiagonal() * A * column_.template cast<T>().asDiagonal());
    cholesky_ = llt_.info() == Eigen::Success;
    if (!cholesky_) ++factorizations;
  }
  if (!cholesky_) {
    equilibrate(A);
    lu_.compute(row_.template cast<T>().asDiagonal() * A * column_.template cast<T>().asDiagonal());
  }
  // A pivot of exactly zero escapes the estimate, which drops what is not a number.
  const bool regular = cholesky_ || lu_.matrixLU().diagonal().cwiseAbs().minCoeff() > 0;
  valid_ = regular && (cholesky_ ? llt_.rcond() : lu_.rcond()) > 10 * std::numeric_limits<double>::epsilon();
  if (!valid_) message_ = "the tangent is singular to working precision";
  return valid_;
}

template <class T>
Matrix<T> DenseFactor<T>::solve(const Matrix<T>& B, Taken taken) const {
  if (B.rows() == 0) return B;
  const bool transposed = taken == Taken::transposed;
  const Vector<T> before = (transposed ? column_ : row_).template cast<T>();
  const Vector<T> after = (transposed ? row_ : column_).template cast<T>();
  Matrix<T> x = before.asDiagonal() * B;
  if (cholesky_)
    x = llt_.solve(x).eval();
  else if (transposed)
    x = lu_.transpose().solve(x).eval();
  else
    x = lu_.solve(x).eval();
  return after.asDiagonal() * x;
}

template <class T>
int DenseFactor<T>::determinant_sign() const {
  if (cholesky_ || row_.size() == 0) return 1;
  int sign = static_cast<int>(lu_.permutationP().determinant());
  for (Eigen::Index i = 0; i < lu_.rows(); ++i)
    if (value(lu_.matrixLU()(i, i)) < 0) sign = -sign;
  return sign;
}

template <class T>
double DenseFactor<T>::condition_estimate() const {
  if (!valid_ || row_.size() == 0) return 0;
  const auto apply = [&](const Vector<T>& x) -> Vector<T> { return solve(x); };
  const auto adjoint = [&](const Vector<T>& x) -> Vector<T> {
    return solve(x.conjugate(), Taken::transposed).conjugate();
  };
  return norm_ * one_norm_estimate<T>(static_cast<int>(row_.size()), apply, adjoint).first;
}

template class DenseFactor<double>;
template class DenseFactor<std::complex<double>>;

}  // namespace stickslip
