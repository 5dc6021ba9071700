/// Contact evaluation of a whole model: local unknowns of its contact points, nodal forces, multiplier rows, history.
///
/// Displacements are arguments and forces are results, both as compact vectors over Model::contact_nodes (D per node).
/// The multiplier lambda is an argument too: the methods differ only in what they pass for it.
#pragma once

#include "core/model/contact_input.hpp"

namespace stickslip {

/// History before the first increment: zero slip and work. Where the present geometry is used, it holds the initial
/// feet.
template <class T>
History<T> initial_history(const Model& model, const Slots<T>& slots);

/// State before the first increment: zero displacements and tractions, all points open.
template <class T>
State<T> initial_state(const Model& model, const Slots<T>& slots);

/// Local unknowns of all points.
///
///   compact     displacements of the contact nodes, D per node, length
///   multiplier  lambda, force per area, laid out by ContactPoint::multiplier
///   states      branch of the projection per point; nullptr: each point is classified by its trial traction
template <class T>
ContactField<T> evaluate_contact(const ContactInput<T>& input, const Vector<T>& compact, const Vector<T>& multiplier,
                                 const std::vector<ContactState>* states);

/// Nodal contact forces of the residual, compact (D per contact node), force. They follow from the tractions of
/// `field`.
template <class T>
Vector<T> contact_forces(const Model& model, const Slots<T>& slots, const ContactField<T>& field);

/// Multiplier rows of the monolithic method: A (t - lambda) per component, force. A is the initial area.
template <class T>
Vector<T> multiplier_residual(const Model& model, const Slots<T>& slots, const Vector<T>& traction,
                              const Vector<T>& multiplier);

/// History of the contacts after an increment. Placement and feet are moved out of `field`. `multiplier`: lambda. The
/// history of the bodies is bulk_flow().
template <class T>
History<T> next_history(const ContactInput<T>& input, ContactField<T>& field, const Vector<T>& multiplier);

/// All of these in a scalar, as STICKSLIP_SLOTS; the source includes core/model/contact_assembly_impl.hpp.
#define STICKSLIP_CONTACT(EXTERN, T)                                                                                \
  EXTERN template History<T> initial_history(const Model&, const Slots<T>&);                                        \
  EXTERN template State<T> initial_state(const Model&, const Slots<T>&);                                            \
  EXTERN template ContactField<T> evaluate_contact(const ContactInput<T>&, const Vector<T>&, const Vector<T>&,      \
                                                   const std::vector<ContactState>*);                               \
  EXTERN template Vector<T> contact_forces(const Model&, const Slots<T>&, const ContactField<T>&);                  \
  EXTERN template Vector<T> multiplier_residual(const Model&, const Slots<T>&, const Vector<T>&, const Vector<T>&); \
  EXTERN template History<T> next_history(const ContactInput<T>&, ContactField<T>&, const Vector<T>&)

STICKSLIP_CONTACT(extern, double);

namespace detail {

/// Result of f.template operator()<D, Tangents>() with the dimension and the tangents of a point.
template <class F>
decltype(auto) with_point(const Model& model, const ContactPoint& point, F&& f) {
  return with_dimension(model.dimension, [&]<int D>() {
    return point.tangents > 0 ? f.template operator()<D, D - 1>() : f.template operator()<D, 0>();
  });
}

/// Displacement, D, of the obstacle of point p at the initial foot; zero without an obstacle. Linear in the angle.
template <class T, int D>
Vec<T, D> obstacle_displacement(const ContactInput<T>& input, int p) {
  const auto& point = input.model.points[p];
  Vec<T, D> u = Vec<T, D>::Constant(T(0));
  if (point.obstacle < 0) return u;
  for (const auto& [axis, table] : input.model.scene.obstacles[point.obstacle].move)
    u[axis - 'x'] = evaluate(table, input.time, input.slots.numbers);
  if (const auto& rotate = input.model.scene.obstacles[point.obstacle].rotate) {
    const T angle = evaluate(rotate->angle, input.time, input.slots.numbers);
    for (int i = 0; i < D; ++i) u[i] += angle * input.slots.spins[p][i];
  }
  return u;
}

/// Traction of one point. `field`: laid out as multipliers; `offset`: ContactPoint::multiplier.
template <class T, int Tangents>
Traction<T, Tangents> gather_traction(const Vector<T>& field, int offset) {
  Traction<T, Tangents> t;
  t.normal = field[offset];
  for (int a = 0; a < Tangents; ++a) t.tangential[a] = field[offset + 1 + a];
  return t;
}

/// Gap of point p, length, up to which it counts as zero: tie_length() at compact displacements.
template <class T>
double tie_at(const ContactInput<T>& input, int p, const Vector<T>& compact) {
  const auto& point = input.model.points[p];
  const int D = input.model.dimension;
  double largest = 0;
  for (int place : point.places)
    for (int i = 0; i < D; ++i) largest = std::max(largest, std::abs(value(compact[place * D + i])));
  return tie_length(point, input.slots.geometry[p], largest);
}

}  // namespace detail

}  // namespace stickslip
