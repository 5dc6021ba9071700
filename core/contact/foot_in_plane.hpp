/// Feet of points on patches of the plane, 0 <= xi <= 1 from the start of a patch to its end.
///
///   foot of x: (x - y(xi)) . y'(xi) = 0, measured from a reference on its patch, xi = reference + shift
///
///   Catmull-Rom   cubic through both ends, slope (y_next - y_previous) / (1 + q) at each
///   B-spline      uniform cubic
///
/// q is the length of the longer facet at the vertex over that of the shorter one, at the start, rounded to a whole
/// number: q = 1 for facets that are about alike. At a free end, and at a corner that is kept, a smooth patch extends
/// its facet straight: y_0 = 2 y_1 - y_2.
/// Source of the smoothings: core/README.md.
#pragma once

#include "core/contact/surface.hpp"

namespace stickslip {

/// Vectors from the vertex where a patch starts to each of its vertices. That of one that it lacks is not read.
template <class T>
struct PatchAround<T, 2> {
  std::array<Vec<T, 2>, 4> arms;
};

namespace detail {

/// N_i and their first two derivatives by xi at one place of a patch.
template <class T>
struct PatchWeights {
  std::array<T, 4> value, slope, bend;
};

template <class T>
PatchWeights<T> patch_weights(const Patch<2>& patch, const T& s) {
  const T zero(0), one(1), half(0.5), sixth(1.0 / 6);
  PatchWeights<T> w;
  if (!patch.is_smooth()) {
    w.value = {zero, one - s, s, zero};
    w.slope = {zero, -one, one, zero};
    w.bend = {zero, zero, zero, zero};
    return w;
  }
  const T r = one - s;
  if (patch.smoothing == Smoothing::catmull_rom) {
    w.value = {-half * s * r * r, one + half * s * s * (T(3) * s - T(5)), half * s * (one + s * (T(4) - T(3) * s)),
               -half * s * s * r};
    w.slope = {-half * r * (one - T(3) * s), half * s * (T(9) * s - T(10)), half * (one + s * (T(8) - T(9) * s)),
               half * s * (T(3) * s - T(2))};
    w.bend = {T(2) - T(3) * s, T(9) * s - T(5), T(4) - T(9) * s, T(3) * s - one};
  } else {
    w.value = {sixth * r * r * r, sixth * (T(4) + s * s * (T(3) * s - T(6))), sixth * (one + T(3) * s * (one + s * r)),
               sixth * s * s * s};
    w.slope = {-half * r * r, half * s * (T(3) * s - T(4)), half * (one + s * (T(2) - T(3) * s)), half * s * s};
    w.bend = {r, T(3) * s - T(2), one - T(3) * s, s};
  }
  for (auto* order : {&w.value, &w.slope, &w.bend})
    for (int end : {0, 1}) {
      auto& n = *order;
      const int outer = 3 * end, near = 1 + end, far = 2 - end;
      if (!patch.goes_on(end)) {  // 2 y_near - y_far stands for the outer vertex
        n[near] += T(2) * n[outer];
        n[far] -= n[outer];
        n[outer] = zero;
      } else if (patch.slope_factor[end] != 1) {  // y_far + factor (y_outer - y_far)
        n[far] += T(1 - patch.slope_factor[end]) * n[outer];
        n[outer] *= T(patch.slope_factor[end]);
      }
    }
  return w;
}

/// N_i and its derivatives at a place `by` from another, and the change of N_i from there, with the digits of `by`.
/// They are cubic, so these series end. `from`: at the other place, in S: T, or what it is built on.
template <class T>
struct MovedWeights : PatchWeights<T> {
  std::array<T, 4> change;
};
template <class T, class S>
MovedWeights<T> moved_weights(const Patch<2>& patch, const PatchWeights<S>& from, const T& by) {
  MovedWeights<T> w;
  if (!patch.is_smooth()) {
    w.change = {T(0), -by, by, T(0)};
    for (int i = 0; i < 4; ++i) {
      w.value[i] = T(from.value[i]) + w.change[i];
      w.slope[i] = T(from.slope[i]);
      w.bend[i] = T(0);
    }
    return w;
  }
  const auto start = patch_weights<double>(patch, 0).bend, end = patch_weights<double>(patch, 1).bend;
  const T half = by * S(0.5), third = by * S(1.0 / 3);
  for (int i = 0; i < 4; ++i) {
    const S jerk(end[i] - start[i]);
    const T slope(from.slope[i]), bend(from.bend[i]);
    w.change[i] = by * (slope + half * (bend + third * jerk));
    w.value[i] = T(from.value[i]) + w.change[i];
    w.slope[i] = slope + by * (bend + half * jerk);
    w.bend[i] = bend + by * jerk;
  }
  return w;
}

/// Sum of n_i y_i. `position(vertex)`: y_i.
template <class T, class Position>
Vec<T, 2> on_patch(const Patch<2>& patch, const std::array<T, 4>& n, Position&& position) {
  Vec<T, 2> sum = Vec<T, 2>::Constant(T(0));
  for (int i = 0; i < 4; ++i)
    if (patch.vertices[i] != no_vertex) sum += n[i] * position(patch.vertices[i]);
  return sum;
}

/// Sum of n_i (y_i - y_1): of n_i y_i where the n_i sum to 0. The n_i are in T, or in what it is built on.
template <class T, class S>
Vec<T, 2> along_arms(const Patch<2>& patch, const std::array<S, 4>& n, const PatchAround<T, 2>& of) {
  Vec<T, 2> sum = n[2] * of.arms[2];
  if (patch.vertices[0] != no_vertex) sum += n[0] * of.arms[0];
  if (patch.vertices[3] != no_vertex) sum += n[3] * of.arms[3];
  return sum;
}

/// The vertices of a patch. One that it lacks is not read. `position(vertex)`: Placed.
template <class T, class S, class Position>
std::array<Placed<T, S>, 4> vertices_of(const Patch<2>& patch, Position&& position) {
  std::array<Placed<T, S>, 4> vertices;
  for (int i = 0; i < 4; ++i)
    if (patch.vertices[i] != no_vertex) vertices[i] = position(patch.vertices[i]);
  return vertices;
}
template <class T, class S>
PatchAround<T, 2> arms_of(const Patch<2>& patch, const std::array<Placed<T, S>, 4>& vertices) {
  PatchAround<T, 2> of;
  for (int i : {0, 2, 3})
    if (patch.vertices[i] != no_vertex) of.arms[i] = vertices[i] - vertices[1];
  return of;
}

/// x - y of a place of constant weights N_i. Initial positions are summed up apart from displacements.
template <class T, class S>
Vec<T, 2> off_place(const Patch<2>& patch, const std::array<S, 4>& n, const Placed<T, S>& x,
                    const std::array<Placed<T, S>, 4>& vertices) {
  Vec<S, 2> start = Vec<S, 2>::Constant(S(0));
  Vec<T, 2> moved = Vec<T, 2>::Constant(T(0));
  for (int i = 0; i < 4; ++i)
    for (int k = 0; k < 2 && patch.vertices[i] != no_vertex; ++k) {
      start[k] += n[i] * (x.start[k] - vertices[i].start[k]);
      moved[k] += n[i] * (x.moved[k] - vertices[i].moved[k]);
    }
  return {T(start[0]) + moved[0], T(start[1]) + moved[1]};
}

}  // namespace detail

/// Position y(xi) on a patch. `position(vertex)`: y_i.
template <class T, class Position>
Vec<T, 2> curve_position(const Patch<2>& patch, const T& xi, Position&& position) {
  return detail::on_patch<T>(patch, detail::patch_weights<T>(patch, xi).value, position);
}

/// Foot of x on a patch.
///
///   reference  a place of the patch
///   at         the foot in double, found by the search; on a facet it is not read
///   x          the point
///   vertex(v)  Placed<T, S>: where vertex v of the curve is
///
/// Newton steps in the scalar T carry its derivatives: one step the first, two steps the second. On a facet one step
/// from anywhere is exact.
template <class T, class S, class Vertex>
SurfaceFoot<T, 2> foot_on_patch(const Patch<2>& patch, const FootReference& reference, const Vec<double, 2>& at,
                                const Placed<T, S>& x, Vertex&& vertex) {
  const auto from = detail::patch_weights<S>(patch, S(reference.at[0]));
  SurfaceFoot<T, 2> foot;
  foot.place = {&patch, reference, reference.at};
  T& shift = foot.place.rest[0];
  const auto vertices = detail::vertices_of<T, S>(patch, vertex);
  foot.around = detail::arms_of(patch, vertices);
  const auto sum = [&](const auto& n) { return detail::along_arms<T>(patch, n, foot.around); };
  const Vec<T, 2> off_reference = detail::off_place<T, S>(patch, from.value, x, vertices);
  const auto step_from = [&](const auto& w) {
    const Vec<T, 2> slope = sum(w.slope), off = off_reference - sum(w.change);
    const T square = dot(slope, slope);
    shift += dot(off, slope) / (patch.is_smooth() ? T(square - dot(off, sum(w.bend))) : square);
  };
  const S first(patch.is_smooth() ? at[0] - reference.at[0] : 0.0);
  shift = T(first);
  step_from(detail::moved_weights<S>(patch, from, first));
  if (patch.is_smooth()) step_from(detail::moved_weights<T>(patch, from, shift));
  const auto w = detail::moved_weights<T>(patch, from, shift);
  foot.weights = w.value;
  const Vec<T, 2> slope = sum(w.slope), off = off_reference - sum(w.change);
  const T length = norm(slope);
  foot.normal << slope[1] / length, -slope[0] / length;
  foot.gap = dot(off, foot.normal);
  return foot;
}

/// The same of places without displacements. `position(vertex)`: a vector.
template <class T, class Position>
SurfaceFoot<T, 2> foot_on_patch(const Patch<2>& patch, const Vec<double, 2>& at, const Vec<T, 2>& x,
                                Position&& position) {
  return foot_on_patch<T, T>(patch, {at}, at, at_start<T>(x),
                             [&](int vertex) { return at_start<T>(position(vertex)); });
}

/// Place of the facet of a patch that is nearest to x, 0 <= xi <= 1: where a point is along a curve that it does not
/// face. At a free end it is that end, however far from it x is. The arguments are those of foot_on_patch(); the foot
/// has its place alone.
template <class T, class S, class Vertex>
SurfaceFoot<T, 2> foot_on_facet(const Patch<2>& patch, const FootReference& reference, const Placed<T, S>& x,
                                Vertex&& vertex) {
  const Placed<T, S> a = vertex(patch.corner(0));
  const Vec<T, 2> tau = vertex(patch.corner(1)) - a;
  const T along = dot(Vec<T, 2>(x - a), tau) / dot(tau, tau);
  const T xi = value(along) <= 0 ? T(0) : value(along) >= 1 ? T(1) : along;
  SurfaceFoot<T, 2> foot;
  foot.place = {&patch, reference, reference.at, Vec<T, 1>::Constant(xi - T(reference.at[0]))};
  return foot;
}

/// Vector to a foot from the place `from`, both where their patches are now. It has the digits of the ways from the
/// references where the patches are the same one, and where they share a vertex that both places are near. `from` is in
/// S: T, or what it is built on.
template <class T, class S, class Vertex>
Vec<T, 2> foot_motion(const SurfacePlace<S, 2>& from, const SurfaceFoot<T, 2>& foot, Vertex&& vertex) {
  const Patch<2>&last = *from.patch, &patch = *foot.place.patch;
  const double reference = foot.place.reference.at[0], last_reference = from.reference.at[0];
  const S& last_shift = from.rest[0];
  const T& shift = foot.place.rest[0];
  if (&patch == &last) {
    const auto weights = detail::patch_weights<S>(patch, S(last_reference) + last_shift);
    const T by = T(reference - last_reference) + (shift - T(last_shift));
    return detail::along_arms<T>(patch, detail::moved_weights<T>(patch, weights, by).change, foot.around);
  }
  const bool ends_in_last = patch.corner(1) == last.corner(0), begins_in_last = last.corner(1) == patch.corner(0);
  const double end = ends_in_last ? 1 : 0, end_of_last = 1 - end;
  const auto from_end = [](const Patch<2>& of, double end, const T& by, const PatchAround<T, 2>& around) {
    const auto weights = detail::patch_weights<S>(of, S(end));
    return detail::along_arms<T>(of, detail::moved_weights<T>(of, weights, by).change, around);
  };
  const Vec<T, 2> motion = from_end(patch, end, T(reference - end) + shift, foot.around) -
                           from_end(last, end_of_last, T(last_reference - end_of_last) + T(last_shift),
                                    detail::arms_of(last, detail::vertices_of<T, S>(last, vertex)));
  if (ends_in_last || begins_in_last) return motion;
  const auto origin = vertex(patch.corner(0));
  const auto place = [&](int of) -> Vec<T, 2> { return vertex(of) - origin; };
  return motion + curve_position<T>(patch, T(end), place) - curve_position<T>(last, T(end_of_last), place);
}

}  // namespace stickslip
