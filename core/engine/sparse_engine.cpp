#include "core/engine/sparse_engine_impl.hpp"

namespace stickslip {
RowLists tangent_rows(const Model& model, bool unknown_multipliers, const MixedRows* mixed) {
  const auto& row_of_dof = mixed ? mixed->row_of_dof : model.free_index;
  auto lists = element_rows(model, row_of_dof, mixed ? BodyKind::changing : BodyKind::all);
  if (mixed) mixed->add_blocks(lists);
  const int displacements = static_cast<int>((mixed ? mixed->dofs : model.free_dofs).size());
  for (const auto& point : model.points)
    lists.add(detail::rows_of_point(model, row_of_dof, point.nodes, point, unknown_multipliers ? displacements : -1));
  return lists;
}

template class SparseEngine<double>;

}  // namespace stickslip
