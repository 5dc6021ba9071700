/// Rigid surfaces that are made of facets, along which points slide as along a side of a body. Each has, beside its
/// description,
///
///   vertices_of()   of (surface, numbers): positions of its vertices at the start, D x vertices, length, in the scalar
///                   of the numbers
///   facets_of()     the vertices of each facet: in the plane two, the solid on the left of the way from one to the
///                   other; in space three or four, counter-clockwise seen from outside
#pragma once

#include <array>
#include <string>
#include <vector>

#include "core/algebra/number.hpp"
#include "core/mesh/generators.hpp"

namespace stickslip {

/// Curve from point to point, the solid on its right. `closed`: the last point is the first again.
struct Polyline {
  static constexpr bool is_in_plane = true, is_in_space = false, is_flat = false, has_facets = true;
  static constexpr const char* if_turned = "turn the points of the polyline round: its solid is on their right";
  std::vector<std::array<Number, 2>> points;  ///< without the repeated one
  bool closed = false;
};

/// Triangles and quadrilaterals of a file, the solid behind them.
struct RigidFacets {
  static constexpr bool is_in_plane = false, is_in_space = true, is_flat = false, has_facets = true;
  static constexpr const char* if_turned = "turn the facets of its file round: its solid is behind them";
  Eigen::Matrix3Xd vertices;             ///< length
  std::vector<std::vector<int>> facets;  ///< three or four vertices each, counter-clockwise seen from outside
};

/// A side of a mesh that is held rigid. The solid is that of the mesh; a curve or surface that is on no body has it
/// behind its facets.
struct MeshSide {
  static constexpr bool is_in_plane = true, is_in_space = true, is_flat = false, has_facets = true;
  static constexpr const char* if_turned =
      "take another side of its mesh, or turn the facets of its file round: the solid is that of the mesh, or behind "
      "them";
  MeshDescription description;
  Mesh mesh;                             ///< made of the description
  std::vector<int> nodes;                ///< of the mesh, by vertex
  std::vector<std::vector<int>> facets;  ///< by vertices

  /// `side`: an expression without a body's name (evaluate_side()). Throws std::invalid_argument if there is no such
  /// side, or if it has no facets.
  MeshSide(MeshDescription description, Mesh mesh, const std::string& side);
};

template <class T>
Points<T> vertices_of(const Polyline& polyline, const Numbers<T>& numbers) {
  Points<T> vertices(2, static_cast<Eigen::Index>(polyline.points.size()));
  for (Eigen::Index v = 0; v < vertices.cols(); ++v)
    for (int i = 0; i < 2; ++i) vertices(i, v) = numbers(polyline.points[v][i]);
  return vertices;
}

template <class T>
Points<T> vertices_of(const RigidFacets& surface, const Numbers<T>&) {
  return surface.vertices.template cast<T>();
}

template <class T>
Points<T> vertices_of(const MeshSide& side, const Numbers<T>& numbers) {
  return make_points<T>(side.description, side.mesh, numbers)(Eigen::all, side.nodes);
}

std::vector<std::vector<int>> facets_of(const Polyline&);
inline const std::vector<std::vector<int>>& facets_of(const RigidFacets& surface) { return surface.facets; }
inline const std::vector<std::vector<int>>& facets_of(const MeshSide& side) { return side.facets; }

}  // namespace stickslip
