/// Shape functions, Gauss points and the areas of edges (core/README.md, Elements, Shares). Corners come first, then
/// the middles of the sides in turn, counter-clockwise. A square is [-1, 1]^2, a triangle r, s >= 0, r + s <= 1.
#pragma once

#include "studies/verify/scene.hpp"

namespace stickslip::verify {

Places natural_nodes(const Body& body);  ///< r, s of each node of an element

/// Shape functions N at a place: the polynomials that are 1 at their node and 0 at the others; their gradients by r, s.
struct Shape {
  Eigen::VectorXd value;
  Eigen::MatrixX2d gradient;
};
Shape shape(const Body& body, const Vec2& at);

/// A Gauss point of an element, with gradients by coordinates of the start.
struct Point : Shape {
  double radius, volume;
};
std::vector<Point> points_of(const Scene& scene, const Body& body, const Nodes& element);

/// A Gauss point of an edge: weight, place from its first end to its second, shape functions and their slopes.
struct EdgePoint {
  double weight, s;
  Vec3 value, slope;
};
std::vector<EdgePoint> edge_points(std::size_t nodes, bool of_revolution);

/// Areas of the start that belong to the nodes of a side: int N dA.
std::map<int, double> areas_of(const Scene& scene, const Body& body, const Side& side);

}  // namespace stickslip::verify
