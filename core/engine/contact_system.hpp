/// The tangent of condensed bodies and contact points: a dense system of the contact dofs and the multipliers.
///
///   [ S + C_uu  C_ul ]
///   [ C_lu      C_ll ]      S: the bodies on their contact dofs (core/engine/condensation.hpp); C: of the points
///
/// Rows of the multipliers of open points hold nothing but these, and are left out of the factor. Vectors u are over
/// the contact dofs (Layout::compact), l over the multipliers.
#pragma once

#include "core/algebra/dense_factor.hpp"
#include "core/engine/engine_parts.hpp"

namespace stickslip {

template <class T>
class ContactSystem {
 public:
  ContactSystem(const Model& model, const Slots<T>& slots, bool unknown_multipliers, Symmetry symmetry);

  bool is_free(Eigen::Index row) const { return free_[row]; }
  /// From the next factorise() on the system has these displacements alone: of the free ones, all that points touch.
  /// Solutions are zero in the others.
  void take_rows(const std::vector<int>& rows) {
    free_list_ = rows;
    std::fill(free_place_.begin(), free_place_.end(), -1);
    for (std::size_t i = 0; i < rows.size(); ++i) free_place_[rows[i]] = static_cast<int>(i);
  }
  /// Unknown displacements.
  int displacements() const { return static_cast<int>(free_list_.size()); }
  /// Makes the factor anew. `hold`: stiffness against motion of each contact node, the same in all directions, force
  /// per length; empty: none. False where the system is singular: message() says why.
  bool factorise(const Matrix<T>& schur, const std::vector<PointTangent<T>>& tangents, const Vector<double>& hold,
                 long& factorizations);
  /// Whether the factor is that of these tangents up to rounding, as long as S is the same.
  bool is_factor_of(const std::vector<PointTangent<T>>& tangents, const Vector<double>& hold) const {
    return valid_ && detail::same_values(hold, held_) && detail::same_tangents(tangents, factorised_);
  }
  /// In place of factorise(), where few points changed since and S is the same (engine/tangent_update.hpp). False, and
  /// nothing changed, where an update does not pay or cannot be made.
  bool update(const std::vector<PointTangent<T>>& tangents, const Vector<double>& hold, Counters& counters);
  void drop_update() { update_.clear(); }
  BlockVector<T> solve(const BlockVector<T>& rows, Solving how) const;
  /// Solves by the factor that one refined right-hand side takes.
  int solves() const { return update_.empty() ? 1 : 2; }
  /// Whether the determinant has another sign than where all points stick.
  bool reversed() const {
    const int expected = active_.size() % 2 == 1 ? -1 : 1;  // each multiplier turns the sign
    return (factor_.determinant_sign() != expected) != update_.turns_sign();
  }
  double condition_estimate() const { return valid_ ? factor_.condition_estimate() : 0; }
  const std::string& message() const { return factor_.message(); }
  Symmetry symmetry() const { return symmetry_; }
  long entries() const { return static_cast<long>(matrix_.size()); }
  long factor_bytes() const { return factor_.bytes(); }

  FactorRecipe<T> recipe() const { return {valid_, factorised_, held_, update_}; }
  /// Goes back to a factor that was made from `recipe`: later solves have the same bits as they had then.
  void restore(const FactorRecipe<T>& recipe, const Matrix<T>& schur, long& factorizations);

 private:
  std::vector<int> point_rows(std::size_t p, const PointTangent<T>& tangent) const;

  const Model& model_;
  const Slots<T>& slots_;
  bool unknown_multipliers_;
  Symmetry symmetry_;
  std::vector<char> free_;
  std::vector<int> free_list_, free_place_;  ///< the displacements of the system, and the place of each row; -1: none
  std::vector<int> active_;                  ///< multiplier rows in the factor: those of points that are not open
  std::vector<int> place_;                   ///< per multiplier row: its place in the factor; -1: none
  Vector<T> open_diagonal_;                  ///< of the other multiplier rows
  Matrix<T> matrix_;                         ///< the one that is factorised
  DenseFactor<T> factor_;
  bool valid_ = false;
  std::vector<PointTangent<T>> factorised_;
  TangentUpdate update_;
  Vector<double> held_;
};

extern template class ContactSystem<double>;

}  // namespace stickslip
