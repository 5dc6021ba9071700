/// Where a contact point is and what it knows from earlier: what its geometries against obstacles and surfaces share.
#pragma once

#include "core/contact/segments.hpp"
#include "core/contact/surfaces.hpp"
#include "core/model/positions.hpp"

namespace stickslip::detail {

/// Geometry of a contact point at some positions.
template <class T, int D>
struct PlacedPoint {
  PointGeometry<T> geometry;
  /// Foot, as History::foot stores it. On an obstacle: in its frame, from the initial position of the slave node, and
  /// where ContactPoint::turns_frame the normal and the first tangent. On a surface: coordinates on the patch less
  /// foot_reference(), and in space both tangents in terms of the slopes y_s and y_t there; where segment-integrated:
  /// mean initial arc length less origin_of_arcs(). What is not stored is 0.
  Feet<T, D> foot = Feet<T, D>::Constant(T(0));
  /// Motion of the foot relative to the master since the last increment, length. Slip is its tangential part.
  Vec<T, D> foot_motion = Vec<T, D>::Constant(T(0));
  bool faces_master = true;   ///< false: the point is open
  bool has_potential = true;  ///< false: the force without friction is not along the gradient of the gap
};

/// What is known of a point from earlier; nothing at the start.
template <class T>
struct Earlier {
  const PointGeometry<T>* start = nullptr;  ///< its initial geometry
  const T* foot = nullptr;                  ///< in the history of the last increment; none: it has no friction
  int patch = no_patch;                     ///< that this foot is on, along a surface
};

template <class T>
T offset_of(const ContactPoint& point, const Model& model, const Slots<T>& slots) {
  return slots.numbers(model.scene.contacts[point.contact].offset);
}

template <class T>
T tributary_area(const ContactPoint& point, const Slots<T>& slots) {
  if (point.area_of_bar) return bar_area(slots, point.slave_body);
  if (point.area_edges.empty()) return T(1);
  T area{};
  for (const auto& edge : point.area_edges) {
    const auto shares = side_shares(slots.points, edge, slots.depths[point.slave_body]);
    for (std::size_t a = 0; a < edge.size(); ++a)
      if (edge[a] == point.nodes[0]) area += shares[a];
  }
  return area;
}

/// Mean initial length of facets, in space of their edges; 0 without facets. `points`: of all nodes.
template <class T>
T mean_edge_length(const std::vector<std::vector<int>>& facets, const Points<T>& points) {
  T sum{};
  int edges = 0;
  for (const auto& facet : facets)
    for (std::size_t a = 0; a < facet.size(); ++a, ++edges)
      sum += norm(points.col(facet[a]) - points.col(facet[(a + 1) % facet.size()]));
  return edges > 0 ? T(sum / T(edges)) : T(0);
}

/// Initial area of a point, whether all of it faces the master or not. pre: present geometry, or the point is not
/// segment-integrated.
template <class T>
T whole_area(const ContactPoint& point, const Slots<T>& slots) {
  if (!point.is_integrated()) return tributary_area(point, slots);
  return area_of_facets<T>(
      point.segments, [&](int node) { return point2(slots.points, node); }, slots.depths[point.slave_body]);
}

/// The same, from the initial geometry where it is known.
template <class T>
T whole_area(const ContactPoint& point, const Earlier<T>& earlier, const Slots<T>& slots) {
  return earlier.start ? earlier.start->area : whole_area(point, slots);
}

/// Initial length of what a segment-integrated point weighs: its whole area at unit depth.
template <class T>
T length_of_facets(const ContactPoint& point, const Slots<T>& slots) {
  return area_of_facets<T>(
      point.segments, [&](int node) { return point2(slots.points, node); }, Depth<T>{});
}

/// Turns normal, tangents and foot motion from the frame of the obstacle into the axes.
template <class U, class T, int D>
void turn_with(const Frame<T, D>& frame, PlacedPoint<U, D>& at) {
  if (!frame.turn) return;
  const auto turned = [&](const Vec<U, D>& v) { return Vec<U, D>(v + frame.turn->change(v)); };
  at.geometry.normal = turned(at.geometry.normal);
  at.foot_motion = turned(at.foot_motion);
  if constexpr (D == 2)
    at.geometry.tangents = tangent_frame<U>(at.geometry.normal);
  else
    for (int a = 0; a < 2; ++a) at.geometry.tangents.col(a) = turned(at.geometry.tangents.col(a));
}

/// Tangents of a point in space whose normal turns from increment to increment: those of the last one, turned from its
/// normal n_0 to the present n the shortest way, which takes a vector e across n_0 to
///
///   e - (e . n) / (1 + n_0 . n) (n_0 + n)
///
/// So components of tractions and slips keep their directions on the surface. `before`: n_0; `first`: the first
/// tangent.
template <class U>
auto carried_tangents(const Vec<U, 3>& before, Vec<U, 3> first, const Vec<U, 3>& normal) {
  first -= Vec<U, 3>(before + normal) * (dot(first, normal) / (U(1) + dot(before, normal)));
  decltype(PointGeometry<U>::tangents) tangents(3, 2);
  tangents << first, cross<U>(normal, first);
  return tangents;
}

}  // namespace stickslip::detail
