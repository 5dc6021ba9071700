/// Pairing: which slave node is a contact point, and what it faces at the start. At small strain this is final.
#pragma once

#include "core/model/model.hpp"

namespace stickslip {

/// Adds the contact points of all contacts, numbers their multipliers and sets the effects that they bring. `points`:
/// initial nodal positions, D x nodes, length. pre: the bodies have meshes. Throws ModelError if a contact is of a kind
/// that does not exist, or if all places of an obstacle are equally near to a slave node.
void pair_contacts(Model& model, const Points<double>& points);

}  // namespace stickslip
