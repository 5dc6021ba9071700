/// Warnings of solutions that are not the only one, or not the exact one.
///
///   non_unique    a body that nothing holds and no load moves; bars that begin as a mechanism; increments with several
///                 solutions, or with tangents that allow several; contacts whose forces are undetermined; points on a
///                 vertex
///   branch_ends   where solutions were counted: the branch from the last increment ends
///   unstable      steps whose equilibrium is unstable
///   folded_element  elements that are folded where no integration point sees it
///   soft_penalty  springs of a penalty that yield by more than 2 % of what the bodies do, under all of a contact's
///                 force or under the share of it that its slave alone distributes
#pragma once

#include <vector>

#include "core/model/warning.hpp"
#include "studies/run/case.hpp"

namespace stickslip {

void add_solution_warnings(const CaseResult& result, std::vector<Warning>& warnings);

/// A body without supports and contact points, whose position is undetermined; nullptr: there is none.
const Body* loose_body(const Model& model);

}  // namespace stickslip
