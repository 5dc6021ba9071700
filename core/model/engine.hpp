/// Linear algebra of a Newton iteration, in two engines of one interface. A method sees residual, factorise and solve;
/// it does not see whether the bodies are there in full (SparseEngine) or as their Schur complement on the contact dofs
/// (CondensedEngine: small strain and linear materials; 20-200 times cheaper an iteration).
///
/// An engine owns a displacement vector layout ("engine dofs"): all dofs, or the compact contact dofs, in the frames of
/// the nodes (model/frames.hpp). Rows and increments are in that layout; entries of prescribed dofs are zero in
/// increments and ignored in rows. What `compact`, `all` and `expand` return and `residual` is given is in the axes.
#pragma once

#include <Eigen/Dense>
#include <Eigen/SparseCore>
#include <memory>
#include <variant>

#include "core/algebra/linear_solver.hpp"
#include "core/model/contact_assembly.hpp"
#include "core/model/loading.hpp"
#include "core/model/tangent_update.hpp"

namespace stickslip {

/// K [du; dl] = [r_u; r_l]: one column a right-hand side; l is the scaled multiplier lambda / rho.
template <class T>
struct BlockVector {
  Matrix<T> u, l;
};

/// Scales that a residual is measured against.
struct ForceScale {
  double force = 0;     ///< largest nodal force of any kind
  double rounding = 0;  ///< what rounding alone may leave in a row
};

/// Largest Euclidean norm of the nodal vectors (D consecutive entries) of the primal parts; NaN where one is.
template <class T>
double largest_nodal_norm(const Vector<T>& v, int D) {
  double largest = 0;
  for (Eigen::Index n = 0; n + D <= v.size(); n += D) {
    double squares = 0;
    for (int i = 0; i < D; ++i) squares += value(v[n + i]) * value(v[n + i]);
    double norm = std::sqrt(squares);
    if (!(squares > 1e-280 && squares < 1e280)) {  // squares that overflow or vanish though the numbers do not
      norm = 0;
      for (int i = 0; i < D; ++i) norm = std::hypot(norm, value(v[n + i]));
    }
    largest = larger(largest, norm);
  }
  return largest;
}

namespace detail {

/// Whether two tangents of a point are the same up to rounding.
template <class T>
bool same_tangent(const PointTangent<T>& a, const PointTangent<T>& b) {
  const double scale = std::max(a.force_w.cwiseAbs().maxCoeff(), a.row_l.cwiseAbs().maxCoeff());
  const auto close = [&](const Matrix<T>& x, const Matrix<T>& y) {
    for (Eigen::Index i = 0; i < x.size(); ++i)
      if (!(std::abs(x.data()[i] - y.data()[i]) <= 1e-14 * scale)) return false;
    return true;
  };
  return close(a.force_w, b.force_w) && close(a.force_l, b.force_l) && close(a.row_w, b.row_w) &&
         close(a.row_l, b.row_l);
}

/// Whether two sets of point tangents are, so that a factor can be used again.
template <class T>
bool same_tangents(const std::vector<PointTangent<T>>& a, const std::vector<PointTangent<T>>& b) {
  return std::equal(a.begin(), a.end(), b.begin(), b.end(),
                    [](const auto& x, const auto& y) { return same_tangent(x, y); });
}

/// Whether two vectors are the same to the last bit, their sizes included.
inline bool same_values(const Vector<double>& a, const Vector<double>& b) { return a.size() == b.size() && a == b; }

}  // namespace detail

/// The bodies in full: one sparse matrix over the free dofs and the multipliers, its pattern fixed for every contact
/// state, the bodies' part assembled once.
template <class T>
class SparseEngine {
 public:
  /// `unknown_multipliers`: the monolithic method's layout, [free dofs; multipliers]. `cone`: of all its systems.
  SparseEngine(const Model& model, const Slots<T>& slots, bool unknown_multipliers, ConeRadius cone, Backend backend);

  Vector<T> begin(double time, const Vector<T>& displacement);  ///< all dofs, prescribed values at `time` set
  Vector<T> compact(const Vector<T>& u) const {
    return out_of_frames(model_, slots_.frames, Layout::compact, to_compact(model_, u));
  }
  Vector<T> all(const Vector<T>& u) const { return out_of_frames(model_, slots_.frames, Layout::all, u); }
  /// f_int - f_ext + contact.
  Vector<T> residual(const Vector<T>& u, const Vector<T>& contact, ForceScale& scale) const;
  bool is_free(Eigen::Index row) const { return model_.free_index[row] >= 0; }
  /// `hold`: stiffness against motion of each contact node, the same in all directions, force per length; empty: none.
  bool factorise(const std::vector<PointTangent<T>>& tangents, Counters& counters, const Vector<double>& hold = {});
  /// In place of factorise() where few points changed since (model/tangent_update.hpp); until the next factorise() all
  /// solves are with these tangents. False, and nothing changed, where it does not pay or can't be.
  bool update(const std::vector<PointTangent<T>>& tangents, Counters& counters, const Vector<double>& hold = {});
  /// Whether the tangent has the other sign of its determinant than where all points stick: such a tangent belongs to a
  /// problem that has several solutions, or none, under some load.
  bool reversed() const;
  /// K^T in place of K where `transposed`; pre: that is not after update().
  BlockVector<T> solve(const BlockVector<T>& rows, bool transposed = false);
  /// The bodies' stiffness times engine increments (engine rows).
  Matrix<T> apply_stiffness(const Matrix<T>& u) const;
  /// Rows over all dofs, in the frames -> engine rows, and the increment over all dofs, in the axes, that belongs to an
  /// engine increment.
  Matrix<T> reduce(const Matrix<T>& rows) { return rows; }
  Matrix<T> expand(const Matrix<T>& u, const Matrix<T>&) {
    return out_of_frames(model_, slots_.frames, Layout::all, u);
  }
  Matrix<T> scatter(const Matrix<T>& compact) const;  ///< compact rows -> engine rows
  double condition_estimate() { return solver_.condition_estimate(); }
  std::string name() const { return solver_.name().empty() ? "sparse" : "sparse, " + solver_.name(); }
  const std::string& message() const { return solver_.message(); }
  int unknowns() const { return size_; }
  long nonzeros() const { return pattern_->nonzeros(); }

 private:
  std::vector<int> point_rows(const ContactPoint& point) const;

  const Model& model_;
  const Slots<T>& slots_;
  bool unknown_multipliers_;
  Symmetry symmetry_;
  int size_;
  Vector<T> external_;  ///< in the frames
  std::shared_ptr<Pattern> pattern_;
  std::vector<std::vector<int>> point_map_;  ///< per point: entry of each (row, column) pair of its rows, -1 if fixed
  std::vector<T> bulk_, values_;
  double stiffness_ = 0;  ///< largest diagonal entry, for the rounding of a residual
  LinearSolver<T> solver_;
  std::vector<PointTangent<T>> factorised_;
  TangentUpdate update_;
  Vector<double> held_;
  bool analysed_ = false, valid_ = false;
};

/// The bodies condensed to the contact dofs: S = K_cc - K_ci K_ii^-1 K_ic, all in the frames. Immutable; serves every
/// method, sensitivity and cell of a sweep on the same numbers.
template <class T>
class Condensation {
 public:
  Condensation(const Model& model, const Slots<T>& slots, Backend backend);
  bool valid() const { return valid_; }
  const Matrix<T>& schur() const { return schur_; }
  /// Rows over all dofs -> rows of the contact dofs: r_c - K_ci K_ii^-1 r_i.
  Matrix<T> reduce(const Matrix<T>& rows);
  /// Interior increments of contact increments: K_ii du_i + K_ic du_c = r_i. Returns all dofs.
  Matrix<T> expand(const Matrix<T>& compact, const Matrix<T>& rows);
  /// Forces of prescribed dofs outside the contact on all dofs: K u for u zero elsewhere.
  Vector<T> apply_stiffness(const Vector<T>& u) const { return stiffness_ * u; }
  const std::string& message() const { return solver_.message(); }
  std::string name() const { return solver_.name(); }
  Counters counters;  ///< one factorisation and the solves that made S

 private:
  const Model& model_;
  std::vector<int> interior_;                ///< free dofs outside the contact
  std::vector<int> place_;                   ///< per dof: index in interior_, or -1
  Eigen::SparseMatrix<T> stiffness_;         ///< all dofs
  Eigen::SparseMatrix<T> interior_contact_;  ///< K_ic
  Matrix<T> schur_;
  LinearSolver<T> solver_;
  bool valid_ = true;
};

template <class T>
class CondensedEngine {
 public:
  CondensedEngine(const Model& model, const Slots<T>& slots, bool unknown_multipliers, ConeRadius cone,
                  std::shared_ptr<Condensation<T>> condensation);

  Vector<T> begin(double time, const Vector<T>& displacement);
  Vector<T> compact(const Vector<T>& u) const { return out_of_frames(model_, slots_.frames, Layout::compact, u); }
  Vector<T> all(const Vector<T>& u);
  Vector<T> residual(const Vector<T>& u, const Vector<T>& contact, ForceScale& scale) const;
  bool is_free(Eigen::Index row) const { return free_[row]; }
  /// `hold`: stiffness against motion of each contact node, the same in all directions, force per length; empty: none.
  bool factorise(const std::vector<PointTangent<T>>& tangents, Counters& counters, const Vector<double>& hold = {});
  /// In place of factorise() where few points changed since (model/tangent_update.hpp); until the next factorise() all
  /// solves are with these tangents. False, and nothing changed, where it does not pay or can't be.
  bool update(const std::vector<PointTangent<T>>& tangents, Counters& counters, const Vector<double>& hold = {});
  /// Whether the tangent has the other sign of its determinant than where all points stick: such a tangent belongs to a
  /// problem that has several solutions, or none, under some load.
  bool reversed() const;
  /// K^T in place of K where `transposed`; pre: that is not after update().
  BlockVector<T> solve(const BlockVector<T>& rows, bool transposed = false);
  Matrix<T> apply_stiffness(const Matrix<T>& u) const { return condensation_->schur() * u; }
  Matrix<T> reduce(const Matrix<T>& rows) { return condensation_->reduce(rows); }
  Matrix<T> expand(const Matrix<T>& u, const Matrix<T>& rows) {
    return out_of_frames(model_, slots_.frames, Layout::all, condensation_->expand(u, rows));
  }
  Matrix<T> scatter(const Matrix<T>& compact) const { return compact; }
  double condition_estimate();
  std::string name() const;
  const std::string& message() const { return message_; }
  int unknowns() const {
    return static_cast<int>(free_list_.size()) + (unknown_multipliers_ ? model_.multiplier_count : 0);
  }
  long nonzeros() const { return static_cast<long>(unknowns()) * unknowns(); }

 private:
  std::vector<int> point_rows(const ContactPoint& point) const;
  Matrix<T> solve_factorised(const Matrix<T>& b, bool transposed) const;

  const Model& model_;
  const Slots<T>& slots_;
  bool unknown_multipliers_;
  std::shared_ptr<Condensation<T>> condensation_;
  std::vector<char> free_;
  std::vector<int> free_list_, free_place_;
  Vector<T> rest_;       ///< all dofs: prescribed values outside the contact, zero elsewhere
  Matrix<T> rest_rows_;  ///< f_ext - K rest, all dofs
  Vector<T> load_;       ///< reduced load on the contact dofs
  bool symmetric_;
  std::vector<int> active_;  ///< multiplier rows in the factor: those of points that are not open
  std::vector<int> place_;   ///< and where they stand in it; -1: not there
  Vector<T> open_diagonal_;  ///< of the other multiplier rows
  Matrix<T> matrix_;         ///< that is factorised
  Eigen::PartialPivLU<Matrix<T>> lu_;
  Eigen::LLT<Matrix<T>> llt_;
  bool cholesky_ = false, valid_ = false;
  std::vector<PointTangent<T>> factorised_;
  TangentUpdate update_;
  Vector<double> held_;
  std::string message_;
};

template <class T>
using Engine = std::variant<SparseEngine<T>, CondensedEngine<T>>;

}  // namespace stickslip

#include "core/model/engine_impl.hpp"
