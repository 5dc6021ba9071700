/// Into and out of the frames of the nodes that an inclined support holds. An engine works in the frames, so that what
/// is prescribed are entries of its vectors; all else is in the axes. Without inclined supports nothing happens here.
#pragma once

#include "core/model/slots.hpp"

namespace stickslip {

/// How nodal vectors are laid out: all nodes, or those of the contact.
enum class NodalLayout { all, compact };

namespace detail {

/// Calls f(Q, first row of the node) for each framed node of the layout.
template <class T, class F>
void for_each_frame(const Model& model, const std::vector<Matrix<T>>& frames, NodalLayout layout, F&& f) {
  for (std::size_t i = 0; i < model.framed.size(); ++i) {
    const int at = layout == NodalLayout::all ? model.framed[i].node : model.framed[i].place;
    if (at >= 0) f(frames[i], at * model.dimension);
  }
}

}  // namespace detail

/// Nodal vectors, one a column, in the frames: Q^T v. (Lazy products: Eigen's others do not know every scalar of ours.)
template <class T, class V>
V into_frames(const Model& model, const std::vector<Matrix<T>>& frames, NodalLayout layout, V v) {
  detail::for_each_frame(model, frames, layout, [&](const Matrix<T>& Q, int row) {
    v.middleRows(row, Q.rows()) = Q.transpose().lazyProduct(v.middleRows(row, Q.rows())).eval();
  });
  return v;
}

/// Back to the axes: Q v.
template <class T, class V>
V out_of_frames(const Model& model, const std::vector<Matrix<T>>& frames, NodalLayout layout, V v) {
  detail::for_each_frame(model, frames, layout, [&](const Matrix<T>& Q, int row) {
    v.middleRows(row, Q.rows()) = Q.lazyProduct(v.middleRows(row, Q.rows())).eval();
  });
  return v;
}

/// A tangent over `nodes` (node-major, then whatever rows) in the frames: Q^T K Q.
template <class T>
Matrix<T> into_frames(const Model& model, const std::vector<Matrix<T>>& frames, const std::vector<int>& nodes,
                      Matrix<T> K) {
  const int D = model.dimension;
  for (std::size_t n = 0; n < nodes.size(); ++n) {
    const int index = framed_index(model, nodes[n]);
    if (index < 0) continue;
    const Matrix<T>& Q = frames[index];
    const auto first = static_cast<Eigen::Index>(n) * D;
    K.middleRows(first, D) = Q.transpose().lazyProduct(K.middleRows(first, D)).eval();
    K.middleCols(first, D) = K.middleCols(first, D).lazyProduct(Q).eval();
  }
  return K;
}

}  // namespace stickslip
