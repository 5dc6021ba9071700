/// Contact points where they are now: against rigid obstacles, which carry what touches them along, along curves, and
/// integrated over the pieces of either that they face.
#pragma once

#include "core/contact/curve_search.hpp"
#include "core/model/faced_pieces.hpp"
#include "core/model/slots.hpp"
#include "core/model/state.hpp"

namespace stickslip {

/// Regularisation of all points, force per length cubed.
template <class T>
using RegularisationField = std::vector<PointRegularisation<T>>;

/// Everything a contact evaluation reads beside displacement and multiplier.
template <class T>
struct ContactInput {
  const Model& model;
  const Slots<T>& slots;
  const RegularisationField<T>& rho;
  const History<T>& previous;  ///< of the last increment
  ConeRadius cone = ConeRadius::augmented;
  double time = 0;
  const std::vector<Facing>* facing = nullptr;  ///< what points face of their curves; nullptr: it is searched for
};

namespace detail {

/// The place on an obstacle that a place in its frame faces.
template <class T, class Place, class Read>
Vector<T> foot_on(const Obstacle& obstacle, const Place& x, const Read& numbers) {
  const auto geometry = against_rigid<T>(x, obstacle.shape, numbers);
  Vector<T> foot(x.size());
  for (Eigen::Index i = 0; i < foot.size(); ++i) foot[i] = x[i] - geometry.gap * geometry.normal[i];
  return foot;
}

/// A point where it is now: its geometry, its foot (in the frame of the obstacle; on a curve: xi, 0, or integrated over
/// it: a length along it, 0), and the way of the foot since the last increment, less what carries it along.
template <class T, int D>
struct MovedPoint {
  PointGeometry<T> geometry;
  Vec<T, D> foot = Vec<T, D>::Constant(T(0)), way = foot;
  bool faces = true;  ///< something
};

/// Where the frame of a point's obstacle is: turned about its centre, then shifted.
template <class T, int D>
struct Frame {
  Vec<T, D> shift = Vec<T, D>::Constant(T(0)), center = Vec<T, D>::Constant(T(0));
  std::optional<Turn<T>> turn;  ///< in the plane
};
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

/// Where a node is in a frame. `u`: its displacement, in the scalar U built on T.
template <class U, class T, int D>
Vec<U, D> place_in(const Frame<T, D>& frame, const Points<T>& points, int node, const Vec<U, D>& u) {
  Vec<U, D> x;
  for (int i = 0; i < D; ++i) x[i] = U(points(i, node) - frame.shift[i]) + u[i];
  if constexpr (D == 2)
    if (frame.turn) x += frame.turn->back().change(Vec<U, 2>(x[0] - U(frame.center[0]), x[1] - U(frame.center[1])));
  return x;
}

/// Turns what is of a frame with it.
template <class U, class T>
void turn_with(const Frame<T, 2>& frame, MovedPoint<U, 2>& at) {
  if (!frame.turn) return;
  const auto turned = [&](const Vec<U, 2>& v) { return Vec<U, 2>(v + frame.turn->change(v)); };
  const Vec<U, 2> normal = turned(Vec<U, 2>(at.geometry.normal[0], at.geometry.normal[1]));
  at.geometry.normal << normal[0], normal[1];
  at.geometry.tangents = tangent_frame<U>(at.geometry.normal);
  at.way = turned(at.way);
}

/// Against an obstacle. `u`: displacement of the slave node, in the scalar U built on T.
template <class U, class T, int D>
MovedPoint<U, D> moved_point(const ContactInput<T>& input, int p, const Vec<U, D>& u) {
  const auto& point = input.model.points[p];
  const auto number = [&](const Number& n) { return U(input.slots.numbers(n)); };
  const auto& obstacle = input.model.scene.obstacles[point.obstacle];
  const auto frame = frame_of_obstacle<T, D>(input, obstacle);
  const Vec<U, D> x = place_in<U, T, D>(frame, input.slots.points, point.nodes[0], u);
  MovedPoint<U, D> at;
  at.geometry = against_rigid<U>(x, obstacle.shape, number);
  for (int i = 0; i < D; ++i) {
    at.foot[i] = x[i] - at.geometry.gap * at.geometry.normal[i];
    at.way[i] = point.foot < 0 ? U(0) : U(at.foot[i] - U(input.previous.foot[point.foot + i]));
  }
  if constexpr (D == 2) turn_with<U, T>(frame, at);
  at.geometry.gap += number(input.model.scene.contacts[point.contact].offset);
  at.geometry.area = U(input.slots.geometry[p].area);
  return at;
}

/// Where a vertex of a curve is now. `moved(place)`: displacement of a contact node, in the scalar U built on T.
template <class U, class T, class Moved>
Vec<U, 2> vertex_of(const ContactInput<T>& input, const MasterCurve& curve, int vertex, Moved&& moved) {
  if (curve.obstacle >= 0) {
    const auto& obstacle = input.model.scene.obstacles[curve.obstacle];
    const auto frame = frame_of_obstacle<T, 2>(input, obstacle);
    const auto& X = std::get<Polyline>(obstacle.shape).points[vertex];
    Vec<T, 2> x(input.slots.numbers(X[0]), input.slots.numbers(X[1]));
    if (frame.turn) x += frame.turn->change(Vec<T, 2>(x - frame.center));
    return {U(x[0] + frame.shift[0]), U(x[1] + frame.shift[1])};
  }
  const int node = curve.nodes[vertex];
  const Vec<U, 2> u = moved(curve.places[vertex]);
  return {U(input.slots.points(0, node)) + u[0], U(input.slots.points(1, node)) + u[1]};
}

/// A point that faces nothing of its curve.
template <class U, class T>
MovedPoint<U, 2> beside_curve(const ContactInput<T>& input, int p, const Facing& facing) {
  const auto& start = input.slots.geometry[p];
  MovedPoint<U, 2> at;
  at.faces = false;
  at.geometry = alone<U>(U(facing.distance), start.normal.unaryExpr([](const T& n) { return U(n); }),
                         input.model.points[p].slave_nodes);
  at.geometry.area = U(start.area);
  return at;
}

/// Segment-integrated. `facing`: as search found it; unread against an obstacle.
template <class U, class T, class Moved>
MovedPoint<U, 2> moved_on_pieces(const ContactInput<T>& input, int p, const Facing* facing, Moved&& moved) {
  const auto& point = input.model.points[p];
  const bool along_curve = point.curve >= 0;
  if (along_curve && facing->patch == Patch::none) return beside_curve<U, T>(input, p, *facing);
  const auto number = [&](const Number& n) { return U(input.slots.numbers(n)); };
  const auto frame =
      along_curve ? Frame<T, 2>{} : frame_of_obstacle<T, 2>(input, input.model.scene.obstacles[point.obstacle]);
  const auto place = [&](int node) {
    return place_in<U, T, 2>(frame, input.slots.points, node, moved(input.model.place_of(node)));
  };
  const Facing unread;
  auto faced = faced_pieces<U>(input.model, point, input.slots, along_curve ? *facing : unread, place, number);
  MovedPoint<U, 2> at;
  at.geometry = std::move(faced.geometry);
  at.foot = faced.foot;
  const auto before = [&](int i) { return U(input.previous.foot[point.foot + i]); };
  if (point.foot >= 0 && !along_curve) {
    at.way = Vec<U, 2>(at.foot[0] - before(0), at.foot[1] - before(1));
  } else if (const int last = point.foot >= 0 ? input.previous.patch[p] : Patch::none; last != Patch::none) {
    const auto& curve = input.model.curves[point.curve];
    const U slid = at.foot[0] + U(length_between(curve, input.slots.points, last, facing->patch)) - before(0);
    for (int i = 0; i < 2; ++i) at.way[i] = faced.tangent[i] * slid;
  }
  turn_with<U, T>(frame, at);
  at.geometry.gap += number(input.model.scene.contacts[point.contact].offset);
  return at;
}

/// Against a curve, at a place of it that search found.
template <class U, class T, class Moved>
MovedPoint<U, 2> moved_on_curve(const ContactInput<T>& input, int p, const Facing& facing, Moved&& moved) {
  const auto& point = input.model.points[p];
  const auto& curve = input.model.curves[point.curve];
  if (facing.patch == Patch::none) return beside_curve<U, T>(input, p, facing);
  const auto place = [&](int vertex) { return vertex_of<U, T>(input, curve, vertex, moved); };
  MovedPoint<U, 2> at;
  at.geometry.area = U(input.slots.geometry[p].area);
  Vec<U, 2> x = moved(point.places[0]);
  for (int i = 0; i < 2; ++i) x[i] += U(input.slots.points(i, point.nodes[0]));
  const Patch& patch = curve.patches[facing.patch];
  const auto foot = foot_on_patch<U>(patch, facing.xi, x, place);
  at.geometry.gap = foot.gap + U(input.slots.numbers(input.model.scene.contacts[point.contact].offset));
  at.geometry.normal = foot.normal;
  at.geometry.tangents = tangent_frame<U>(at.geometry.normal);
  at.geometry.weights = foot_weights(patch, foot.weights, curve.obstacle >= 0);
  at.foot[0] = foot.xi;
  if (point.foot >= 0 && input.previous.patch[p] != Patch::none)
    at.way =
        foot.place - place_on<U>(curve.patches[input.previous.patch[p]], U(input.previous.foot[point.foot]), place);
  return at;
}

/// Compact displacement of a contact node.
template <class T>
auto displacement_in(const Vector<T>& compact) {
  return [&compact](int place) -> Vec<T, 2> { return compact.template segment<2>(2 * place); };
}

/// What the points face of their curves. `compact`: displacements of the contact nodes; `kept`: patches that points
/// stay on, per point; empty, or Patch::none: they are free.
template <class T>
std::vector<Facing> facings(const ContactInput<T>& input, const Vector<T>& compact, const std::vector<int>& kept = {}) {
  const Model& model = input.model;
  std::vector<Facing> found(model.points.size());
  const auto moved = displacement_in(compact);
  for (std::size_t c = 0; c < model.curves.size(); ++c) {
    const auto& curve = model.curves[c];
    if (curve.is_integrated()) {
      Points<double> places = values(input.slots.points);
      for (std::size_t n = 0; n < model.contact_nodes.size(); ++n)
        places.col(model.contact_nodes[n]).head<2>() += values(moved(static_cast<int>(n)));
      find_pieces(model, static_cast<int>(c), values(input.slots.points), places, found);
      continue;
    }
    Eigen::Matrix2Xd places(2, curve.vertex_count);
    for (int v = 0; v < curve.vertex_count; ++v) places.col(v) = values(vertex_of<T, T>(input, curve, v, moved));
    const CurveSearch search(curve.patches, places);
    const auto place_of = [&](int node, int place) -> Vec<double, 2> {
      return values(input.slots.points.col(node).template head<2>()) + values(moved(place));
    };
    for (std::size_t p = 0; p < found.size(); ++p) {
      const auto& point = model.points[p];
      if (point.curve != static_cast<int>(c)) continue;
      const Vec<double, 2> x = place_of(point.nodes[0], point.places[0]);
      if (!kept.empty() && kept[p] != Patch::none) {
        found[p] = search.stay(kept[p], x);
        continue;
      }
      Vec<double, 2> outward = Vec<double, 2>::Zero();
      for (std::size_t f = 0; f < point.facet_places.size(); ++f) {
        const auto& [a, b] = point.area_facets[f];
        const Vec<double, 2> along =
            place_of(b, point.facet_places[f].second) - place_of(a, point.facet_places[f].first);
        outward += Vec<double, 2>(along[1], -along[0]);
      }
      found[p] = point.own.vertex == Patch::none ? search.facing(x, outward)
                                                 : search.facing_itself(x, outward, point.own, input.previous.patch[p]);
    }
  }
  return found;
}

}  // namespace detail

}  // namespace stickslip
