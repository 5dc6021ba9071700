/// Quadratic meshes, made of linear ones by a node in the middle of each edge.
#pragma once

#include "core/mesh/mesh.hpp"

namespace stickslip {

/// The mesh of six-node triangles or eight-node quadrilaterals on the corners of a mesh of three-node triangles or
/// four-node quadrilaterals: the same nodes, then the middles, in the order in which the elements name their edges.
/// Sides get the middles of their facets.
Mesh with_middles(const Mesh& linear);

/// Coordinates of all nodes, of those of the corners; a middle lies half-way between the ends of its edge.
template <class T>
Points<T> with_middles(const Mesh& quadratic, const Points<T>& corners) {
  Points<T> points(corners.rows(), quadratic.node_count);
  points.leftCols(corners.cols()) = corners;
  for (std::size_t k = 0; k < quadratic.middles.size(); ++k) {
    const auto [a, b] = quadratic.middles[k];
    for (int i = 0; i < corners.rows(); ++i)
      points(i, corners.cols() + static_cast<Eigen::Index>(k)) = T(0.5) * (corners(i, a) + corners(i, b));
  }
  return points;
}

}  // namespace stickslip
