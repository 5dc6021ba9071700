/// Volumes, areas and shapes of meshes in space.
#pragma once

#include <Eigen/Geometry>

#include "core/mesh/mesh.hpp"
#include "core/solids/continuum.hpp"
#include "core/solids/edges.hpp"
#include "tests/support/largest.hpp"

namespace stickslip {

inline double volume(const Mesh& mesh, const Points<double>& points) {
  double sum = 0;
  with_shape(mesh.shape, [&]<class Shape>(Shape) {
    if constexpr (Shape::dimension == 3)
      for (int e = 0; e < mesh.element_count(); ++e) {
        Nodal<double, Shape> X;
        for (int a = 0; a < Shape::nodes; ++a) X.col(a) = points.col(mesh.connectivity[e * Shape::nodes + a]);
        for (const auto& point : Shape::quadrature()) sum += Gradient<double, Shape>(point, X).volume;
      }
  });
  return sum;
}

/// Integral of the normal over a side, out of the body (length squared).
inline Vec<double, 3> vector_area(const Points<double>& points, const Side& side) {
  Vec<double, 3> sum = Vec<double, 3>::Zero();
  for (const auto& facet : side.facets)
    for_each_side_point(points, facet, Depth<double>{}, [&](const auto&, const auto& out, double) { sum += out; });
  return sum;
}

/// Integral of the length of the normal over a side (length squared).
inline double area(const Points<double>& points, const Side& side) {
  double sum = 0;
  for (const auto& facet : side.facets)
    for (const double share : side_shares(points, facet, Depth<double>{})) sum += share;
  return sum;
}

/// Least determinant of the three unit vectors along the edges at a corner, over the corners of all elements: 1 at a
/// right-angled one, 0 at a flat one, negative at one that is turned inside out.
inline double worst_corner_in_space(const Mesh& mesh, const Points<double>& points) {
  using Corners = std::vector<std::array<int, 3>>;
  static const Corners tetrahedron{{1, 2, 3}, {2, 0, 3}, {0, 1, 3}, {0, 2, 1}},
      hexahedron{{1, 3, 4}, {2, 0, 5}, {3, 1, 6}, {0, 2, 7}, {7, 5, 0}, {4, 6, 1}, {5, 7, 2}, {6, 4, 3}};
  const Corners& neighbours = linear_shape(mesh.shape) == ElementShape::tet4 ? tetrahedron : hexahedron;
  const int count = nodes_of(mesh.shape);
  double worst = 1;
  for (int e = 0; e < mesh.element_count(); ++e)
    for (int corner = 0; corner < corners_of(mesh.shape); ++corner) {
      const auto at = [&](int a) -> Vec<double, 3> { return points.col(mesh.connectivity[e * count + a]); };
      Mat<double, 3> edges;
      for (int k = 0; k < 3; ++k) edges.col(k) = (at(neighbours[corner][k]) - at(corner)).normalized();
      worst = smaller(worst, edges.determinant());
    }
  return worst;
}

}  // namespace stickslip
