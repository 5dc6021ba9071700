/// Pairing: which slave node is a contact point, and what it faces at the start. At small strain this is final.
#pragma once

#include "core/model/model.hpp"

namespace stickslip {

/// Adds the contact points of all contacts, numbers their multipliers and sets the effects that they bring. `points`:
/// initial nodal positions, D x nodes, length. pre: the bodies have meshes. Throws ModelError if a contact is of a kind
/// that does not exist, or if all places of an obstacle are equally near to a slave node.
void pair_contacts(Model& model, const Points<double>& points);

/// A side without what lies on the axis of revolution, which is inside of the body: without the facets there, and the
/// nodes that have no other.
SideSet surface_of(const Model& model, const Points<double>& points, SideSet side);

/// Slave nodes of a contact that are no contact points because they have no tributary area: nodes of quadratic elements
/// on the axis of revolution. Ascending.
std::vector<int> nodes_without_area(const Model& model, const Points<double>& points, int contact);

}  // namespace stickslip
