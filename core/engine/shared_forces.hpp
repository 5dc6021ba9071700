/// Multipliers that equilibrium does not determine: constraints that supports decide, and such as repeat one another.
#pragma once

#include "core/engine/engine.hpp"
#include "core/model/point_tangent.hpp"
#include "core/model/stencil.hpp"

namespace stickslip {

/// Which multiplier components have nothing left to decide: their constraint moves along with what supports prescribe,
/// or with the components before them. Empty where there is none. `field`: where the geometry is taken; nullptr: the
/// start.
template <class T>
std::vector<char> decided_elsewhere(const Model& model, const Slots<T>& slots, const ContactField<T>* field = nullptr) {
  constexpr double independent = 1e-9;  // sine of the least angle to what is decided
  const int D = model.dimension;
  std::vector<char> decided;
  for (std::size_t p = 0; p < model.points.size(); ++p) {
    const auto& point = model.points[p];
    const auto& geometry = field ? geometry_in(*field, slots, p) : slots.geometry[p];
    const auto is_free = [&](int node) {
      const auto first = model.free_index.begin() + node * D;
      return std::all_of(first, first + D, [](int index) { return index >= 0; });
    };
    const auto faced = field && !field->facing.empty() ? nodes_in(model, *field, p) : std::vector<int>();
    const auto& nodes = faced.empty() ? point.nodes : faced;
    if (std::all_of(nodes.begin(), nodes.end(), is_free)) continue;
    Matrix<double> rows = Matrix<double>::Zero(point.components(), nodes.size() * D);  // on free directions
    for (std::size_t n = 0; n < nodes.size(); ++n) {
      const int framed = framed_index(model, nodes[n]);
      const Matrix<double> Q = framed < 0 ? Matrix<double>::Identity(D, D).eval() : values(slots.frames[framed]);
      for (int i = 0; i < D; ++i) {
        if (model.free_index[nodes[n] * D + i] < 0) continue;
        const auto column = static_cast<Eigen::Index>(n) * D + i;
        rows(0, column) = value(geometry.weights[n]) * values(geometry.normal).dot(Q.col(i));
        for (int a = 0; a < point.tangents; ++a)
          rows(1 + a, column) = value(geometry.weights[n]) * values(geometry.tangents.col(a)).dot(Q.col(i));
      }
    }
    for (Eigen::Index c = 0; c < rows.rows(); ++c) {
      for (Eigen::Index k = 0; k < c; ++k) rows.row(c) -= rows.row(k).dot(rows.row(c)) * rows.row(k);
      const double left = rows.row(c).norm();
      if (left <= independent) decided.resize(model.multiplier_count);
      if (left <= independent) decided[point.multiplier + c] = 1;
      rows.row(c) *= left <= independent ? 0 : 1 / left;
    }
  }
  return decided;
}

/// Adds -share times the multiplier's own stiffness to the rows of closed constraints, which have none. `which`: these
/// constraints alone; nullptr: all. The residual stays what it is: only the step changes.
template <class T>
void yield_rows(const Model& model, const std::vector<char>* which, double share,
                std::vector<PointTangent<T>>& tangents) {
  for (std::size_t p = 0; p < tangents.size(); ++p) {
    auto& tangent = tangents[p];
    for (Eigen::Index c = 0; c < tangent.row_l.rows(); ++c) {
      if (which && !(*which)[model.points[p].multiplier + c]) continue;
      double own = 0, along = 0;
      for (Eigen::Index k = 0; k < tangent.row_l.cols(); ++k) own = std::max(own, std::abs(value(tangent.row_l(c, k))));
      for (Eigen::Index i = 0; i < tangent.row_w.cols(); ++i)
        along = std::max(along, std::abs(value(tangent.row_w(c, i))));
      if (own <= 1e-8 * along) tangent.row_l(c, c) -= T(share * along);
    }
  }
}

/// Factorises with unknown multipliers that need not be unique. There are two cases:
///
///   - A constraint that supports decide. Its multiplier follows from the gap, step by step, as a penalty's would, and
///     is zero where the support agrees with the constraint.
///   - Constraints that repeat one another. The tangent is singular. A compliance of 1e-8 shares the force out in the
///     least norm; it is far above the limit of singularity, and costs one iteration more.
///
/// `redundant`: whether that compliance was needed; it is kept then. `anchor`: as of the engine's factorise().
template <class T>
bool factorise_sharing(Engine<T>& engine, const Model& model, const std::vector<char>& decided,
                       std::vector<PointTangent<T>> tangents, bool& redundant, Counters& counters,
                       const Vector<double>& anchor = {}) {
  if (!decided.empty()) yield_rows(model, &decided, 1, tangents);
  if (!redundant && engine.factorise(tangents, counters, anchor)) return true;
  yield_rows(model, nullptr, 1e-8, tangents);
  return redundant = engine.factorise(tangents, counters, anchor);
}

}  // namespace stickslip
