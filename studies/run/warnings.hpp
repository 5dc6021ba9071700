/// Warnings of a result beside its status: effects that the scene leaves out although its solution shows that they
/// matter, discretisations that are not reliable for this solution, and steps that differ from those asked for.
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <span>
#include <vector>

#include "core/model/warning.hpp"
#include "studies/run/case.hpp"

namespace stickslip {

/// The warnings of a run, each with its body or contact and the measured value, largest over the steps
/// (docs/results.md):
///   large_strain, large_rotation   above 5 % or 5 degrees in an element
///   large_sliding  slip of a closed point along a master that is deformable or curved, above half a slave element
///   idle_friction  none of the points of a contact with friction has slipped in any step
///   held_on_facet  closed points beyond the end of their facet, at a vertex where neither facet has an equilibrium
///   cut_steps      with friction: steps that were cut, which gives another discrete path
///   locking        Q4 or T3, nu near 1/2: pressures that oscillate within and between elements
///   shear_locking  Q4 or T3, one element thick, that bend: a shear that varies within elements
///   floating_body  a body that nothing which presses holds at the end of a step
///   (of contacts: studies/run/contact_warnings.hpp)
///   single_node    a side of several nodes, one of which carries nearly all of the contact force
///   shared_place   a response at a point that belongs to several bodies, and names none of them
///   soft_penalty   springs of a penalty that yield by more than 2 % of what the bodies do, under all of a contact's
///                  force or under the share of it that its slave alone distributes
///   non_unique     a body that nothing holds and no load moves; increments with several solutions, or with tangents
///                  that allow several; contacts whose forces are undetermined; points on a vertex
///   path_goes_on   a path by arc length used up its steps before the full load
///   branch_ends    where solutions were counted: the branch from the last increment ends
/// Empty if there is none, or if nothing converged.
std::vector<Warning> warnings_of(const CaseResult& result);

/// The steps that were solved: all of a run, or of one that failed those before.
std::span<const StepResult> solved_steps(const CaseResult& result);

BodyMeasures measures_of_body(const Problem& problem, const State<double>& state, std::size_t body);

/// [{"code", "where", "value", "remedy", "text"}].
nlohmann::json warnings_json(const CaseResult& result);

/// A body without supports and contact points, whose position is undetermined; nullptr: there is none.
const Body* loose_body(const Model& model);

/// Measure of locking of a body: root mean square over its volume of the pressure that remains after the dilatation is
/// averaged over the elements around each node, over that of the stress. 0 unless the body is of Q4 without mean
/// dilatation or of T3; 0 in plane stress.
double spurious_pressure(const Problem& problem, const State<double>& state, std::size_t body);

/// Measure of shear locking of a body of Q4 or T3 that is one element thick: the share, in the squared strain of the
/// body, of shears along and across it that vary within elements or from each to those around it. Bending makes them
/// where an element has no curvature: a third in squares, more in longer elements. 0 for other bodies.
double parasitic_shear(const Problem& problem, const State<double>& state, std::size_t body);

}  // namespace stickslip
