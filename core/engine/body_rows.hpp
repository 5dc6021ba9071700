/// Rows of the bodies' matrix: which dofs have one, and the pattern; in full, or with what can be condensed left out or
/// behind: bodies of constant stiffness once, or each tangent of bodies that change.
#pragma once

#include <memory>
#include <utility>
#include <vector>

#include "core/algebra/linear_solver.hpp"
#include "core/engine/multipliers.hpp"
#include "core/model/model.hpp"

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

/// Entry of (row, column) in the pattern. pre: it exists.
int locate(const Pattern& pattern, int row, int column);

/// Whether some bodies can be condensed and others can't: of constant stiffness with something inside, and of another.
bool has_mixed_bodies(const Model& model);

/// Whether all bodies can be condensed, or some of them.
inline bool can_condense(const Model& model) { return model.effects.linear_bulk || has_mixed_bodies(model); }

/// Whether tangents can be condensed: those of contact between bodies with something inside, whose tangents change and
/// are symmetric and, as long as no path leads past its limit points, definite.
bool can_condense_tangents(const Model& model);

/// The matrix of some bodies, with their contact dofs behind the other free ones.
struct ContactLast {
  std::vector<int> interior;    ///< free dofs outside the contact, as rows follow one another
  std::vector<int> contact;     ///< dofs of the contact, likewise
  std::vector<int> row_of_dof;  ///< -1: none
  RowLists lists;               ///< of the elements
  std::shared_ptr<Pattern> pattern;
};

/// Of the bodies of constant stiffness, prescribed contact dofs among them.
ContactLast constant_bodies(const Model& model);
/// Of all bodies, without the prescribed contact dofs.
ContactLast all_bodies(const Model& model);

/// Rows of the sparse system of a scene in which the bodies of constant stiffness are condensed and the others are not:
/// the free dofs but for those inside condensed bodies, in their order. Each condensed body is a dense block on its
/// contact dofs.
struct MixedRows {
  std::vector<int> row_of_dof;  ///< -1: prescribed, or inside a condensed body
  std::vector<int> dofs;        ///< of the rows
  std::vector<int> contact;     ///< contact dofs of condensed bodies, as the rows of their Schur complement
  /// Of each condensed body in contact: first of its `contact`, and their end.
  std::vector<std::pair<int, int>> blocks;

  explicit MixedRows(const Model& model);
  /// Adds the rows of the blocks, a list each.
  void add_blocks(RowLists& lists) const;
};

/// Free displacements that are left where what can be condensed of a mixed scene is.
int mixed_displacements(const Model& model);

/// Rows of the sparse tangent that each element, and after them each contact point, has entries in. A point's: its
/// nodes' dofs, and its multipliers where these are unknown; -1: prescribed. `mixed`: of a scene that is condensed in
/// part; the blocks of its condensed bodies come before the points.
RowLists tangent_rows(const Model& model, Multipliers multipliers, const MixedRows* mixed = nullptr);

}  // namespace stickslip
