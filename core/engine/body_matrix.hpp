/// The bodies' stiffness as one sparse matrix over chosen dofs, in the frames of the nodes (model/frames.hpp).
#pragma once

#include <algorithm>
#include <memory>
#include <vector>

#include "core/engine/body_rows.hpp"
#include "core/model/frames.hpp"

namespace stickslip {

/// Values of the bodies' tangent on a pattern, whose first lists are those of element_rows(). `at`: the motion where it
/// is taken; nullptr: the start.
template <class T>
std::vector<T> assemble_bodies(const Model& model, const Slots<T>& slots, const RowLists& lists, const Pattern& pattern,
                               const BodyMotion<T>* at = nullptr, BodyKind kind = BodyKind::all);

/// for_each_element_tangent of a body, in the frames of the nodes.
template <class T>
void for_each_framed_tangent(const Model& model, const Slots<T>& slots, int b, const BodyMotion<T>* at,
                             const ElementSink<T>& sink) {
  if (model.framed.empty()) return for_each_element_tangent(model, slots, b, nullptr, sink, at);
  const auto framed = [&](const std::vector<int>& nodes, const auto& K) {
    sink(nodes, into_frames(model, slots.frames, nodes, Matrix<T>(K)));
  };
  for_each_element_tangent(model, slots, b, nullptr, std::ref(framed), at);
}

template <class T>
std::vector<T> assemble_bodies(const Model& model, const Slots<T>& slots, const RowLists& lists, const Pattern& pattern,
                               const BodyMotion<T>* at, BodyKind kind) {
  std::vector<T> values(pattern.nonzeros(), T(0));
  int list = 0;
  const auto add = [&](const auto&, const auto& K) {
    const int* rows = lists.row.data() + lists.start[list];
    const int count = lists.start[list + 1] - lists.start[list];
    for (int c = 0; c < count; ++c)
      for (int r = 0; r < count; ++r)
        if (rows[r] >= 0 && rows[c] >= 0) values[locate(pattern, rows[r], rows[c])] += K(r, c);
    ++list;
  };
  for (std::size_t b = 0; b < model.bodies.size(); ++b)
    if (is_among(model, b, kind)) for_each_framed_tangent<T>(model, slots, static_cast<int>(b), at, std::ref(add));
  return values;
}

/// The bodies' tangent as a part of a system: on its pattern, over its dofs.
template <class T>
struct BodyMatrix {
  std::vector<int> row_of_dof;  ///< -1: none
  std::vector<int> dofs;        ///< of the rows
  RowLists lists = {};          ///< of the blocks that add up to it; none where it stays as it is
  std::shared_ptr<Pattern> pattern = nullptr;
  std::vector<T> values = {};

  /// The matrix times vectors of all dofs, or its transpose; zero where there is no row.
  Matrix<T> times(const Matrix<T>& u, Taken taken) const;
  double largest_diagonal() const;
};

template <class T>
Matrix<T> BodyMatrix<T>::times(const Matrix<T>& u, Taken taken) const {
  const bool transposed = taken == Taken::transposed;
  Matrix<T> rows = Matrix<T>::Zero(u.rows(), u.cols());
  for (std::size_t j = 0; j < dofs.size(); ++j)
    for (int k = pattern->column_start[j]; k < pattern->column_start[j + 1]; ++k)
      if (pattern->row[k] < static_cast<int>(dofs.size())) {
        const int row = dofs[pattern->row[k]], column = dofs[j];
        rows.row(transposed ? column : row) += values[k] * u.row(transposed ? row : column);
      }
  return rows;
}

template <class T>
double BodyMatrix<T>::largest_diagonal() const {
  double largest = 0;
  for (int i = 0; i < static_cast<int>(dofs.size()); ++i)
    largest = std::max(largest, value(values[locate(*pattern, i, i)]));
  return largest;
}

/// Of a scalar that is solved in: as STICKSLIP_SLOTS.
#define STICKSLIP_TANGENTS(EXTERN, T)                                                                                 \
  EXTERN template Vector<T> bulk_tangent_times(const Model&, const Slots<T>&, const BodyMotion<T>&, const Vector<T>&, \
                                               const ElementLists*);                                                  \
  EXTERN template void for_each_follower_tangent(const Model&, const Slots<T>&, const BodyMotion<T>&,                 \
                                                 const ElementSink<T>&);                                              \
  EXTERN template std::vector<T> assemble_bodies(const Model&, const Slots<T>&, const RowLists&, const Pattern&,      \
                                                 const BodyMotion<T>*, BodyKind)

STICKSLIP_TANGENTS(extern, double);

}  // namespace stickslip
