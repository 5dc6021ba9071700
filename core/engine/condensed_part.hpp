/// The bodies of constant stiffness of a mixed scene, condensed: their share in the systems of the sparse engine.
#pragma once

#include <memory>
#include <vector>

#include "core/engine/condensation.hpp"
#include "core/engine/engine_parts.hpp"
#include "core/engine/mixed_rows.hpp"
#include "core/model/loading.hpp"

namespace stickslip {

/// Vectors are over all dofs, in the frames of the nodes, as those of the sparse engine.
template <class T>
class CondensedPart {
 public:
  CondensedPart(const Model& model, const Slots<T>& slots, std::shared_ptr<Condensation<T>> condensation);

  const MixedRows& rows() const { return rows_; }
  const ElementLists& others() const { return others_; }  ///< elements of the bodies that are not condensed

  /// Adds S to the values of a matrix, whose pattern has MixedRows::add_blocks().
  void add_stiffness(const Pattern& pattern, std::vector<T>& values) const;
  /// Reduces the loads of these bodies and what their supports prescribe, and takes them out of `external`, which is in
  /// the axes.
  void begin(const Vector<T>& u, Vector<T>& external);
  /// Largest nodal force of these bodies, as residuals are measured by it.
  double force_scale() const;
  /// Adds S u - load.
  void add_balance(const Vector<T>& u, Vector<T>& rows) const;
  /// Adds S u.
  void add_stiffness_times(const Vector<T>& u, Vector<T>& rows) const;
  Reduction<T> reduce(const Matrix<T>& rows) const;
  /// Sets what is inside: u_i of K_ii u_i + K_ic u_c = r_i.
  void expand(Matrix<T>& u, Matrix<T> reduced, const std::vector<int>* wanted = nullptr) const;
  void expand_all(Matrix<T>& u) const { expand(u, reduced_); }  ///< the same of a displacement, r the loads

  const Condensation<T>& condensation() const { return *condensation_; }

 private:
  const Model& model_;
  const Slots<T>& slots_;
  std::shared_ptr<Condensation<T>> condensation_;
  MixedRows rows_;
  ElementLists own_, others_;
  Vector<T> load_;               ///< f_ext - K u of what supports prescribe outside the contact, reduced
  Matrix<T> reduced_;            ///< what expand() takes of it
  double largest_external_ = 0;  ///< nodal force of the loads
};

extern template class CondensedPart<double>;

}  // namespace stickslip
