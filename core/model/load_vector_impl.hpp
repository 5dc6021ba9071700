/// Definitions of the templates in slots.hpp for loads: consistent shares of what acts on facets and in elements, in
/// any scalar; and those of pressures that follow a side, by its displacements.
#pragma once

#include "core/algebra/reverse.hpp"
#include "core/model/element_nodes.hpp"
#include "core/model/slots.hpp"

namespace stickslip {

namespace detail {

inline bool is_of(const SideSet& side, int node) {
  return std::find(side.nodes.begin(), side.nodes.end(), node) != side.nodes.end();
}

/// Consistent shares of each side of an element for its nodes, as far as they belong to the side: force per area, or
/// against the outward normal where it is a pressure.
template <class T>
void add_surface_load(const Load& load, const SideSet& side, const Slots<T>& slots, int D, Vector<T>& forces) {
  for (const auto& edge : side.edges)
    for_each_side_point(slots.points, edge, slots.depths[side.body],
                        [&](const auto& values, const auto& outward, const T& area) {
                          Vector<T> force(D);
                          if (load.kind == Load::Kind::pressure) {
                            for (int i = 0; i < D; ++i) force[i] = -outward[i] * slots.numbers(load.vector[0]);
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
    const auto shares = side_shares(slots.points, edge, slots.depths[side.body]);
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

/// int N_a b dV of body b if it is a continuum, and half of each bar's volume at either end.
template <class T>
void add_body_force(const Model& model, const Load& load, int b, const Slots<T>& slots, Vector<T>& forces) {
  const int D = model.dimension;
  const auto& body = model.bodies[b];
  auto add = [&](int node, const T& volume) {
    for (int i = 0; i < D; ++i) forces[node * D + i] += volume * slots.numbers(load.vector[i]);
  };
  for (int e = 0; e < body.mesh.element_count(); ++e) {
    const auto nodes = element_nodes(body, e);
    if (body.mesh.shape == ElementShape::bar2) {
      const T length = norm((slots.points.col(nodes[1]) - slots.points.col(nodes[0])).eval());
      const T half = T(0.5) * length * bar_area(slots, b);
      for (int node : nodes) add(node, half);
    }
    with_shape(body.mesh.shape, [&]<class Shape>(Shape) {
      const auto X = gather_coordinates<T, Shape>(slots.points, nodes.data());
      const auto add_shares = [&]<Kinematics kinematics>() {
        const auto points = quadrature_of<Shape, kinematics>();
        std::array<T, points_of<Shape>(kinematics)> volumes;
        const TapeMark<T> mark(X);
        for (std::size_t q = 0; q < points.size(); ++q)
          volumes[q] = Gradient<T, Shape, kinematics>(points[q], X, slots.depths[b].thickness).volume;
        mark.fold(volumes);
        for (std::size_t q = 0; q < points.size(); ++q)
          for (int a = 0; a < Shape::nodes; ++a) add(nodes[a], T(points[q].value[a]) * volumes[q]);
      };
      if constexpr (Shape::dimension == 2)
        if (slots.depths[b].of_revolution) return add_shares.template operator()<Kinematics::revolution>();
      add_shares.template operator()<plain_kinematics<Shape>>();
    });
  }
}

/// Forces of a pressure on a side of an element at its nodes' places, dimension x nodes. `loaded`: nodes that it acts
/// on. `pressure_at`: by point of the side's quadrature.
template <class T, class Pressure>
Points<T> pressure_on(const Points<T>& places, const std::vector<char>& loaded, const Depth<T>& depth,
                      Pressure&& pressure_at) {
  std::vector<int> edge(loaded.size());
  for (std::size_t a = 0; a < edge.size(); ++a) edge[a] = static_cast<int>(a);
  Points<T> forces = Points<T>::Constant(places.rows(), places.cols(), T(0));
  int point = 0;
  for_each_side_point(places, edge, depth, [&](const auto& values, const auto& outward, const T&) {
    const T pressure = pressure_at(point++);
    for (std::size_t a = 0; a < edge.size(); ++a)
      for (int i = 0; loaded[a] && i < places.rows(); ++i) forces(i, a) += T(values[a]) * (-outward[i] * pressure);
  });
  return forces;
}

/// A side of an element that a pressure follows. It acts on the present area, in the plane the present length times the
/// thickness of the start; in plane stress the stretch of the thickness multiplies it, point by point.
template <class T>
struct FollowedEdge {
  const std::vector<int>& nodes;
  std::vector<char> loaded;
  int body;
  T pressure;
  const ElementEdge* backing;                     ///< nullptr: its thickness stays
  std::vector<ThicknessStretch<T>> stretch = {};  ///< by point; empty where it stays

  T pressure_at(int point) const { return stretch.empty() ? pressure : T(pressure * stretch[point].value); }
};

/// Calls f(edge) for each edge that a pressure follows at a time, at displacements of all dofs.
template <class T, class F>
void for_each_followed_edge(const Model& model, const Slots<T>& slots, double t, const Vector<T>& u, F&& f) {
  for (const auto& follower : model.followers) {
    const Load& load = model.scene.loads[follower.load];
    const T factor = load.history ? evaluate(*load.history, t, slots.numbers) : T(1);
    const T pressure = factor * slots.numbers(load.vector[0]);
    const SideSet& side = model.load_sides[follower.load];
    for (std::size_t k = 0; k < side.edges.size(); ++k) {
      const ElementEdge* const behind = follower.backing.empty() ? nullptr : &follower.backing[k];
      FollowedEdge<T> edge{side.edges[k], {}, side.body, pressure, behind};
      for (int node : edge.nodes) edge.loaded.push_back(is_of(side, node));
      if (behind) edge.stretch = edge_stretches(model, slots, edge.body, *behind, u);
      f(edge);
    }
  }
}

/// Present places of the nodes of an edge of body b, in a scalar that is made of theirs: from the initial place of the
/// first, so that they keep the digits of the displacements; of revolution, radii from the axis.
template <class U, class T, class Make>
Points<U> present_places(const Slots<T>& slots, int b, const std::vector<int>& nodes, const Vector<T>& u, Make&& make) {
  const auto D = static_cast<int>(slots.points.rows());
  Points<U> places(D, nodes.size());
  for (std::size_t a = 0; a < nodes.size(); ++a)
    for (int i = 0; i < D; ++i) {
      const T& X = slots.points(i, nodes[a]);
      const bool is_radius = i == 0 && slots.depths[b].of_revolution;
      places(i, a) = make((is_radius ? X : T(X - slots.points(i, nodes[0]))) + u[nodes[a] * D + i], D * a + i);
    }
  return places;
}

/// What a stretch of the thickness adds to the derivatives of an edge's forces: by displacements of the element behind.
template <class T>
void add_thickness_tangent(const Model& model, const Slots<T>& slots, const FollowedEdge<T>& edge, const Points<T>& at,
                           const ElementSink<T>& sink) {
  const auto& body = model.bodies[edge.body];
  const auto nodes = element_nodes(body, edge.backing->element);
  Matrix<T> K = Matrix<T>::Constant(2 * nodes.size(), 2 * nodes.size(), T(0));
  for (int q = 0; q < static_cast<int>(edge.stretch.size()); ++q) {
    const auto force = pressure_on(at, edge.loaded, slots.depths[edge.body],
                                   [&](int point) { return point == q ? edge.pressure : T(0); });
    for (std::size_t a = 0; a < edge.nodes.size(); ++a) {
      const auto local = std::find(nodes.begin(), nodes.end(), edge.nodes[a]) - nodes.begin();
      for (int i = 0; i < 2; ++i) K.row(2 * local + i) += force(i, a) * edge.stretch[q].by_motion.transpose();
    }
  }
  sink(nodes, K);
}

}  // namespace detail

template <class T>
Vector<T> follower_forces(const Model& model, const Slots<T>& slots, double t, const Vector<T>& u) {
  Vector<T> forces = Vector<T>::Constant(model.dof_count(), T(0));
  detail::for_each_followed_edge(model, slots, t, u, [&](const detail::FollowedEdge<T>& edge) {
    const auto places =
        detail::present_places<T>(slots, edge.body, edge.nodes, u, [](const T& x, std::size_t) { return x; });
    const Points<T> force = detail::pressure_on(places, edge.loaded, slots.depths[edge.body],
                                                [&](int point) { return edge.pressure_at(point); });
    for (std::size_t a = 0; a < edge.nodes.size(); ++a)
      for (int i = 0; i < model.dimension; ++i) forces[edge.nodes[a] * model.dimension + i] += force(i, a);
  });
  return forces;
}

namespace detail {

/// Hands out the derivatives of the forces on a side by its displacements. `dofs`: at least as many as it has.
template <int D, int dofs, class T>
void follow_tangent(const Model& model, const Slots<T>& slots, const BodyMotion<T>& at, const FollowedEdge<T>& edge,
                    const ElementSink<T>& sink) {
  using Probe = Dual<dofs, T>;
  const int n = static_cast<int>(edge.nodes.size());
  const auto places =
      present_places<Probe>(slots, edge.body, edge.nodes, at.displacement,
                            [](const T& x, std::size_t k) { return Probe::seed(x, static_cast<int>(k)); });
  const auto& depth = slots.depths[edge.body];
  const auto force = pressure_on<Probe>(places, edge.loaded, {depth.of_revolution, Probe(depth.thickness)},
                                        [&](int point) { return Probe(edge.pressure_at(point)); });
  Matrix<T> K(D * n, D * n);
  for (int r = 0; r < D * n; ++r)
    for (int c = 0; c < D * n; ++c) K(r, c) = force(r % D, r / D).d[c];
  sink(edge.nodes, K);
  if (!edge.stretch.empty()) {
    const Points<T> now = places.unaryExpr([](const Probe& x) { return x.v; });
    add_thickness_tangent(model, slots, edge, now, sink);
  }
}

template <int D, class T>
void visit_follower_tangents(const Model& model, const Slots<T>& slots, const BodyMotion<T>& at,
                             const ElementSink<T>& sink) {
  for_each_followed_edge(model, slots, at.time, at.displacement, [&](const FollowedEdge<T>& edge) {
    if constexpr (D == 2)
      follow_tangent<D, 6>(model, slots, at, edge, sink);
    else if (edge.nodes.size() <= 4)
      follow_tangent<D, 12>(model, slots, at, edge, sink);
    else
      follow_tangent<D, 27>(model, slots, at, edge, sink);
  });
}

}  // namespace detail

template <class T>
void for_each_follower_tangent(const Model& model, const Slots<T>& slots, const BodyMotion<T>& at,
                               const std::type_identity_t<ElementSink<T>>& sink) {
  with_dimension(model.dimension, [&]<int D>() { detail::visit_follower_tangents<D>(model, slots, at, sink); });
}

template <class T>
Vector<T> load_vector(const Model& model, int index, const Slots<T>& slots) {
  const Load& load = model.scene.loads[index];
  const SideSet& side = model.load_sides[index];
  Vector<T> forces = Vector<T>::Constant(model.dof_count(), T(0));
  if (load.kind == Load::Kind::pressure && !model.followers.empty()) return forces;  // (follower_forces)
  if (load.kind == Load::Kind::body_force) {
    detail::add_body_force(model, load, side.body, slots, forces);
    return forces;
  }
  if (load.kind == Load::Kind::force || side.edges.empty())
    detail::add_total_force(load, side, slots, model.dimension, forces);
  else
    detail::add_surface_load(load, side, slots, model.dimension, forces);
  return forces;
}

}  // namespace stickslip
