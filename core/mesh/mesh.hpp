/// Mesh of one body: what does not depend on numbers (connectivity, sides), apart from what does (coordinates, which
/// a generator evaluates in any scalar, so that the derivative with respect to a dimension is exact).
#pragma once

#include <map>
#include <string>
#include <vector>

#include "core/algebra/scalar.hpp"

namespace stickslip {

enum class ElementShape { point, bar2, tri3, quad4 };

/// Nodes of one element of the shape.
int nodes_of(ElementShape);

/// Whether elements of the shape fill a region (springs and bars do not).
inline bool is_continuum(ElementShape shape) { return shape == ElementShape::tri3 || shape == ElementShape::quad4; }

/// Named part of the boundary: nodes in order along the side where it is a curve, and its facets (2D: node pairs)
/// directed so that the solid lies on the LEFT of a -> b (counter-clockwise boundary); facets may be empty
/// (a corner, a point).
struct Side {
  std::vector<int> nodes;
  std::vector<std::vector<int>> facets;
};

struct Mesh {
  int dimension = 2;  ///< of the space the nodes live in
  int node_count = 0;
  ElementShape shape = ElementShape::quad4;
  std::vector<int> connectivity;  ///< nodes_of(shape) per element; counter-clockwise in 2D
  std::map<std::string, Side> sides;
  int element_count() const { return static_cast<int>(connectivity.size()) / nodes_of(shape); }
};

/// Coordinates, one column per node.
template <class T>
using Points = Eigen::Matrix<T, Eigen::Dynamic, Eigen::Dynamic>;

}  // namespace stickslip
