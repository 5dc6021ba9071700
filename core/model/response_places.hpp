/// Where responses are taken: nodes, bodies, contacts and points, resolved once for a model.
#pragma once

#include "core/model/model.hpp"

namespace stickslip {

/// Resolves what a response is taken of. `points`: initial nodal coordinates, D x nodes. Throws ModelError if it names
/// what is not there.
ResponsePlace place_of(const Model& model, const Points<double>& points, const Response& response);

/// Elements that have a node of a side whose reaction is a response, per body; empty if none is.
ElementLists elements_at_reactions(const Model& model);

}  // namespace stickslip
