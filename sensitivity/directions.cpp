/// Slots in the scalar of direct differentiation, and the elements that parameters touch.
#include <numeric>

#include "core/engine/body_matrix.hpp"
#include "core/model/contact_assembly_impl.hpp"
#include "core/model/element_nodes.hpp"
#include "core/model/slots_impl.hpp"
#include "sensitivity/differentiation.hpp"

namespace stickslip {

STICKSLIP_SLOTS(, Direction);
STICKSLIP_CONTACT(, Direction);

namespace {

/// Whether the numbers of a law have no derivative; false if the law does not list them.
const auto has_no_derivative = []<class L>(const L& law) {
  if constexpr (!Remembers<L> && requires { law.numbers(); }) return are_constant(law.numbers());
  return false;
};

/// Removes the elements of linear bodies from lists, and returns them.
ElementLists take_linear(const Model& model, ElementLists& lists) {
  ElementLists linear(lists.size());
  for (std::size_t b = 0; b < lists.size(); ++b)
    if (is_among(model, b, BodyKind::constant)) std::swap(linear[b], lists[b]);
  return linear;
}

/// Those of the given parameters that touch elements; all, if a law does not list its numbers.
std::vector<int> touching_elements(const Model& model, const std::vector<int>& parameters) {
  const auto numbers = seeded(model.scene, parameters);
  const auto slots = make_body_slots(model, numbers, initial_points(model, numbers));
  Direction::Gradient by = Direction::Gradient::Zero();  // sizes of derivatives
  const auto join = [&](const Direction& x) { by += x.d.abs(); };
  std::for_each(slots.points.data(), slots.points.data() + slots.points.size(), join);
  for (const auto& depth : slots.depths) join(depth.thickness);
  const auto join_numbers = [&]<class L>(const L& law) {
    if constexpr (requires { law.numbers(); })
      for (const auto& x : law.numbers()) join(x);
    else
      by += 1;
  };
  for (const auto& of : slots.laws) std::visit(join_numbers, of.law);
  std::vector<int> touching;
  for (std::size_t d = 0; d < parameters.size(); ++d)
    if (by[d] != 0) touching.push_back(parameters[d]);
  return touching;
}

}  // namespace

void ParameterBlock::keep_stiffness(const Model& model) {
  stiffness.emplace(model, slots, take_linear(model, touched));
}

long kept_stiffness_bytes(const Model& model) {
  long bytes = 0;
  if (!keeps_stiffness(model)) return bytes;
  for (const auto& group : parameter_groups(model)) {
    const auto numbers = seeded(model.scene, group);
    auto touched = touched_elements(model, make_body_slots(model, numbers, initial_points(model, numbers)));
    bytes += DualStiffness::bytes_of(model, take_linear(model, touched));
  }
  return bytes;
}

std::vector<std::vector<int>> parameter_groups(const Model& model) {
  const int parameters = static_cast<int>(model.scene.parameters.size());
  std::vector<std::vector<int>> groups;
  std::vector<int> order(parameters);
  std::iota(order.begin(), order.end(), 0);
  const auto divide = [&] {
    groups.clear();
    for (int first = 0; first < parameters; first += directions)
      groups.emplace_back(order.begin() + first, order.begin() + std::min(parameters, first + directions));
  };
  divide();
  if (groups.size() < 2) return groups;
  std::vector<char> touches(parameters, false);
  for (const auto& group : groups)
    for (int j : touching_elements(model, group)) touches[j] = true;
  std::stable_partition(order.begin(), order.end(), [&](int j) { return touches[j]; });
  divide();
  return groups;
}

ElementLists touched_elements(const Model& model, const Slots<Direction>& slots) {
  const int D = model.dimension;
  std::vector<char> touched(model.node_count, !model.framed.empty());
  for (const auto& constraint : model.constraints) touched[constraint.dof / D] = true;
  for (int node = 0; node < model.node_count; ++node)
    for (int i = 0; i < D; ++i) touched[node] |= !is_constant(slots.points(i, node));
  ElementLists lists(model.bodies.size());
  std::vector<int> nodes;
  for (std::size_t b = 0; b < lists.size(); ++b) {
    const bool all = !is_constant(slots.depths[b].thickness) || !std::visit(has_no_derivative, slots.laws[b].law);
    for (int e = 0; e < model.bodies[b].mesh.element_count(); ++e) {
      detail::set_element_nodes(model.bodies[b], e, nodes);
      if (all || std::any_of(nodes.begin(), nodes.end(), [&](int node) { return touched[node]; }))
        lists[b].push_back(e);
    }
  }
  return lists;
}

}  // namespace stickslip
