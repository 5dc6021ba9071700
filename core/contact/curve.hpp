/// Master curves of the plane that points slide along: patches from vertex to vertex, each linear in the places of its
/// vertices, so that their forces and derivatives go to all of them by the same weights.
///
///   y(xi) = sum N_i(xi) y_i,   0 <= xi <= 1, the solid on the left      foot of x:  (x - y(xi)) . y'(xi) = 0
///
///   facets        N of the two ends
///   Catmull-Rom   cubic through both ends, slope (y_next - y_previous)/2 at each: normals go on
///   B-spline      uniform, cubic; the vertices are its control points: curvatures go on; off the vertices by O(h^2)
///
/// At a free end, and at a corner that is to stay one, a smooth patch continues its facet straight: y_0 = 2 y_1 - y_2.
/// Source of the smoothings: core/README.md.
#pragma once

#include <algorithm>
#include <array>
#include <vector>

#include "core/contact/piece.hpp"
#include "core/contact/point_geometry.hpp"

namespace stickslip {

enum class Smoothing { none, catmull_rom, b_spline };

struct Patch {
  static constexpr int none = -1;
  /// Vertices before, start, end, after; `none` of the outer two: the patch goes on straight there.
  std::array<int, 4> vertices{{none, none, none, none}};
  int previous = none, next = none;  ///< patches that meet it at its ends
  Smoothing smoothing = Smoothing::none;
  bool goes_on_before() const { return vertices[0] != none; }  ///< without a corner
  bool goes_on_after() const { return vertices[3] != none; }
};

/// A point that is a vertex of the curve that it faces: a side in contact with itself. It faces only patches that come
/// after it on the curve, so that of two places that meet one is the slave. It never faces a patch that it shapes, nor
/// one of its own wall.
struct OwnVertex {
  int vertex = Patch::none;
  double reach = 0;             ///< length: deeper than this it counts as inside of no patch
  std::vector<char> wall = {};  ///< per patch: whether it belongs to the point's own wall

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

/// Place on a curve.
struct Facing {
  int patch = Patch::none;  ///< none: nothing of the curve is faced
  double xi = 0;
  double distance = 0;  ///< where nothing is faced: to the nearest facet
  /// Segment-integrated: what of the curve is faced, from whose facet `patch` lengths along the curve are measured.
  std::vector<Piece> pieces = {};
  std::vector<int> nodes = {};  ///< of the slave's facets and these pieces, in the order of the weights
  friend bool operator==(const Facing&, const Facing&) = default;
};

namespace detail {

/// N_i and their first two derivatives at a place of a patch.
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
  for (auto* order : {&w.value, &w.slope, &w.bend}) {  // what stands in for a vertex that is not there
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

/// sum of n_i y_i. `place(vertex)`: y_i.
template <class T, class Place>
Vec<T, 2> on_patch(const Patch& patch, const std::array<T, 4>& n, Place&& place) {
  Vec<T, 2> sum = Vec<T, 2>::Constant(T(0));
  for (int i = 0; i < 4; ++i)
    if (patch.vertices[i] != Patch::none) sum += n[i] * place(patch.vertices[i]);
  return sum;
}

}  // namespace detail

/// Place of a curve.
template <class T, class Place>
Vec<T, 2> place_on(const Patch& patch, const T& xi, Place&& place) {
  return detail::on_patch<T>(patch, detail::patch_weights<T>(patch, xi).value, place);
}

/// The foot of a point on a patch and what belongs to it.
template <class T>
struct CurveFoot {
  T xi{}, gap{};
  Vec<T, 2> place, normal;  ///< place and unit normal out of the solid
  std::array<T, 4> weights;
};

/// Geometry of x against a patch. `xi`: the foot in double, found by the search. Steps of Newton's method from there,
/// in T, give its derivatives: one step the first, two the second. `place(vertex)`: where a vertex is.
template <class T, class Place>
CurveFoot<T> foot_on_patch(const Patch& patch, double xi, const Vec<T, 2>& x, Place&& place) {
  CurveFoot<T> foot;
  foot.xi = T(xi);
  const int steps = patch.smoothing == Smoothing::none ? 1 : 2;
  for (int step = 0; step < steps; ++step) {
    const auto w = detail::patch_weights<T>(patch, foot.xi);
    const Vec<T, 2> slope = detail::on_patch<T>(patch, w.slope, place),
                    bend = detail::on_patch<T>(patch, w.bend, place);
    const Vec<T, 2> off = x - detail::on_patch<T>(patch, w.value, place);
    foot.xi += dot(off, slope) / (dot(slope, slope) - dot(off, bend));
  }
  const auto w = detail::patch_weights<T>(patch, foot.xi);
  foot.weights = w.value;
  foot.place = detail::on_patch<T>(patch, w.value, place);
  const Vec<T, 2> slope = detail::on_patch<T>(patch, w.slope, place);
  const T length = norm(slope);
  foot.normal << slope[1] / length, -slope[0] / length;
  foot.gap = dot((x - foot.place).eval(), foot.normal);
  return foot;
}

/// Weights of displacements in w: 1 of the slave node, -N_i of the vertices that a patch has. Where these are `rigid`
/// they have none.
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

/// What a vertex of a side that touches itself may face.
///
///   through  how far a ray from the vertex, straight into the solid, runs until it comes out
///   reach    through, and at least the mesh size
///   wall     patches on the other face of the solid that the vertex itself is on. A patch belongs to it where the
///            vertex is behind the patch, and the distance to the patch, from the vertex or from where the ray comes
///            out, is less than 2 through plus the length of the patch
///
/// All are of the start. `places`: of the vertices; `outward`: normal of the side at the vertex; `mesh_size`: there.
OwnVertex own_vertex(const std::vector<Patch>& patches, const Eigen::Matrix2Xd& places, int vertex,
                     const Vec<double, 2>& outward, double mesh_size);

/// Patches from facets (vertex pairs, solid on their left). `places`: of the vertices at the start, by number. Facets
/// that turn by more than `corner` degrees keep their corner.
std::vector<Patch> make_patches(const std::vector<std::vector<int>>& facets, Smoothing smoothing, double corner,
                                const Eigen::Matrix2Xd& places);

}  // namespace stickslip
