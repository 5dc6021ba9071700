/// Bytes of what slots and states hold, by what they are held for: the arrays themselves are asked for their sizes.
#pragma once

#include "core/model/slots.hpp"
#include "core/model/state.hpp"

namespace stickslip {

template <class V>
long bytes_of(const V& array) {
  return static_cast<long>(array.size() * sizeof(*array.data()));
}

/// Of slots; the few numbers of each body's material are left out.
struct SlotBytes {
  long bodies = 0;   ///< numbers of the scene, coordinates, loads, frames
  long contact = 0;  ///< geometry, stiffness and friction of the contact points
  long all() const { return bodies + contact; }
};

/// Slots as they are, or as they would be with the scalar U in place of T.
template <class U, class T>
SlotBytes slot_bytes(const Slots<T>& slots) {
  constexpr long one = sizeof(U);
  SlotBytes held;
  held.bodies = one * static_cast<long>(slots.numbers.at_slot.size() + slots.points.size());
  for (const auto& load : slots.loads) held.bodies += one * static_cast<long>(load.forces.size());
  for (const auto& frame : slots.frames) held.bodies += one * frame.size();
  for (const auto& geometry : slots.geometry)
    held.contact += static_cast<long>(sizeof(PointGeometry<U>)) + one * geometry.weights.size();
  held.contact += one * static_cast<long>(slots.stiffness.size());
  for (const auto& law : slots.friction) held.contact += one * std::max(law.size(), 1);
  for (const auto& spin : slots.spins) held.contact += one * spin.size();
  for (const auto& arcs : slots.arcs) held.contact += one * arcs.size();
  return held;
}
template <class T>
SlotBytes slot_bytes(const Slots<T>& slots) {
  return slot_bytes<T, T>(slots);
}

/// Of states. Friction's share is what a frictionless contact does not have: tangential components, and work.
struct StateBytes {
  long displacements = 0;
  long contact = 0;      ///< gaps, branches, normal tractions
  long multipliers = 0;  ///< normal
  long history = 0;      ///< friction: placement, slip, work
  long tangential = 0;   ///< friction: tractions and multipliers
  long bodies = 0;       ///< plasticity: what bodies remember
  long all() const { return displacements + contact + multipliers + history + tangential + bodies; }
  StateBytes& operator+=(const StateBytes& o) {
    displacements += o.displacements;
    contact += o.contact;
    multipliers += o.multipliers;
    history += o.history;
    tangential += o.tangential;
    bodies += o.bodies;
    return *this;
  }
};

template <class T>
StateBytes state_bytes(const State<T>& state) {
  constexpr long one = sizeof(T);
  const auto& contact = state.contact;
  const Eigen::Index normal = contact.gap.size();
  const auto across = [&](const Vector<T>& v) { return one * std::max<long>(v.size() - normal, 0); };
  StateBytes held;
  held.displacements = bytes_of(state.displacement);
  held.tangential = across(contact.traction) + across(state.multiplier);
  held.multipliers = bytes_of(state.multiplier) - across(state.multiplier);
  held.contact =
      bytes_of(contact.state) + bytes_of(contact.gap) + bytes_of(contact.traction) - across(contact.traction);
  for (const auto& geometry : contact.moved)
    held.contact += static_cast<long>(sizeof(PointGeometry<T>)) + one * geometry.weights.size();
  held.history = bytes_of(contact.slip);
  for_each_part([&](const Vector<T>& part) { held.history += bytes_of(part); }, state.history);
  held.bodies = bytes_of(state.history.bodies);
  held.history -= held.bodies;
  return held;
}

}  // namespace stickslip
