/// What the ledger of a run and its forecast both look up in the model.
#pragma once

#include "studies/run/ledger.hpp"

namespace stickslip {

/// Bytes of connectivity, sides and numbering.
double mesh_bytes(const Model& model);
/// Bytes of the contact points and of their slots.
double point_bytes(const Model& model, const Slots<double>& slots);
double element_count(const Model& model);
/// What of the bodies is condensed: nothing, what can be of a mixed scene, or all.
enum class Condensed { nothing, part, all };
/// Displacements in the systems that an engine solves.
double solved_displacements(const Model& model, Condensed condensed);

/// Nodes of deformable masters, and bytes that the contact points keep of them: weight, node and its place.
struct Masters {
  double nodes = 0, bytes = 0;
};
Masters masters_of(const Model& model);

}  // namespace stickslip
