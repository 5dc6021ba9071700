/// The bodies' stiffness as one sparse matrix over chosen dofs, in the frames of the nodes (model/frames.hpp).
#pragma once

#include <memory>
#include <vector>

#include "core/algebra/linear_solver.hpp"
#include "core/model/frames.hpp"

namespace stickslip {

/// Rows of dense blocks that add up to a matrix, one list after another; -1: a row that is not there.
struct RowLists {
  std::vector<int> start = {0};  ///< one more than there are lists
  std::vector<int> row;
  void add(const std::vector<int>& rows);
  int count() const { return static_cast<int>(start.size()) - 1; }
};

/// One list for each element, body by body: where each of its dofs (node-major) stands in the matrix.
RowLists element_rows(const Model& model, const std::vector<int>& row_of_dof);

/// Pattern of a sum of such blocks; every diagonal entry is stored.
std::shared_ptr<Pattern> make_pattern(int size, const RowLists& lists);

/// Entry of (row, column) in the pattern. pre: it exists.
int locate(const Pattern& pattern, int row, int column);

/// Values of the bodies' tangent on a pattern; the first lists are those of element_rows(). `at`: a motion; nullptr: of
/// the start.
template <class T>
std::vector<T> assemble_bodies(const Model& model, const Slots<T>& slots, const RowLists& lists, const Pattern& pattern,
                               const BodyMotion<T>* at = nullptr);

/// for_each_element_tangent of a body, in the frames of the nodes.
template <class T, class Sink>
void for_each_framed_tangent(const Model& model, const Slots<T>& slots, int b, const BodyMotion<T>* at, Sink&& sink) {
  const auto framed = [&](const auto& nodes, const auto& K) {
    if (model.framed.empty())
      sink(nodes, K);
    else
      sink(nodes, into_frames(model, slots.frames, nodes, Matrix<T>(K)));
  };
  for_each_element_tangent(model, slots, b, nullptr, framed, at);
}

}  // namespace stickslip
