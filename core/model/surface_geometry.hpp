/// Geometry of contact points against surfaces in space.
#pragma once

#include "core/model/placed_point.hpp"

namespace stickslip::detail {

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

}  // namespace stickslip::detail
