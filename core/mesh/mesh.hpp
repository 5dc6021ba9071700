/// Mesh of one body: what does not depend on numbers (connectivity, sides), apart from what does (coordinates, which
/// a generator evaluates in any scalar, so that the derivative with respect to a dimension is exact).
#pragma once

#include <array>
#include <map>
#include <string>
#include <vector>

#include "core/algebra/scalar.hpp"

namespace stickslip {

enum class ElementShape { point, bar2, tri3, quad4, tri6, quad8 };

/// What a mesh is made of.
enum class Filling { point, bars, continuum };

/// Nodes of one element of the shape: corners first, then the middles of the sides in turn.
int nodes_of(ElementShape);
/// Corners of a plane element; nodes of the others.
int corners_of(ElementShape);
/// Whether elements of the shape fill a region (springs and bars do not).
bool is_continuum(ElementShape);
/// Whether its sides have nodes in the middle.
bool is_quadratic(ElementShape);

/// Named part of the boundary: nodes in order along the side where it is a curve, and its facets (2D: node pairs)
/// directed so that the solid lies on the LEFT of a -> b (counter-clockwise boundary); facets may be empty
/// (a corner, a point). Sides of quadratic elements are two facets each, and are listed whole in `quadratic`.
struct Side {
  std::vector<int> nodes;
  std::vector<std::vector<int>> facets;
  std::vector<std::vector<int>> quadratic = {};  ///< start, end, middle
  /// Sides of elements, over which loads and areas are integrated.
  const std::vector<std::vector<int>>& edges() const { return quadratic.empty() ? facets : quadratic; }
};

struct Mesh {
  int dimension = 2;  ///< of the space the nodes live in
  int node_count = 0;
  ElementShape shape = ElementShape::quad4;
  std::vector<int> connectivity;  ///< nodes_of(shape) per element; counter-clockwise in 2D
  std::map<std::string, Side> sides;
  /// Of a generated quadratic mesh: the two ends of the edge that each node after the corners halves.
  std::vector<std::array<int, 2>> middles;
  int element_count() const { return static_cast<int>(connectivity.size()) / nodes_of(shape); }
};

/// Coordinates, one column per node.
template <class T>
using Points = Eigen::Matrix<T, Eigen::Dynamic, Eigen::Dynamic>;

}  // namespace stickslip
