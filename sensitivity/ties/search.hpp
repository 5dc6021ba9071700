/// Search for the choices that an increment takes at its ties (sensitivity/ties/tie.hpp), for a derivative on one side
/// of a parameter.
#pragma once

#include "sensitivity/differentiation.hpp"

namespace stickslip {

/// Side of a one-sided derivative, and its scales.
struct SideDirection {
  double side;            ///< s: -1 or 1
  double parameter;       ///< size of the parameter; 0: not known
  double largest_so_far;  ///< traction_scale() of the run so far
};

/// What becomes of an increment whose choices no derivative confirms.
enum class Unconfirmed {
  fails,  ///< it has no derivative
  holds,  ///< it has that of the choices that hold most
};

/// Differentiates one increment on one side of a parameter, the first direction of the first block, with the choices
/// that the derivative confirms. They are written into the increment. False if it has no derivative.
bool differentiate_side(Differentiation& problem, const State<double>& previous, Increment<double>& increment,
                        const SideDirection& along, Unconfirmed unconfirmed = Unconfirmed::fails);

}  // namespace stickslip
