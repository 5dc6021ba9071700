#include "core/engine/sparse_system_impl.hpp"

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

template class SparseSystem<double>;

}  // namespace stickslip
