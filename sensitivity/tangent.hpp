/// Factorised tangent of a converged increment, from which direct and adjoint differentiation start.
#pragma once

#include "core/engine/engine.hpp"
#include "core/engine/shared_forces.hpp"
#include "core/model/point_tangent.hpp"
#include "sensitivity/rays.hpp"
#include "sensitivity/redundancy.hpp"

namespace stickslip {

/// Tangents of all contact points at a converged state, in its branches.
inline std::vector<PointTangent<double>> converged_tangents(const ContactInput<double>& input,
                                                            const State<double>& at) {
  const Vector<double> compact = to_compact(input.model, at.displacement);
  const Vector<double> multiplier = multiplier_on_rays(input, at);
  std::vector<PointTangent<double>> tangents;
  for (int p = 0; p < static_cast<int>(input.model.points.size()); ++p)
    tangents.push_back(point_tangent<double>(input, p, compact, multiplier, at.contact.state[p], at.contact.facing));
  return tangents;
}

/// Factorises the tangent of the engine at a converged state. False, with a message in `problem`, if it is singular and
/// constraints do not repeat one another.
///
///   problem      has engine, counters and message
///   multipliers  unknown: lambda is part of p
///   redundant    result: constraints repeat one another; the tangent is then regularised, and a solution needs one
///                more pass
template <class Problem>
bool factorise_converged(Problem& problem, const ContactInput<double>& input, const State<double>& at,
                         Multipliers multipliers, bool& redundant) {
  const bool unknown = multipliers == Multipliers::unknown;
  if (!problem.model.effects.linear_bulk)
    problem.engine.linearise({at.displacement, input.previous.bodies, input.time, &at.flow});
  auto tangents = converged_tangents(input, at);
  Counters spent;
  const auto decided = unknown ? decided_elsewhere(problem.model, problem.slots, &at.contact) : std::vector<char>();
  const bool valid =
      unknown ? factorise_sharing(problem.engine, problem.model, decided, std::move(tangents), redundant, spent)
              : problem.engine.factorise(tangents, spent);
  spent.sensitivity_backsolves = std::exchange(spent.backsolves, 0);
  spent.sensitivity_factorizations = spent.factorizations;
  problem.counters += spent;
  if (!valid) problem.message = "the tangent of the converged state is singular: " + problem.engine.message();
  if (valid && redundant && !constraints_repeat(problem.model, problem.slots, at.contact, decided)) {
    problem.message =
        "the tangent of the converged state is singular: it is about to lose its balance, and has no derivative";
    return false;
  }
  return valid;
}

/// The same with the present factor of the engine, which is used as it is, or updated. It may be that of Newton's last
/// iteration, whose tangent is that of the converged state except for slip directions in 3D, or that of a neighbouring
/// increment. False if it cannot be used. The caller must check or refine its solutions.
template <class Problem>
bool reuse_factor(Problem& problem, const ContactInput<double>& input, const State<double>& at,
                  Multipliers multipliers) {
  if (multipliers == Multipliers::unknown && !decided_elsewhere(problem.model, problem.slots, &at.contact).empty())
    return false;
  Counters spent;
  const bool updated = problem.engine.update(converged_tangents(input, at), spent);
  spent.sensitivity_backsolves = std::exchange(spent.backsolves, 0);
  spent.sensitivity_factorizations = spent.factorizations;
  problem.counters += spent;
  return updated;
}

}  // namespace stickslip
