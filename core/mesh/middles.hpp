/// Quadratic meshes, made of linear ones by a node in the middle of each edge, and for some of each face and element.
#pragma once

#include "core/mesh/mesh.hpp"

namespace stickslip {

/// The mesh of quadratic elements of a shape on the corners of a mesh of linear ones: the same nodes, then the middles
/// of edges, in the order in which the elements name them, then those of faces and elements, likewise. Sides get the
/// middles of their facets.
Mesh with_middles(const Mesh& linear, ElementShape);

/// Puts the nodes in the middle of faces and elements where the element without them has that place: -1/4 of the
/// corners and 1/2 of a face's middles, 1/4 of a hexahedron's.
template <class T>
void place_centres(const Mesh& mesh, Points<T>& points) {
  int node = mesh.node_count - static_cast<int>(mesh.centres.size());
  for (const auto& around : mesh.centres) {
    const std::size_t corners = around.size() == 8 ? 4 : 8;
    const double share = around.size() == 8 ? 0.5 : 0.25;
    for (int i = 0; i < points.rows(); ++i) {
      T place = T(0);
      for (std::size_t k = 0; k < around.size(); ++k) place += T(k < corners ? -0.25 : share) * points(i, around[k]);
      points(i, node) = place;
    }
    ++node;
  }
}

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
  place_centres(quadratic, points);
  return points;
}

}  // namespace stickslip
