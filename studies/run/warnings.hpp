/// What a user should know of a result beside its status: effects that the scene leaves out and that its own solution
/// shows to matter, discretisations that this solution is not to be trusted on, and steps that are not those that were
/// asked for.
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <vector>

#include "core/model/warning.hpp"
#include "studies/run/case.hpp"

namespace stickslip {

/// The warnings of a run, each with its body or contact and the measured value, largest over the steps
/// (docs/results.md):
///   large_strain, large_rotation   above 5 % or 5 degrees in an element
///   large_sliding  slip of a closed point along a master that is deformable or curved, above half a slave element
///   idle_friction  none of the points of a contact with friction has slipped in any step
///   held_on_facet  closed points beyond the end of their facet, at a vertex of which neither has an equilibrium
///   cut_steps      with friction: steps that were taken in smaller ones, which is another discrete path
///   locking        Q4 or T3, nu near 1/2: pressures that differ within and between elements as no smooth field does
///   single_node    a side of several nodes one of which carries nearly all of the contact's force
///   shared_place   a response at a point that several bodies hold, and that names none of them
///   non_unique     a body that nothing holds and no load moves; increments with several solutions, or tangents of
///                  problems of which some have several
///   path_goes_on   a path by arc length used its steps up before it came to the full load
///   branch_ends    where solutions were counted: the one that leads on from the last increment ceases to be
/// Empty where nothing of it is found, and where nothing converged.
std::vector<Warning> warnings_of(const CaseResult& result);

BodyMeasures measures_of_body(const Problem& problem, const State<double>& state, std::size_t body);

/// [{"code", "where", "value", "remedy", "text"}].
nlohmann::json warnings_json(const CaseResult& result);

/// A body that no support holds and no contact point touches: nothing determines where it is. nullptr where all are
/// held.
const Body* loose_body(const Model& model);

/// What locking does to a body: the root mean square, over its volume, of the pressure that is left once the dilatation
/// has been averaged over the elements around each node, relative to that of the stress. 0 where the body is no Q4
/// without mean dilatation and no T3, or the space is plane stress.
double spurious_pressure(const Problem& problem, const State<double>& state, std::size_t body);

}  // namespace stickslip
