/// Stiffness of linear bodies with its derivatives by the parameters of a block, stored element by element.
///
///   f = K u,   Df = DK u + K Du
///
/// K of a linear body is the same in all increments. So geometry and law are differentiated once, and the forces of an
/// increment are products of small matrices.
#pragma once

#include "sensitivity/direction.hpp"

namespace stickslip {

class DualStiffness {
 public:
  /// `lists`: elements per body; only of bodies with constant stiffness.
  DualStiffness(const Model& model, const Slots<Direction>& slots, const ElementLists& lists);

  /// Adds the derivatives of the forces of its elements at displacements of all dofs. If nodes have frames, their
  /// derivatives turn the forces, and the values are added too.
  void add_forces(const Vector<Direction>& u, Vector<Direction>& forces) const;

  long bytes() const;
  /// Bytes that it would take.
  static long bytes_of(const Model& model, const ElementLists& lists);

 private:
  void add_element(const std::vector<int>& nodes, int dimension, const Eigen::Ref<const Matrix<Direction>>& K);
  /// add_forces() of one element with `count` dofs.
  template <int count>
  void add_products(const int* dofs, const double* value, const double* gradient, const Vector<Direction>& u,
                    Vector<Direction>& forces) const;

  bool turns_;                     ///< some nodes have frames
  std::vector<int> dofs_;          ///< dofs of all elements in sequence
  std::vector<int> start_ = {0};   ///< first entry of each element in dofs_
  std::vector<double> values_;     ///< lower triangles of the element matrices, by columns
  std::vector<double> gradients_;  ///< `directions` derivatives per value
};

}  // namespace stickslip
