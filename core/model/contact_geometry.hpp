/// Geometry of contact points: against rigid obstacles, along master surfaces, and over the segments of either. One
/// evaluation serves all: the initial geometry, which is kept at small strain, is that at the positions of the start.
#pragma once

#include "core/contact/overlaps.hpp"
#include "core/model/master_geometry.hpp"

namespace stickslip::detail {

/// Geometry of a point against its obstacle.
template <int D, class U, class T, class Displacement>
PlacedPoint<U, D> on_obstacle(const Positions<U, T, Displacement>& positions, const ContactPoint& point,
                              const Earlier<T>& earlier) {
  const Model& model = positions.model;
  const Slots<T>& slots = positions.slots;
  const auto number = [&](const Number& n) { return U(slots.numbers(n)); };
  const auto frame = positions.template frame<D>(point.obstacle);
  const Vec<T, D> start = slots.points.template block<D, 1>(0, point.nodes[0]);
  const Vec<U, D> w = frame.seen(start, positions.template motion_of_slave<D>(point));
  Vec<U, D> X;
  for (int i = 0; i < D; ++i) X[i] = U(start[i]);
  PlacedPoint<U, D> at;
  at.geometry = against_rigid<U>(X, w, model.scene.obstacles[point.obstacle].shape, number);
  for (int i = 0; i < D; ++i) {
    at.foot[i] = w[i] - at.geometry.gap * at.geometry.normal[i];
    at.foot_motion[i] = earlier.foot ? U(at.foot[i] - U(earlier.foot[i])) : U(0);
  }
  if constexpr (D == 3)
    if (point.turns_frame) {
      if (earlier.foot) {
        const auto last = [&](int k) -> Vec<U, 3> {
          return {U(earlier.foot[k]), U(earlier.foot[k + 1]), U(earlier.foot[k + 2])};
        };
        at.geometry.tangents = carried_tangents<U>(last(D), last(2 * D), at.geometry.normal);
      }
      at.foot.template segment<D>(D) = at.geometry.normal;
      at.foot.template segment<D>(2 * D) = at.geometry.tangents.col(0);
    }
  turn_with<U, T>(frame, at);
  at.geometry.gap += U(offset_of(point, model, slots));
  at.geometry.area = U(whole_area(point, earlier, slots));
  return at;
}

/// Geometry of a point that faces nothing of its surface: it transmits no force. The gap is the distance. The normal is
/// that of the start, and if it faced nothing then either, opposite to the normal of its own side. The foot is its
/// placement beside the surface.
template <int D, class U, class T, class Displacement>
PlacedPoint<U, D> off_master(const Positions<U, T, Displacement>& positions, const ContactPoint& point,
                             const Facing& facing, const Earlier<T>& earlier) {
  decltype(PointGeometry<U>::normal) normal(D);
  for (int i = 0; i < D; ++i) normal[i] = U(i == 1 ? 1.0 : 0.0);
  if (earlier.start) {
    for (int i = 0; i < D; ++i) normal[i] = U(earlier.start->normal[i]);
  } else if (!point.area_facets.empty()) {
    const Vec<T, D> outward = slave_normal<D>(point.area_facets, positions.slots.points);
    const T length = norm(outward);
    for (int i = 0; i < D; ++i) normal[i] = U(-outward[i] / length);
  }
  PlacedPoint<U, D> at;
  at.faces_master = false;
  at.geometry = alone<U>(U(facing.distance), normal, point.slave_nodes);
  at.geometry.area = U(whole_area(point, earlier, positions.slots));
  if (point.foot < 0 || facing.nearest == no_patch) return at;
  place_beside(positions, point, facing.nearest, at);
  return at;
}

/// Geometry of a point that faces no facet or vertex for good. `facing`: what it faces of its surface; not read where
/// it has none.
template <int D, class U, class T, class Displacement>
PlacedPoint<U, D> place_point(const Positions<U, T, Displacement>& positions, const ContactPoint& point,
                              const Facing& facing, const Earlier<T>& earlier = {}) {
  if (point.surface >= 0 && facing.patch == no_patch) return off_master<D>(positions, point, facing, earlier);
  if constexpr (D == 2)
    if (point.is_integrated()) return on_segments(positions, point, facing, earlier);
  if (point.surface >= 0) return on_master<D>(positions, point, facing, earlier);
  return on_obstacle<D>(positions, point, earlier);
}

/// Geometry against the facet or the vertex that a point faces for good.
template <class T>
PointGeometry<T> on_corners(const Model& model, const ContactPoint& point, const Slots<T>& slots) {
  const auto place = [&](int node) { return start_of<2>(model, point.obstacle, slots, node); };
  const auto corner = [&](int k) { return place(point.corners[k]); };
  const Vec<T, 2> x = place(point.nodes[0]);
  const bool at_facet = point.master == ContactPoint::Master::facet;
  PointGeometry<T> geometry =
      at_facet ? against_facet<T>(x, corner(0), corner(1)) : against_vertex<T>(x, corner(0), corner(1), corner(2));
  if (point.obstacle >= 0) return fixed(std::move(geometry));
  for (std::size_t n = 2; !at_facet && n < point.nodes.size(); ++n)
    slide_off<T>(geometry, x, corner(1), place(point.nodes[n]));
  return geometry;
}

/// Geometry of a point that is integrated over overlaps.
template <class T>
PointGeometry<T> over_overlaps(const Model& model, const ContactPoint& point, const Slots<T>& slots) {
  const auto position = [&](int node) -> Vec<T, 3> { return start_of<3>(model, point.obstacle, slots, node); };
  const auto foot = [&](const Vec<T, 3>& X) {
    const auto number = [&](const Number& n) { return slots.numbers(n); };
    const auto& shape = model.scene.obstacles[point.obstacle].shape;
    return against_rigid<T>(X, shape, number);
  };
  const auto sums = integrate_overlaps<T>(point.overlaps, point.nodes, position, foot);
  PointGeometry<T> geometry = sums.geometry(sums.normal);
  geometry.gap += offset_of(point, model, slots);
  return geometry;
}

/// Initial geometry of a point. Of a segment-integrated one along a curve the area is whole, whatever part faces it.
template <class T>
PointGeometry<T> initial_geometry(const Model& model, const ContactPoint& point, const Slots<T>& slots) {
  using Master = ContactPoint::Master;
  PointGeometry<T> geometry;
  const auto node = [&]<int D>(int n) -> Vec<T, D> { return slots.points.template block<D, 1>(0, n); };
  if (point.master == Master::facet || point.master == Master::vertex || point.master == Master::faces) {
    geometry = point.master != Master::faces
                   ? on_corners(model, point, slots)
                   : against_faces<T>(node.template operator()<3>(point.nodes[0]), point.faces, point.nodes,
                                      [&](int n) { return node.template operator()<3>(n); });
    geometry.gap += offset_of(point, model, slots);
    geometry.area = whole_area(point, slots);
  } else if (!point.overlaps.empty()) {
    return over_overlaps(model, point, slots);
  } else {
    with_dimension(model.dimension, [&]<int D>() {
      auto at = place_point<D>(positions_of_start(model, slots), point, point.facing);
      geometry = std::move(at.geometry);
      if (!at.faces_master) geometry.gap += offset_of(point, model, slots);
    });
  }
  if (point.master == Master::segments && point.surface >= 0) geometry.area = whole_area(point, slots);
  if (!point.shares_normal) return geometry;
  with_dimension(model.dimension, [&]<int D>() {
    share_normal<D, T>(geometry, slave_normal<D>(point.area_facets, slots.points));
    geometry.gap = T(0);
    for (std::size_t n = 0; n < point.nodes.size(); ++n)
      geometry.gap += geometry.weights[n] * dot(geometry.normal, node.template operator()<D>(point.nodes[n]));
  });
  geometry.gap += offset_of(point, model, slots);
  return geometry;
}

/// Displacement of the obstacle at the initial foot of point p per degree of rotation, length; zero if it does not
/// rotate. If the point is segment-integrated: at its mean foot.
template <class T>
Vector<T> spin(const Model& model, int p, const Slots<T>& slots) {
  const auto& point = model.points[p];
  const auto& geometry = slots.geometry[p];
  Vector<T> foot = Vector<T>::Constant(model.dimension, T(0));
  if (point.obstacle < 0 || !model.scene.obstacles[point.obstacle].rotate) return foot;
  const T gap = geometry.gap - offset_of(point, model, slots);
  const bool at_vertex = point.master == ContactPoint::Master::vertex;
  for (int i = 0; i < model.dimension; ++i) {
    if (at_vertex) {
      foot[i] = start_of<2>(model, point.obstacle, slots, point.corners[1])[i];
      continue;
    }
    for (int n = 0; n < point.slave_nodes; ++n) foot[i] += geometry.weights[n] * slots.points(i, point.nodes[n]);
    foot[i] -= gap * geometry.normal[i];
  }
  return displacement_per_degree(*model.scene.obstacles[point.obstacle].rotate, foot, slots.numbers);
}

}  // namespace stickslip::detail
