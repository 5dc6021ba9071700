/// Obstacles that are turned inside out: points of a polyline in the wrong order, facets or normals that point into the
/// solid.
#pragma once

#include <optional>

#include "core/model/warning.hpp"
#include "studies/run/case.hpp"

namespace stickslip {

/// The warning where an obstacle, or the slave, cannot be what the contact means; none: it can. The solid of the
/// obstacle is where the slave is: no outward normal of the slave is against its own, or a closed slave is inside of it
/// as a whole. If the slave's body is outside of the solid, the slave is the far side of its body.
std::optional<Warning> turned_surface(const Problem& problem, int contact);

}  // namespace stickslip
