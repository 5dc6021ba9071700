/// Shape functions, Gauss points and the areas of edges (core/README.md, Elements, Shares). Corners come first, then
/// the middles of the sides in turn, counter-clockwise.
#pragma once

#include "studies/verify/scene.hpp"

namespace stickslip::verify {

/// Shape functions at a place (r, s), and their gradients by these. A square is [-1, 1]^2, a triangle r, s, 1 - r - s.
struct Shape {
  Eigen::VectorXd value;
  Eigen::Matrix2Xd gradient;
};
Shape shape(const std::string& element, double r, double s);

/// A Gauss point of an element: shape functions, their gradients by coordinates of the start, radius and volume.
struct Point {
  Eigen::VectorXd value;
  Eigen::MatrixX2d gradient;
  double radius, volume;
};
std::vector<Point> points_of(const Scene& scene, const Body& body, const std::vector<int>& element);

/// Gauss points of an edge: weight, place from its first end to its second, shape functions and their slopes.
struct EdgePoint {
  double weight, s;
  std::array<double, 3> value, slope;
};
std::vector<EdgePoint> edge_points(std::size_t nodes, bool of_revolution);

/// Areas of the start that belong to the nodes of an edge: int N dA.
std::array<double, 3> edge_areas(const Scene& scene, const Body& body, const std::vector<int>& edge);

}  // namespace stickslip::verify
