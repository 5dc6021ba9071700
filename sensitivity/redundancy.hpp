/// Redundancy: whether the closed constraints of a state repeat one another. It depends on nodes and supports alone.
///
/// The tangent of a solution with multipliers is singular for one of two reasons. If constraints repeat one another, as
/// those of a node in two contacts, their forces are not unique, but displacements have derivatives. If not, the
/// equilibrium is about to become unstable, as at the critical friction coefficient, and nothing has a derivative.
#pragma once

#include <vector>

#include "core/model/contact_assembly.hpp"

namespace stickslip {

/// Whether the normal rows of closed points and the tangential rows of sticking points are linearly dependent on the
/// free dofs. `decided`: per multiplier, whether supports decide it, so that its row is left out; may be empty.
bool constraints_repeat(const Model& model, const Slots<double>& slots, const ContactField<double>& field,
                        const std::vector<char>& decided);

}  // namespace stickslip
