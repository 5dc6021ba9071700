/// Master surfaces, along which points slide: curves in the plane, surfaces in space. A surface consists of patches,
/// one a facet of the mesh. The position on a patch is linear in the positions of its vertices, so forces and
/// derivatives have the weights N_i:
///
///   y(at) = sum N_i(at) y_i        at = xi in the plane, (s, t) in space; the solid on the left, or behind
///   foot of x:  x - y is across all slopes of y there       gap g = n . (x - y), n out of the solid
///
///   facets        N_i of the corners
///   Catmull-Rom   through the vertices; the normal is continuous
///   B-spline      the vertices are control points, which the surface misses by O(h^2); the curvature is continuous too
///                 (in space where four quadrilaterals meet at each node)
///
/// The weights depend on how the facets are joined, and those of Catmull-Rom curves in the plane on the ratios of the
/// facets' lengths at the start, but not on where they are. A smooth surface is not smooth at corners
/// and creases, where facets turn by more than an angle that is given.
///
/// What a contact point needs of a surface has the same name in both dimensions:
///
///   make_surface      its patches, from facets
///   SurfaceSearch     which place a point faces, in double       surface_search.hpp
///   foot_on_patch     the foot there, with its derivatives       foot_in_plane.hpp, foot_in_space.hpp
///   foot_on_facet     the nearest place of a facet, of a point that faces nothing
///   foot_motion       the way along the present surface to the foot from that of the last increment
///   foot_weights      weights of the displacements
#pragma once

#include <algorithm>
#include <array>
#include <vector>

#include "core/contact/placed.hpp"
#include "core/contact/point_geometry.hpp"
#include "core/contact/segment.hpp"

namespace stickslip {

/// Numbers of what is not there.
inline constexpr int no_patch = -1, no_vertex = -1;

enum class Smoothing { none, catmull_rom, b_spline };

/// A piece of a surface. Its edges are numbered; in the plane they are its two ends.
///
///   corners, corner(k)  number of its corners, and of its edges; the vertex at corner k
///   vertices            all vertices that its weights are of
///   across[k]           the patch behind edge k; no_patch at a border
///   goes_on(k)          whether the normal is continuous there; goes_on_around(): at all edges
///   is_smooth()         whether it is no facet
template <int D>
struct Patch;

template <>
struct Patch<2> {
  static constexpr int corners = 2;
  /// Vertex before the patch, its start, its end, vertex after it. no_vertex for an outer one: the facet is extended
  /// straight there.
  std::array<int, 4> vertices{{no_vertex, no_vertex, no_vertex, no_vertex}};
  std::array<int, 2> across{{no_patch, no_patch}};
  /// Per end, of Catmull-Rom: the slope there over that of the uniform spline (slope_factor() in surface.cpp).
  std::array<double, 2> slope_factor{{1, 1}};
  Smoothing smoothing = Smoothing::none;
  int corner(int k) const { return vertices[1 + k]; }
  bool goes_on(int end) const { return vertices[3 * end] != no_vertex; }
  bool goes_on_around() const { return goes_on(0) && goes_on(1); }
  bool is_smooth() const { return smoothing != Smoothing::none; }
};

/// How a patch goes on straight beyond an end of the surface: against `along` times its derivative along the edge plus
/// `across` times that across it. At a node of the border all patches there go on along one line.
struct WayBeyond {
  double along = 0, across = 1;
};

template <>
struct Patch<3> {
  int corners = 0;            ///< 3 or 4; edge k is from corner k to the next
  std::vector<int> vertices;  ///< its corners, counter-clockwise seen from outside, then others that the weights are of
  /// Weights of the vertices in each control point, control points x vertices; empty: a facet, whose control points are
  /// its corners.
  Eigen::MatrixXd control = {};
  std::array<int, 4> across{{no_patch, no_patch, no_patch, no_patch}};
  std::array<int, 4> across_edge{};                  ///< per edge: its number on the patch behind it
  std::array<char, 4> smooth_at{};                   ///< per edge: goes_on()
  std::array<double, 4> widths{};                    ///< per edge: width_behind() it at the start
  std::array<std::array<WayBeyond, 2>, 4> beyond{};  ///< per edge, at its beginning and its end
  int corner(int k) const { return vertices[k]; }
  bool goes_on(int edge) const { return smooth_at[edge] != 0; }
  bool goes_on_around() const { return std::count(smooth_at.begin(), smooth_at.end(), 1) == corners; }
  bool is_smooth() const { return control.size() > 0; }
};

template <int D>
using Surface = std::vector<Patch<D>>;

/// Positions of the vertices of a surface, D x vertices, length.
template <int D>
using Places = Eigen::Matrix<double, D, Eigen::Dynamic>;

/// Patches of facets, one each. In space throws std::runtime_error if the facets do not make a surface: three at an
/// edge, or two that are turned against each other.
///
///   facets     in the plane two vertices each, the solid on their left; in space three or four, counter-clockwise seen
///              from outside
///   corner     degrees by which facets turn at most where they are smoothed
///   positions  of the start
template <int D>
Surface<D> make_surface(const std::vector<std::vector<int>>& facets, Smoothing smoothing, double corner,
                        const Places<D>& positions);

/// The vertices at the corners of each patch.
std::vector<std::vector<int>> corners_of(const Surface<3>& patches);

/// How far a place is beyond an edge of a patch, in its coordinates; negative inside.
inline double beyond_edge(const Patch<2>&, int end, const Vec<double, 2>& at) { return end == 1 ? at[0] - 1 : -at[0]; }
template <class At>
auto beyond_edge(const Patch<3>& patch, int edge, const At& at) {
  using T = typename At::Scalar;
  if (edge == 0) return T(-at[1]);
  if (edge == patch.corners - 1) return T(-at[0]);
  return T((patch.corners == 3 ? T(at[0] + at[1]) : at[edge - 1]) - T(1));
}

/// Whether a place is beyond a border of the surface by more than `by`.
template <int D>
bool is_past_border(const Patch<D>& patch, const Vec<double, 2>& at, double by) {
  for (int k = 0; k < patch.corners; ++k)
    if (patch.across[k] == no_patch && beyond_edge(patch, k, at) > by) return true;
  return false;
}

/// Whether a place is beyond an edge behind which the surface goes on smoothly, by more than `by`. Smooth weights mean
/// nothing there: the place is on another patch, or on none, as past a corner of the border.
template <int D>
bool is_past_joint(const Patch<D>& patch, const Vec<double, 2>& at, double by) {
  for (int k = 0; k < patch.corners; ++k)
    if (patch.goes_on(k) && beyond_edge(patch, k, at) > by) return true;
  return false;
}

/// What a contact point faces: a place on a surface, or segments of a curve.
struct Facing {
  /// Coordinates on a patch; not aligned, so that no room is lost around them.
  using Coordinates = Eigen::Matrix<double, 2, 1, Eigen::DontAlign>;
  int patch = no_patch;                  ///< no_patch: the point faces nothing of the surface
  Coordinates at = Coordinates::Zero();  ///< of the foot on the patch; in the plane xi and 0
  int ends = 0;                          ///< in space: bit k: the foot is beyond edge k, where the surface ends and is
                                         ///< rounded off (past_end.hpp)
  double distance = 0;                   ///< where nothing is faced: to the nearest facet, length
  int nearest = no_patch;                ///< where nothing is faced: the patch of the nearest facet
  /// Segment-integrated contact: the segments. `patch` is then the origin of arc lengths along the curve.
  std::vector<Segment> pieces = {};
  std::vector<int> nodes = {};  ///< of the slave facets and of these segments, in the order of the weights
  friend bool operator==(const Facing&, const Facing&) = default;
};

/// A place of a patch from which the feet of a point on it are measured.
struct FootReference {
  Vec<double, 2> at = Vec<double, 2>::Zero();
  bool is_start = false;  ///< it is where the point was at the start
};

/// A place of a patch, `at` + `rest`. It is measured from a reference, so that small motions have their digits however
/// far from the origin the surface is. In the plane `at` is the reference. In space `at` is the place in double, and
/// the rest is rounding that carries derivatives.
template <class T, int D>
struct SurfacePlace {
  const Patch<D>* patch = nullptr;
  FootReference reference = {};
  Vec<double, 2> at = Vec<double, 2>::Zero();
  Vec<T, D - 1> rest = Vec<T, D - 1>::Constant(T(0));

  /// The place that is `way` from a reference.
  static SurfacePlace behind(const Patch<D>& patch, const FootReference& reference, const Vec<T, D - 1>& way) {
    SurfacePlace place{&patch, reference, reference.at, way};
    if constexpr (D == 3) {
      place.at += values(way);
      for (int i = 0; i < 2; ++i) place.rest[i] -= T(place.at[i] - reference.at[i]);
    }
    return place;
  }
  /// In the plane: xi.
  T coordinate() const { return T(at[0]) + rest[0]; }
  /// The way from the reference.
  Vec<T, D - 1> way() const {
    if constexpr (D == 2)
      return rest;
    else
      return {T(at[0] - reference.at[0]) + rest[0], T(at[1] - reference.at[1]) + rest[1]};
  }
};

/// A patch around a place, as far as its motion is to be followed: foot_in_plane.hpp, foot_in_space.hpp.
template <class T, int D>
struct PatchAround;

/// The foot of a point on a patch.
template <class T, int D>
struct SurfaceFoot {
  SurfacePlace<T, D> place;
  T gap{};           ///< distance along the normal, length, negative inside
  Vec<T, D> normal;  ///< unit, out of the solid
  std::conditional_t<D == 2, std::array<T, 4>, Vector<T>> weights;  ///< N_i, as Patch::vertices
  PatchAround<T, D> around;
};

/// Weights of the displacements in w: 1 for the slave node, then -N_i for each vertex of the patch. On a rigid surface:
/// 1 alone.
template <class T, int D>
auto foot_weights(const SurfaceFoot<T, D>& foot, bool is_rigid) {
  const auto& vertices = foot.place.patch->vertices;
  const auto missing = std::count(vertices.begin(), vertices.end(), no_vertex);
  decltype(PointGeometry<T>::weights) weights(is_rigid ? 1 : 1 + static_cast<Eigen::Index>(vertices.size()) - missing);
  weights[0] = T(1);
  Eigen::Index k = 0;
  for (std::size_t i = 0; i < vertices.size() && !is_rigid; ++i)
    if (vertices[i] != no_vertex) weights[++k] = -foot.weights[i];
  return weights;
}

}  // namespace stickslip
