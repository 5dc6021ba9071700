/// Which slave node faces what: the contact points of a model, fixed for small strain.
#pragma once

#include "core/model/model.hpp"

namespace stickslip {

/// Adds the contact points of all contacts, numbers their multipliers and sets the effects they bring. `points`: nodal
/// coordinates, D x nodes. pre: bodies are meshed. Throws ModelError where a contact is not of a kind there is, or a
/// slave node lies where no place of its obstacle is nearer than another.
void pair_contacts(Model& model, const Points<double>& points);

}  // namespace stickslip
