/// Sides by name and by set operations: "left" of a mesh, "boundary" all around a solid one; "block.left &
/// block.bottom" is the intersection of two sides (a corner); "block.bottom - block.right" leaves nodes out. Operations
/// apply from left to right.
#pragma once

#include <string>
#include <utility>
#include <vector>

#include "core/mesh/mesh.hpp"

namespace stickslip {

enum class SideOperation { intersect, leave_out };

/// "body.side", then any number of "& body.side" and "- body.side", all of one body.
struct SideExpression {
  std::string body;
  std::string side;
  std::vector<std::pair<SideOperation, std::string>> operations;  ///< with the side's name, without the body's
  std::string error;  ///< what is wrong, as a sentence without a full stop; empty: the rest is valid
};

/// The parsed expression. `&` and a `-` between spaces are operators (names may contain a hyphen); the first dot
/// separates body from side. Whether the names exist is not looked at: see side_error.
SideExpression parse_side_expression(const std::string&);

/// What is wrong with the expression on this mesh (its own error, else a side that does not exist, with the nearest
/// that does, else no node left), or "".
std::string side_error(const Mesh&, const SideExpression&);

/// The nodes the expression leaves, in the order of its first side, and the facets:
///   intersection: the facets common to both sides (none at a corner);
///   leaving out: the facets with a node that is left, so that each such node keeps its whole tributary area. A facet
///   may therefore end at a node that is not in `nodes`, and `nodes` decides who belongs to the side.
/// Throws std::invalid_argument with side_error.
Side evaluate_side(const Mesh&, const SideExpression&);

/// The same of a text whose sides stand without a body's name: "left & bottom".
Side evaluate_side(const Mesh&, const std::string& expression);

/// A side of an element: the element, and the nodes in the order of sides_of().
struct ElementSide {
  int element;
  std::vector<int> nodes;
};
/// All sides of elements of a continuum that only one element has, in the order of the elements.
std::vector<ElementSide> free_sides(const Mesh&);

/// The same as one side. In the plane one loop after another, the solid on their left; in space nodes ascending.
Side boundary_of(const Mesh&);

/// The candidate with the least edit distance to the name (the first of equals); "" if there is none.
std::string nearest_name(const std::string& name, const std::vector<std::string>& candidates);

}  // namespace stickslip
