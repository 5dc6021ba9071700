/// What drives a model in time: external nodal forces and prescribed displacements.
#pragma once

#include "core/algebra/linear_solver.hpp"
#include "core/model/frames.hpp"
#include "core/model/slots.hpp"
#include "core/model/supports.hpp"

namespace stickslip {

/// Adds external nodal forces at time t that do not depend on displacements, times a sign, to all dofs.
template <class T>
void add_dead_forces(const Model& model, const Slots<T>& slots, double t, double sign, Vector<T>& forces) {
  for (std::size_t l = 0; l < slots.loads.size(); ++l) {
    const auto& history = model.scene.loads[l].history;
    const T factor = T(sign) * (history ? evaluate(*history, t, slots.numbers) : T(1));
    const auto& load = slots.loads[l];
    for (std::size_t k = 0; k < load.dofs.size(); ++k) forces[load.dofs[k]] += factor * load.forces[k];
  }
}

/// External nodal forces at time t that do not depend on displacements, all dofs.
template <class T>
Vector<T> dead_forces(const Model& model, const Slots<T>& slots, double t) {
  Vector<T> forces = Vector<T>::Constant(model.dof_count(), T(0));
  add_dead_forces(model, slots, t, 1, forces);
  return forces;
}

/// External nodal forces at time t and displacements of all dofs.
template <class T>
Vector<T> external_forces(const Model& model, const Slots<T>& slots, double t, const Vector<T>& u) {
  if (model.followers.empty()) return dead_forces(model, slots, t);
  return dead_forces(model, slots, t) + follower_forces(model, slots, t, u);
}

/// Forces of elements less the external ones at time t and displacements of all dofs.
template <class T>
Vector<T> less_external_forces(const Model& model, const Slots<T>& slots, double t, const Vector<T>& u,
                               Vector<T> internal) {
  add_dead_forces(model, slots, t, -1, internal);
  if (!model.followers.empty()) internal -= follower_forces(model, slots, t, u);
  return internal;
}

/// The tangent, or its transpose, times a vector, all dofs: of the forces of elements, less those of pressures that
/// follow the bodies. `only`: elements that are visited.
template <class T>
Vector<T> tangent_times(const Model& model, const Slots<T>& slots, const BodyMotion<T>& at, const Vector<T>& vector,
                        Taken taken, const ElementLists* only = nullptr) {
  const int D = model.dimension;
  Vector<T> product = bulk_tangent_times(model, slots, at, vector, only);
  if (!model.followers.empty())
    for_each_follower_tangent(model, slots, at, [&](const std::vector<int>& nodes, const Matrix<T>& K) {
      for (Eigen::Index r = 0; r < K.rows(); ++r)
        for (Eigen::Index c = 0; c < K.cols(); ++c)
          product[nodes[r / D] * D + r % D] -=
              (taken == Taken::transposed ? K(c, r) : K(r, c)) * vector[nodes[c / D] * D + c % D];
    });
  return product;
}

/// Sets the prescribed entries of a displacement vector (all dofs, in the axes) to their values at time t. All else
/// stays, also what a node moves across an inclined direction.
template <class T>
void prescribe(const Model& model, const Slots<T>& slots, double t, Vector<T>& displacement) {
  const int D = model.dimension;
  auto prescribed = [&](const Constraint& constraint) {
    return prescribed_value<T>(model.scene, constraint, slots.points.col(constraint.dof / D), t, slots.numbers);
  };
  std::size_t next = 0;  // framed node
  for (const auto& constraint : model.constraints) {
    while (next < model.framed.size() && model.framed[next].node < constraint.dof / D) ++next;
    const bool framed = next < model.framed.size() && model.framed[next].node == constraint.dof / D;
    if (!framed) displacement[constraint.dof] = prescribed(constraint);
  }
  for (std::size_t f = 0; f < model.framed.size(); ++f) {
    const auto& framed = model.framed[f];
    const Matrix<T>& Q = slots.frames[f];
    Vector<T> u = Q.transpose().lazyProduct(displacement.segment(framed.node * D, D));
    for (int c = 0; c < static_cast<int>(framed.prescribed.size()); ++c) {
      u[c] = prescribed(framed.prescribed[c]);
      if (framed.prescribed[c].support < 0) continue;
      const Vector<T> d = direction(model.scene, framed.prescribed[c], slots.numbers);
      for (int k = 0; k < c; ++k) u[c] -= dot(Q.col(k), d) * u[k];
      u[c] /= dot(Q.col(c), d);
    }
    displacement.segment(framed.node * D, D) = Q.lazyProduct(u).eval();
  }
}

/// The part of nodal forces (all dofs, in the axes) that acts along prescribed displacements: of a balance, the forces
/// of the supports on the bodies.
template <class T>
Vector<T> support_forces(const Model& model, const Slots<T>& slots, const Vector<T>& forces) {
  Vector<T> held = into_frames(model, slots.frames, NodalLayout::all, forces);
  for (int dof : model.free_dofs) held[dof] = T(0);
  return out_of_frames(model, slots.frames, NodalLayout::all, std::move(held));
}

/// Length of a step along a path where the scene gives none: that share of the diagonal of all nodes' box.
template <class T>
double path_length(const Model& model, const Slots<T>& slots) {
  constexpr double tenth = 0.1;
  const ArcLength& arc = *model.scene.arc_length;
  if (arc.length > 0) return arc.length;
  const Points<double> places = slots.points.unaryExpr([](const T& x) { return value(x); });
  const double diagonal = (places.rowwise().maxCoeff() - places.rowwise().minCoeff()).norm();
  return tenth * diagonal / model.scene.legs.front().steps;
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
