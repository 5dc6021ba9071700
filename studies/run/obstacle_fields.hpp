/// Obstacles with their displacement, for VTU files.
#pragma once

#include "studies/io/vtu.hpp"
#include "studies/run/case.hpp"

namespace stickslip {

/// Whether there are any: obstacles of the plane; in space those that have facets.
bool has_obstacle_fields(const Model& model);

/// The obstacles of a plane scene as lines at the start, in space their facets; with what they moved by until `time` as
/// point field `displacement`, length, and their number as cell field `obstacle`.
VtuData obstacle_fields(const Problem& problem, double time);

}  // namespace stickslip
