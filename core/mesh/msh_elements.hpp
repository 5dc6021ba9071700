/// Elements of an imported body: which way round they are, their sides, and the sides of the body that these make.
#pragma once

#include <array>
#include <vector>

#include "core/mesh/mesh.hpp"

namespace stickslip {

/// Positive where an element is counter-clockwise, in space right-handed, by its corners: twice its area; in space
/// the determinant of the edges of a tetrahedron, or of the middle lines of a hexahedron, times 64.
double orientation(const Mesh&, const Points<double>&, int element);

/// Turns an element over: its mirror image.
void turn_over(Mesh&, int element);

/// A side of an element of dimension `of` as its nodes, -1 for those that it lacks. Two are the same side, in the same
/// direction, if they are equal.
///   of = 1: a node
///   of = 2: an edge from its start to its end, the element on its left, and its middle
///   of = 3: a face, counter-clockwise seen from outside of the element: its corners, the least node first, and its
///           middles, as in sides_of
using ElementFacet = std::array<int, 9>;

/// Of its nodes in turn, nine at most.
ElementFacet element_facet(const std::vector<int>& nodes, int of);
/// The nodes of a side.
std::vector<int> nodes_of(const ElementFacet&);
/// Of an edge its ends alone, of a face its corners.
ElementFacet without_middles(const ElementFacet&, int of);
/// The same side seen from the other element that has it.
ElementFacet turned(const ElementFacet&, int of);
/// The sides of an element of a mesh, in the order of sides_of.
std::vector<ElementFacet> facets_of_element(const Mesh&, int element);

/// Edges in order: each piece from its beginning (the node no edge leads to; a closed one from the first given). Nodes
/// and faces in the order given, the nodes of faces ascending.
Side side_of_facets(const std::vector<ElementFacet>&, int of);

}  // namespace stickslip
