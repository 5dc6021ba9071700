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

/// Bodies by their stiffness: all, those of which it is constant, and the others.
enum class BodyKind { all, constant, changing };
bool is_among(const Model& model, std::size_t body, BodyKind kind);

/// One list for each element, body by body: where each of its dofs (node-major) stands in the matrix.
RowLists element_rows(const Model& model, const std::vector<int>& row_of_dof, BodyKind kind = BodyKind::all);

/// Pattern of a sum of such blocks; every diagonal entry is stored.
std::shared_ptr<Pattern> make_pattern(int size, const RowLists& lists);

/// The matrix of the bodies of constant stiffness, with their contact dofs, prescribed ones among them, behind the
/// other free ones.
struct ContactLast {
  std::vector<int> interior;  ///< free dofs outside the contact, as rows follow one another
  std::vector<int> contact;   ///< dofs of the contact, likewise
  RowLists lists;
  std::shared_ptr<Pattern> pattern;
};
ContactLast with_contact_last(const Model& model);

/// Entry of (row, column) in the pattern. pre: it exists.
int locate(const Pattern& pattern, int row, int column);

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

/// Of a scalar that is solved in: as STICKSLIP_SLOTS.
#define STICKSLIP_TANGENTS(EXTERN, T)                                                                                 \
  EXTERN template Vector<T> bulk_tangent_times(const Model&, const Slots<T>&, const BodyMotion<T>&, const Vector<T>&, \
                                               const ElementLists*);                                                  \
  EXTERN template std::vector<T> assemble_bodies(const Model&, const Slots<T>&, const RowLists&, const Pattern&,      \
                                                 const BodyMotion<T>*, BodyKind)

STICKSLIP_TANGENTS(extern, double);

}  // namespace stickslip
