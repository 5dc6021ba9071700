/// The factorised tangent of a converged increment: what direct and adjoint differentiation start from.
#pragma once

#include "core/model/engine.hpp"
#include "sensitivity/rays.hpp"

namespace stickslip {

/// Factorises the tangent at a state, in its branches (the last one that Newton had is a step old). `problem`: where
/// engine, counters and message are. `unknown`: lambda is part of p. `redundant`: constraints repeat one another, so
/// that the tangent yields and a solution takes a pass more. False, with the message, where it is singular.
template <class Problem>
bool factorise_converged(Problem& problem, const ContactInput<double>& input, const State<double>& at, bool unknown,
                         bool& redundant) {
  const Model& model = problem.model;
  const Vector<double> compact = to_compact(model, at.displacement);
  const Vector<double> multiplier = multiplier_on_rays(input, at);
  std::vector<PointTangent<double>> tangents;
  for (int p = 0; p < static_cast<int>(model.points.size()); ++p)
    tangents.push_back(point_tangent<double>(input, p, compact, multiplier, at.contact.state[p]));
  const long before = problem.counters.factorizations;
  const bool valid = unknown ? factorise_sharing(problem.engine, model, decided_elsewhere(model, problem.slots),
                                                 std::move(tangents), redundant, problem.counters)
                             : problem.engine.factorise(tangents, problem.counters);
  problem.counters.sensitivity_factorizations += problem.counters.factorizations - before;
  if (!valid) problem.message = "the tangent of the converged state is singular: " + problem.engine.message();
  return valid;
}

}  // namespace stickslip
