/// Whether the closed constraints of a state repeat one another: a question of nodes and supports alone.
///
/// The tangent of a solution with multipliers is singular for two reasons. Where constraints repeat one another, as of
/// a node in two contacts, their forces are not unique, and displacements have derivatives all the same. Where they do
/// not, the state is about to lose its balance, as at the critical friction coefficient: nothing has a derivative
/// there.
#pragma once

#include <vector>

#include "core/model/contact_assembly.hpp"

namespace stickslip {

/// True where the rows of closed points, and of the sticking ones along their tangents, depend on one another on the
/// free dofs. `decided`: multipliers that supports decide, which do not count; may be empty.
bool constraints_repeat(const Model& model, const Slots<double>& slots, const ContactField<double>& field,
                        const std::vector<char>& decided);

}  // namespace stickslip
