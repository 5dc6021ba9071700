#include "core/engine/body_rows.hpp"

#include <algorithm>

#include "core/model/element_nodes.hpp"
#include "core/model/slots.hpp"

namespace stickslip {
namespace {

bool is_in_contact(const Model& model, int node) {
  return std::binary_search(model.contact_nodes.begin(), model.contact_nodes.end(), node);
}

/// Whether a free dof of the body is at none of the contact nodes.
bool has_inside(const Model& model, const BodyMesh& body) {
  const int D = model.dimension, first = body.first_node * D, end = first + body.mesh.node_count * D;
  for (int dof = first; dof < end; ++dof)
    if (model.free_index[dof] >= 0 && !is_in_contact(model, dof / D)) return true;
  return false;
}

/// Per node, whether its body is among those of a kind.
std::vector<char> nodes_among(const Model& model, BodyKind kind) {
  std::vector<char> among(model.node_count, false);
  for (std::size_t b = 0; b < model.bodies.size(); ++b)
    if (is_among(model, b, kind))
      std::fill_n(among.begin() + model.bodies[b].first_node, model.bodies[b].mesh.node_count, true);
  return among;
}

enum class PrescribedContact { kept, left_out };

ContactLast contact_last(const Model& model, BodyKind kind, PrescribedContact prescribed) {
  const int D = model.dimension;
  ContactLast rows;
  const auto among = nodes_among(model, kind);
  for (int node : model.contact_nodes)
    for (int dof = node * D; among[node] && dof < (node + 1) * D; ++dof)
      if (prescribed == PrescribedContact::kept || model.free_index[dof] >= 0) rows.contact.push_back(dof);
  for (int dof : model.free_dofs)
    if (among[dof / D] && !is_in_contact(model, dof / D)) rows.interior.push_back(dof);
  rows.row_of_dof.assign(model.dof_count(), -1);
  int next = 0;
  for (const auto* dofs : {&rows.interior, &rows.contact})
    for (int dof : *dofs) rows.row_of_dof[dof] = next++;
  rows.lists = element_rows(model, rows.row_of_dof, kind);
  rows.pattern = make_pattern(next, rows.lists);
  return rows;
}

}  // namespace

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
  std::vector<int> nodes;
  for (std::size_t b = 0; b < model.bodies.size(); ++b) {
    if (!is_among(model, b, kind)) continue;
    const auto& body = model.bodies[b];
    lists.start.reserve(lists.start.size() + body.mesh.element_count());
    lists.row.reserve(lists.row.size() + body.mesh.connectivity.size() * D);
    for (int e = 0; e < body.mesh.element_count(); ++e) {
      detail::set_element_nodes(body, e, nodes);
      for (int node : nodes)
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

int locate(const Pattern& pattern, int row, int column) {
  const auto first = pattern.row.begin() + pattern.column_start[column];
  const auto last = pattern.row.begin() + pattern.column_start[column + 1];
  return static_cast<int>(std::lower_bound(first, last, row) - pattern.row.begin());
}

bool has_mixed_bodies(const Model& model) {
  if (model.scene.arc_length) return false;  // (whose loads move within an increment)
  if (model.effects.linear_bulk || model.scene.finite_strain) return false;
  for (std::size_t b = 0; b < model.bodies.size(); ++b)
    if (is_among(model, b, BodyKind::constant) && has_inside(model, model.bodies[b])) return true;
  return false;
}

bool can_condense_tangents(const Model& model) {
  if (model.effects.linear_bulk || model.points.empty() || model.scene.arc_length || !model.followers.empty())
    return false;
  return std::any_of(model.free_dofs.begin(), model.free_dofs.end(),
                     [&](int dof) { return !is_in_contact(model, dof / model.dimension); });
}

ContactLast constant_bodies(const Model& model) {
  return contact_last(model, BodyKind::constant, PrescribedContact::kept);
}

ContactLast all_bodies(const Model& model) { return contact_last(model, BodyKind::all, PrescribedContact::left_out); }

MixedRows::MixedRows(const Model& model) : row_of_dof(model.dof_count(), -1) {
  const int D = model.dimension;
  const auto condensed = nodes_among(model, BodyKind::constant);
  for (int node : model.contact_nodes)
    for (int i = 0; condensed[node] && i < D; ++i) contact.push_back(node * D + i);
  for (int dof : model.free_dofs) {
    if (condensed[dof / D] && !is_in_contact(model, dof / D)) continue;
    row_of_dof[dof] = static_cast<int>(dofs.size());
    dofs.push_back(dof);
  }
  for (std::size_t b = 0; b < model.bodies.size(); ++b) {
    if (!is_among(model, b, BodyKind::constant)) continue;
    const int first = model.bodies[b].first_node * D, end = first + model.bodies[b].mesh.node_count * D;
    const auto place = [&](int dof) {
      return static_cast<int>(std::lower_bound(contact.begin(), contact.end(), dof) - contact.begin());
    };
    if (place(first) < place(end)) blocks.emplace_back(place(first), place(end));
  }
}

void MixedRows::add_blocks(RowLists& lists) const {
  for (const auto& [first, end] : blocks) {
    for (int k = first; k < end; ++k) lists.row.push_back(row_of_dof[contact[k]]);
    lists.start.push_back(static_cast<int>(lists.row.size()));
  }
}

int mixed_displacements(const Model& model) { return static_cast<int>(MixedRows(model).dofs.size()); }

RowLists tangent_rows(const Model& model, Multipliers multipliers, const MixedRows* mixed) {
  const auto& row_of_dof = mixed ? mixed->row_of_dof : model.free_index;
  auto lists = element_rows(model, row_of_dof, mixed ? BodyKind::changing : BodyKind::all);
  if (mixed) mixed->add_blocks(lists);
  const int behind = static_cast<int>((mixed ? mixed->dofs : model.free_dofs).size());
  for (const auto& point : model.points) {
    for (int node : point.nodes)
      for (int i = 0; i < model.dimension; ++i) lists.row.push_back(row_of_dof[node * model.dimension + i]);
    for (int c = 0; multipliers == Multipliers::unknown && c < point.components(); ++c)
      lists.row.push_back(behind + point.multiplier + c);
    lists.start.push_back(static_cast<int>(lists.row.size()));
  }
  return lists;
}

}  // namespace stickslip
