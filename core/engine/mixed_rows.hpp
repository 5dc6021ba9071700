/// Rows of the sparse system of a scene in which the bodies of constant stiffness are condensed and the others are not:
/// the free dofs but for those inside condensed bodies, in their order. Each condensed body is a dense block on its
/// contact dofs.
#pragma once

#include <utility>
#include <vector>

#include "core/engine/body_matrix.hpp"

namespace stickslip {

/// Whether some bodies can be condensed and others can't: of constant stiffness with something inside, and of another.
bool has_mixed_bodies(const Model& model);

struct MixedRows {
  std::vector<int> row_of_dof;  ///< -1: prescribed, or inside a condensed body
  std::vector<int> dofs;        ///< of the rows
  std::vector<int> contact;     ///< contact dofs of condensed bodies, as the rows of their Schur complement
  std::vector<std::pair<int, int>>
      blocks;  ///< of each condensed body in contact: first of its `contact`, and their end

  explicit MixedRows(const Model& model);
  /// Adds the rows of the blocks, a list each.
  void add_blocks(RowLists& lists) const;
};

/// Free displacements that the sparse engine solves for where it condenses what it can of a mixed scene.
int mixed_displacements(const Model& model);

}  // namespace stickslip
