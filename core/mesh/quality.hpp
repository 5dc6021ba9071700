/// Whether the elements of a mesh are usable where they lie, and whether they hold together.
#pragma once

#include <optional>
#include <utility>

#include "core/mesh/mesh.hpp"

namespace stickslip {

/// Number of the first element with a corner that is not convex (Jacobian there zero, negative or not a number; of a
/// quadratic element in space also at its other nodes and in its quadrature), or with zero length for a bar; none if
/// all are usable. A corner counts as flat when its sine is within rounding of zero. A point is always usable.
std::optional<int> first_inverted_element(const Mesh&, const Points<double>&);

/// A node in the middle of an edge that folds its element, whose corners alone are sound.
struct StrayMiddle {
  int node = 0;      ///< of the mesh
  double share = 0;  ///< of the edge's length: how far the node is from the middle of its ends
};

/// Of an element that is not usable the node in the middle of an edge that lies furthest from where it should, if the
/// element with its corners alone would be usable.
std::optional<StrayMiddle> stray_middle(const Mesh&, const Points<double>&, int element);

/// Largest relative rounding of a strain: four digits, as many as a run that passes as solved has at least
/// (most_rounding of studies/run/accuracy.hpp).
inline constexpr double most_strain_rounding = 1e-4;

struct ThinElement {
  int element = 0;
  double thickness = 0, size = 0;  ///< lengths: of the element; of its body, or of its distance from the origin
};

/// The first element that is too thin for its strain to have digits; none if all are usable. The strain is a difference
/// of displacements over the thickness of the element, and displacements and coordinates round by 1e-16 of the size of
/// the body, or of its distance from the origin.
std::optional<ThinElement> first_thin_element(const Mesh&, const Points<double>&);

/// Two nodes that are nearer to one another than a millionth of the shortest edge of the elements, if there are any.
/// What a mesh generator computes twice differs by its rounding, 1e-11 and less; no mesh has edges as short as that.
std::optional<std::pair<int, int>> nodes_at_one_place(const Mesh&, const Points<double>&);

/// Number of parts of a mesh that share no node with one another.
int count_of_parts(const Mesh&);

}  // namespace stickslip
