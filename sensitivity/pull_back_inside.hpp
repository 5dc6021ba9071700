/// What an adjoint leaves to be done inside the bodies, for many increments together: a inside, out of its values at
/// the contact in one solve; what it weighs of the loads there and of the motion that is prescribed; and the bodies'
/// share of the gradient, sum of a . df(u)/dslots, f the bodies' forces, in one visit of each element.
#pragma once

#include "core/model/storage.hpp"
#include "sensitivity/pull_back.hpp"

namespace stickslip {

/// Does what waits inside the bodies. What these remember adds to the derivatives by history.
void pull_back_inside(AdjointProblem& problem);

}  // namespace stickslip
