/// Obstacles as lines with their displacement, for VTU files.
#pragma once

#include "studies/io/vtu.hpp"
#include "studies/run/case.hpp"

namespace stickslip {

/// The obstacles of a plane scene as lines at the start, with what they moved by until `time` as point field
/// `displacement`, length, and their number as cell field `obstacle`.
VtuData obstacle_fields(const Problem& problem, double time);

}  // namespace stickslip
