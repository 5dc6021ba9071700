/// Geometry of contact points: against rigid obstacles, along master curves, and over the segments of either. One
/// evaluation serves all: the initial geometry, which is kept at small strain, is that at the positions of the start.
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
  /// where ContactPoint::turns_frame the normal and the first tangent. On a curve: coordinate on the patch less
  /// foot_reference(), on a surface the first two, and both tangents in terms of the slopes y_s and y_t there; where
  /// segment-integrated: mean initial arc length less origin_of_arcs(). What is not stored is 0.
  Feet<T, D> foot = Feet<T, D>::Constant(T(0));
  /// Motion of the foot relative to the master since the last increment, length. Slip is its tangential part.
  Vec<T, D> foot_motion = Vec<T, D>::Constant(T(0));
  bool faces_master = true;  ///< false: the point is open
};

/// What is known of a point from earlier; nothing at the start.
template <class T>
struct Earlier {
  const PointGeometry<T>* start = nullptr;  ///< its initial geometry
  const T* foot = nullptr;                  ///< in the history of the last increment; none: it has no friction
  int patch = Patch::none;                  ///< that this foot is on, along a curve
};

template <class T>
T offset_of(const ContactPoint& point, const Model& model, const Slots<T>& slots) {
  return slots.numbers(model.scene.contacts[point.contact].offset);
}

template <class T>
T tributary_area(const ContactPoint& point, const Slots<T>& slots) {
  if (point.area_of_bar) return area_of(slots.laws[point.slave_body]);
  if (point.area_edges.empty()) return T(1);
  T area{};
  for (const auto& edge : point.area_edges) {
    const auto shares = side_shares(slots.points, edge, slots.depths[point.slave_body]);
    for (std::size_t a = 0; a < edge.size(); ++a)
      if (edge[a] == point.nodes[0]) area += shares[a];
  }
  return area;
}

/// Initial area of a point, whether all of it faces the master or not. pre: present geometry, or the point is not
/// segment-integrated.
template <class T>
T whole_area(const ContactPoint& point, const Slots<T>& slots) {
  if (point.segments.empty()) return tributary_area(point, slots);
  return area_of_facets<T>(
      point.segments, [&](int node) { return point2(slots.points, node); }, slots.depths[point.slave_body]);
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
/// So components of tractions and slips keep their directions on the surface. `before`: n_0; `first`: the first tangent.
template <class U>
auto carried_tangents(const Vec<U, 3>& before, Vec<U, 3> first, const Vec<U, 3>& normal) {
  first -= Vec<U, 3>(before + normal) * (dot(first, normal) / (U(1) + dot(before, normal)));
  decltype(PointGeometry<U>::tangents) tangents(3, 2);
  tangents << first, cross<U>(normal, first);
  return tangents;
}

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
  at.geometry.area = U(earlier.start ? earlier.start->area : whole_area(point, slots));
  return at;
}

/// Slots::arcs of a curve.
template <class T>
Vector<T> arcs_of(const Model& model, const MasterCurve& curve, const Slots<T>& slots) {
  if (!curve.is_integrated()) return {};
  Vector<T> arcs(static_cast<Eigen::Index>(curve.facets.size()) + 1);
  arcs[0] = T(0);
  for (std::size_t f = 0; f < curve.facets.size(); ++f) {
    const auto end = [&](int k) { return start_of(model, curve.obstacle, slots, curve.facets[f][k]); };
    arcs[f + 1] = arcs[f] + norm(Vec<T, 2>(end(1) - end(0)));
  }
  return arcs;
}

/// The facet of an integrated curve from which the arc lengths of a point are measured.
inline int facet_of_arcs(const ContactPoint& point) { return std::max(point.facing.patch, 0); }

/// Where a point is along its integrated curve at the start, from the beginning of facet_of_arcs(): that facet's line
/// at its slave node. Arc lengths are measured from there, so that those of small motions are small.
template <class T>
double origin_of_arcs(const Model& model, const ContactPoint& point, const Slots<T>& slots) {
  const auto& curve = model.curves[point.curve];
  const auto& facet = curve.facets[facet_of_arcs(point)];
  const auto place = [&](int node) -> Vec<double, 2> { return values(start_of(model, curve.obstacle, slots, node)); };
  const Vec<double, 2> c = place(facet[0]), tau = place(facet[1]) - c;
  return (place(point.nodes[0]) - c).dot(tau) / tau.norm();
}

/// Initial arc length along an integrated curve from the beginning of facet_of_arcs() to that of a facet. `first`: a
/// facet near it; on a closed curve the way to `first` is the shorter one.
template <class T>
T arc_to(const Model& model, const ContactPoint& point, const Slots<T>& slots, int first, int facet) {
  const auto& curve = model.curves[point.curve];
  const Vector<T>& arcs = slots.arcs[point.curve];
  const int count = static_cast<int>(curve.facets.size()), origin = facet_of_arcs(point);
  const auto way = [&](int from, int to) {
    const bool is_longer = curve.is_loop() && 2 * std::abs(to - from) > count;
    return to - from + (!is_longer ? 0 : to < from ? count : -count);
  };
  const int turns = (origin + way(origin, first) + way(first, facet) - facet) / count;
  const T arc = arcs[facet] - arcs[origin];
  return turns == 0 ? arc : T(arc + T(static_cast<double>(turns)) * arcs[count]);
}

/// Coordinate on a patch from which the foot of a point is measured: that of its foot at the start, and on the patch
/// before this one its end. So a small motion makes a small difference, also across a vertex.
inline double foot_reference(const Model& model, const ContactPoint& point, int patch) {
  const Facing& start = point.facing;
  if (patch == start.patch) return start.xi;
  return start.patch != Patch::none && model.curves[point.curve].patches[start.patch].previous == patch ? 1 : 0;
}

/// Placement along its curve of a point that faces nothing of it, as History::foot stores it: from there it slides in
/// the increment in which it comes to face the curve. It is the place of the patch `nearest` that is nearest to the
/// slave node; for a segment-integrated point past a free end, where such a point comes on.
template <class U, class T, class Displacement>
U place_beside(const Positions<U, T, Displacement>& positions, const ContactPoint& point, int nearest) {
  const Model& model = positions.model;
  const Slots<T>& slots = positions.slots;
  const auto& curve = model.curves[point.curve];
  const auto& patch = curve.patches[nearest];
  const U xi = beside_facet<U, T>(positions.slave(point), positions.vertex(curve, patch.vertices[1]),
                                  positions.vertex(curve, patch.vertices[2]));
  if (!curve.is_integrated()) return xi - U(foot_reference(model, point, nearest));
  const auto of_start = [&](int node) { return start_of(model, point.obstacle, slots, node); };
  const auto& facet = curve.facets[nearest];
  const U place = U(arc_to(model, point, slots, nearest, nearest) - T(origin_of_arcs(model, point, slots))) +
                  xi * U(norm(Vec<T, 2>(of_start(facet[1]) - of_start(facet[0]))));
  if (value(xi) <= 0 && patch.previous == Patch::none)
    return place - U(way_outside_of_end<T>(point.segments, 1, of_start));
  if (value(xi) >= 1 && patch.next == Patch::none) return place + U(way_outside_of_end<T>(point.segments, 0, of_start));
  return place;
}

/// The place of the start of a point on a patch of its surface; none where the patch does not have it.
inline std::optional<Vec<double, 2>> start_on(const ContactPoint& point, int patch) {
  for (const Facing& start : point.starts)
    if (start.patch == patch) return Vec<double, 2>(start.xi, start.eta);
  return std::nullopt;
}

/// Place of a patch from which the feet of a point are measured: that of the start, if the patch has it; so a small
/// motion makes a small difference, also across an edge.
inline Vec<double, 2> surface_reference(const ContactPoint& point, int patch) {
  return start_on(point, patch).value_or(Vec<double, 2>::Zero());
}

/// Stores the foot of a point on a surface: the way to it, and both tangents in terms of the slopes.
template <class U>
void keep_foot(const SurfacePlace<U>& place, const Vec<double, 2>& reference, const PatchAround<U>& around,
               PlacedPoint<U, 3>& at) {
  at.foot.template head<2>() = place.from(reference);
  const U ss = dot(around.along_s, around.along_s), st = dot(around.along_s, around.along_t),
          tt = dot(around.along_t, around.along_t), determinant = ss * tt - st * st;
  for (int a = 0; a < 2; ++a) {
    const Vec<U, 3> e = at.geometry.tangents.col(a);
    const U s = dot(e, around.along_s), t = dot(e, around.along_t);
    at.foot[2 + 2 * a] = (tt * s - st * t) / determinant;
    at.foot[3 + 2 * a] = (ss * t - st * s) / determinant;
  }
}

/// Tangents of the last increment, carried along with a surface that has turned and stretched since: they turn as it
/// does in the mean, by the rotation of the polar decomposition F = R U of its tangent plane. Of the two lines f_1 = F
/// e_1 and f_2 = F e_2, R e_1 is along f_1 - n x f_2. So no direction of the surface is better than another. Then they
/// turn from the normal of the last foot to the present one. `last`: where keep_foot() stored them.
template <class U, class T>
auto carried_tangents(const PatchAround<U>& around, const T* last, const Vec<U, 3>& normal) {
  const Vec<U, 3> across = around.cross(), before = across / norm(across);
  const auto line = [&](int k) -> Vec<U, 3> { return U(last[k]) * around.along_s + U(last[k + 1]) * around.along_t; };
  const Vec<U, 3> first = line(2) - cross<U>(before, line(4));
  return carried_tangents<U>(before, first / norm(first), normal);
}

/// Place of a patch, as History::foot stores it.
template <class U, class T>
SurfacePlace<U> stored_place(const MasterCurve& surface, const ContactPoint& point, int patch, const T* foot) {
  return SurfacePlace<U>::behind(surface.surface[patch], surface_reference(point, patch), {U(foot[0]), U(foot[1])});
}

/// The same as place_beside() on a surface: sets the foot of a point to the place of the facet `nearest` that is
/// nearest to the slave node.
template <class U, class T, class Displacement>
void set_place_beside(const Positions<U, T, Displacement>& positions, const ContactPoint& point, int nearest,
                      PlacedPoint<U, 3>& at) {
  const auto& surface = positions.model.curves[point.curve];
  const auto& patch = surface.surface[nearest];
  FacePlace face;
  face.corners = patch.corners;
  std::copy_n(patch.vertices.begin(), patch.corners, face.nodes.begin());
  const Placed<U, T, 3> x = positions.template slave<3>(point);
  const auto corner = corners_of<U>(face, [&](int v) -> Vec<U, 3> {  // (from x, so that nothing is far away)
    return positions.template vertex<3>(surface, v) - x;
  });
  std::array<Vec<double, 3>, 4> in_double;
  for (int k = 0; k < 4; ++k) in_double[k] = values(corner[k]);
  const auto found = nearest_of_face(face, in_double, Vec<double, 3>::Zero());
  const auto foot = face_foot<U>(found.place, Vec<U, 3>::Constant(U(0)), corner);
  SurfacePlace<U> place{&patch, found.place.at};
  for (int i = 0; i < 2; ++i) place.rest[i] = foot.at[i] - U(place.at[i]);
  at.geometry.tangents = tangent_frame<U>(foot.normal);
  keep_foot(place, surface_reference(point, nearest), {foot.y, foot.along_s, foot.along_t}, at);
}

/// Geometry of a point against its surface in space.
template <class U, class T, class Displacement>
PlacedPoint<U, 3> on_surface(const Positions<U, T, Displacement>& positions, const ContactPoint& point,
                             const Facing& facing, const Earlier<T>& earlier) {
  const Model& model = positions.model;
  const auto& surface = model.curves[point.curve];
  const auto vertex = [&](int v) { return positions.template vertex<3>(surface, v); };
  const Vec<double, 2> reference = surface_reference(point, facing.patch);
  PlacedPoint<U, 3> at;
  const auto foot = foot_on_patch<U, T>(surface.surface[facing.patch], reference, {facing.xi, facing.eta},
                                        positions.template slave<3>(point), vertex);
  at.geometry.gap = foot.gap + U(offset_of(point, model, positions.slots));
  at.geometry.normal = foot.normal;
  at.geometry.weights.resize(1 + foot.weights.size());
  at.geometry.weights << U(1), -foot.weights;
  at.geometry.area = U(earlier.start ? earlier.start->area : whole_area(point, positions.slots));
  at.geometry.tangents = tangent_frame<U>(at.geometry.normal);
  if (point.foot < 0) return at;
  if (earlier.patch != Patch::none) {
    const auto last = stored_place<U>(surface, point, earlier.patch, earlier.foot);
    const bool joined = start_on(point, facing.patch) && start_on(point, earlier.patch);
    at.foot_motion =
        surface_motion<U, T>(last, surface_reference(point, earlier.patch), foot.place, reference, joined, vertex);
    at.geometry.tangents = carried_tangents<U>(around_place<U, T>(last, vertex), earlier.foot, foot.normal);
  }
  keep_foot(foot.place, reference, foot.around, at);
  return at;
}

/// Geometry of a point that faces nothing of its curve: it transmits no force. The gap is the distance, the normal that
/// of the start, and if it faced nothing then either, opposite to the normal of its own side. The foot is its placement
/// beside the curve.
template <int D, class U, class T, class Displacement>
PlacedPoint<U, D> off_curve(const Positions<U, T, Displacement>& positions, const ContactPoint& point,
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
  at.geometry.area = U(earlier.start ? earlier.start->area : whole_area(point, positions.slots));
  if (point.foot < 0 || facing.nearest == Patch::none) return at;
  if constexpr (D == 2)
    at.foot[0] = place_beside(positions, point, facing.nearest);
  else
    set_place_beside(positions, point, facing.nearest, at);
  return at;
}

/// Geometry of a point against its curve.
template <class U, class T, class Displacement>
PlacedPoint<U, 2> on_curve(const Positions<U, T, Displacement>& positions, const ContactPoint& point,
                           const Facing& facing, const Earlier<T>& earlier) {
  const Model& model = positions.model;
  const auto& curve = model.curves[point.curve];
  const auto vertex = [&](int v) { return positions.vertex(curve, v); };
  const Patch& patch = curve.patches[facing.patch];
  PlacedPoint<U, 2> at;
  const auto foot =
      foot_on_patch<U, T>(patch, foot_reference(model, point, facing.patch), facing.xi, positions.slave(point), vertex);
  at.geometry.gap = foot.gap + U(offset_of(point, model, positions.slots));
  at.geometry.normal = foot.normal;
  at.geometry.tangents = tangent_frame<U>(at.geometry.normal);
  at.geometry.weights = foot_weights(patch, foot.weights, curve.obstacle >= 0);
  at.geometry.area = U(earlier.start ? earlier.start->area : whole_area(point, positions.slots));
  at.foot[0] = foot.shift;
  if (earlier.patch != Patch::none)
    at.foot_motion = foot_motion<U, T>(patch, foot, curve.patches[earlier.patch],
                                       foot_reference(model, point, earlier.patch), *earlier.foot, vertex);
  return at;
}

/// Foot on an obstacle of a place of a segment, X displaced by u.
template <class U, class Read>
Foot<U> foot_on_obstacle(const RigidSurface& shape, const Vec<U, 2>& X, const Vec<U, 2>& u, const Read& numbers) {
  const auto g = against_rigid<U>(X, u, shape, numbers);
  Foot<U> foot;
  for (int i = 0; i < 2; ++i) {
    foot.normal[i] = g.normal[i];
    foot.off[i] = g.gap * g.normal[i];
    foot.moved[i] = u[i] - foot.off[i];
  }
  return foot;
}

/// Geometry of a segment-integrated point. `facing`: its segments along a curve; not read where it has none, as against
/// an obstacle, in whose frame the integration is.
template <class U, class T, class Displacement>
PlacedPoint<U, 2> on_segments(const Positions<U, T, Displacement>& positions, const ContactPoint& point,
                              const Facing& facing, const Earlier<T>& earlier) {
  const Model& model = positions.model;
  const Slots<T>& slots = positions.slots;
  const bool along_curve = point.curve >= 0;
  const auto number = [&](const Number& n) { return U(slots.numbers(n)); };
  const Frame<T, 2> frame =
      along_curve || point.obstacle < 0 ? Frame<T, 2>{} : positions.template frame<2>(point.obstacle);
  const auto place = [&](int node) {
    auto at = positions.node(point.obstacle, node);
    if (node < positions.model.node_count) at.moved = frame.seen(at.start, at.moved);
    return at;
  };
  const auto rigid_foot = [&](const Vec<U, 2>& X, const Vec<U, 2>& u) {
    return foot_on_obstacle<U>(model.scene.obstacles[point.obstacle].shape, X, u, number);
  };
  const double origin = along_curve ? origin_of_arcs(model, point, slots) : 0;
  const auto begin = [&](int facet) {
    return along_curve ? T(arc_to(model, point, slots, facing.patch, facet) - T(origin)) : T(0);
  };
  const auto& depth = slots.depths[point.slave_body];
  auto kinematics = segment_kinematics<U, T>(
      along_curve ? facing.pieces : point.segments, along_curve ? facing.nodes : point.nodes, place,
      Depth<U>{depth.of_revolution, U(depth.thickness)}, rigid_foot, begin, !along_curve);
  PlacedPoint<U, 2> at;
  at.geometry = std::move(kinematics.geometry);
  at.foot.template head<2>() = kinematics.foot;
  if (earlier.foot && !along_curve) {
    at.foot_motion = Vec<U, 2>(at.foot[0] - U(earlier.foot[0]), at.foot[1] - U(earlier.foot[1]));
  } else if (earlier.patch != Patch::none) {
    U length = at.foot[0] - U(earlier.foot[0]);
    const Vector<T>& arcs = slots.arcs[point.curve];
    const T& whole = arcs[arcs.size() - 1];
    const double turns = model.curves[point.curve].is_loop() ? std::round(value(length) / value(whole)) : 0;
    if (turns != 0) length -= U(turns) * U(whole);
    for (int i = 0; i < 2; ++i) at.foot_motion[i] = kinematics.tangent[i] * length;
  }
  turn_with<U, T>(frame, at);
  at.geometry.gap += number(model.scene.contacts[point.contact].offset);
  return at;
}

/// Geometry of a point that faces no facet or vertex for good. `facing`: what it faces of its curve; not read where it
/// has none.
template <int D, class U, class T, class Displacement>
PlacedPoint<U, D> place_point(const Positions<U, T, Displacement>& positions, const ContactPoint& point,
                              const Facing& facing, const Earlier<T>& earlier = {}) {
  if (point.curve >= 0 && facing.patch == Patch::none) return off_curve<D>(positions, point, facing, earlier);
  if constexpr (D == 3) {
    if (point.curve >= 0) return on_surface(positions, point, facing, earlier);
  } else {
    if (!point.segments.empty()) return on_segments(positions, point, facing, earlier);
    if (point.curve >= 0) return on_curve(positions, point, facing, earlier);
  }
  return on_obstacle<D>(positions, point, earlier);
}

/// Geometry against the facet or the vertex that a point faces for good.
template <class T>
PointGeometry<T> on_corners(const Model& model, const ContactPoint& point, const Slots<T>& slots) {
  const auto place = [&](int node) { return start_of(model, point.obstacle, slots, node); };
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
  } else {
    with_dimension(model.dimension, [&]<int D>() {
      auto at = place_point<D>(positions_of_start(model, slots), point, point.facing);
      geometry = std::move(at.geometry);
      if (!at.faces_master) geometry.gap += offset_of(point, model, slots);
    });
  }
  if (point.master == Master::segments && point.curve >= 0) geometry.area = whole_area(point, slots);
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
      foot[i] = start_of(model, point.obstacle, slots, point.corners[1])[i];
      continue;
    }
    for (int n = 0; n < point.slave_nodes; ++n) foot[i] += geometry.weights[n] * slots.points(i, point.nodes[n]);
    foot[i] -= gap * geometry.normal[i];
  }
  return displacement_per_degree(*model.scene.obstacles[point.obstacle].rotate, foot, slots.numbers);
}

}  // namespace stickslip::detail
