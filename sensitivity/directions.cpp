/// The slots and bodies in the scalar of direct differentiation, and which elements it touches.
#include "sensitivity/differentiation.hpp"

namespace stickslip {

STICKSLIP_SLOTS(, Direction);

ElementLists touched_elements(const Model& model, const Slots<Direction>& slots) {
  const int D = model.dimension;
  std::vector<char> touched(model.node_count, !model.framed.empty());
  for (const auto& constraint : model.constraints) touched[constraint.dof / D] = true;
  for (int node = 0; node < model.node_count; ++node)
    for (int i = 0; i < D; ++i) touched[node] |= !is_constant(slots.points(i, node));
  const auto has_no_derivative = []<class L>(const L& law) {
    if constexpr (!Remembers<L> && requires { law.numbers(); }) return detail::is_constant(law.numbers());
    return false;
  };
  ElementLists lists(model.bodies.size());
  std::vector<int> nodes;
  for (std::size_t b = 0; b < lists.size(); ++b) {
    const bool all = !is_constant(slots.depths[b].thickness) || !std::visit(has_no_derivative, slots.laws[b]);
    for (int e = 0; e < model.bodies[b].mesh.element_count(); ++e) {
      detail::set_element_nodes(model.bodies[b], e, nodes);
      if (all || std::any_of(nodes.begin(), nodes.end(), [&](int node) { return touched[node]; }))
        lists[b].push_back(e);
    }
  }
  return lists;
}

}  // namespace stickslip
