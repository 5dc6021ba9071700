/// Linear bodies condensed to their contact dofs.
#pragma once

#include <string>
#include <vector>

#include "core/algebra/linear_solver.hpp"
#include "core/model/frames.hpp"
#include "core/model/result.hpp"

namespace stickslip {

/// S = K_cc - K_ci K_ii^-1 K_ic, c the contact dofs (prescribed ones among them), i the other free dofs, all in the
/// frames. Serves every method, sensitivity and cell of a sweep on the same numbers.
///
/// One factorisation does it, of
///
///   M = [ K_ii  K_ic     ]
///       [ K_ci  K_cc + D ],   D = diag K_cc
///
/// with the contact dofs eliminated last: M is positive definite wherever K_ii is, also for a body that nothing but
/// contact holds, and the Schur complement of M is S + D. The same factor reduces and expands: of M [x_i; x_c] =
/// [r_i; f], x_c = (S + D)^-1 (f - K_ci K_ii^-1 r_i).
template <class T>
class Condensation {
 public:
  Condensation(const Model& model, const Slots<T>& slots, Backend backend);
  /// Whether K_ii is regular; if not, `message` says why, and nothing else may be asked.
  bool valid() const { return valid_; }
  const Matrix<T>& schur() const { return schur_; }
  /// Rows over all dofs -> rows of the contact dofs: r_c - K_ci K_ii^-1 r_i.
  Matrix<T> reduce(const Matrix<T>& rows);
  /// Increments u over all dofs, zero where they are prescribed outside the contact: u_c = `compact` and
  /// K_ii u_i + K_ic u_c = r_i. `reduced`: of the same rows.
  Matrix<T> expand(const Matrix<T>& compact, const Matrix<T>& rows, const Matrix<T>& reduced);
  const std::string& message() const { return solver_.message(); }
  std::string name() const { return solver_.name(); }
  long factor_bytes() const { return solver_.factor_bytes(); }
  /// Right-hand sides solved with the factor so far.
  long backsolves() const { return solver_.counters().backsolves; }
  Counters counters;  ///< what S has cost

 private:
  Matrix<T> contact_rows(const Matrix<T>& rows) const;
  /// [r_i; last] -> M^-1 of it.
  Matrix<T> solve(const Matrix<T>& rows, const Matrix<T>& last);

  const Model& model_;
  std::vector<int> interior_;  ///< free dofs outside the contact
  int contacts_ = 0;           ///< dofs of the contact
  Matrix<T> schur_;
  Vector<double> shift_;  ///< D
  LinearSolver<T> solver_;
  bool valid_ = true;
};

extern template class Condensation<double>;

}  // namespace stickslip
