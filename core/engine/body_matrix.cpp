#include "core/engine/body_matrix.hpp"

#include <algorithm>

namespace stickslip {

void RowLists::add(const std::vector<int>& rows) {
  row.insert(row.end(), rows.begin(), rows.end());
  start.push_back(static_cast<int>(row.size()));
}

bool is_among(const Model& model, std::size_t body, BodyKind kind) {
  if (kind == BodyKind::all) return true;
  // (at small strain a law that remembers nothing is linear)
  const bool is_constant = model.effects.linear_bulk || (!model.scene.finite_strain && model.bodies[body].memory == 0);
  return is_constant == (kind == BodyKind::constant);
}

RowLists element_rows(const Model& model, const std::vector<int>& row_of_dof, BodyKind kind) {
  const int D = model.dimension;
  RowLists lists;
  for (std::size_t b = 0; b < model.bodies.size(); ++b) {
    if (!is_among(model, b, kind)) continue;
    const auto& body = model.bodies[b];
    for (int e = 0; e < body.mesh.element_count(); ++e) {
      for (int node : detail::element_nodes(body, e))
        for (int i = 0; i < D; ++i) lists.row.push_back(row_of_dof[node * D + i]);
      lists.start.push_back(static_cast<int>(lists.row.size()));
    }
  }
  return lists;
}

std::shared_ptr<Pattern> make_pattern(int size, const RowLists& lists) {
  std::vector<int> start(size + 1, 0), member(lists.row.size());  // which lists each row belongs to
  for (int row : lists.row)
    if (row >= 0) ++start[row + 1];
  for (int row = 0; row < size; ++row) start[row + 1] += start[row];
  std::vector<int> filled(start.begin(), start.end() - 1);
  for (int list = 0; list < lists.count(); ++list)
    for (int k = lists.start[list]; k < lists.start[list + 1]; ++k)
      if (lists.row[k] >= 0) member[filled[lists.row[k]]++] = list;
  auto pattern = std::make_shared<Pattern>();
  pattern->size = size;
  pattern->column_start.push_back(0);
  std::vector<int> last_column(size, -1), column;  // where a row was met last
  for (int j = 0; j < size; ++j) {
    column.assign(1, j);
    last_column[j] = j;
    for (int m = start[j]; m < start[j + 1]; ++m)
      for (int k = lists.start[member[m]]; k < lists.start[member[m] + 1]; ++k)
        if (const int row = lists.row[k]; row >= 0 && last_column[row] != j) {
          last_column[row] = j;
          column.push_back(row);
        }
    std::sort(column.begin(), column.end());
    pattern->row.insert(pattern->row.end(), column.begin(), column.end());
    pattern->column_start.push_back(static_cast<int>(pattern->row.size()));
  }
  return pattern;
}

ContactLast with_contact_last(const Model& model) {
  const int D = model.dimension;
  ContactLast rows;
  enum Place : char { elsewhere, inside, in_contact };
  std::vector<Place> place(model.node_count, elsewhere);
  for (std::size_t b = 0; b < model.bodies.size(); ++b)
    if (is_among(model, b, BodyKind::constant))
      std::fill_n(place.begin() + model.bodies[b].first_node, model.bodies[b].mesh.node_count, inside);
  for (int node : model.contact_nodes) {
    if (place[node] == elsewhere) continue;
    place[node] = in_contact;
    for (int d = 0; d < D; ++d) rows.contact.push_back(node * D + d);
  }
  for (int dof : model.free_dofs)
    if (place[dof / D] == inside) rows.interior.push_back(dof);
  std::vector<int> row(model.dof_count(), -1);
  int next = 0;
  for (const auto* dofs : {&rows.interior, &rows.contact})
    for (int dof : *dofs) row[dof] = next++;
  rows.lists = element_rows(model, row, BodyKind::constant);
  rows.pattern = make_pattern(next, rows.lists);
  return rows;
}

int locate(const Pattern& pattern, int row, int column) {
  const auto first = pattern.row.begin() + pattern.column_start[column];
  const auto last = pattern.row.begin() + pattern.column_start[column + 1];
  return static_cast<int>(std::lower_bound(first, last, row) - pattern.row.begin());
}

STICKSLIP_TANGENTS(, double);

}  // namespace stickslip
