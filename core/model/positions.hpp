/// Where the nodes of bodies, the vertices of obstacles and the obstacles are: at the start, or displaced.
#pragma once

#include <optional>

#include "core/contact/placed.hpp"
#include "core/model/slots.hpp"
#include "core/model/supports.hpp"

namespace stickslip::detail {

/// Initial position of a vertex of an obstacle that has facets.
template <int D, class T>
Vec<T, D> start_of_vertex(const Slots<T>& slots, int obstacle, int vertex) {
  return slots.vertices[obstacle].template block<D, 1>(0, vertex);
}

/// Initial position of a node, or of a vertex of the obstacle, if that has facets (core/contact/segment.hpp).
template <int D, class T>
Vec<T, D> start_of(const Model& model, int obstacle, const Slots<T>& slots, int node) {
  if (node < model.node_count) return slots.points.template block<D, 1>(0, node);
  return start_of_vertex<D>(slots, obstacle, node - model.node_count);
}

/// Rigid motion of an obstacle: a turn about its centre, then a shift.
template <class T, int D>
struct Frame {
  Vec<T, D> shift = Vec<T, D>::Constant(T(0)), center = Vec<T, D>::Constant(T(0));
  std::optional<Turn<T>> turn = {};  ///< none: the obstacle does not rotate

  /// Displacement seen from the obstacle. `X`: initial position; `u`: displacement, in a scalar built on T.
  template <class U>
  Vec<U, D> seen(const Vec<T, D>& X, const Vec<U, D>& u) const {
    Vec<U, D> w;
    for (int i = 0; i < D; ++i) w[i] = u[i] - U(shift[i]);
    if (!turn) return w;
    Vec<U, D> arm;
    for (int i = 0; i < D; ++i) arm[i] = U(X[i] - center[i]) + w[i];
    return w + turn->back().change(arm);
  }
  /// Displacement of the place X of the obstacle.
  Vec<T, D> displacement(const Vec<T, D>& X) const {
    Vec<T, D> u = shift;
    if (turn) u += turn->change(Vec<T, D>(X - center));
    return u;
  }
};

/// The frame of an obstacle at a time.
template <int D, class T>
Frame<T, D> frame_of_obstacle(const Obstacle& obstacle, double time, const Numbers<T>& numbers) {
  Frame<T, D> frame;
  for (const auto& [axis, table] : obstacle.move) frame.shift[axis - 'x'] = evaluate(table, time, numbers);
  if (!obstacle.rotate) return frame;
  for (int i = 0; i < D; ++i) frame.center[i] = numbers(obstacle.rotate->center[i]);
  frame.turn = Turn<T>::about(*obstacle.rotate, evaluate(obstacle.rotate->angle, time, numbers), numbers);
  return frame;
}

/// In place of displacements: those of the start, which are zero.
struct Still {};

/// Positions at displacements. Scalars: T of the slots, U built on T of the displacements.
///
///   Displacement  place -> displacement of the contact node Model::contact_nodes[place], as a Vec<U, D>; Still: all is
///                 at the start, and so are the obstacles, whatever their tables are
template <class U, class T, class Displacement>
struct Positions {
  static constexpr bool is_start = std::is_same_v<Displacement, Still>;
  const Model& model;
  const Slots<T>& slots;
  Displacement displacement;
  double time = 0;  ///< not read at the start

  /// The frame of an obstacle.
  template <int D>
  Frame<T, D> frame(int obstacle) const {
    if constexpr (is_start) return {};
    return frame_of_obstacle<D>(model.scene.obstacles[obstacle], time, slots.numbers);
  }
  /// Displacement of the slave node of a point.
  template <int D>
  Vec<U, D> motion_of_slave(const ContactPoint& point) const {
    if constexpr (is_start)
      return Vec<U, D>::Constant(U(0));
    else
      return displacement(point.places[0]);
  }
  template <int D = 2>
  Placed<U, T, D> slave(const ContactPoint& point) const {
    return {slots.points.template block<D, 1>(0, point.nodes[0]), motion_of_slave<D>(point)};
  }
  /// A vertex of an obstacle that has facets.
  template <int D = 2>
  Placed<U, T, D> vertex_of_obstacle(int obstacle, int number) const {
    const Vec<T, D> X = start_of_vertex<D>(slots, obstacle, number), u = frame<D>(obstacle).displacement(X);
    return {X, u.template cast<U>()};
  }
  /// A vertex of a surface.
  template <int D = 2>
  Placed<U, T, D> vertex(const MasterSurface& surface, int number) const {
    if (surface.is_rigid()) return vertex_of_obstacle<D>(surface.obstacle, number);
    const Vec<T, D> X = slots.points.template block<D, 1>(0, surface.nodes[number]);
    if constexpr (is_start)
      return {X, Vec<U, D>::Constant(U(0))};
    else
      return {X, displacement(surface.places[number])};
  }
  /// A node of a body, or a vertex of the obstacle, numbered behind them.
  Placed<U, T> node(int obstacle, int number) const {
    if (number >= model.node_count) return vertex_of_obstacle(obstacle, number - model.node_count);
    const Vec<T, 2> X = point2(slots.points, number);
    if constexpr (is_start)
      return {X, Vec<U, 2>::Constant(U(0))};
    else
      return {X, displacement(model.place_of(number))};
  }
};

/// Positions of the start.
template <class T>
Positions<T, T, Still> positions_of_start(const Model& model, const Slots<T>& slots) {
  return {model, slots, {}};
}

/// The function place -> displacement of the contact node, from compact displacements.
template <int D = 2, class T>
auto nodal_displacement(const Vector<T>& compact) {
  return [&compact](int place) -> Vec<T, D> { return compact.template segment<D>(D * place); };
}

/// Positions at compact displacements, which must outlive them.
template <int D = 2, class T>
auto positions_at(const Model& model, const Slots<T>& slots, const Vector<T>& compact, double time) {
  const auto displacement = nodal_displacement<D>(compact);
  return Positions<T, T, decltype(displacement)>{model, slots, displacement, time};
}

}  // namespace stickslip::detail
