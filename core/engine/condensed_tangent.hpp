/// The tangent of bodies that are not linear, with what is inside them eliminated first:
///
///   [ K_ii  K_ic         0    ]      i: inside the bodies, c: on their contact dofs
///   [ K_ci  K_cc + C_uu  C_ul ]      K: of the bodies; C: of the contact points
///   [ 0     C_lu         C_ll ]
///
/// K is symmetric, and K_ii positive definite but where a body buckles. One Cholesky factorisation with the contact
/// dofs last makes S = K_cc - K_ci K_ii^-1 K_ic, whatever friction does to the symmetry of C. The rest is the dense
/// system of core/engine/contact_system.hpp, of those contact dofs that points touch (core/engine/untouched_rows.hpp),
/// so that points which change their branches while K stays cost no sparse factor. The sparse pattern is that of the
/// bodies alone, and stays the same wherever points slide to.
#pragma once

#include <memory>
#include <vector>

#include "core/engine/body_matrix.hpp"
#include "core/engine/contact_system.hpp"
#include "core/engine/tangent_system.hpp"
#include "core/engine/untouched_rows.hpp"

namespace stickslip {

/// Rows of the bodies: their free dofs, those of the contact last.
struct CondensedRows {
  std::vector<int> row_of_dof;  ///< -1: prescribed
  std::vector<int> dofs;        ///< of the rows
  int kept = 0;                 ///< how many rows are of the contact
  RowLists lists;               ///< of the elements
  std::shared_ptr<Pattern> pattern;

  explicit CondensedRows(const Model& model);
};

/// Whether tangents can be condensed: those of contact between bodies with something inside, whose tangents change and
/// are symmetric and, as long as no path leads past its limit points, definite.
bool can_condense_tangents(const Model& model);

template <class T>
class CondensedTangent : public TangentSystem<T> {
 public:
  /// Orders and analyses the bodies' matrix. `symmetry`: of the whole tangent.
  CondensedTangent(const Model& model, const Slots<T>& slots, bool unknown_multipliers, Symmetry symmetry,
                   Backend backend);

  const CondensedRows& rows() const { return rows_; }
  const std::vector<int>& row_of_dof() const override { return rows_.row_of_dof; }
  const std::vector<int>& dofs() const override { return rows_.dofs; }
  const Pattern& pattern() const override { return *rows_.pattern; }
  /// Size of the bodies' factor, and rows of the dense system at the start where no point is open.
  FactorSize factor_size() const { return solver_.factor_size(); }
  int dense_rows() const { return dense_rows_; }
  /// Takes the bodies' matrix, values on the pattern of rows(). False where K_ii is not positive definite.
  bool condense(const std::vector<T>& bodies, Counters& counters);
  /// Contact dofs that the dense system has: those that points have touched since condense().
  const std::vector<int>& touched() const { return untouched_.touched(); }
  /// Gives the dense system these contact dofs. pre: condense() returned true.
  void touch(const std::vector<int>& rows);
  /// Makes the dense factor. pre: condense() returned true. `hold`: ContactSystem::factorise.
  bool factorise(const std::vector<PointTangent<T>>& tangents, const Vector<double>& hold);
  BlockVector<T> solve(const BlockVector<T>& rows, Solving how) override;
  bool reversed() const override { return system_.reversed(); }  // (K_ii is positive definite)
  /// The larger one of the bodies' and the dense system's.
  double condition_estimate() override;
  const std::string& message() const override { return system_.message(); }
  std::string name() const override;
  void add_holdings(EngineHoldings& held) const override;

 private:
  /// Per contact dof: whether a point of these tangents touches it, or what holds the nodes.
  std::vector<char> touched_by(const std::vector<PointTangent<T>>& tangents, const Vector<double>& hold) const;
  void eliminate_all_but(const std::vector<char>& touched);

  const Model& model_;
  CondensedRows rows_;
  int dense_rows_;
  bool analysis_counted_ = false;
  std::vector<int> kept_;  ///< place of the kept rows among the contact dofs, in their order
  Matrix<T> schur_;        ///< over all contact dofs; zero where they are prescribed
  UntouchedRows<T> untouched_;
  bool eliminated_ = false;  ///< the untouched rows, of the present S
  LinearSolver<T> solver_;
  ContactSystem<T> system_;
};

extern template class CondensedTangent<double>;

}  // namespace stickslip
