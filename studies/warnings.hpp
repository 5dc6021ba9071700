/// What a user should know of a result beside its status: effects that the scene leaves out and that its own solution
/// shows to matter, and steps that are not those that were asked for.
#pragma once

#include <string>
#include <vector>

#include "studies/case.hpp"

namespace stickslip {

/// A sentence each, with the contact or body and the measured value, largest over the steps:
///   small strain   strain above 5 % or rotation above 5 degrees in an element
///   fixed geometry slip of a closed point along a master that is deformable or curved, above half a slave element
///   friction       none of the points of a contact with friction has slipped in any step
///   cut steps      with friction: steps that were taken in smaller ones, which is another discrete path
/// Empty where nothing of it is found, and where nothing converged.
std::vector<std::string> warnings_of(const CaseResult& result);

}  // namespace stickslip
