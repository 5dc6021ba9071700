/// Linear bodies condensed to their contact dofs.
#pragma once

#include <string>
#include <vector>

#include "core/engine/body_rows.hpp"
#include "core/model/result.hpp"
#include "core/model/slots.hpp"

namespace stickslip {

/// Factor of a symmetric matrix K with the kept rows c last, behind the others i, and their Schur complement
///
///   S = K_cc - K_ci K_ii^-1 K_ic
///
/// One factorisation makes it, of
///
///   M = [ K_ii  K_ic     ]
///       [ K_ci  K_cc + D ],   D = diag K_cc
///
/// with the kept rows eliminated last. D makes M positive definite wherever K_ii is, also for a body that nothing
/// but contact holds. The Schur complement of M is S + D, from which D is taken off. The same factor reduces by the
/// forward half of a solve, and expands by the backward half; D enters neither.
template <class T>
struct SchurFactor {
  LinearSolver<T> solver;
  std::shared_ptr<Pattern> pattern = nullptr;
  int kept = 0;               ///< rows
  Vector<double> shift = {};  ///< D

  /// Factorises M. `values`: K on the pattern. pre: solver.analyse(). False where M is singular.
  bool factorise(std::vector<T> values);
  /// S, symmetric to the last bit. pre: factorise() returned true.
  Matrix<T> schur();
};

/// S = K_cc - K_ci K_ii^-1 K_ic of the bodies of constant stiffness, in the frames of the nodes. c: their contact dofs,
/// prescribed ones among them; i: their other free dofs. One S serves every method, sensitivity and cell of a sweep on
/// the same numbers.
template <class T>
class Condensation {
 public:
  /// Orders and analyses the matrix.
  Condensation(const Model& model, Backend backend);
  /// Orders, analyses and factorises.
  Condensation(const Model& model, const Slots<T>& slots, Backend backend) : Condensation(model, backend) {
    factorise(slots);
  }
  /// Size of the factor, as far as the backend tells; zero where all dofs are of the contact.
  FactorSize factor_size() const { return rows_.interior.empty() ? FactorSize{} : factor_.solver.factor_size(); }
  /// Makes S. False where K_ii is singular: `message` says why, valid() is false too, and nothing else may be asked.
  bool factorise(const Slots<T>& slots);
  bool valid() const { return valid_; }
  const Matrix<T>& schur() const { return schur_; }
  const std::vector<int>& contact() const { return rows_.contact; }    ///< dofs, in the order of the rows of S
  const std::vector<int>& interior() const { return rows_.interior; }  ///< dofs
  /// Takes rows over all dofs to rows of the contact dofs. `kept`: r_c - K_ci K_ii^-1 r_i. `others`: what expand()
  /// needs of r_i. Rows of bodies that are not condensed are not read.
  Reduction<T> reduce(const Matrix<T>& rows);
  /// Increments u over all dofs: u_c = `compact`, and u_i solves K_ii u_i + K_ic u_c = r_i. u is zero where it is
  /// prescribed outside the contact, and in bodies that are not condensed. `others`: of reduce(r). `wanted`: dofs that
  /// are read, ascending, where not all are; other dofs inside may then be zero.
  Matrix<T> expand(const Matrix<T>& compact, Matrix<T> others, const std::vector<int>* wanted = nullptr);
  const std::string& message() const { return factor_.solver.message(); }
  std::string name() const { return factor_.solver.name(); }
  long factor_bytes() const { return factor_.solver.factor_bytes(); }
  /// Right-hand sides solved with the factor so far; a reduction or an expansion alone counts half.
  double backsolves() const {
    return static_cast<double>(factor_.solver.counters().backsolves) +
           0.5 * static_cast<double>(factor_.solver.counters().half_solves);
  }
  Counters counters;  ///< what S has cost

 private:
  const Model& model_;
  ContactLast rows_;  ///< its lists are dropped once there is a factor
  Matrix<T> schur_;
  SchurFactor<T> factor_;
  bool valid_ = false;
};

extern template class Condensation<double>;

}  // namespace stickslip
