/// Mesh of one body: what does not depend on numbers (connectivity, sides), apart from what does (coordinates, which
/// a generator evaluates in any scalar, so that the derivative with respect to a dimension is exact).
#pragma once

#include <array>
#include <map>
#include <string>
#include <vector>

#include "core/algebra/scalar.hpp"

namespace stickslip {

enum class ElementShape { point, bar2, tri3, quad4, tri6, quad8, tet4, hex8, tet10, hex20, hex27 };

/// The rounding of coordinates in a mesh file, as a share of a length, or as an angle. What differs by less counts as
/// equal. Example: a node at the end of its master, which projects past it by that much, still faces it.
inline constexpr double mesh_file_rounding = 1e-6;

/// What a mesh is made of.
enum class Filling { point, bars, continuum };

/// Nodes of one element of the shape: corners first, then the middles of the sides in turn; in space those of the
/// edges, then of the faces, then that of the element (core/mesh/shapes.hpp).
int nodes_of(ElementShape);
/// Corners of an element of a continuum; nodes of the others.
int corners_of(ElementShape);
/// Whether elements of the shape fill a region (springs and bars do not).
bool is_continuum(ElementShape);
/// Whether its sides have nodes in the middle.
bool is_quadratic(ElementShape);
/// Whether elements of the shape fill a region of space.
bool is_solid(ElementShape);
/// The sides of an element of a continuum: of each its nodes, counted within the element. In the plane its edges, start
/// and end (and middle), the element on their left; in space its faces, counter-clockwise seen from outside: corners,
/// middles of the edges in turn, and the one in the middle, as far as the element has them.
const std::vector<std::vector<int>>& sides_of(ElementShape);
/// Of each node of an element of a continuum the corners that it lies between: itself, or the ends of an edge, or the
/// corners of a face or of the element.
const std::vector<std::vector<int>>& corners_around(ElementShape);
/// The shape of an element with the same corners and no middles.
ElementShape linear_shape(ElementShape);

/// Corners of a face of an element in space, by the number of its nodes: three of 3 and 6, four of 4, 8 and 9.
constexpr int corners_of_face(std::size_t nodes) { return nodes == 3 || nodes == 6 ? 3 : 4; }
/// The facets of a side of a quadratic element. Of an edge two, from its middle to its ends. Of a face those that its
/// middles cut: four triangles of six nodes; four quadrilaterals of nine; of eight, which have no node in the middle, a
/// triangle at each corner and the quadrilateral of the middles. So the shares of all nodes are positive, as they are
/// of a whole face if it has nine nodes (core/README.md, Shares). A side without middles: itself.
std::vector<std::vector<int>> facets_of_side(const std::vector<int>& side, int dimension);

/// Named part of the boundary: its nodes, in order along the side where it is a curve, and its facets. In the plane a
/// facet is a pair of nodes, directed so that the solid lies on the LEFT of a -> b (counter-clockwise boundary); in
/// space it is a face of three or four nodes, counter-clockwise seen from outside. Facets may be empty (a corner, a
/// point). Sides of quadratic elements are several facets each (facets_of_side), and are listed whole in `quadratic`.
struct Side {
  std::vector<int> nodes;
  std::vector<std::vector<int>> facets;
  std::vector<std::vector<int>> quadratic = {};  ///< start, end, middle; in space as in sides_of
  /// Sides of elements, over which loads and areas are integrated.
  const std::vector<std::vector<int>>& edges() const { return quadratic.empty() ? facets : quadratic; }
};

struct Mesh {
  int dimension = 2;  ///< of the space the nodes live in
  int node_count = 0;
  ElementShape shape = ElementShape::quad4;
  /// nodes_of(shape) per element; counter-clockwise in the plane; in space as in core/mesh/shapes.hpp
  std::vector<int> connectivity;
  std::map<std::string, Side> sides;
  /// Of a generated quadratic mesh: the two ends of the edge that each node after the corners halves.
  std::vector<std::array<int, 2>> middles;
  /// Of the nodes after these, in the middle of faces and elements: the corners, then the middles of the edges.
  std::vector<std::vector<int>> centres = {};
  int element_count() const { return static_cast<int>(connectivity.size()) / nodes_of(shape); }
};

/// Coordinates, one column per node.
template <class T>
using Points = Eigen::Matrix<T, Eigen::Dynamic, Eigen::Dynamic>;

}  // namespace stickslip
