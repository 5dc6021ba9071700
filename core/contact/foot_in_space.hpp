/// Feet of points on patches in space, at the coordinates (s, t) of a face (core/contact/face.hpp).
///
///   foot of x:  (x - y) . y_s = (x - y) . y_t = 0     normal  y_s x y_t / |y_s x y_t|
///
/// Facets are triangles and bilinear quadrilaterals, smooth patches are those of Gregory on meshes with any number of
/// faces at a node (formulas and sources: core/contact/gregory.cpp). Where four quadrilaterals meet at each node they
/// are the tensor product of the splines of the plane. Beyond its edges a smooth patch goes on straight, with the
/// slopes that it has there.
#pragma once

#include "core/contact/face.hpp"
#include "core/contact/surface.hpp"

namespace stickslip {

/// Weights of the vertices of a patch at one place, and their derivatives: vertices x 10, with the columns
///
///   N  N_s N_t  N_ss N_st N_tt  N_sss N_sst N_stt N_ttt
using PlaceWeights = Eigen::Matrix<double, Eigen::Dynamic, 10>;
PlaceWeights place_weights(const Patch<3>& patch, const Vec<double, 2>& at);
/// Its columns up to the second derivatives.
using CurvedWeights = Eigen::Matrix<double, Eigen::Dynamic, 6>;
CurvedWeights curved_weights(const Patch<3>& patch, const Vec<double, 2>& at);
/// N at `to` less N at `from`, with the digits of the way between them.
Eigen::VectorXd weights_moved(const Patch<3>& patch, const Vec<double, 2>& from, const Vec<double, 2>& to);

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

/// A patch in space around a place, at given positions of its vertices.
template <class T>
struct PatchAround<T, 3> {
  Vec<T, 3> rise;              ///< from the place itself to the place with its rest, length
  Vec<T, 3> along_s, along_t;  ///< y_s, y_t there
  Vec<T, 3> cross() const { return stickslip::cross(along_s, along_t); }
};

/// `arm(i)`: vector to vertex i from a point that is the same for all, length.
template <class T, class S, class Arm>
PatchAround<T, 3> patch_around(const PlaceWeights& weights, const Vec<T, 2>& rest, Arm&& arm) {
  std::array<Vec<T, 3>, 9> y;
  for (int k = 0; k < 9; ++k) y[k] = detail::weighted<T, S>(weights.col(1 + k), arm);
  const detail::Taylor<T> by(rest);
  PatchAround<T, 3> around{Vec<T, 3>::Constant(T(0)), y[0], y[1]};
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

/// First and second derivatives of the weights of the vertices: columns 1 to 5 of PlaceWeights.
using PlaceSlopes = Eigen::Ref<const Eigen::Matrix<double, Eigen::Dynamic, 5>>;
/// How (s, t) changes with (off . y_s, off . y_t), so that off = x - y stays perpendicular to both slopes.
Mat<double, 2> foot_slope(const PlaceSlopes& slopes, const Eigen::Matrix3Xd& arms, const Vec<double, 3>& off);

/// Foot of x on a patch, as in the plane. Initial positions are summed up apart from displacements at the reference,
/// from which the way to the foot is measured.
template <class T, class S, class Vertex>
SurfaceFoot<T, 3> foot_on_patch(const Patch<3>& patch, const FootReference& reference, const Vec<double, 2>& at,
                                const Placed<T, S, 3>& x, Vertex&& vertex) {
  const auto count = static_cast<Eigen::Index>(patch.vertices.size());
  std::vector<Placed<T, S, 3>> placed;
  for (int v : patch.vertices) placed.push_back(vertex(v));
  const auto arm = [&](Eigen::Index i) -> Vec<T, 3> { return placed[i] - placed[0]; };
  const Eigen::VectorXd of_reference = curved_weights(patch, reference.at).col(0);
  const Vec<S, 3> start =
      detail::weighted<S, S>(of_reference, [&](Eigen::Index i) -> Vec<S, 3> { return x.start - placed[i].start; });
  const Vec<T, 3> moved =
      detail::weighted<T, S>(of_reference, [&](Eigen::Index i) -> Vec<T, 3> { return x.moved - placed[i].moved; });
  Vec<T, 3> off_at = moved - detail::weighted<T, S>(weights_moved(patch, reference.at, at), arm);
  for (int i = 0; i < 3; ++i) off_at[i] += T(start[i]);
  const PlaceWeights weights = place_weights(patch, at);
  Eigen::Matrix3Xd arms(3, count);
  for (Eigen::Index i = 0; i < count; ++i) arms.col(i) = values(arm(i));
  const Mat<double, 2> slope = foot_slope(weights.middleCols<5>(1), arms, values(off_at));
  SurfaceFoot<T, 3> foot;
  foot.place = {&patch, reference, at};
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

/// The facet of a patch.
inline FacePlace face_of(const Patch<3>& patch) {
  FacePlace face;
  face.corners = patch.corners;
  std::copy_n(patch.vertices.begin(), patch.corners, face.nodes.begin());
  return face;
}

/// Place of the facet of a patch that is nearest to x, as in the plane. The foot has its place, the normal, and the
/// slopes of the facet.
template <class T, class S, class Vertex>
SurfaceFoot<T, 3> foot_on_facet(const Patch<3>& patch, const FootReference& reference, const Placed<T, S, 3>& x,
                                Vertex&& vertex) {
  const FacePlace face = face_of(patch);
  const auto corner =  // (from x, so that nothing is far away)
      corners_of<T>(face, [&](int v) -> Vec<T, 3> { return vertex(v) - x; });
  std::array<Vec<double, 3>, 4> in_double;
  for (int k = 0; k < 4; ++k) in_double[k] = values(corner[k]);
  const auto found = nearest_of_face(face, in_double, Vec<double, 3>::Zero());
  const auto on_face = face_foot<T>(found.place, Vec<T, 3>::Constant(T(0)), corner);
  SurfaceFoot<T, 3> foot;
  foot.place = {&patch, reference, found.place.at};
  for (int i = 0; i < 2; ++i) foot.place.rest[i] = on_face.at[i] - T(found.place.at[i]);
  foot.normal = on_face.normal;
  foot.around = {on_face.y, on_face.along_s, on_face.along_t};
  return foot;
}

/// The patch of a place around it. `vertex(v)`: Placed<T, S, 3>, where vertex v of the surface is. The place is in S:
/// T, or what it is built on.
template <class T, class S, class Vertex>
PatchAround<T, 3> around_place(const SurfacePlace<S, 3>& place, Vertex&& vertex) {
  const auto& vertices = place.patch->vertices;
  const auto origin = vertex(vertices[0]);
  return patch_around<T, S>(place_weights(*place.patch, place.at), {T(place.rest[0]), T(place.rest[1])},
                            [&](Eigen::Index i) -> Vec<T, 3> { return vertex(vertices[i]) - origin; });
}

/// Vector to a foot from the place `from`, both where the surface is now, length. It has the digits of the ways from
/// the references where both places are on one patch, and where both references are the start.
template <class T, class S, class Vertex>
Vec<T, 3> foot_motion(const SurfacePlace<S, 3>& from, const SurfaceFoot<T, 3>& foot, Vertex&& vertex) {
  const SurfacePlace<T, 3>& to = foot.place;
  const auto origin = vertex(to.patch->vertices[0]);
  const auto arm_of = [&](const Patch<3>& patch) {
    return [&](Eigen::Index i) -> Vec<T, 3> { return vertex(patch.vertices[i]) - origin; };
  };
  const auto rise = [&](const auto& place) -> Vec<T, 3> {
    const Vec<T, 2> rest(T(place.rest[0]), T(place.rest[1]));
    return patch_around<T, S>(place_weights(*place.patch, place.at), rest, arm_of(*place.patch)).rise;
  };
  const auto way = [&](const Patch<3>& patch, const Vec<double, 2>& begin, const Vec<double, 2>& end) {
    return detail::weighted<T, S>(weights_moved(patch, begin, end), arm_of(patch));
  };
  const Vec<T, 3> rises = rise(to) - rise(from);
  if (to.patch == from.patch) return rises + way(*to.patch, from.at, to.at);
  if (to.reference.is_start && from.reference.is_start)
    return rises + way(*to.patch, to.reference.at, to.at) - way(*from.patch, from.reference.at, from.at);
  const auto place = [&](const Patch<3>& patch, const Vec<double, 2>& at) {
    return detail::weighted<T, S>(place_weights(patch, at).col(0), arm_of(patch));
  };
  return rises + place(*to.patch, to.at) - place(*from.patch, from.at);
}

}  // namespace stickslip
