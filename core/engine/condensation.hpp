/// Linear bodies condensed to their contact dofs.
#pragma once

#include <string>
#include <vector>

#include "core/algebra/linear_solver.hpp"
#include "core/engine/body_matrix.hpp"
#include "core/model/result.hpp"

namespace stickslip {

/// S = K_cc - K_ci K_ii^-1 K_ic of the bodies of constant stiffness, in the frames of the nodes. c: their contact dofs,
/// prescribed ones among them; i: their other free dofs. One S serves every method, sensitivity and cell of a sweep on
/// the same numbers.
///
/// One factorisation makes it, of
///
///   M = [ K_ii  K_ic     ]
///       [ K_ci  K_cc + D ],   D = diag K_cc
///
/// with the contact dofs eliminated last. D makes M positive definite wherever K_ii is, also for a body that nothing
/// but contact holds. The Schur complement of M is S + D, from which D is taken off. The same factor reduces by the
/// forward half of a solve, and expands by the backward half; D enters neither.
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
  FactorSize factor_size() const { return rows_.interior.empty() ? FactorSize{} : solver_.factor_size(); }
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
  const std::string& message() const { return solver_.message(); }
  std::string name() const { return solver_.name(); }
  long factor_bytes() const { return solver_.factor_bytes(); }
  /// Right-hand sides solved with the factor so far; a reduction or an expansion alone counts half.
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

/// The loads of the condensed bodies, less the forces of what is prescribed outside the contact, reduced to the
/// contact. `u`: prescribed displacements, all dofs, in the frames. `external`: loads, in the axes. `rest`: set to what
/// is prescribed outside the contact, zero elsewhere. `only`: elements of the condensed bodies; nullptr: all elements
/// are theirs.
template <class T>
Reduction<T> reduce_loads(Condensation<T>& condensation, const Model& model, const Slots<T>& slots, const Vector<T>& u,
                          const Vector<T>& external, Vector<T>& rest, const ElementLists* only = nullptr) {
  rest = Vector<T>::Constant(model.dof_count(), T(0));
  for (const auto& constraint : model.constraints) rest[constraint.dof] = u[constraint.dof];
  for (int node : model.contact_nodes)
    for (int i = 0; i < model.dimension; ++i) rest[node * model.dimension + i] = T(0);
  const Vector<T> moved = out_of_frames(model, slots.frames, Layout::all, rest);
  return condensation.reduce(
      into_frames(model, slots.frames, Layout::all, Vector<T>(external - bulk_forces(model, slots, moved, {}, only))));
}

extern template class Condensation<double>;

}  // namespace stickslip
