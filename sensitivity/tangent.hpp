/// The factorised tangent of a converged increment: what direct and adjoint differentiation start from.
#pragma once

#include "core/model/engine.hpp"
#include "sensitivity/rays.hpp"

namespace stickslip {

/// Prepares the engine to solve with the tangent at a state, in its branches. `problem`: where engine, counters and
/// message are. `unknown`: lambda is part of p. `follows`: the engine has the factor of Newton's last iteration, whose
/// tangent is the same, but for directions in space: it is used as it is, or updated. `redundant`: constraints repeat
/// one another, so that the tangent yields and a solution takes a pass more. False, with the message, where it is
/// singular.
template <class Problem>
bool factorise_converged(Problem& problem, const ContactInput<double>& input, const State<double>& at, bool unknown,
                         bool follows, bool& redundant) {
  const Model& model = problem.model;
  const Vector<double> compact = to_compact(model, at.displacement);
  const Vector<double> multiplier = multiplier_on_rays(input, at);
  std::vector<PointTangent<double>> tangents;
  for (int p = 0; p < static_cast<int>(model.points.size()); ++p)
    tangents.push_back(point_tangent<double>(input, p, compact, multiplier, at.contact.state[p]));
  const auto decided = unknown ? decided_elsewhere(model, problem.slots) : std::vector<char>();
  Counters spent;
  const bool updated = follows && decided.empty() && problem.engine.update(tangents, spent);
  spent.sensitivity_backsolves = std::exchange(spent.backsolves, 0);
  const bool valid =
      updated || (unknown ? factorise_sharing(problem.engine, model, decided, std::move(tangents), redundant, spent)
                          : problem.engine.factorise(tangents, spent));
  spent.sensitivity_factorizations = spent.factorizations;
  problem.counters += spent;
  if (!valid) problem.message = "the tangent of the converged state is singular: " + problem.engine.message();
  return valid;
}

}  // namespace stickslip
