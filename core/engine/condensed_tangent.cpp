#include "core/engine/condensed_tangent_impl.hpp"

namespace stickslip {

CondensedRows::CondensedRows(const Model& model) : row_of_dof(model.dof_count(), -1) {
  std::vector<char> in_contact(model.node_count, false);
  for (int node : model.contact_nodes) in_contact[node] = true;
  for (const bool contact : {false, true}) {
    // (contact dofs in the order of Model::contact_nodes, which is that of the nodes)
    for (int dof : model.free_dofs)
      if (in_contact[dof / model.dimension] == contact) {
        row_of_dof[dof] = static_cast<int>(dofs.size());
        dofs.push_back(dof);
        kept += contact;
      }
  }
  lists = element_rows(model, row_of_dof);
  pattern = make_pattern(static_cast<int>(dofs.size()), lists);
}

bool can_condense_tangents(const Model& model) {
  if (model.effects.linear_bulk || model.points.empty() || model.scene.arc_length || !model.followers.empty())
    return false;
  const auto is_inside = [&](int dof) {
    return !std::binary_search(model.contact_nodes.begin(), model.contact_nodes.end(), dof / model.dimension);
  };
  return std::any_of(model.free_dofs.begin(), model.free_dofs.end(), is_inside);
}

template class CondensedTangent<double>;

}  // namespace stickslip
