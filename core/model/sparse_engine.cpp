#include "core/model/sparse_engine_impl.hpp"

namespace stickslip {
namespace detail {

std::vector<int> rows_of_point(const Model& model, const std::vector<int>& nodes, const ContactPoint& point,
                               bool unknown_multipliers) {
  std::vector<int> rows;
  const int D = model.dimension;
  for (int node : nodes)
    for (int i = 0; i < D; ++i) rows.push_back(model.free_index[node * D + i]);
  if (unknown_multipliers)
    for (int c = 0; c < point.components(); ++c)
      rows.push_back(static_cast<int>(model.free_dofs.size()) + point.multiplier + c);
  return rows;
}

std::vector<int> entries_of(const Pattern& pattern, const std::vector<int>& rows) {
  std::vector<int> map;
  for (int row : rows)
    for (int column : rows) map.push_back(row < 0 || column < 0 ? -1 : locate(pattern, row, column));
  return map;
}

}  // namespace detail

RowLists tangent_rows(const Model& model, bool unknown_multipliers) {
  auto lists = element_rows(model, model.free_index);
  for (const auto& point : model.points)
    lists.add(detail::rows_of_point(model, point.nodes, point, unknown_multipliers));
  return lists;
}

template class SparseEngine<double>;

}  // namespace stickslip
