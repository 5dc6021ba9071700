/// Master surfaces in space, on which points slide. A surface consists of patches, one a face of the mesh. The position
/// on a patch is linear in the positions of its vertices, so forces and derivatives have the weights N_i:
///
///   y(s, t) = sum N_i(s, t) y_i     foot of x:  (x - y) . y_s = (x - y) . y_t = 0     normal  y_s x y_t / |y_s x y_t|
///
///   facets        N_i of a triangle or of a bilinear quadrilateral
///   Catmull-Rom   through the nodes, with a continuous normal: Gregory patches on meshes of triangles and
///                 quadrilaterals with any number of faces at a node; the tensor product of Catmull-Rom splines if four
///                 quadrilaterals meet at each node
///   B-spline      the same of uniform cubic B-splines, whose control points the nodes are
///
/// Coordinates s and t are those of a face (core/contact/face.hpp). The weights depend on how the faces are joined and
/// not on where they are. An edge at which the faces turn by more than an angle that is given is a crease: the surface
/// ends there as at a border. Formulas and sources: core/contact/gregory.cpp.
#pragma once

#include <array>
#include <string>
#include <vector>

#include "core/contact/curve.hpp"
#include "core/contact/face.hpp"
#include "core/mesh/mesh.hpp"

namespace stickslip {

struct SurfacePatch {
  int corners = 0;            ///< 3 or 4
  std::vector<int> vertices;  ///< its corners, counter-clockwise seen from outside, then others that the weights are of
  /// Weights of the vertices in each control point, control points x vertices; empty: a facet, whose control points are
  /// its corners.
  Eigen::MatrixXd control = {};
  std::array<int, 4> across{{Patch::none, Patch::none, Patch::none, Patch::none}};  ///< per edge: the patch behind it
  std::array<int, 4> across_edge{};                                                 ///< its number of that edge
  std::array<char, 4> goes_on{};  ///< per edge: whether the normal is continuous there
  bool is_smooth() const { return control.size() > 0; }
};

/// Patches of faces, one each. Throws std::runtime_error if the faces do not make a surface: three at an edge, or two
/// that are turned against each other.
///
///   faces      three or four vertices each, counter-clockwise seen from outside of the solid
///   corner     degrees by which faces turn at most where they are smoothed
///   positions  of the vertices at the start, 3 x vertices, length
std::vector<SurfacePatch> make_surface(const std::vector<std::vector<int>>& faces, Smoothing smoothing, double corner,
                                       const Points<double>& positions);

/// How far a place is beyond an edge of a patch, in its coordinates; negative inside.
double beyond_edge(int corners, int edge, const Vec<double, 2>& at);
/// Whether a place is beyond a border of the surface by more than `by`.
bool is_past_border(const SurfacePatch& patch, const Vec<double, 2>& at, double by);

/// Weights of the vertices of a patch at one place, and their derivatives: vertices x 10, with the columns
///
///   N  N_s N_t  N_ss N_st N_tt  N_sss N_sst N_stt N_ttt
using PlaceWeights = Eigen::Matrix<double, Eigen::Dynamic, 10>;
PlaceWeights place_weights(const SurfacePatch& patch, const Vec<double, 2>& at);
/// N at `to` less N at `from`, with the digits of the way between them.
Eigen::VectorXd weights_moved(const SurfacePatch& patch, const Vec<double, 2>& from, const Vec<double, 2>& to);

/// A place of a patch, (s, t), kept as a double and a small rest that carries derivatives. Weights in its surroundings
/// are their Taylor series to third order: exact for rests that are rounding, and for derivatives of two layers.
template <class T>
struct SurfacePlace {
  const SurfacePatch* patch = nullptr;
  Vec<double, 2> at = Vec<double, 2>::Zero();
  Vec<T, 2> rest = Vec<T, 2>::Constant(T(0));

  /// Where reference + shift is.
  static SurfacePlace behind(const SurfacePatch& patch, const Vec<double, 2>& reference, const Vec<T, 2>& shift) {
    SurfacePlace place{&patch, reference + values(shift)};
    for (int i = 0; i < 2; ++i) place.rest[i] = shift[i] - T(place.at[i] - reference[i]);
    return place;
  }
  /// Way in (s, t) from a reference.
  Vec<T, 2> from(const Vec<double, 2>& reference) const {
    return {T(at[0] - reference[0]) + rest[0], T(at[1] - reference[1]) + rest[1]};
  }
};

namespace detail {

/// The sum of n_i v_i. `v(i)`: a vector in T; S: what T is built on, or T.
template <class T, class S, class V>
Vec<T, 3> weighted(const Eigen::Ref<const Eigen::VectorXd>& n, V&& v) {
  Vec<T, 3> sum = Vec<T, 3>::Constant(T(0));
  for (Eigen::Index i = 0; i < n.size(); ++i)
    if (n[i] != 0) sum += S(n[i]) * v(i);
  return sum;
}

/// Factors of the derivatives in PlaceWeights, from the first on, in a Taylor series at (s, t) from its place.
template <class T>
struct Taylor {
  std::array<T, 9> position;
  std::array<T, 5> slope;  ///< of N_s with N_ss, N_st, N_sss, N_sst, N_stt; of N_t with N_st, N_tt, N_sst, N_stt, N_ttt
  explicit Taylor(const Vec<T, 2>& by) {
    const T half(0.5), third(1.0 / 3);
    const T &s = by[0], &t = by[1], ss = half * s * s, st = s * t, tt = half * t * t;
    position = {s, t, ss, st, tt, third * ss * s, ss * t, s * tt, third * tt * t};
    slope = {s, t, ss, st, tt};
  }
};

}  // namespace detail

/// A patch around one place, at given positions of its vertices.
template <class T>
struct PatchAround {
  Vec<T, 3> rise;              ///< from the place itself to the place with its rest, length
  Vec<T, 3> along_s, along_t;  ///< y_s, y_t there
  Vec<T, 3> cross() const { return stickslip::cross(along_s, along_t); }
};

/// `arm(i)`: vector to vertex i from a point that is the same for all, length.
template <class T, class S, class Arm>
PatchAround<T> patch_around(const PlaceWeights& weights, const Vec<T, 2>& rest, Arm&& arm) {
  std::array<Vec<T, 3>, 9> y;
  for (int k = 0; k < 9; ++k) y[k] = detail::weighted<T, S>(weights.col(1 + k), arm);
  const detail::Taylor<T> by(rest);
  PatchAround<T> around{Vec<T, 3>::Constant(T(0)), y[0], y[1]};
  for (int k = 0; k < 9; ++k) around.rise += by.position[k] * y[k];
  constexpr std::array of_s{2, 3, 5, 6, 7}, of_t{3, 4, 6, 7, 8};
  for (int k = 0; k < 5; ++k) {
    around.along_s += by.slope[k] * y[of_s[k]];
    around.along_t += by.slope[k] * y[of_t[k]];
  }
  return around;
}

/// N_i at a place with its rest.
template <class T>
Vector<T> weights_at(const PlaceWeights& weights, const Vec<T, 2>& rest) {
  const detail::Taylor<T> by(rest);
  Vector<T> n(weights.rows());
  for (Eigen::Index i = 0; i < n.size(); ++i) {
    n[i] = T(weights(i, 0));
    for (int k = 0; k < 9; ++k)
      if (weights(i, 1 + k) != 0) n[i] += T(weights(i, 1 + k)) * by.position[k];
  }
  return n;
}

/// The foot of a point on a patch.
template <class T>
struct SurfaceFoot {
  SurfacePlace<T> place;
  T gap{};           ///< distance along the normal, length, negative inside
  Vec<T, 3> normal;  ///< unit, out of the solid
  Vector<T> weights;
  PatchAround<T> around;
};

/// How (s, t) changes with (off . y_s, off . y_t), so that off = x - y stays perpendicular to both slopes.
Mat<double, 2> foot_slope(const PlaceWeights& weights, const Eigen::Matrix3Xd& arms, const Vec<double, 3>& off);

/// Foot of x on a patch. Initial positions are summed up apart from displacements at the reference, from which the way
/// to the foot is measured, so that small motions have their digits.
///
///   reference  a place of the patch, (s, t)
///   at         the foot in double, found by the search
///   x          the point
///   vertex(v)  Placed<T, S, 3>: where vertex v of the surface is
template <class T, class S, class Vertex>
SurfaceFoot<T> foot_on_patch(const SurfacePatch& patch, const Vec<double, 2>& reference, const Vec<double, 2>& at,
                             const Placed<T, S, 3>& x, Vertex&& vertex) {
  const auto count = static_cast<Eigen::Index>(patch.vertices.size());
  std::vector<Placed<T, S, 3>> placed;
  for (int v : patch.vertices) placed.push_back(vertex(v));
  const auto arm = [&](Eigen::Index i) -> Vec<T, 3> { return placed[i] - placed[0]; };
  const Eigen::VectorXd of_reference = place_weights(patch, reference).col(0);
  const Vec<S, 3> start =
      detail::weighted<S, S>(of_reference, [&](Eigen::Index i) -> Vec<S, 3> { return x.start - placed[i].start; });
  const Vec<T, 3> moved =
      detail::weighted<T, S>(of_reference, [&](Eigen::Index i) -> Vec<T, 3> { return x.moved - placed[i].moved; });
  Vec<T, 3> off_at = moved - detail::weighted<T, S>(weights_moved(patch, reference, at), arm);
  for (int i = 0; i < 3; ++i) off_at[i] += T(start[i]);
  const PlaceWeights weights = place_weights(patch, at);
  Eigen::Matrix3Xd arms(3, count);
  for (Eigen::Index i = 0; i < count; ++i) arms.col(i) = values(arm(i));
  const Mat<double, 2> slope = foot_slope(weights, arms, values(off_at));
  SurfaceFoot<T> foot;
  foot.place = {&patch, at};
  Vec<T, 3> off = off_at;
  // Newton's corrections by the slope in double: one gives first derivatives, and another those of two layers.
  constexpr int layers = 2;
  for (int layer = 0; layer <= layers; ++layer) {
    foot.around = patch_around<T, S>(weights, foot.place.rest, arm);
    off = off_at - foot.around.rise;
    if (layer == layers) break;
    const T along_s = dot(off, foot.around.along_s), along_t = dot(off, foot.around.along_t);
    for (int i = 0; i < 2; ++i) foot.place.rest[i] += T(slope(i, 0)) * along_s + T(slope(i, 1)) * along_t;
  }
  foot.normal = foot.around.cross();
  const T area = norm(foot.normal);
  for (int i = 0; i < 3; ++i) foot.normal[i] /= area;
  foot.gap = dot(off, foot.normal);
  foot.weights = weights_at<T>(weights, foot.place.rest);
  return foot;
}

/// A patch around one of its places. `vertex(v)`: Placed<T, S, 3>, where vertex v of the surface is.
template <class T, class S, class Vertex>
PatchAround<T> around_place(const SurfacePlace<T>& place, Vertex&& vertex) {
  const auto& vertices = place.patch->vertices;
  const auto origin = vertex(vertices[0]);
  return patch_around<T, S>(place_weights(*place.patch, place.at), place.rest,
                            [&](Eigen::Index i) -> Vec<T, 3> { return vertex(vertices[i]) - origin; });
}

/// Vector from the place `from` to the place `to`, both where the surface is now, length. It has the digits of the way
/// where they are on one patch, and where both patches have the start of the way, `to_start` and `from_start`.
///
///   vertex(v)  Placed<T, S, 3>: where vertex v of the surface is
///   joined     whether to_start and from_start are the same place of the surface; not read on one patch
template <class T, class S, class Vertex>
Vec<T, 3> surface_motion(const SurfacePlace<T>& from, const Vec<double, 2>& from_start, const SurfacePlace<T>& to,
                         const Vec<double, 2>& to_start, bool joined, Vertex&& vertex) {
  const auto origin = vertex(to.patch->vertices[0]);
  const auto arm_of = [&](const SurfacePatch& patch) {
    return [&](Eigen::Index i) -> Vec<T, 3> { return vertex(patch.vertices[i]) - origin; };
  };
  const auto rise = [&](const SurfacePlace<T>& place) -> Vec<T, 3> {
    return patch_around<T, S>(place_weights(*place.patch, place.at), place.rest, arm_of(*place.patch)).rise;
  };
  const auto way = [&](const SurfacePatch& patch, const Vec<double, 2>& begin, const Vec<double, 2>& end) {
    return detail::weighted<T, S>(weights_moved(patch, begin, end), arm_of(patch));
  };
  const Vec<T, 3> rises = rise(to) - rise(from);
  if (to.patch == from.patch) return rises + way(*to.patch, from.at, to.at);
  if (joined) return rises + way(*to.patch, to_start, to.at) - way(*from.patch, from_start, from.at);
  const auto place = [&](const SurfacePlace<T>& of) {
    return detail::weighted<T, S>(place_weights(*of.patch, of.at).col(0), arm_of(*of.patch));
  };
  return rises + place(to) - place(from);
}

}  // namespace stickslip
