/// Linear bodies condensed to their contact dofs.
#pragma once

#include <string>
#include <vector>

#include "core/algebra/linear_solver.hpp"
#include "core/model/body_matrix.hpp"
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
/// contact holds, and the Schur complement of M is S + D. The same factor reduces, on its way forwards, and expands, on
/// its way back; neither meets D.
template <class T>
class Condensation {
 public:
  /// Orders and analyses the matrix.
  Condensation(const Model& model, Backend backend);
  /// And factorises it.
  Condensation(const Model& model, const Slots<T>& slots, Backend backend) : Condensation(model, backend) {
    factorise(slots);
  }
  /// Size of the factor, as far as the backend tells; none of bodies that have nothing inside.
  FactorSize factor_size() const { return rows_.interior.empty() ? FactorSize{} : solver_.factor_size(); }
  /// Makes S. False, as valid() then is, where K_ii is singular: `message` says why, and nothing else may be asked.
  bool factorise(const Slots<T>& slots);
  bool valid() const { return valid_; }
  const Matrix<T>& schur() const { return schur_; }
  /// Rows over all dofs -> rows of the contact dofs, r_c - K_ci K_ii^-1 r_i, and what expand() takes of them.
  Reduction<T> reduce(const Matrix<T>& rows);
  /// Increments u over all dofs, zero where they are prescribed outside the contact: u_c = `compact` and
  /// K_ii u_i + K_ic u_c = r_i, `others` being of the rows' reduction.
  Matrix<T> expand(const Matrix<T>& compact, Matrix<T> others);
  const std::string& message() const { return solver_.message(); }
  std::string name() const { return solver_.name(); }
  long factor_bytes() const { return solver_.factor_bytes(); }
  /// Right-hand sides solved with the factor so far; one that is reduced or expanded alone counts half.
  double backsolves() const {
    return static_cast<double>(solver_.counters().backsolves) +
           0.5 * static_cast<double>(solver_.counters().half_solves);
  }
  Counters counters;  ///< what S has cost

 private:
  const Model& model_;
  ContactLast rows_;  ///< its lists are dropped once there is a factor
  Matrix<T> schur_;
  LinearSolver<T> solver_;
  bool valid_ = false;
};

extern template class Condensation<double>;

}  // namespace stickslip
