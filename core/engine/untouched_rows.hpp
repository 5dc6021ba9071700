/// Contact dofs that no point touches at the moment, eliminated from the bodies on their contact dofs:
///
///   [ S_tt  S_to ]                                        t: touched, o: untouched
///   [ S_ot  S_oo ]      S_tt - S_to W,  W = S_oo^-1 S_ot
///
/// Why: of a long side that a small body slides along, few facets are faced, and a dense factor has the third power of
/// its rows as price. S_oo is symmetric and its factor serves for all branches of the points.
#pragma once

#include <algorithm>
#include <vector>

#include "core/algebra/dense_factor.hpp"
#include "core/algebra/symmetric_modes.hpp"

namespace stickslip {

template <class T>
class UntouchedRows {
 public:
  /// Eliminates from S the `rows` (of S, ascending; the others are zero) that are not touched. If that part is
  /// singular, none is.
  void eliminate(const Matrix<T>& S, const std::vector<int>& rows, const std::vector<char>& touched) {
    touched_.clear();
    others_.clear();
    for (int row : rows) (touched[row] ? touched_ : others_).push_back(row);
    long unused = 0;
    if (!factor_.factorise(S(others_, others_), Symmetry::positive_definite, unused)) {
      touched_ = rows;
      others_.clear();
      factor_.factorise(Matrix<T>(0, 0), Symmetry::positive_definite, unused);
    }
    W_ = factor_.solve(S(others_, touched_));
    reduced_ = Matrix<T>::Zero(S.rows(), S.cols());
    reduced_(touched_, touched_) = S(touched_, touched_) - W_.transpose() * S(others_, touched_);
  }
  /// S with the untouched rows eliminated; zero there.
  const Matrix<T>& reduced() const { return reduced_; }
  const std::vector<int>& touched() const { return touched_; }
  /// Whether rows are among the touched ones. `needed`: per row of S.
  bool has(const std::vector<char>& needed) const {
    return std::none_of(others_.begin(), others_.end(), [&](int row) { return needed[row]; });
  }
  /// What right-hand sides over all rows of S leave to the touched ones.
  Matrix<T> reduce(Matrix<T> b) const {
    b(touched_, Eigen::all) -= W_.transpose() * b(others_, Eigen::all);
    return b;
  }
  /// Fills in the untouched rows of a solution. `b`: what was given to reduce().
  void expand(const Matrix<T>& b, Matrix<T>& x) const {
    x(others_, Eigen::all) = factor_.solve(b(others_, Eigen::all)) - W_ * x(touched_, Eigen::all);
  }
  /// Of S_oo: how many eigenvalues are negative, and the sign of the determinant. `S`: that of eliminate().
  int negative_eigenvalues(const Matrix<T>& S) const {
    if (others_.empty() || factor_.is_cholesky()) return 0;
    return count_negative_eigenvalues(Matrix<T>(S(others_, others_)));
  }
  int determinant_sign() const { return factor_.determinant_sign(); }
  long bytes() const { return static_cast<long>((W_.size() + reduced_.size()) * sizeof(T)) + factor_.bytes(); }

 private:
  std::vector<int> touched_, others_;
  Matrix<T> W_, reduced_;
  DenseFactor<T> factor_;  ///< of S_oo
};

}  // namespace stickslip
