#include "core/engine/mixed_rows.hpp"

#include <algorithm>

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

}  // namespace

bool has_mixed_bodies(const Model& model) {
  if (model.scene.arc_length) return false;  // (whose loads move within an increment)
  if (model.effects.linear_bulk || model.scene.finite_strain) return false;
  for (std::size_t b = 0; b < model.bodies.size(); ++b)
    if (is_among(model, b, BodyKind::constant) && has_inside(model, model.bodies[b])) return true;
  return false;
}

MixedRows::MixedRows(const Model& model) : row_of_dof(model.dof_count(), -1) {
  const int D = model.dimension;
  std::vector<char> condensed(model.node_count, false);
  for (std::size_t b = 0; b < model.bodies.size(); ++b)
    if (is_among(model, b, BodyKind::constant))
      std::fill_n(condensed.begin() + model.bodies[b].first_node, model.bodies[b].mesh.node_count, true);
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

}  // namespace stickslip
