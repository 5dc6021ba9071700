/// The factorised tangent of a converged increment: what direct and adjoint differentiation start from.
#pragma once

#include "core/model/engine.hpp"
#include "core/model/shared_forces.hpp"
#include "sensitivity/rays.hpp"
#include "sensitivity/redundancy.hpp"

namespace stickslip {

/// Tangents of all points at a converged state, in its branches.
inline std::vector<PointTangent<double>> converged_tangents(const ContactInput<double>& input,
                                                            const State<double>& at) {
  const Vector<double> compact = to_compact(input.model, at.displacement);
  const Vector<double> multiplier = multiplier_on_rays(input, at);
  std::vector<PointTangent<double>> tangents;
  for (int p = 0; p < static_cast<int>(input.model.points.size()); ++p)
    tangents.push_back(point_tangent<double>(input, p, compact, multiplier, at.contact.state[p], at.contact.facing));
  return tangents;
}

/// Prepares the engine to solve with the tangent at a converged state. `problem`: where engine, counters and message
/// are. `unknown`: lambda is part of p. `redundant`: constraints repeat one another, so that the tangent yields and a
/// solution takes a pass more. False, with the message, where it is singular for another reason.
template <class Problem>
bool factorise_converged(Problem& problem, const ContactInput<double>& input, const State<double>& at, bool unknown,
                         bool& redundant) {
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

/// The same with the factor that the engine has. It may be of Newton's last iteration, whose tangent is that of the
/// converged state, but for directions in space; or of an increment beside this one. It is used as it is, or updated.
/// False where that cannot be. The caller must check, or refine, what it solves.
template <class Problem>
bool reuse_factor(Problem& problem, const ContactInput<double>& input, const State<double>& at, bool unknown) {
  if (unknown && !decided_elsewhere(problem.model, problem.slots, &at.contact).empty()) return false;
  Counters spent;
  const bool updated = problem.engine.update(converged_tangents(input, at), spent);
  spent.sensitivity_backsolves = std::exchange(spent.backsolves, 0);
  spent.sensitivity_factorizations = spent.factorizations;
  problem.counters += spent;
  return updated;
}

}  // namespace stickslip
