/// Geometry of segment-integrated contact points, along master curves of the plane and against obstacles.
#pragma once

#include "core/contact/past_end.hpp"
#include "core/model/placed_point.hpp"

namespace stickslip::detail {

/// Slots::arcs of a curve.
template <class T>
Vector<T> arcs_of(const Model& model, const MasterSurface& curve, const Slots<T>& slots) {
  if (!curve.is_integrated()) return {};
  Vector<T> arcs(static_cast<Eigen::Index>(curve.facets.size()) + 1);
  arcs[0] = T(0);
  for (std::size_t f = 0; f < curve.facets.size(); ++f) {
    const auto end = [&](int k) { return start_of<2>(model, curve.obstacle, slots, curve.facets[f][k]); };
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
  const auto& curve = model.surfaces[point.surface];
  const auto& facet = curve.facets[facet_of_arcs(point)];
  const auto place = [&](int node) -> Vec<double, 2> {
    return values(start_of<2>(model, curve.obstacle, slots, node));
  };
  const Vec<double, 2> c = place(facet[0]), tau = place(facet[1]) - c;
  return (place(point.nodes[0]) - c).dot(tau) / tau.norm();
}

/// Initial arc length along an integrated curve from the beginning of facet_of_arcs() to that of a facet. `first`: a
/// facet near it; on a closed curve the way to `first` is the shorter one.
template <class T>
T arc_to(const Model& model, const ContactPoint& point, const Slots<T>& slots, int first, int facet) {
  const auto& curve = model.surfaces[point.surface];
  const Vector<T>& arcs = slots.arcs[point.surface];
  const int count = static_cast<int>(curve.facets.size()), origin = facet_of_arcs(point);
  const auto way = [&](int from, int to) {
    const bool is_longer = curve.is_loop() && 2 * std::abs(to - from) > count;
    return to - from + (!is_longer ? 0 : to < from ? count : -count);
  };
  const int turns = (origin + way(origin, first) + way(first, facet) - facet) / count;
  const T arc = arcs[facet] - arcs[origin];
  return turns == 0 ? arc : T(arc + T(static_cast<double>(turns)) * arcs[count]);
}

/// Placement of a segment-integrated point that faces nothing of its curve, as History::foot stores it: that of the
/// place xi of the facet `nearest`; past a free end, where such a point comes on.
template <class U, class T, class Displacement>
U arc_beside(const Positions<U, T, Displacement>& positions, const ContactPoint& point, int nearest, const U& xi) {
  const Model& model = positions.model;
  const Slots<T>& slots = positions.slots;
  const MasterSurface& curve = model.surfaces[point.surface];
  const auto& across = curve.patches<2>()[nearest].across;
  const auto of_start = [&](int node) { return start_of<2>(model, point.obstacle, slots, node); };
  const auto& facet = curve.facets[nearest];
  const U place = U(arc_to(model, point, slots, nearest, nearest) - T(origin_of_arcs(model, point, slots))) +
                  xi * U(norm(Vec<T, 2>(of_start(facet[1]) - of_start(facet[0]))));
  if (value(xi) <= 0 && across[0] == no_patch) return place - U(way_outside_of_end<T>(point.segments, 1, of_start));
  if (value(xi) >= 1 && across[1] == no_patch) return place + U(way_outside_of_end<T>(point.segments, 0, of_start));
  return place;
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
  const bool along_curve = point.surface >= 0;
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
  } else if (earlier.patch != no_patch) {
    U length = at.foot[0] - U(earlier.foot[0]);
    const Vector<T>& arcs = slots.arcs[point.surface];
    const T& whole = arcs[arcs.size() - 1];
    const double turns = model.surfaces[point.surface].is_loop() ? std::round(value(length) / value(whole)) : 0;
    if (turns != 0) length -= U(turns) * U(whole);
    for (int i = 0; i < 2; ++i) at.foot_motion[i] = kinematics.tangent[i] * length;
  }
  turn_with<U, T>(frame, at);
  at.geometry.gap += number(model.scene.contacts[point.contact].offset);
  if (along_curve && model.effects.current_geometry) {
    const U share = at.geometry.area / U(whole_area(point, earlier, slots));
    if (value(share) < relieved_share)
      at.geometry.gap += end_relief<U, T>(U(relieved_share) / share, length_of_facets(point, slots));
  }
  return at;
}

}  // namespace stickslip::detail
