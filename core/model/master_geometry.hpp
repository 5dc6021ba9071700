/// Geometry of contact points along master surfaces, which are curves in the plane: one evaluation for both dimensions.
#pragma once

#include "core/contact/foot_in_plane.hpp"
#include "core/contact/foot_in_space.hpp"
#include "core/contact/past_end.hpp"
#include "core/model/segment_geometry.hpp"

namespace stickslip::detail {

/// Place of a patch from which the feet of a point are measured: that of the start, if the patch has it. So a small
/// motion makes a small difference. In the plane also on the patch before that of the start: its end.
template <int D>
FootReference foot_reference(const Model& model, const ContactPoint& point, int patch) {
  if constexpr (D == 2) {
    const Facing& start = point.facing;
    if (patch == start.patch) return {start.at, true};
    const auto& patches = model.surfaces[point.surface].patches<2>();
    return {{start.patch != no_patch && patches[start.patch].across[0] == patch ? 1 : 0, 0}};
  } else {
    for (const Facing& start : point.starts)
      if (start.patch == patch) return {start.at, true};
    return {};
  }
}

/// Place of a patch, as History::foot stores it.
template <int D, class T>
SurfacePlace<T, D> stored_place(const Model& model, const ContactPoint& point, int patch, const T* foot) {
  return SurfacePlace<T, D>::behind(model.surfaces[point.surface].patches<D>()[patch],
                                    foot_reference<D>(model, point, patch), Eigen::Map<const Vec<T, D - 1>>(foot));
}

/// Stores a foot: the way to it, and in space both tangents in terms of the slopes.
template <class U, int D>
void keep_foot(const SurfacePlace<U, D>& place, const PatchAround<U, D>& around, PlacedPoint<U, D>& at) {
  at.foot.template head<D - 1>() = place.way();
  if constexpr (D == 3) {
    const U ss = dot(around.along_s, around.along_s), st = dot(around.along_s, around.along_t),
            tt = dot(around.along_t, around.along_t), determinant = ss * tt - st * st;
    for (int a = 0; a < 2; ++a) {
      const Vec<U, 3> e = at.geometry.tangents.col(a);
      const U s = dot(e, around.along_s), t = dot(e, around.along_t);
      at.foot[2 + 2 * a] = (tt * s - st * t) / determinant;
      at.foot[3 + 2 * a] = (ss * t - st * s) / determinant;
    }
  }
}

/// Tangents of the last increment, carried along with a surface in space that has turned and stretched since: they
/// turn as it does in the mean, by the rotation of the polar decomposition F = R U of its tangent plane. Of the lines
/// f_1 = F e_1 and f_2 = F e_2, R e_1 is along f_1 - n x f_2. So no direction of the surface is better than another.
/// Then they turn from the normal of the last foot to the present one. `last`: where keep_foot() stored them.
template <class U, class T>
auto carried_tangents(const PatchAround<U, 3>& around, const T* last, const Vec<U, 3>& normal) {
  const Vec<U, 3> across = around.cross(), before = across / norm(across);
  const auto line = [&](int k) -> Vec<U, 3> { return U(last[k]) * around.along_s + U(last[k + 1]) * around.along_t; };
  const Vec<U, 3> first = line(2) - cross<U>(before, line(4));
  return carried_tangents<U>(before, first / norm(first), normal);
}

/// Places a point that faces nothing of its surface beside it: sets its foot to the place of the facet `nearest` that
/// is nearest to the slave node. From there it slides in the increment in which it comes to face the surface.
template <int D, class U, class T, class Displacement>
void place_beside(const Positions<U, T, Displacement>& positions, const ContactPoint& point, int nearest,
                  PlacedPoint<U, D>& at) {
  const MasterSurface& master = positions.model.surfaces[point.surface];
  const FootReference reference =
      master.is_integrated() ? FootReference{} : foot_reference<D>(positions.model, point, nearest);
  const auto foot = foot_on_facet<U, T>(master.patches<D>()[nearest], reference, positions.template slave<D>(point),
                                        [&](int v) { return positions.template vertex<D>(master, v); });
  if constexpr (D == 3) at.geometry.tangents = tangent_frame<U>(foot.normal);
  keep_foot(foot.place, foot.around, at);
  if constexpr (D == 2)
    if (master.is_integrated()) at.foot[0] = arc_beside(positions, point, nearest, at.foot[0]);
}

/// The term by which the gap of a point is larger beyond ends of its surface, which are rounded off.
template <class U, class T, class Vertex>
U beyond_ends(const SurfaceFoot<U, 3>& foot, const Facing& facing, const T& size, Vertex&& vertex) {
  const Patch<3>& patch = *foot.place.patch;
  const auto corner = [&](int k) -> Vec<T, 3> { return vertex(patch.corner(k)).start; };
  Vec<U, 2> at;
  for (int i = 0; i < 2; ++i) at[i] = U(foot.place.at[i]) + foot.place.rest[i];
  U term(0);
  for (int k = 0; k < patch.corners; ++k)
    if ((facing.ends >> k & 1) != 0)
      term += end_relief<U, T>({size, width_behind<T>(patch.corners, k, corner)}, beyond_edge(patch, k, at), size);
  return term;
}

/// Geometry of a point against its surface.
template <int D, class U, class T, class Displacement>
PlacedPoint<U, D> on_master(const Positions<U, T, Displacement>& positions, const ContactPoint& point,
                            const Facing& facing, const Earlier<T>& earlier) {
  const Model& model = positions.model;
  const MasterSurface& master = model.surfaces[point.surface];
  const auto vertex = [&](int v) { return positions.template vertex<D>(master, v); };
  const auto foot =
      foot_on_patch<U, T>(master.patches<D>()[facing.patch], foot_reference<D>(model, point, facing.patch), facing.at,
                          positions.template slave<D>(point), vertex);
  PlacedPoint<U, D> at;
  at.geometry.gap = foot.gap + U(offset_of(point, model, positions.slots));
  at.geometry.normal = foot.normal;
  at.geometry.tangents = tangent_frame<U>(at.geometry.normal);
  at.geometry.weights = foot_weights(foot, master.is_rigid());
  at.geometry.area = U(whole_area(point, earlier, positions.slots));
  if constexpr (D == 3)
    if (facing.ends != 0) {
      at.geometry.gap +=
          beyond_ends<U, T>(foot, facing, mean_edge_length<T>(point.area_facets, positions.slots.points), vertex);
      at.has_potential = false;
    }
  if (point.foot < 0) return at;
  if (earlier.patch != no_patch) {
    const auto last = stored_place<D>(model, point, earlier.patch, earlier.foot);
    at.foot_motion = foot_motion<U, T>(last, foot, vertex);
    if constexpr (D == 3)
      at.geometry.tangents = carried_tangents<U>(around_place<U, T>(last, vertex), earlier.foot, foot.normal);
  }
  keep_foot(foot.place, foot.around, at);
  return at;
}

}  // namespace stickslip::detail
