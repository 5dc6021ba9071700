/// Definitions of the templates in slots.hpp that visit the elements of bodies, by their tables.
#pragma once

#include "core/model/element_kernels.hpp"

namespace stickslip {

template <class T>
Vector<T> bulk_forces(const Model& model, const Slots<T>& slots, const Vector<T>& u, const Vector<T>& memory,
                      const ElementLists* only) {
  Vector<T> forces = Vector<T>::Constant(model.dof_count(), T(0));
  for (int b = 0; b < static_cast<int>(model.bodies.size()); ++b)
    kernels_of<T>(model, b).forces({model, slots, b, only ? &(*only)[b] : nullptr}, u, memory, forces);
  return forces;
}

template <class T>
Vector<T> bulk_flow(const Model& model, const Slots<T>& slots, const Vector<T>& u, const Vector<T>& before,
                    const FlowBranches& branches) {
  Vector<T> after = before;
  for (int b = 0; b < static_cast<int>(model.bodies.size()); ++b)
    if (model.bodies[b].memory > 0) kernels_of<T>(model, b).flow({model, slots, b}, u, before, branches, after);
  return after;
}

template <class T>
void for_each_plastic_strain(const Model& model, const Slots<T>& slots, int b, const Vector<T>& memory,
                             const std::type_identity_t<PlasticStrainSink<T>>& sink) {
  if (model.bodies[b].memory > 0) kernels_of<T>(model, b).plastic_strains({model, slots, b}, memory, sink);
}

template <class T>
std::vector<ThicknessStretch<T>> edge_stretches(const Model& model, const Slots<T>& slots, int b,
                                                const ElementEdge& edge, const Vector<T>& u) {
  std::vector<ThicknessStretch<T>> stretches;
  kernels_of<T>(model, b).edge_stretches({model, slots, b}, edge, u, stretches);
  return stretches;
}

template <class T>
void for_each_element_tangent(const Model& model, const Slots<T>& slots, int b, const std::vector<int>* only,
                              const std::type_identity_t<ElementSink<T>>& sink, const BodyMotion<T>* at) {
  kernels_of<T>(model, b).tangents({model, slots, b, only}, at, sink);
}

template <class T>
Vector<T> bulk_tangent_times(const Model& model, const Slots<T>& slots, const BodyMotion<T>& at,
                             const Vector<T>& vector, const ElementLists* only) {
  if (model.effects.linear_bulk) return bulk_forces(model, slots, vector, {}, only);
  const int D = model.dimension;
  Vector<T> product = Vector<T>::Constant(model.dof_count(), T(0));
  const auto add = [&](const auto& nodes, const auto& K) {
    for (Eigen::Index r = 0; r < K.rows(); ++r)
      for (Eigen::Index c = 0; c < K.cols(); ++c)
        product[nodes[r / D] * D + r % D] += K(r, c) * vector[nodes[c / D] * D + c % D];
  };
  for (int b = 0; b < static_cast<int>(model.bodies.size()); ++b)
    for_each_element_tangent(model, slots, b, only ? &(*only)[b] : nullptr, std::ref(add), &at);
  return product;
}

template <class T>
T bulk_energy(const Model& model, const Slots<T>& slots, const Vector<T>& u, const Vector<T>& memory) {
  T energy{};
  for (int b = 0; b < static_cast<int>(model.bodies.size()); ++b)
    kernels_of<T>(model, b).energy({model, slots, b}, u, memory, energy);
  return energy;
}

}  // namespace stickslip
