/// Whether the elements of a mesh are usable where they lie.
#pragma once

#include <optional>

#include "core/mesh/mesh.hpp"

namespace stickslip {

/// Number of the first element with a corner that is not convex (Jacobian there zero, negative or not a number), or
/// with zero length for a bar; none if all are usable. A corner counts as flat when its sine is within rounding of
/// zero. A point is always usable.
std::optional<int> first_inverted_element(const Mesh&, const Points<double>&);

}  // namespace stickslip
