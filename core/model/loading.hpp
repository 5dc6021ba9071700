/// What drives a model in time: external nodal forces and prescribed displacements.
#pragma once

#include "core/model/slots.hpp"

namespace stickslip {

/// External nodal forces at time t, all dofs.
template <class T>
Vector<T> external_forces(const Model& model, const Slots<T>& slots, double t) {
  Vector<T> forces = Vector<T>::Constant(model.dof_count(), T(0));
  for (std::size_t l = 0; l < slots.loads.size(); ++l) {
    const auto& history = model.scene.loads[l].history;
    const T factor = history ? evaluate(*history, t, slots.numbers) : T(1);
    for (int dof = 0; dof < model.dof_count(); ++dof) forces[dof] += factor * slots.loads[l][dof];
  }
  return forces;
}

/// Sets the prescribed entries of a displacement vector (all dofs) to their values at time t.
template <class T>
void prescribe(const Model& model, const Slots<T>& slots, double t, Vector<T>& displacement) {
  for (const auto& constraint : model.constraints)
    displacement[constraint.dof] =
        constraint.support < 0
            ? T(0)
            : evaluate(model.scene.supports[constraint.support].move.at(constraint.axis), t, slots.numbers);
}

/// Compact displacements of the contact nodes out of all.
template <class T>
Vector<T> to_compact(const Model& model, const Vector<T>& all) {
  const int D = model.dimension;
  Vector<T> compact(static_cast<Eigen::Index>(model.contact_nodes.size()) * D);
  for (std::size_t n = 0; n < model.contact_nodes.size(); ++n)
    for (int i = 0; i < D; ++i) compact[n * D + i] = all[model.contact_nodes[n] * D + i];
  return compact;
}

/// Adds compact forces to a vector over all dofs.
template <class T>
void add_compact(const Model& model, const Vector<T>& compact, Vector<T>& all) {
  const int D = model.dimension;
  for (std::size_t n = 0; n < model.contact_nodes.size(); ++n)
    for (int i = 0; i < D; ++i) all[model.contact_nodes[n] * D + i] += compact[n * D + i];
}

}  // namespace stickslip
