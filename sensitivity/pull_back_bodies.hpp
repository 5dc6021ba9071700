/// The bodies' share of a gradient: sum over the increments of a . df(u)/dslots, f the bodies' forces; where these are
/// K u, for all increments in one visit of each element.
#pragma once

#include "core/algebra/reverse.hpp"
#include "core/model/slots.hpp"
#include "sensitivity/pull_back.hpp"

namespace stickslip {

/// Adds to each objective's derivatives by the entries of the tape, `Backward::by`, what its pairs (a, u) give. An
/// element of a continuum is differentiated forward by its own inputs (coordinates, law, thickness), which are few, and
/// the chain goes on from there; one of two nodes is recorded behind what `tape` holds, and taken off again.
void pull_back_bodies(const Model& model, const Slots<Reverse>& slots, Tape& tape, std::vector<Backward>& objectives);

}  // namespace stickslip
