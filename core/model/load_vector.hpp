/// Nodal forces of a load: consistent shares of what acts on facets and in elements, in any scalar.
#pragma once

#include "core/model/slots.hpp"

namespace stickslip {

namespace detail {

inline bool is_of(const SideSet& side, int node) {
  return std::find(side.nodes.begin(), side.nodes.end(), node) != side.nodes.end();
}

/// Consistent shares of each edge for its nodes, as far as they belong to the side: force per area, or along the inward
/// normal where it is a pressure (solid on the left of an edge).
template <class T>
void add_surface_load(const Load& load, const SideSet& side, const Slots<T>& slots, int D, Vector<T>& forces) {
  for (const auto& edge : side.edges)
    for_each_edge_point(slots.points, edge, slots.depths[side.body],
                        [&](const auto& values, const auto& tau, const T& area) {
                          Vector<T> force(D);
                          if (load.kind == Load::Kind::pressure) {
                            force << -tau[1], tau[0];
                            force *= slots.numbers(load.vector[0]);
                          } else {
                            for (int i = 0; i < D; ++i) force[i] = area * slots.numbers(load.vector[i]);
                          }
                          for (std::size_t a = 0; a < edge.size(); ++a)
                            for (int i = 0; i < D && is_of(side, edge[a]); ++i)
                              forces[edge[a] * D + i] += T(values[a]) * force[i];
                        });
}

/// A total force, shared by tributary area; in equal shares among single nodes. A traction takes their area as 1.
template <class T>
void add_total_force(const Load& load, const SideSet& side, const Slots<T>& slots, int D, Vector<T>& forces) {
  std::vector<std::pair<int, T>> share;
  T total{};
  for (const auto& edge : side.edges) {
    const auto shares = edge_shares(slots.points, edge, slots.depths[side.body]);
    for (std::size_t a = 0; a < edge.size(); ++a)
      if (is_of(side, edge[a])) {
        share.emplace_back(edge[a], shares[a]);
        total += shares[a];
      }
  }
  if (side.edges.empty()) {
    for (int node : side.nodes) share.emplace_back(node, T(1));
    total = T(load.kind == Load::Kind::force ? static_cast<double>(side.nodes.size()) : 1.0);
  }
  for (const auto& [node, area] : share)
    for (int i = 0; i < D; ++i) forces[node * D + i] += T(area / total) * slots.numbers(load.vector[i]);
}

/// int N_a b dV of a continuum, and half of each bar's volume at either end.
template <class T>
void add_body_force(const Model& model, const Load& load, const Slots<T>& slots, Vector<T>& forces) {
  const int D = model.dimension;
  int b = 0;
  while (model.scene.bodies[b].name != load.on) ++b;
  const auto& body = model.bodies[b];
  auto add = [&](int node, const T& volume) {
    for (int i = 0; i < D; ++i) forces[node * D + i] += volume * slots.numbers(load.vector[i]);
  };
  for (int e = 0; e < body.mesh.element_count(); ++e) {
    const auto nodes = element_nodes(body, e);
    if (body.mesh.shape == ElementShape::bar2) {
      const T length = norm((slots.points.col(nodes[1]) - slots.points.col(nodes[0])).eval());
      const T half = T(0.5) * length * area_of(slots.laws[b]);
      for (int node : nodes) add(node, half);
    }
    with_shape(body.mesh.shape, [&]<class Shape>(Shape) {
      const auto X = gather_coordinates<T, Shape>(slots.points, nodes.data());
      const auto add_shares = [&]<Kinematics kinematics>() {
        for (const auto& point : quadrature_of<Shape, kinematics>()) {
          const T volume = Gradient<T, Shape, kinematics>(point, X, slots.depths[b].thickness).volume;
          for (int a = 0; a < Shape::nodes; ++a) add(nodes[a], T(point.value[a]) * volume);
        }
      };
      if (slots.depths[b].of_revolution)
        add_shares.template operator()<Kinematics::revolution>();
      else
        add_shares.template operator()<Kinematics::plane>();
    });
  }
}

}  // namespace detail

template <class T>
Vector<T> load_vector(const Model& model, const Load& load, const Slots<T>& slots) {
  Vector<T> forces = Vector<T>::Constant(model.dof_count(), T(0));
  if (load.kind == Load::Kind::body_force) {
    detail::add_body_force(model, load, slots, forces);
    return forces;
  }
  const SideSet side = model.side(load.on);
  if (load.kind == Load::Kind::force || side.edges.empty())
    detail::add_total_force(load, side, slots, model.dimension, forces);
  else
    detail::add_surface_load(load, side, slots, model.dimension, forces);
  return forces;
}

}  // namespace stickslip
