/// Master curves in the plane, along which points slide. A curve consists of patches from vertex to vertex. The
/// position on a patch is linear in the positions of its vertices, so forces and derivatives have the weights N_i:
///
///   y(xi) = sum N_i(xi) y_i,   0 <= xi <= 1, the solid on the left      foot of x:  (x - y(xi)) . y'(xi) = 0
///
/// A foot is measured from a reference on its patch, xi = reference + shift, and places from one another, so that a
/// small motion has its digits, however far from the origin the curve is.
///
///   facets        N_i of the two ends
///   Catmull-Rom   cubic through both ends, slope (y_next - y_previous)/2 at each: the normal is continuous
///   B-spline      uniform cubic, the vertices are its control points: the curvature is continuous; the curve misses
///                 the vertices by O(h^2)
///
/// At a free end, and at a corner that is kept, a smooth patch extends its facet straight: y_0 = 2 y_1 - y_2.
/// Source of the smoothings: core/README.md.
#pragma once

#include <algorithm>
#include <array>
#include <vector>

#include "core/contact/placed.hpp"
#include "core/contact/point_geometry.hpp"
#include "core/contact/segment.hpp"

namespace stickslip {

/// Share of a facet's length within which a projection counts as lying at the facet's end.
inline constexpr double at_facet_end = 1e-9;

/// The place of a facet that is nearest to a point.
struct FacetPlace {
  double xi;        ///< coordinate of the projection, which may lie past the ends: 0 at the first, 1 at the second
  double distance;  ///< of the nearest place, length
};
/// `a`, `b`: ends of the facet.
FacetPlace nearest_of_facet(const Vec<double, 2>& a, const Vec<double, 2>& b, const Vec<double, 2>& x);

enum class Smoothing { none, catmull_rom, b_spline };

struct Patch {
  static constexpr int none = -1;
  /// Vertex before the patch, its start, its end, vertex after it. `none` for an outer one: the facet is extended
  /// straight there.
  std::array<int, 4> vertices{{none, none, none, none}};
  int previous = none, next = none;  ///< patches that share its start, its end; none: free end
  Smoothing smoothing = Smoothing::none;
  bool goes_on_before() const { return vertices[0] != none; }  ///< whether it joins `previous` without a corner
  bool goes_on_after() const { return vertices[3] != none; }   ///< whether it joins `next` without a corner
};

/// Two places of one curve can touch only if the cosine of the angle between their outward normals is less than minus
/// this. So the angle exceeds 120 degrees, and the two sides of a corner never touch.
inline constexpr double least_against = 0.5;

/// Whether a place whose foot has the coordinate xi on a facet is beside it, up to half its length past an end. Farther
/// away a place is not inside of the facet.
inline bool is_beside_facet(double xi) {
  constexpr double past_end = 0.5;
  return xi >= -past_end && xi <= 1 + past_end;
}

/// A contact point that is a vertex of the curve that it faces: a side in contact with itself. It faces only patches
/// that come after it on the curve, so of two positions that touch exactly one is the slave. It never faces a patch
/// that it is a vertex of, nor a patch of its own wall.
struct OwnVertex {
  int vertex = Patch::none;
  double max_depth = 0;         ///< length: beyond this depth it is not inside of a patch
  std::vector<char> wall = {};  ///< per patch: whether it belongs to the wall of the vertex (own_vertex())

  /// Number of patches from the one that was faced last within which it may be inside by all of max_depth; elsewhere by
  /// a share of that.
  static constexpr int neighbourhood = 8;
  static constexpr double share_of_depth = 0.25;
  /// How deep inside of patch p it may be, length. `last`: the patch that was faced last, or Patch::none.
  double depth_in(int p, int last) const {
    const int count = static_cast<int>(wall.size());
    bool is_near_last = false;
    for (const int turn : {-count, 0, count}) is_near_last |= std::abs(p - last - turn) <= neighbourhood;
    return (last != Patch::none && is_near_last ? 1 : share_of_depth) * max_depth;
  }
  /// Whether the vertex may touch patch p, as slave or as a place of the master.
  bool may_touch(const std::vector<Patch>& patches, int p) const {
    const auto& vertices = patches[p].vertices;
    return !wall[p] && std::find(vertices.begin(), vertices.end(), vertex) == vertices.end();
  }
  bool may_face(const std::vector<Patch>& patches, int p) const {
    return patches[p].vertices[1] > vertex && may_touch(patches, p);
  }
  bool may_face_some(const std::vector<Patch>& patches) const {
    for (int p = 0; p < static_cast<int>(patches.size()); ++p)
      if (may_face(patches, p)) return true;
    return false;
  }
};

/// What a contact point faces: a place on a curve, or segments of it.
struct Facing {
  int patch = Patch::none;    ///< none: the point faces nothing of the curve
  double xi = 0;              ///< coordinate of the foot on the patch
  double distance = 0;        ///< where nothing is faced: to the nearest facet, length
  int nearest = Patch::none;  ///< where nothing is faced: the patch of the nearest facet; see beside_facet()
  /// Segment-integrated contact: the segments. `patch` is then the origin of arc lengths along the curve.
  std::vector<Segment> pieces = {};
  std::vector<int> nodes = {};  ///< of the slave facets and of these segments, in the order of the weights
  double eta = 0;               ///< in space: the second coordinate of the foot
  friend bool operator==(const Facing&, const Facing&) = default;
};

namespace detail {

/// N_i and their first two derivatives by xi at one place of a patch.
template <class T>
struct PatchWeights {
  std::array<T, 4> value, slope, bend;
};

template <class T>
PatchWeights<T> patch_weights(const Patch& patch, const T& s) {
  const T zero(0), one(1), half(0.5), sixth(1.0 / 6);
  PatchWeights<T> w;
  if (patch.smoothing == Smoothing::none) {
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
  for (auto* order : {&w.value, &w.slope, &w.bend}) {  // a missing outer vertex is 2 y_1 - y_2
    auto& n = *order;
    if (!patch.goes_on_before()) {
      n[1] += T(2) * n[0];
      n[2] -= n[0];
      n[0] = zero;
    }
    if (!patch.goes_on_after()) {
      n[2] += T(2) * n[3];
      n[1] -= n[3];
      n[3] = zero;
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
MovedWeights<T> moved_weights(const Patch& patch, const PatchWeights<S>& from, const T& by) {
  MovedWeights<T> w;
  if (patch.smoothing == Smoothing::none) {
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
Vec<T, 2> on_patch(const Patch& patch, const std::array<T, 4>& n, Position&& position) {
  Vec<T, 2> sum = Vec<T, 2>::Constant(T(0));
  for (int i = 0; i < 4; ++i)
    if (patch.vertices[i] != Patch::none) sum += n[i] * position(patch.vertices[i]);
  return sum;
}

}  // namespace detail

/// Position y(xi) on a patch. `position(vertex)`: y_i.
template <class T, class Position>
Vec<T, 2> curve_position(const Patch& patch, const T& xi, Position&& position) {
  return detail::on_patch<T>(patch, detail::patch_weights<T>(patch, xi).value, position);
}

/// Vectors from the vertex where a patch starts to each of its vertices. That of one that it lacks is not read.
template <class T>
using PatchArms = std::array<Vec<T, 2>, 4>;

namespace detail {

/// Sum of n_i (y_i - y_1): of n_i y_i where the n_i sum to 0. The n_i are in T, or in what it is built on.
template <class T, class S>
Vec<T, 2> along_arms(const Patch& patch, const std::array<S, 4>& n, const PatchArms<T>& arms) {
  Vec<T, 2> sum = n[2] * arms[2];
  if (patch.vertices[0] != Patch::none) sum += n[0] * arms[0];
  if (patch.vertices[3] != Patch::none) sum += n[3] * arms[3];
  return sum;
}

/// The vertices of a patch. One that it lacks is not read.
template <class T, class S>
using PatchVertices = std::array<Placed<T, S>, 4>;

/// `position(vertex)`: Placed.
template <class T, class S, class Position>
PatchVertices<T, S> vertices_of(const Patch& patch, Position&& position) {
  PatchVertices<T, S> vertices;
  for (int i = 0; i < 4; ++i)
    if (patch.vertices[i] != Patch::none) vertices[i] = position(patch.vertices[i]);
  return vertices;
}
template <class T, class S>
PatchArms<T> arms_of(const Patch& patch, const PatchVertices<T, S>& vertices) {
  PatchArms<T> arms;
  for (int i : {0, 2, 3})
    if (patch.vertices[i] != Patch::none) arms[i] = vertices[i] - vertices[1];
  return arms;
}

/// x - y of a place of constant weights N_i. Initial positions are summed up apart from displacements.
template <class T, class S>
Vec<T, 2> off_place(const Patch& patch, const std::array<S, 4>& n, const Placed<T, S>& x,
                    const PatchVertices<T, S>& vertices) {
  Vec<S, 2> start = Vec<S, 2>::Constant(S(0));
  Vec<T, 2> moved = Vec<T, 2>::Constant(T(0));
  for (int i = 0; i < 4; ++i)
    for (int k = 0; k < 2 && patch.vertices[i] != Patch::none; ++k) {
      start[k] += n[i] * (x.start[k] - vertices[i].start[k]);
      moved[k] += n[i] * (x.moved[k] - vertices[i].moved[k]);
    }
  return {T(start[0]) + moved[0], T(start[1]) + moved[1]};
}

}  // namespace detail

/// The foot of a point on a patch.
template <class T>
struct CurveFoot {
  double reference = 0;
  T shift{};                 ///< coordinate on the patch: reference + shift
  T gap{};                   ///< distance along the normal, length, negative inside
  Vec<T, 2> normal;          ///< unit, out of the solid
  std::array<T, 4> weights;  ///< N_i(xi)
  PatchArms<T> arms;
  T xi() const { return T(reference) + shift; }
};

/// Foot of x on a patch. `reference`: coordinate that it is measured from; `xi`: the foot in double, found by the
/// search; `position(vertex)`: Placed. Newton steps in the scalar T carry its derivatives: one step the first, two
/// steps the second. On a facet one step from anywhere is exact.
template <class T, class S, class Position>
CurveFoot<T> foot_on_patch(const Patch& patch, double reference, double xi, const Placed<T, S>& x,
                           Position&& position) {
  const bool facet = patch.smoothing == Smoothing::none;
  const auto from = detail::patch_weights<S>(patch, S(reference));
  CurveFoot<T> foot;
  foot.reference = reference;
  const auto vertices = detail::vertices_of<T, S>(patch, position);
  foot.arms = detail::arms_of(patch, vertices);
  const auto sum = [&](const auto& n) { return detail::along_arms<T>(patch, n, foot.arms); };
  const Vec<T, 2> off_reference = detail::off_place<T, S>(patch, from.value, x, vertices);
  const auto step_from = [&](const auto& w) {
    const Vec<T, 2> slope = sum(w.slope), off = off_reference - sum(w.change);
    const T square = dot(slope, slope);
    foot.shift += dot(off, slope) / (facet ? square : T(square - dot(off, sum(w.bend))));
  };
  const S first(facet ? 0.0 : xi - reference);
  foot.shift = T(first);
  step_from(detail::moved_weights<S>(patch, from, first));
  if (!facet) step_from(detail::moved_weights<T>(patch, from, foot.shift));
  const auto w = detail::moved_weights<T>(patch, from, foot.shift);
  foot.weights = w.value;
  const Vec<T, 2> slope = sum(w.slope), off = off_reference - sum(w.change);
  const T length = norm(slope);
  foot.normal << slope[1] / length, -slope[0] / length;
  foot.gap = dot(off, foot.normal);
  return foot;
}

/// Coordinate of the place of the facet a -> b that is nearest to x, 0 <= xi <= 1: where a point is along a curve that
/// it does not face. At a free end it is that end, however far from it x is.
template <class T, class S>
T beside_facet(const Placed<T, S>& x, const Placed<T, S>& a, const Placed<T, S>& b) {
  const Vec<T, 2> tau = b - a;
  const T xi = dot(Vec<T, 2>(x - a), tau) / dot(tau, tau);
  return value(xi) <= 0 ? T(0) : value(xi) >= 1 ? T(1) : xi;
}

/// The same of places without displacements. `position(vertex)`: a vector.
template <class T, class Position>
CurveFoot<T> foot_on_patch(const Patch& patch, double xi, const Vec<T, 2>& x, Position&& position) {
  return foot_on_patch<T, T>(patch, xi, xi, at_start<T>(x), [&](int vertex) { return at_start<T>(position(vertex)); });
}

/// Vector to a foot on `patch` from the place reference + shift on the patch `last`, both where the patches are now. It
/// has the digits of the shifts where the patches are the same one, and where they share a vertex that both places are
/// near. `shift` is in S: T, or what it is built on.
template <class T, class S, class Position>
Vec<T, 2> foot_motion(const Patch& patch, const CurveFoot<T>& foot, const Patch& last, double reference, const S& shift,
                      Position&& position) {
  if (&patch == &last) {
    const auto from = detail::patch_weights<S>(patch, S(reference) + shift);
    const T by = T(foot.reference - reference) + (foot.shift - T(shift));
    return detail::along_arms<T>(patch, detail::moved_weights<T>(patch, from, by).change, foot.arms);
  }
  const bool ends_in_last = patch.vertices[2] == last.vertices[1],
             begins_in_last = last.vertices[2] == patch.vertices[1];
  const double end = ends_in_last ? 1 : 0, end_of_last = 1 - end;
  const auto from_end = [](const Patch& of, double end, const T& by, const PatchArms<T>& arms) {
    const auto from = detail::patch_weights<S>(of, S(end));
    return detail::along_arms<T>(of, detail::moved_weights<T>(of, from, by).change, arms);
  };
  const Vec<T, 2> motion = from_end(patch, end, T(foot.reference - end) + foot.shift, foot.arms) -
                           from_end(last, end_of_last, T(reference - end_of_last) + T(shift),
                                    detail::arms_of(last, detail::vertices_of<T, S>(last, position)));
  if (ends_in_last || begins_in_last) return motion;
  const auto origin = position(patch.vertices[1]);
  const auto place = [&](int vertex) -> Vec<T, 2> { return position(vertex) - origin; };
  return motion + curve_position<T>(patch, T(end), place) - curve_position<T>(last, T(end_of_last), place);
}

/// Weights of the displacements in w: 1 for the slave node, then -N_i for each vertex of the patch. On a rigid curve: 1
/// alone.
template <class T>
auto foot_weights(const Patch& patch, const std::array<T, 4>& n, bool rigid) {
  const auto vertices = rigid ? 0 : 4 - std::count(patch.vertices.begin(), patch.vertices.end(), Patch::none);
  decltype(PointGeometry<T>::weights) weights(1 + vertices);
  weights[0] = T(1);
  Eigen::Index k = 0;
  for (int i = 0; i < 4 && !rigid; ++i)
    if (patch.vertices[i] != Patch::none) weights[++k] = -n[i];
  return weights;
}

/// OwnVertex of a vertex of a side in contact with itself, from initial positions.
///
///   positions  of the vertices, 2 x vertices, length
///   outward    outward normal of the side at the vertex, any length
///   mesh_size  at the vertex, length
///
/// The thickness is the length of the ray from the vertex along -outward until it leaves the solid. max_depth is the
/// larger of thickness and mesh size. The wall consists of the patches on the opposite face of the same wall. A patch
/// belongs to it if the vertex is behind the patch, and the patch is nearer than 2 thickness plus its own length to the
/// vertex or to the end of the ray.
OwnVertex own_vertex(const std::vector<Patch>& patches, const Eigen::Matrix2Xd& positions, int vertex,
                     const Vec<double, 2>& outward, double mesh_size);

/// Patches from facets, one each. `facets`: two vertices each, the solid on their left; `positions`: initial, of the
/// vertices, 2 x vertices. Two facets that turn by more than `corner` degrees keep their corner.
std::vector<Patch> make_patches(const std::vector<std::vector<int>>& facets, Smoothing smoothing, double corner,
                                const Eigen::Matrix2Xd& positions);

}  // namespace stickslip
