/// What systems of bodies and contact points have in common, sparse or dense: the entries of the points, the factor
/// that is used again, updated or made anew, and the solution with it.
#pragma once

#include <algorithm>

#include "core/engine/tangent_system.hpp"
#include "core/model/frames.hpp"
#include "core/model/point_tangent.hpp"

namespace stickslip {
namespace detail {

/// Whether two tangents of a point are the same up to rounding.
template <class T>
bool same_tangent(const PointTangent<T>& a, const PointTangent<T>& b) {
  if (a.places != b.places) return false;
  const double scale = std::max(a.force_w.cwiseAbs().maxCoeff(), a.row_l.cwiseAbs().maxCoeff());
  const auto close = [&](const Matrix<T>& x, const Matrix<T>& y) {
    for (Eigen::Index i = 0; i < x.size(); ++i)
      if (!(std::abs(x.data()[i] - y.data()[i]) <= 1e-14 * scale)) return false;
    return true;
  };
  return close(a.force_w, b.force_w) && close(a.force_l, b.force_l) && close(a.row_w, b.row_w) &&
         close(a.row_l, b.row_l);
}

/// Adds one point's tangent to a matrix through add(row index in rows, column index in rows, value), where rows are
/// the point's displacement rows (node-major) followed by its multiplier rows (if unknown). A tangent with places has a
/// row for each dof already: it counts as one of a single node.
template <class T, class Add>
void for_each_entry(const PointGeometry<T>& geometry, const PointTangent<T>& tangent, Multipliers multipliers,
                    Add&& add) {
  const bool unknown = multipliers == Multipliers::unknown;
  const int D = static_cast<int>(tangent.force_w.rows()), C = static_cast<int>(tangent.row_l.rows());
  const bool by_places = !tangent.places.empty();
  const int nodes = by_places ? 1 : static_cast<int>(geometry.weights.size());
  const auto weight = [&](int n) { return by_places ? T(1) : geometry.weights[n]; };
  for (int n = 0; n < nodes; ++n)
    for (int i = 0; i < D; ++i) {
      for (int m = 0; m < nodes; ++m)
        for (int j = 0; j < D; ++j) add(n * D + i, m * D + j, weight(n) * weight(m) * tangent.force_w(i, j));
      for (int c = 0; unknown && c < C; ++c) {
        add(n * D + i, nodes * D + c, weight(n) * tangent.force_l(i, c));
        add(nodes * D + c, n * D + i, weight(n) * tangent.row_w(c, i));
      }
    }
  for (int r = 0; unknown && r < C; ++r)
    for (int c = 0; c < C; ++c) add(nodes * D + r, nodes * D + c, tangent.row_l(r, c));
}

/// The same in the frames of the nodes.
template <class T, class Add>
void for_each_framed_entry(const Model& model, const Slots<T>& slots, int p, const PointTangent<T>& tangent,
                           Multipliers multipliers, Add&& add) {
  const auto& geometry = slots.geometry[p];
  if (model.framed.empty()) return for_each_entry(geometry, tangent, multipliers, add);
  std::vector<int> nodes = model.points[p].nodes;
  if (!tangent.places.empty()) nodes.clear();
  for (int place : tangent.places) nodes.push_back(model.contact_nodes[place]);
  const auto rows = static_cast<Eigen::Index>(nodes.size()) * model.dimension +
                    (multipliers == Multipliers::unknown ? tangent.row_l.rows() : 0);
  Matrix<T> K = Matrix<T>::Constant(rows, rows, T(0));
  for_each_entry(geometry, tangent, multipliers, [&](int r, int c, const T& x) { K(r, c) += x; });
  K = into_frames(model, slots.frames, nodes, std::move(K));
  for (int c = 0; c < rows; ++c)
    for (int r = 0; r < rows; ++r) add(r, c, K(r, c));
}

}  // namespace detail

template <class T>
class PointSystem : public TangentSystem<T> {
 public:
  bool factorise(const std::vector<PointTangent<T>>& tangents, const Vector<double>& anchor,
                 Counters& counters) override {
    made_.update.clear();
    if (model_.effects.linear_bulk && is_made_from(tangents, anchor)) return true;
    ++counters.assemblies;
    made_.valid = false;
    made_.tangents = tangents;
    made_.anchor = anchor;
    return made_.valid = make_factor(counters);
  }
  bool update(const std::vector<PointTangent<T>>& tangents, const Vector<double>& anchor, Counters& counters) override;
  BlockVector<T> solve(const BlockVector<T>& rows, Solving how) override;
  int solves() const override { return made_.update.empty() ? 1 : 2; }
  bool reversed() const override {
    const int expected = multipliers_.size() % 2 == 1 ? -1 : 1;  // each multiplier turns the sign
    return (determinant_sign() != expected) != made_.update.turns_sign();
  }
  int unknowns() const override {
    return static_cast<int>(displacements_.size()) + (kind_.has_unknown_multipliers() ? model_.multiplier_count : 0);
  }

 protected:
  PointSystem(const Model& model, const Slots<T>& slots, const SystemKind& kind)
      : model_(model), slots_(slots), kind_(kind) {}

  /// Factorises the bodies with the points of made_. False where the system is singular: message() says why.
  virtual bool make_factor(Counters& counters) = 0;
  virtual Matrix<T> solve_factor(const Matrix<T>& b, Taken taken) = 0;
  /// The matrix that was factorised, or its transpose, times x.
  virtual Matrix<T> multiply(const Matrix<T>& x, Taken taken) const = 0;
  virtual int determinant_sign() const = 0;
  /// Whether the factor has no rows for the multipliers of a point.
  virtual bool leaves_out(const PointTangent<T>& /*tangent*/) const { return false; }

  /// Of the tangent of made_: general if a point has no potential.
  Symmetry symmetry() const {
    const auto has_potential = [](const PointTangent<T>& tangent) { return tangent.has_potential; };
    const bool all = std::all_of(made_.tangents.begin(), made_.tangents.end(), has_potential);
    return all ? kind_.symmetry : Symmetry::general;
  }
  Eigen::Index size() const { return static_cast<Eigen::Index>(displacements_.size() + multipliers_.size()); }
  /// Rows of the factor that a point has entries in, with nodes at these places; -1: not there.
  std::vector<int> rows_of(std::size_t p, const std::vector<int>& places) const {
    const int D = model_.dimension;
    std::vector<int> rows;
    for (int place : places)
      for (int i = 0; i < D; ++i) rows.push_back(row_of_contact_[place * D + i]);
    if (kind_.has_unknown_multipliers())
      for (int c = 0; c < model_.points[p].components(); ++c)
        rows.push_back(row_of_multiplier_[model_.points[p].multiplier + c]);
    return rows;
  }
  const std::vector<int>& places_of(std::size_t p, const PointTangent<T>& tangent) const {
    return tangent.places.empty() ? model_.points[p].places : tangent.places;
  }
  /// add(row, value) of what holds the nodes.
  template <class Add>
  void for_each_hold(Add&& add) const {
    for (Eigen::Index n = 0; n < made_.anchor.size(); ++n)
      for (int i = 0; i < model_.dimension; ++i)
        if (const int row = row_of_contact_[n * model_.dimension + i]; row >= 0) add(row, T(made_.anchor[n]));
  }
  template <class Add>
  void for_each_entry_of(std::size_t p, const PointTangent<T>& tangent, Multipliers multipliers, Add&& add) const {
    detail::for_each_framed_entry(model_, slots_, static_cast<int>(p), tangent, multipliers, add);
  }
  /// What diagonal entries are multiplied by, so that a tangent which is positive definite but for its rounding is so.
  static constexpr double raised = 1 + 1e-10;
  void restore_factor(const FactorRecipe<T>& recipe, Counters& counters) {
    made_.valid = false;
    if (recipe.valid) factorise(recipe.tangents, recipe.anchor, counters);
    made_.update = recipe.update;
  }

  const Model& model_;
  const Slots<T>& slots_;
  const SystemKind kind_;
  std::vector<int> displacements_;      ///< rows of the engine that the factor has
  std::vector<int> multipliers_;        ///< multipliers that it has, behind them
  std::vector<int> row_of_contact_;     ///< of each contact dof; -1: none
  std::vector<int> row_of_multiplier_;  ///< -1: none
  FactorRecipe<T> made_;                ///< what the last factor was made from

 private:
  bool is_made_from(const std::vector<PointTangent<T>>& tangents, const Vector<double>& anchor) const {
    return made_.valid && is_anchored_by(anchor) &&
           std::equal(tangents.begin(), tangents.end(), made_.tangents.begin(), made_.tangents.end(),
                      [](const auto& a, const auto& b) { return detail::same_tangent(a, b); });
  }
  bool is_anchored_by(const Vector<double>& anchor) const {
    return anchor.size() == made_.anchor.size() && anchor == made_.anchor;
  }
  Matrix<T> solve_updated(const Matrix<T>& b, Solving how);
};

template <class T>
bool PointSystem<T>::update(const std::vector<PointTangent<T>>& tangents, const Vector<double>& anchor,
                            Counters& counters) {
  if (!model_.effects.linear_bulk || !made_.valid || !is_anchored_by(anchor)) return false;
  if constexpr (std::is_same_v<T, double>) {
    std::vector<TangentUpdate::Change> changes;
    for (std::size_t p = 0; p < tangents.size(); ++p) {
      if (detail::same_tangent(made_.tangents[p], tangents[p])) continue;
      if (changes.size() == TangentUpdate::most || leaves_out(made_.tangents[p])) return false;
      TangentUpdate::Change change{static_cast<int>(p), rows_of(p, places_of(p, tangents[p])), {}};
      const auto n = static_cast<Eigen::Index>(change.rows.size());
      change.block = Matrix<double>::Zero(n, n);
      const auto add = [&](double sign) {
        return [&change, sign](int r, int c, double x) { change.block(r, c) += sign * x; };
      };
      for_each_entry_of(p, tangents[p], kind_.multipliers, add(1));
      for_each_entry_of(p, made_.tangents[p], kind_.multipliers, add(-1));
      changes.push_back(std::move(change));
    }
    return made_.update.take(std::move(changes), size(), counters,
                             [this](const Matrix<double>& b) { return solve_factor(b, Taken::as_is); });
  }
  return false;
}

/// The solution with the factor and its update; only in double there are any.
template <class T>
Matrix<T> PointSystem<T>::solve_updated(const Matrix<T>& b, Solving how) {
  const Taken taken = how == Solving::transposed ? Taken::transposed : Taken::as_is;
  if constexpr (std::is_same_v<T, double>) {
    const auto solve = [this, taken](const Matrix<T>& r) { return solve_factor(r, taken); };
    const auto product = [this, taken](const Matrix<T>& x) { return multiply(x, taken); };
    if (!made_.update.empty() && taken == Taken::transposed) return made_.update.solve_transposed(b, solve, product);
    if (!made_.update.empty())
      return how == Solving::unrefined ? made_.update.solve(b, solve) : made_.update.solve(b, solve, product);
  }
  return solve_factor(b, taken);
}

template <class T>
BlockVector<T> PointSystem<T>::solve(const BlockVector<T>& rows, Solving how) {
  const auto free = static_cast<Eigen::Index>(displacements_.size());
  Matrix<T> b(size(), rows.u.cols());
  for (Eigen::Index i = 0; i < free; ++i) b.row(i) = rows.u.row(displacements_[i]);
  for (std::size_t k = 0; k < multipliers_.size(); ++k) b.row(free + k) = rows.l.row(multipliers_[k]);
  const Matrix<T> x = solve_updated(b, how);
  BlockVector<T> out{Matrix<T>::Zero(rows.u.rows(), b.cols()), Matrix<T>::Zero(model_.multiplier_count, b.cols())};
  for (Eigen::Index i = 0; i < free; ++i) out.u.row(displacements_[i]) = x.row(i);
  for (std::size_t k = 0; k < multipliers_.size(); ++k) out.l.row(multipliers_[k]) = x.row(free + k);
  return out;
}

}  // namespace stickslip
