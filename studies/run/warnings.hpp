/// Warnings of a result beside its status: effects that the scene leaves out although its solution shows that they
/// matter, discretisations that are not reliable for this solution, and steps that differ from those asked for.
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <vector>

#include "core/model/warning.hpp"
#include "studies/run/case.hpp"

namespace stickslip {

/// The warnings of a run, each with its body or contact and the measured value, largest over the steps
/// (docs/results.md):
///
///   large_strain, large_rotation   above 5 % or 5 degrees in an element
///   large_sliding  slip of a closed point along a master that is deformable or curved, above half a slave element
///   idle_friction  none of the points of a contact with friction has slipped in any step
///   cut_steps      with friction: steps that were cut, which gives another discrete path
///   (of elements that lock: studies/run/locking_warnings.hpp)
///   floating_body  a body that nothing which presses holds at the end of a step
///   (of contacts: studies/run/contact_warnings.hpp)
///   single_node    a side of several nodes, one of which carries nearly all of the contact force
///   shared_place   a response at a point that belongs to several bodies, and names none of them
///   (of solutions that are not unique or not exact: studies/run/solution_warnings.hpp)
///   path_goes_on   a path by arc length used up its steps before the full load
///
/// Empty if there is none, or if nothing converged.
std::vector<Warning> warnings_of(const CaseResult& result);

/// A body that nothing which presses holds at the end of some steps.
struct FloatingBody {
  std::string name;
  int steps = 0;            ///< how many
  double first = 0;         ///< time of the first
  std::string motion = {};  ///< that it is free to make there, in words
};
std::vector<FloatingBody> bodies_that_float(const CaseResult& result);

/// How many of the solved steps have a mark of a contact.
long steps_with(const CaseResult& result, std::size_t contact, std::vector<char> StepResult::*marks);

BodyMeasures measures_of_body(const Problem& problem, const State<double>& state, std::size_t body);

/// [{"code", "where", "value", "remedy", "text"}]: those of contact at the start (studies/run/contact_start.hpp), then
/// warnings_of(). A value that is not finite is null.
nlohmann::json warnings_json(const CaseResult& result);

}  // namespace stickslip
