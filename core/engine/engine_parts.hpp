/// What both engines of engine/engine.hpp are made of: their vectors, and a contact point's share of a tangent.
#pragma once

#include <vector>

#include "core/algebra/linear_solver.hpp"
#include "core/engine/tangent_update.hpp"
#include "core/model/frames.hpp"
#include "core/model/point_tangent.hpp"

namespace stickslip {

/// K [du; dl] = [r_u; r_l]: one column a right-hand side; l is the scaled multiplier lambda / rho.
template <class T>
struct BlockVector {
  Matrix<T> u, l;
};

/// How rows are solved for. `refined`: after an update of the factor, a second solve refines the solution. `unrefined`:
/// it does not, for the caller checks the solution. `transposed`: with K^T in place of K, refined.
enum class Solving { refined, unrefined, transposed };

/// Tangent of bodies that are taken for linear: that at the motion, or the last one, however far from there.
enum class HeldTangent { at_motion, last };

/// What an engine holds now, in bytes, and what it has done beside what Counters count.
struct EngineHoldings {
  long bodies = 0;                              ///< matrix of the bodies, which the tangents begin from
  long condensed = 0;                           ///< Schur complement of the bodies on the contact dofs
  long bodies_factor = 0;                       ///< factor that it came from
  long matrix = 0;                              ///< last tangent, with its pattern
  long factor = 0;                              ///< of that
  long matrix_entries = 0, factor_entries = 0;  ///< of these, stored
  double body_solves = 0;                       ///< right-hand sides solved with the bodies' factor since it was made
  bool unsymmetric = false;                     ///< the tangents are
};

/// What a factor was made from. With the same matrix and library it comes out the same to the last bit.
template <class T>
struct FactorRecipe {
  bool valid = false;
  std::vector<PointTangent<T>> tangents;
  Vector<double> hold;
  TangentUpdate update;  ///< of that factor; its columns are solutions, which are kept
  long bytes() const {
    Eigen::Index numbers = 0;
    for (const auto& t : tangents) numbers += t.force_w.size() + t.force_l.size() + t.row_w.size() + t.row_l.size();
    return static_cast<long>(numbers * sizeof(T) + tangents.size() * sizeof(PointTangent<T>)) + update.bytes();
  }
};

/// Scales that a residual is measured against.
struct ForceScale {
  double force = 0;     ///< largest nodal force of any kind
  double rounding = 0;  ///< what rounding alone may leave in a row
};

/// Share of the forces of a condensed body that residuals are measured by. Of a body that supports carry along, S u and
/// the load cancel. With tolerances of 1e-10, a ten-thousandth of these forces is rounding.
inline constexpr double cancelling_forces = 1e-4;

/// Largest Euclidean norm of the nodal vectors (D consecutive entries) of the primal parts; NaN where one is.
template <class T>
double largest_nodal_norm(const Vector<T>& v, int D) {
  double most = 0, extreme = 0;  // largest sum of squares; largest norm whose squares overflow or vanish
  for (Eigen::Index n = 0; n + D <= v.size(); n += D) {
    double squares = 0;
    bool is_zero = true;
    for (int i = 0; i < D; ++i) {
      squares += value(v[n + i]) * value(v[n + i]);
      is_zero &= value(v[n + i]) == 0;
    }
    if (squares > 1e-280 && squares < 1e280) {
      most = std::max(most, squares);
    } else if (!is_zero) {
      double norm = 0;
      for (int i = 0; i < D; ++i) norm = std::hypot(norm, value(v[n + i]));
      extreme = larger(extreme, norm);
    }
  }
  return larger(extreme, std::sqrt(most));
}

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

/// Whether two sets of point tangents are, so that a factor can be used again.
template <class T>
bool same_tangents(const std::vector<PointTangent<T>>& a, const std::vector<PointTangent<T>>& b) {
  return std::equal(a.begin(), a.end(), b.begin(), b.end(),
                    [](const auto& x, const auto& y) { return same_tangent(x, y); });
}

/// Whether two vectors are the same to the last bit, their sizes included.
inline bool same_values(const Vector<double>& a, const Vector<double>& b) { return a.size() == b.size() && a == b; }

/// The entries of a point's tangent that has a row for each dof.
template <class T, class Add>
void for_each_entry_by_places(const PointTangent<T>& tangent, bool unknown_multipliers, Add&& add) {
  const int count = static_cast<int>(tangent.force_w.rows()), C = static_cast<int>(tangent.row_l.rows());
  for (int r = 0; r < count; ++r)
    for (int c = 0; c < count; ++c) add(r, c, tangent.force_w(r, c));
  if (!unknown_multipliers) return;
  for (int r = 0; r < count; ++r)
    for (int c = 0; c < C; ++c) {
      add(r, count + c, tangent.force_l(r, c));
      add(count + c, r, tangent.row_w(c, r));
    }
  for (int r = 0; r < C; ++r)
    for (int c = 0; c < C; ++c) add(count + r, count + c, tangent.row_l(r, c));
}

/// Adds one point's tangent to a matrix through add(row index in rows, column index in rows, value), where rows are
/// the point's displacement rows (node-major) followed by its multiplier rows (if unknown).
template <class T, class Add>
void for_each_entry(const PointGeometry<T>& geometry, const PointTangent<T>& tangent, bool unknown_multipliers,
                    Add&& add) {
  if (!tangent.places.empty()) return for_each_entry_by_places(tangent, unknown_multipliers, add);
  const int D = static_cast<int>(tangent.force_w.rows()), C = static_cast<int>(tangent.row_l.rows());
  const int nodes = static_cast<int>(geometry.weights.size());
  for (int n = 0; n < nodes; ++n)
    for (int i = 0; i < D; ++i) {
      for (int m = 0; m < nodes; ++m)
        for (int j = 0; j < D; ++j)
          add(n * D + i, m * D + j, geometry.weights[n] * geometry.weights[m] * tangent.force_w(i, j));
      if (unknown_multipliers)
        for (int c = 0; c < C; ++c) {
          add(n * D + i, nodes * D + c, geometry.weights[n] * tangent.force_l(i, c));
          add(nodes * D + c, n * D + i, geometry.weights[n] * tangent.row_w(c, i));
        }
    }
  if (unknown_multipliers)
    for (int r = 0; r < C; ++r)
      for (int c = 0; c < C; ++c) add(nodes * D + r, nodes * D + c, tangent.row_l(r, c));
}

/// The same in the frames of the nodes.
template <class T, class Add>
void for_each_framed_entry(const Model& model, const Slots<T>& slots, int p, const PointTangent<T>& tangent,
                           bool unknown_multipliers, Add&& add) {
  const auto& geometry = slots.geometry[p];
  if (model.framed.empty()) return for_each_entry(geometry, tangent, unknown_multipliers, add);
  std::vector<int> nodes = model.points[p].nodes;
  if (!tangent.places.empty()) nodes.clear();
  for (int place : tangent.places) nodes.push_back(model.contact_nodes[place]);
  const auto rows =
      static_cast<Eigen::Index>(nodes.size()) * model.dimension + (unknown_multipliers ? tangent.row_l.rows() : 0);
  Matrix<T> K = Matrix<T>::Constant(rows, rows, T(0));
  for_each_entry(geometry, tangent, unknown_multipliers, [&](int r, int c, const T& x) { K(r, c) += x; });
  K = into_frames(model, slots.frames, nodes, std::move(K));
  for (int c = 0; c < rows; ++c)
    for (int r = 0; r < rows; ++r) add(r, c, K(r, c));
}

/// Whether a point's multiplier rows hold nothing but the multipliers themselves.
template <class T>
bool is_open(const PointTangent<T>& tangent) {
  return tangent.row_w.cwiseAbs().maxCoeff() == 0;
}

/// Takes tangents as an update of the factor of others. rows(p): rows of the factor of point p's entries.
template <class T, class Rows, class Solve>
bool update_factor(const Model& model, const Slots<T>& slots, const std::vector<PointTangent<T>>& factorised,
                   const std::vector<PointTangent<T>>& tangents, bool unknown_multipliers, Rows&& rows,
                   Eigen::Index size, Counters& counters, Solve&& solve, TangentUpdate& update) {
  if constexpr (std::is_same_v<T, double>) {
    std::vector<TangentUpdate::Change> changes;
    for (std::size_t p = 0; p < tangents.size(); ++p) {
      if (same_tangent(factorised[p], tangents[p])) continue;
      if (changes.size() == TangentUpdate::most) return false;
      TangentUpdate::Change change{static_cast<int>(p), rows(p), {}};
      const auto n = static_cast<Eigen::Index>(change.rows.size());
      change.block = Matrix<double>::Zero(n, n);
      const auto add = [&](double sign) {
        return [&change, sign](int r, int c, double x) { change.block(r, c) += sign * x; };
      };
      for_each_framed_entry(model, slots, change.point, tangents[p], unknown_multipliers, add(1));
      for_each_framed_entry(model, slots, change.point, factorised[p], unknown_multipliers, add(-1));
      changes.push_back(std::move(change));
    }
    return update.take(std::move(changes), size, counters, solve);
  }
  return false;
}

/// The solution with a factor and its update; only in double there are any. `solve` and `multiply`: with K, or K^T.
template <class T, class Solve, class Multiply>
Matrix<T> solve_updated(const TangentUpdate& update, const Matrix<T>& b, Solving how, Solve&& solve,
                        Multiply&& multiply) {
  if constexpr (std::is_same_v<T, double>) {
    if (update.empty()) return solve(b);
    if (how == Solving::transposed) return update.solve_transposed(b, solve, multiply);
    return how == Solving::unrefined ? update.solve(b, solve) : update.solve(b, solve, multiply);
  }
  return solve(b);
}

/// Whether some contact is segment-integrated.
inline bool integrates(const Model& model) {
  return std::any_of(model.points.begin(), model.points.end(),
                     [](const auto& point) { return !point.segments.empty(); });
}

/// Slip couples the normal into the tangential rows, and not the other way round: the tangent is unsymmetric. It is
/// symmetric where nothing couples them: where the radius of the cone is fixed while the system is solved (that of
/// given multipliers), or where the bound does not depend on the pressure. Where frames turn, friction follows them and
/// has no potential, whatever its law.
inline Symmetry symmetry_of(const Model& model, bool unknown_multipliers, ConeRadius cone) {
  const bool fixed_radius = cone == ConeRadius::multiplier && !unknown_multipliers;
  if (!model.followers.empty()) return Symmetry::general;  // of a pressure that follows a side with ends
  if (model.effects.friction && model.effects.current_geometry) return Symmetry::general;
  if (model.effects.current_geometry && integrates(model)) return Symmetry::general;  // its forces have no potential
  if (model.effects.coupled_friction && !fixed_radius) return Symmetry::general;
  return unknown_multipliers ? Symmetry::indefinite : Symmetry::positive_definite;
}

}  // namespace detail

}  // namespace stickslip
