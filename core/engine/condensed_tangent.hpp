/// The tangent of bodies that are not linear, with what is inside them eliminated first:
///
///   [ K_ii  K_ic         0    ]      i: inside the bodies, c: on their contact dofs
///   [ K_ci  K_cc + C_uu  C_ul ]      K: of the bodies; C: of the contact points
///   [ 0     C_lu         C_ll ]
///
/// K is symmetric, and K_ii positive definite but where a body buckles. One Cholesky factorisation with the contact
/// dofs last makes S = K_cc - K_ci K_ii^-1 K_ic, whatever friction does to the symmetry of C. The rest is the dense
/// system of core/engine/dense_system.hpp, of those contact dofs that points touch (core/engine/untouched_rows.hpp),
/// so that points which change their branches while K stays cost no sparse factor. The sparse pattern is that of the
/// bodies alone, and stays the same wherever points slide to.
#pragma once

#include <utility>

#include "core/engine/condensation_impl.hpp"
#include "core/engine/dense_system.hpp"
#include "core/engine/full_bodies.hpp"
#include "core/engine/untouched_rows.hpp"

namespace stickslip {

/// Rows of the engine are over all dofs.
template <class T>
class CondensedTangent : public TangentSystem<T> {
 public:
  /// Orders and analyses the bodies' matrix. `bodies` must outlive it.
  CondensedTangent(const Model& model, const Slots<T>& slots, const SystemKind& kind, FullBodies<T>& bodies);

  /// Size of the bodies' factor, its rows and those of the contact among them, and entries of its pattern.
  FactorSize factor_size() const { return factor_.solver.factor_size(); }
  int rows() const { return matrix_.pattern->size; }
  int kept() const { return factor_.kept; }
  /// Rows of the dense system at the start where no point is open.
  int dense_rows() const { return dense_rows_; }

  void take_over() override { take_bodies(); }
  void take_bodies() override {
    matrix_.values = bodies_.tangent(matrix_);
    condensed_ = false;
  }
  /// Condenses the bodies' tangent. False where K_ii is not positive definite.
  bool accepts_bodies(Counters& counters) override { return condensed_ || condense(counters); }
  Matrix<T> times(const Matrix<T>& u, Taken taken) const override { return matrix_.times(u, taken); }
  double stiffness() const override { return matrix_.largest_diagonal(); }
  /// (A tangent that depends on the displacement alone may serve again.)
  const Vector<T>* condensed_at() const override {
    return condensed_ && model_.memory_count == 0 && model_.followers.empty() ? bodies_.linearised_at() : nullptr;
  }

  bool factorise(const std::vector<PointTangent<T>>& tangents, const Vector<double>& anchor,
                 Counters& counters) override;
  BlockVector<T> solve(const BlockVector<T>& rows, Solving how) override;
  bool reversed() const override {  // (K_ii is positive definite)
    return dense_.reversed() != (untouched_.determinant_sign() < 0);
  }
  std::optional<int> motions_unresisted(const std::vector<PointTangent<T>>& springs, Counters& counters) override {
    if (!condensed_ || !eliminated_ || !untouched_.has(touched_by(springs, {}))) return std::nullopt;
    const auto touched = dense_.motions_unresisted(springs, counters);
    return touched ? std::optional(*touched + untouched_.negative_eigenvalues(schur_)) : std::nullopt;
  }
  /// The larger one of the bodies' and the dense system's.
  double condition_estimate() override {
    return std::max(factor_.solver.condition_estimate(), dense_.condition_estimate());
  }
  EngineMemory<T> memory() const override;
  void restore(const EngineMemory<T>& memory, Counters& counters) override;

  bool is_free(Eigen::Index row) const override { return matrix_.row_of_dof[row] >= 0; }
  bool condenses_tangents() const override { return true; }
  const std::string& message() const override { return dense_.message(); }
  std::string name() const override;
  int unknowns() const override {
    return static_cast<int>(matrix_.dofs.size()) + (kind_.has_unknown_multipliers() ? model_.multiplier_count : 0);
  }
  long nonzeros() const override { return matrix_.pattern->nonzeros(); }
  void add_to_report(EngineReport& report) const override;

 private:
  bool condense(Counters& counters);
  /// Per contact dof: whether a point of these tangents touches it, or what holds the nodes.
  std::vector<char> touched_by(const std::vector<PointTangent<T>>& tangents, const Vector<double>& anchor) const;
  void eliminate_all_but(const std::vector<char>& touched);

  const Model& model_;
  const SystemKind kind_;
  FullBodies<T>& bodies_;
  BodyMatrix<T> matrix_;  ///< rows of the contact last
  SchurFactor<T> factor_;
  int dense_rows_ = 0;
  bool analysis_counted_ = false;
  bool condensed_ = false;  ///< the last tangent that was taken
  std::vector<int> kept_;   ///< place of the kept rows among the contact dofs, in their order
  Matrix<T> schur_;         ///< over all contact dofs; zero where they are prescribed
  UntouchedRows<T> untouched_;
  bool eliminated_ = false;  ///< the untouched rows, of the present S
  DenseSystem<T> dense_;
};

template <class T>
CondensedTangent<T>::CondensedTangent(const Model& model, const Slots<T>& slots, const SystemKind& kind,
                                      FullBodies<T>& bodies)
    : model_(model),
      kind_(kind),
      bodies_(bodies),
      factor_{LinearSolver<T>(kind.backend)},
      dense_(model, slots, kind, untouched_.reduced()) {
  ContactLast rows = all_bodies(model);
  factor_.pattern = rows.pattern;
  factor_.kept = static_cast<int>(rows.contact.size());
  factor_.solver.analyse(rows.pattern, Symmetry::positive_definite, factor_.kept);
  matrix_ = {std::move(rows.row_of_dof), std::move(rows.interior), std::move(rows.lists), std::move(rows.pattern)};
  matrix_.dofs.insert(matrix_.dofs.end(), rows.contact.begin(), rows.contact.end());
  const auto contacts = static_cast<Eigen::Index>(model.contact_nodes.size()) * model.dimension;
  for (Eigen::Index c = 0; c < contacts; ++c)
    if (dense_.is_free(c)) kept_.push_back(static_cast<int>(c));
  schur_ = Matrix<T>::Zero(contacts, contacts);
  const auto touched = touched_by(std::vector<PointTangent<T>>(model.points.size()), {});
  dense_rows_ = kind.has_unknown_multipliers() ? model.multiplier_count : 0;
  for (int row : kept_) dense_rows_ += touched[row];
}

template <class T>
std::vector<char> CondensedTangent<T>::touched_by(const std::vector<PointTangent<T>>& tangents,
                                                  const Vector<double>& anchor) const {
  const int D = model_.dimension;
  std::vector<char> touched(schur_.rows(), anchor.size() > 0);
  for (std::size_t p = 0; p < tangents.size(); ++p)
    for (int place : tangents[p].places.empty() ? model_.points[p].places : tangents[p].places)
      std::fill_n(touched.begin() + place * D, D, 1);
  return touched;
}

template <class T>
bool CondensedTangent<T>::condense(Counters& counters) {
  if (!std::exchange(analysis_counted_, true)) ++counters.analyses;
  const auto before = factor_.solver.counters();
  const bool valid = factor_.factorise(matrix_.values);
  counters.factorizations += factor_.solver.counters().factorizations - before.factorizations;
  if (!valid || factor_.solver.counters().fallbacks > before.fallbacks) return false;
  const Matrix<T> S = factor_.schur();
  for (int j = 0; j < factor_.kept; ++j)
    for (int i = 0; i < factor_.kept; ++i) schur_(kept_[i], kept_[j]) = S(i, j);
  eliminated_ = false;
  return condensed_ = true;
}

template <class T>
void CondensedTangent<T>::eliminate_all_but(const std::vector<char>& touched) {
  untouched_.eliminate(schur_, kept_, touched);
  dense_.take_rows(untouched_.touched());
  eliminated_ = true;
}

template <class T>
bool CondensedTangent<T>::factorise(const std::vector<PointTangent<T>>& tangents, const Vector<double>& anchor,
                                    Counters& counters) {
  ++counters.assemblies;
  auto touched = touched_by(tangents, anchor);
  if (!eliminated_ || !untouched_.has(touched)) {
    if (eliminated_)  // points go on: what they touched they may touch again
      for (int row : untouched_.touched()) touched[row] = 1;
    eliminate_all_but(touched);
  }
  Counters of_dense;  // (the bodies' factor is the one that counts)
  return dense_.factorise(tangents, anchor, of_dense);
}

template <class T>
BlockVector<T> CondensedTangent<T>::solve(const BlockVector<T>& rows, Solving how) {
  const Eigen::Index columns = rows.u.cols();
  Matrix<T> b(this->rows(), columns);
  detail::take_rows(rows.u, matrix_.dofs, b);
  auto reduced = factor_.solver.reduce(b);
  Matrix<T> contact = Matrix<T>::Zero(schur_.rows(), columns);
  detail::put_rows(reduced.kept, kept_, contact);
  auto solved = dense_.solve({untouched_.reduce(contact), rows.l}, how);
  untouched_.expand(contact, solved.u);
  Matrix<T> kept(factor_.kept, columns);
  detail::take_rows(solved.u, kept_, kept);
  Matrix<T> x(this->rows(), columns);
  x.topRows(x.rows() - factor_.kept) = factor_.solver.expand(kept, std::move(reduced.others));
  x.bottomRows(factor_.kept) = kept;
  BlockVector<T> out{Matrix<T>::Zero(model_.dof_count(), columns), solved.l};
  detail::put_rows(x, matrix_.dofs, out.u);
  return out;
}

template <class T>
EngineMemory<T> CondensedTangent<T>::memory() const {
  const Vector<T>* at = condensed_at();
  return at ? EngineMemory<T>{.condensed_at = *at, .touched = untouched_.touched()} : EngineMemory<T>{};
}

template <class T>
void CondensedTangent<T>::restore(const EngineMemory<T>& memory, Counters& counters) {
  condensed_ = false;
  if (memory.condensed_at.size() == 0) return;
  bodies_.linearise({memory.condensed_at, Vector<T>()});
  take_bodies();
  condense(counters);
  std::vector<char> touched(schur_.rows(), false);
  for (int row : memory.touched) touched[row] = true;
  eliminate_all_but(touched);
}

template <class T>
std::string CondensedTangent<T>::name() const {
  return "sparse, tangents condensed by " + factor_.solver.name() + ", dense " + dense_.factor_name();
}

template <class T>
void CondensedTangent<T>::add_to_report(EngineReport& report) const {
  dense_.add_to_report(report);
  report.bodies = static_cast<long>(matrix_.values.size() * sizeof(T));
  report.condensed = static_cast<long>(schur_.size() * sizeof(T)) + untouched_.bytes();
  report.matrix += matrix_.pattern->bytes();
  report.matrix_entries = static_cast<long>(matrix_.pattern->nonzeros());
  report.factor += factor_.solver.factor_bytes();
  report.factor_entries = factor_.solver.factor_nonzeros();
}

extern template class CondensedTangent<double>;

}  // namespace stickslip
