/// Present geometry of contact points: against rigid obstacles, along master curves, and over the segments of either.
///
/// Present means: at the displacements that are passed in. An obstacle moves by its own tables and carries along what
/// sticks to it. Templates have two scalars: T of the slots, U built on T of the displacements.
#pragma once

#include "core/contact/curve_search.hpp"
#include "core/model/segment_search.hpp"
#include "core/model/slots.hpp"
#include "core/model/state.hpp"

namespace stickslip {

/// Regularisation of all points, force per length cubed.
template <class T>
using RegularisationField = std::vector<PointRegularisation<T>>;

/// What a contact evaluation reads beside displacement and multiplier.
template <class T>
struct ContactInput {
  const Model& model;
  const Slots<T>& slots;
  const RegularisationField<T>& rho;
  const History<T>& previous;  ///< of the last converged increment
  ConeRadius cone = ConeRadius::augmented;
  double time = 0;
  const std::vector<Facing>* facing = nullptr;  ///< per point, on its curve; nullptr: search for it
};

namespace detail {

/// Foot, D, of the position x on an obstacle, from there.
template <class T, class Position, class Read>
Vector<T> obstacle_foot(const Obstacle& obstacle, const Position& x, const Read& numbers) {
  const auto geometry = against_rigid<T>(x, obstacle.shape, numbers);
  return -geometry.gap * geometry.normal;
}

/// Present geometry of a contact point.
template <class T, int D>
struct MovedPoint {
  PointGeometry<T> geometry;
  /// Foot, as History::foot stores it. On an obstacle: in its frame, from the initial position of the slave node. On a
  /// curve: coordinate on the patch less foot_reference(), and 0; where segment-integrated: mean initial arc length
  /// less origin_of_arcs(), and 0.
  Vec<T, D> foot = Vec<T, D>::Constant(T(0));
  /// Motion of the foot relative to the master since the last increment, length. Slip is its tangential part.
  Vec<T, D> foot_motion = foot;
  bool faces_master = true;  ///< false: the point is open
};

/// Rigid motion of an obstacle: a turn about its centre, then a shift.
template <class T, int D>
struct Frame {
  Vec<T, D> shift = Vec<T, D>::Constant(T(0)), center = Vec<T, D>::Constant(T(0));
  std::optional<Turn<T>> turn;  ///< 2D only; none: the obstacle does not rotate
};
/// The frame of an obstacle at the time of `input`.
template <class T, int D>
Frame<T, D> frame_of_obstacle(const ContactInput<T>& input, const Obstacle& obstacle) {
  Frame<T, D> frame;
  for (const auto& [axis, table] : obstacle.move)
    frame.shift[axis - 'x'] = evaluate(table, input.time, input.slots.numbers);
  if (!obstacle.rotate) return frame;
  for (int i = 0; i < D; ++i) frame.center[i] = input.slots.numbers(obstacle.rotate->center[i]);
  frame.turn = Turn<T>::from_degrees(evaluate(obstacle.rotate->angle, input.time, input.slots.numbers));
  return frame;
}

/// Displacement of a node in a frame, from its initial position. `points`: initial positions, D x nodes; `u`:
/// displacement of the node.
template <class U, class T, int D>
Vec<U, D> frame_displacement(const Frame<T, D>& frame, const Points<T>& points, int node, const Vec<U, D>& u) {
  Vec<U, D> w;
  for (int i = 0; i < D; ++i) w[i] = u[i] - U(frame.shift[i]);
  if constexpr (D == 2)
    if (frame.turn) {
      const auto arm = [&](int i) { return U(points(i, node) - frame.center[i]) + w[i]; };
      w += frame.turn->back().change(Vec<U, 2>(arm(0), arm(1)));
    }
  return w;
}

/// Turns normal, tangents and foot motion from the frame of the obstacle into axes of the plane.
template <class U, class T>
void turn_with(const Frame<T, 2>& frame, MovedPoint<U, 2>& at) {
  if (!frame.turn) return;
  const auto turned = [&](const Vec<U, 2>& v) { return Vec<U, 2>(v + frame.turn->change(v)); };
  const Vec<U, 2> normal = turned(Vec<U, 2>(at.geometry.normal[0], at.geometry.normal[1]));
  at.geometry.normal << normal[0], normal[1];
  at.geometry.tangents = tangent_frame<U>(at.geometry.normal);
  at.foot_motion = turned(at.foot_motion);
}

/// Geometry of point p against its obstacle. `u`: displacement of the slave node.
template <class U, class T, int D>
MovedPoint<U, D> moved_point(const ContactInput<T>& input, int p, const Vec<U, D>& u) {
  const auto& point = input.model.points[p];
  const auto number = [&](const Number& n) { return U(input.slots.numbers(n)); };
  const auto& obstacle = input.model.scene.obstacles[point.obstacle];
  const auto frame = frame_of_obstacle<T, D>(input, obstacle);
  const Vec<U, D> w = frame_displacement<U, T, D>(frame, input.slots.points, point.nodes[0], u);
  Vec<U, D> X;
  for (int i = 0; i < D; ++i) X[i] = U(input.slots.points(i, point.nodes[0]));
  MovedPoint<U, D> at;
  at.geometry = against_rigid<U>(X, w, obstacle.shape, number);
  for (int i = 0; i < D; ++i) {
    at.foot[i] = w[i] - at.geometry.gap * at.geometry.normal[i];
    at.foot_motion[i] = point.foot < 0 ? U(0) : U(at.foot[i] - U(input.previous.foot[point.foot + i]));
  }
  if constexpr (D == 2) turn_with<U, T>(frame, at);
  at.geometry.gap += number(input.model.scene.contacts[point.contact].offset);
  at.geometry.area = U(input.slots.geometry[p].area);
  return at;
}

/// A vertex of a curve as it moves. `displacement(place)`: of the contact node Model::contact_nodes[place].
template <class U, class T, class Displacement>
Placed<U, T> vertex_position(const ContactInput<T>& input, const MasterCurve& curve, int vertex,
                             Displacement&& displacement) {
  if (curve.obstacle >= 0) {
    const auto& obstacle = input.model.scene.obstacles[curve.obstacle];
    const auto frame = frame_of_obstacle<T, 2>(input, obstacle);
    const auto& X = std::get<Polyline>(obstacle.shape).points[vertex];
    const Vec<T, 2> x(input.slots.numbers(X[0]), input.slots.numbers(X[1]));
    Vec<T, 2> u = frame.shift;
    if (frame.turn) u += frame.turn->change(Vec<T, 2>(x - frame.center));
    return {x, {U(u[0]), U(u[1])}};
  }
  return {point2(input.slots.points, curve.nodes[vertex]), displacement(curve.places[vertex])};
}

/// Geometry of point p if it faces nothing of its curve: the gap is the distance, the normal the initial one, and the
/// foot is its placement beside the curve. `position`: as place_beside() reads it, of the slave node too where it is
/// segment-integrated; `x`: of the slave node.
template <class U, class T, class Position>
MovedPoint<U, 2> point_off_curve(const ContactInput<T>& input, int p, const Facing& facing, const Placed<U, T>& x,
                                 Position&& position) {
  const auto& start = input.slots.geometry[p];
  MovedPoint<U, 2> at;
  at.faces_master = false;
  at.geometry = alone<U>(U(facing.distance), start.normal.unaryExpr([](const T& n) { return U(n); }),
                         input.model.points[p].slave_nodes);
  at.geometry.area = U(start.area);
  if (input.model.points[p].foot >= 0 && facing.nearest != Patch::none)
    at.foot[0] = place_beside<U, T>(input.model, input.model.points[p], input.slots, facing.nearest, x, position);
  return at;
}

/// Geometry of a segment-integrated point p. `facing`: what search found on its curve; not read against an obstacle.
template <class U, class T, class Displacement>
MovedPoint<U, 2> moved_on_segments(const ContactInput<T>& input, int p, const Facing* facing,
                                   Displacement&& displacement) {
  const auto& point = input.model.points[p];
  const bool along_curve = point.curve >= 0;
  const auto number = [&](const Number& n) { return U(input.slots.numbers(n)); };
  const auto frame =
      along_curve ? Frame<T, 2>{} : frame_of_obstacle<T, 2>(input, input.model.scene.obstacles[point.obstacle]);
  const auto position = [&](int node) {
    if (const int vertex = node - input.model.node_count; vertex >= 0)
      return vertex_position<U, T>(input, input.model.curves[point.curve], vertex, displacement);
    const Vec<U, 2> u = displacement(input.model.place_of(node));
    return Placed<U, T>{point2(input.slots.points, node),
                        frame_displacement<U, T, 2>(frame, input.slots.points, node, u)};
  };
  if (along_curve && facing->patch == Patch::none)
    return point_off_curve<U, T>(input, p, *facing, position(point.nodes[0]), position);
  const Facing not_read;
  auto kinematics =
      integrated_kinematics<U>(input.model, point, input.slots, along_curve ? *facing : not_read, position, number);
  MovedPoint<U, 2> at;
  at.geometry = std::move(kinematics.geometry);
  at.foot = kinematics.foot;
  const auto previous_foot = [&](int i) { return U(input.previous.foot[point.foot + i]); };
  if (point.foot >= 0 && !along_curve) {
    at.foot_motion = Vec<U, 2>(at.foot[0] - previous_foot(0), at.foot[1] - previous_foot(1));
  } else if (point.foot >= 0 && input.previous.patch[p] != Patch::none) {
    U length = at.foot[0] - previous_foot(0);
    const Vector<T>& arcs = input.slots.arcs[point.curve];
    const T& whole = arcs[arcs.size() - 1];
    const bool loop = input.model.curves[point.curve].patches.back().next == 0;
    const double turns = loop ? std::round(value(length) / value(whole)) : 0;
    if (turns != 0) length -= U(turns) * U(whole);
    for (int i = 0; i < 2; ++i) at.foot_motion[i] = kinematics.tangent[i] * length;
  }
  turn_with<U, T>(frame, at);
  at.geometry.gap += number(input.model.scene.contacts[point.contact].offset);
  return at;
}

/// Geometry of point p against its curve. `facing`: the place on it that search found.
template <class U, class T, class Displacement>
MovedPoint<U, 2> moved_on_curve(const ContactInput<T>& input, int p, const Facing& facing,
                                Displacement&& displacement) {
  const auto& point = input.model.points[p];
  const auto& curve = input.model.curves[point.curve];
  const auto position = [&](int vertex) { return vertex_position<U, T>(input, curve, vertex, displacement); };
  const Placed<U, T> x{point2(input.slots.points, point.nodes[0]), displacement(point.places[0])};
  if (facing.patch == Patch::none) return point_off_curve<U, T>(input, p, facing, x, position);
  MovedPoint<U, 2> at;
  at.geometry.area = U(input.slots.geometry[p].area);
  const Patch& patch = curve.patches[facing.patch];
  const auto foot =
      foot_on_patch<U, T>(patch, foot_reference(input.model, point, facing.patch), facing.xi, x, position);
  at.geometry.gap = foot.gap + U(input.slots.numbers(input.model.scene.contacts[point.contact].offset));
  at.geometry.normal = foot.normal;
  at.geometry.tangents = tangent_frame<U>(at.geometry.normal);
  at.geometry.weights = foot_weights(patch, foot.weights, curve.obstacle >= 0);
  at.foot[0] = foot.shift;
  if (const int last = point.foot >= 0 ? input.previous.patch[p] : Patch::none; last != Patch::none)
    at.foot_motion = foot_motion<U, T>(patch, foot, curve.patches[last], foot_reference(input.model, point, last),
                                       input.previous.foot[point.foot], position);
  return at;
}

/// The patch that point p faced in the last increment, or Patch::none.
template <class T>
int last_faced(const ContactInput<T>& input, int p) {
  return input.previous.faces[p] ? input.previous.patch[p] : Patch::none;
}

/// The function place -> displacement of the contact node, from compact displacements.
template <class T>
auto nodal_displacement(const Vector<T>& compact) {
  return [&compact](int place) -> Vec<T, 2> { return compact.template segment<2>(2 * place); };
}

/// A curve where displacements have moved it, and the search along it. Positions are from the first vertex at the
/// start, so that what lies far from the origin is found as near it. Not to be copied.
template <class T>
struct MovedCurve {
  const ContactInput<T>& input;
  const Vector<T>& compact;  ///< displacements of the contact nodes
  Vec<double, 2> origin;
  Eigen::Matrix2Xd positions;  ///< of the vertices
  CurveSearch search;

  /// All arguments must outlive this.
  MovedCurve(const ContactInput<T>& input, const MasterCurve& curve, const Vector<T>& compact)
      : input(input),
        compact(compact),
        origin(values(vertex_position<T, T>(input, curve, 0, nodal_displacement(compact)).start)),
        positions(positions_of(curve)),
        search(curve.patches, positions) {}
  MovedCurve(const MovedCurve&) = delete;

  Vec<double, 2> position(int node, int place) const {
    return values(input.slots.points.col(node).template head<2>()) - origin +
           values(nodal_displacement(compact)(place));
  }
  /// Outward normal of the slave side at a point, by the lengths of its facets; zero where it has none.
  Vec<double, 2> outward(const ContactPoint& point) const {
    Vec<double, 2> normal = Vec<double, 2>::Zero();
    for (std::size_t f = 0; f < point.facet_places.size(); ++f) {
      const auto& [a, b] = point.area_facets[f];
      const Vec<double, 2> along = position(b, point.facet_places[f].second) - position(a, point.facet_places[f].first);
      normal += Vec<double, 2>(along[1], -along[0]);
    }
    return normal;
  }

 private:
  Eigen::Matrix2Xd positions_of(const MasterCurve& curve) const {
    Eigen::Matrix2Xd at(2, curve.vertex_count);
    for (int v = 0; v < curve.vertex_count; ++v) {
      const auto vertex = vertex_position<T, T>(input, curve, v, nodal_displacement(compact));
      at.col(v) = values(vertex.start) - origin + values(vertex.moved);
    }
    return at;
  }
};

/// What each contact point faces of its curve. `compact`: displacements of the contact nodes; `kept`: per point, the
/// patch on which its foot is to be found, or Patch::none to search the curve; empty: search for all points.
template <class T>
std::vector<Facing> facings(const ContactInput<T>& input, const Vector<T>& compact, const std::vector<int>& kept = {}) {
  const Model& model = input.model;
  std::vector<Facing> found(model.points.size());
  const auto displacement = nodal_displacement(compact);
  for (std::size_t c = 0; c < model.curves.size(); ++c) {
    const auto& curve = model.curves[c];
    if (curve.is_integrated()) {
      Points<double> start = values(input.slots.points);
      if (curve.obstacle >= 0) start.conservativeResize(Eigen::NoChange, model.node_count + curve.vertex_count);
      Points<double> moved = Points<double>::Zero(start.rows(), start.cols());
      for (std::size_t n = 0; n < model.contact_nodes.size(); ++n)
        moved.col(model.contact_nodes[n]).head<2>() = values(displacement(static_cast<int>(n)));
      for (int v = 0; curve.obstacle >= 0 && v < curve.vertex_count; ++v) {
        const auto vertex = vertex_position<T, T>(input, curve, v, displacement);
        start.col(model.node_count + v) = values(vertex.start);
        moved.col(model.node_count + v) = values(vertex.moved);
      }
      std::vector<int> last;
      for (int p = 0; !curve.own.empty() && p < static_cast<int>(found.size()); ++p)
        last.push_back(model.points[p].curve == static_cast<int>(c) ? last_faced(input, p) : Patch::none);
      find_segments(model, static_cast<int>(c), start, moved, last, found);
      continue;
    }
    const MovedCurve<T> now(input, curve, compact);
    for (std::size_t p = 0; p < found.size(); ++p) {
      const auto& point = model.points[p];
      if (point.curve != static_cast<int>(c)) continue;
      const Vec<double, 2> x = now.position(point.nodes[0], point.places[0]);
      if (!kept.empty() && kept[p] != Patch::none)
        found[p] = now.search.foot_on(kept[p], x);
      else if (point.own.vertex == Patch::none)
        found[p] = now.search.facing(x, now.outward(point));
      else
        found[p] = now.search.facing_itself(x, now.outward(point), point.own, last_faced(input, p));
    }
  }
  return found;
}

/// Places the vertices of curves in contact with themselves that face nothing beside their nearest patches, from which
/// they slide if they come onto one. An equilibrium needs it, and no iterate on the way: the search looks far.
template <class T>
void place_open_vertices(const ContactInput<T>& input, const Vector<T>& compact, ContactField<T>& field) {
  const auto displacement = nodal_displacement(compact);
  std::optional<MovedCurve<T>> now;
  for (int p = 0, of = -1; p < static_cast<int>(field.facing.size()); ++p) {
    const auto& point = input.model.points[p];
    auto& facing = field.facing[p];
    if (point.own.vertex == Patch::none || point.foot < 0 || facing.patch != Patch::none) continue;
    const auto& curve = input.model.curves[point.curve];
    if (of != point.curve) now.emplace(input, curve, compact);
    of = point.curve;
    facing.nearest = now->search.nearest_of_itself(now->position(point.nodes[0], point.places[0]), now->outward(point),
                                                   point.own, last_faced(input, p));
    const Placed<T, T> x{point2(input.slots.points, point.nodes[0]), displacement(point.places[0])};
    const auto position = [&](int vertex) { return vertex_position<T, T>(input, curve, vertex, displacement); };
    field.foot[point.foot] = point_off_curve<T, T>(input, p, facing, x, position).foot[0];
  }
}

}  // namespace detail

}  // namespace stickslip
