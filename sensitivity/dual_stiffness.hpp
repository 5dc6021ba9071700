/// The stiffness of linear bodies with its derivatives along the parameters of a block, kept element by element.
///
///   f = K u,   Df = DK u + K Du
///
/// A linear body has one K in all increments, so geometry and law are differentiated once, and the forces of an
/// increment are products of small matrices.
#pragma once

#include "sensitivity/direction.hpp"

namespace stickslip {

class DualStiffness {
 public:
  /// Of the elements in `lists`, which are of bodies of constant stiffness.
  DualStiffness(const Model& model, const Slots<Direction>& slots, const ElementLists& lists);

  /// Adds the forces of its elements at displacements of all dofs: their derivatives, and where nodes have frames,
  /// whose derivatives turn the forces, their values.
  void add_forces(const Vector<Direction>& u, Vector<Direction>& forces) const;

  long bytes() const;
  /// The same before it is made.
  static long bytes_of(const Model& model, const ElementLists& lists);

 private:
  void add_element(const std::vector<int>& nodes, int dimension, const Eigen::Ref<const Matrix<Direction>>& K);
  /// The same of one element with so many dofs.
  template <int count>
  void add_products(const int* dofs, const double* value, const double* gradient, const Vector<Direction>& u,
                    Vector<Direction>& forces) const;

  bool turns_;                     ///< nodes have frames
  std::vector<int> dofs_;          ///< of all elements, one after another
  std::vector<int> start_ = {0};   ///< where those of each begin
  std::vector<double> values_;     ///< lower triangles, column by column
  std::vector<double> gradients_;  ///< `directions` for each of them
};

}  // namespace stickslip
