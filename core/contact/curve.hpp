/// Master curves in the plane, along which points slide. A curve consists of patches from vertex to vertex. The
/// position on a patch is linear in the positions of its vertices, so forces and derivatives have the weights N_i:
///
///   y(xi) = sum N_i(xi) y_i,   0 <= xi <= 1, the solid on the left      foot of x:  (x - y(xi)) . y'(xi) = 0
///
///   facets        N_i of the two ends
///   Catmull-Rom   cubic through both ends, slope (y_next - y_previous)/2 at each: the normal is continuous
///   B-spline      uniform cubic, the vertices are its control points: the curvature is continuous; the curve misses
///   the
///                 vertices by O(h^2)
///
/// At a free end, and at a corner that is kept, a smooth patch extends its facet straight: y_0 = 2 y_1 - y_2.
/// Source of the smoothings: core/README.md.
#pragma once

#include <algorithm>
#include <array>
#include <vector>

#include "core/contact/point_geometry.hpp"
#include "core/contact/segment.hpp"

namespace stickslip {

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

/// A contact point that is a vertex of the curve that it faces: a side in contact with itself. It faces only patches
/// that come after it on the curve, so of two positions that touch exactly one is the slave. It never faces a patch
/// that it is a vertex of, nor a patch of its own wall.
struct OwnVertex {
  int vertex = Patch::none;
  double max_depth = 0;         ///< length: beyond this depth it is not inside of a patch
  std::vector<char> wall = {};  ///< per patch: whether it belongs to the wall of the vertex (own_vertex())

  bool may_face(const std::vector<Patch>& patches, int p) const {
    const auto& vertices = patches[p].vertices;
    return vertices[1] > vertex && !wall[p] && std::find(vertices.begin(), vertices.end(), vertex) == vertices.end();
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

/// The same at a place without derivatives.
template <class T>
PatchWeights<T> constant_patch_weights(const Patch& patch, double s) {
  const auto of = patch_weights<double>(patch, s);
  PatchWeights<T> w;
  for (int i = 0; i < 4; ++i) {
    w.value[i] = T(of.value[i]);
    w.slope[i] = T(of.slope[i]);
    w.bend[i] = T(of.bend[i]);
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

/// The foot of a point on a patch.
template <class T>
struct CurveFoot {
  T xi{}, gap{};               ///< coordinate on the patch; distance along the normal, length, negative inside
  Vec<T, 2> position, normal;  ///< normal: unit, out of the solid
  std::array<T, 4> weights;    ///< N_i(xi)
};

/// Foot of x on a patch. `xi`: the foot in double, found by the search; `position(vertex)`: of the vertices. Newton
/// steps from xi in the scalar T carry its derivatives: one step the first, two steps the second.
template <class T, class Position>
CurveFoot<T> foot_on_patch(const Patch& patch, double xi, const Vec<T, 2>& x, Position&& position) {
  std::array<Vec<T, 2>, 4> positions;
  for (int i = 0; i < 4; ++i)
    if (patch.vertices[i] != Patch::none) positions[i] = position(patch.vertices[i]);
  const auto at = [&](int vertex) -> const Vec<T, 2>& {
    return positions[std::find(patch.vertices.begin(), patch.vertices.end(), vertex) - patch.vertices.begin()];
  };
  CurveFoot<T> foot;
  foot.xi = T(xi);
  const int steps = patch.smoothing == Smoothing::none ? 1 : 2;
  for (int step = 0; step < steps; ++step) {
    const auto w = step == 0 ? detail::constant_patch_weights<T>(patch, xi) : detail::patch_weights<T>(patch, foot.xi);
    const Vec<T, 2> slope = detail::on_patch<T>(patch, w.slope, at), bend = detail::on_patch<T>(patch, w.bend, at);
    const Vec<T, 2> off = x - detail::on_patch<T>(patch, w.value, at);
    foot.xi += dot(off, slope) / (dot(slope, slope) - dot(off, bend));
  }
  const auto w = detail::patch_weights<T>(patch, foot.xi);
  foot.weights = w.value;
  foot.position = detail::on_patch<T>(patch, w.value, at);
  const Vec<T, 2> slope = detail::on_patch<T>(patch, w.slope, at);
  const T length = norm(slope);
  foot.normal << slope[1] / length, -slope[0] / length;
  foot.gap = dot((x - foot.position).eval(), foot.normal);
  return foot;
}

/// Coordinate of the place of the facet a -> b that is nearest to x, 0 <= xi <= 1: where a point is along a curve that
/// it does not face. At a free end it is that end, however far from it x is.
template <class T>
T beside_facet(const Vec<T, 2>& x, const Vec<T, 2>& a, const Vec<T, 2>& b) {
  const Vec<T, 2> tau = b - a;
  const T xi = dot((x - a).eval(), tau) / dot(tau, tau);
  return value(xi) <= 0 ? T(0) : value(xi) >= 1 ? T(1) : xi;
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
