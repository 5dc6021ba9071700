/// Amounts that the ledger of a run and its forecast share.
#pragma once

#include "studies/run/ledger.hpp"

namespace stickslip {

/// Bytes of connectivity, sides and numbering.
double mesh_bytes(const Model& model);
/// Bytes of the contact points and of their slots.
double point_bytes(const Model& model, const Slots<double>& slots);
double element_count(const Model& model);
/// Which bodies are condensed: none, the condensable ones of a mixed scene, or all.
enum class Condensed { nothing, part, all };
/// Number of displacements in the systems of an engine.
double solved_displacements(const Model& model, Condensed condensed);

/// Number of nodes of deformable masters, and bytes that contact points store for them (weight, node, index).
struct Masters {
  double nodes = 0, bytes = 0;
};
Masters masters_of(const Model& model);

}  // namespace stickslip
