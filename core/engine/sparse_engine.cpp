#include "core/engine/sparse_engine_impl.hpp"

namespace stickslip {
namespace detail {

std::vector<int> rows_of_point(const Model& model, const std::vector<int>& row_of_dof, const std::vector<int>& nodes,
                               const ContactPoint& point, int first_multiplier) {
  std::vector<int> rows;
  const int D = model.dimension;
  for (int node : nodes)
    for (int i = 0; i < D; ++i) rows.push_back(row_of_dof[node * D + i]);
  for (int c = 0; first_multiplier >= 0 && c < point.components(); ++c)
    rows.push_back(first_multiplier + point.multiplier + c);
  return rows;
}

std::vector<int> entries_of(const Pattern& pattern, const std::vector<int>& rows) {
  std::vector<int> map;
  for (int row : rows)
    for (int column : rows) map.push_back(row < 0 || column < 0 ? -1 : locate(pattern, row, column));
  return map;
}

}  // namespace detail

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
