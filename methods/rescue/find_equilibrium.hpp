/// What is tried for one equilibrium, and in which order: Newton's method, the sequence of linear problems, and
/// Newton's method again. The level below methods/rescue/rescue.hpp.
#pragma once

#include "methods/rescue/sequential.hpp"

namespace stickslip {

// (declared, and described, in methods/newton/equilibrium.hpp)
template <class T>
Equilibrium<T> find_equilibrium(Engine<T>& engine, const EquilibriumTask<T>& task, Unknowns<T> start,
                                const NewtonOptions& options, Account& account) {
  constexpr int soon = 15;
  const auto& effects = task.contact.model.effects;
  const bool linear = (effects.linear_bulk && !effects.current_geometry) || task.contact.model.points.empty();
  if (linear || task.arc || options.max_iterations <= soon)
    return newton(engine, task, std::move(start), options, account);
  const RunScales before = account.scales;
  Equilibrium<T> found;
  const auto take = [&](Equilibrium<T> next) {  // adds the iterations of earlier attempts
    next.history.insert(next.history.begin(), found.history.begin(), found.history.end());
    next.iterations += found.iterations;
    found = std::move(next);
    if (!is_converged(found.status)) account.scales = before;
    return is_converged(found.status);
  };
  NewtonOptions brief = options;
  brief.max_iterations = soon;
  bool in_sequence = account.sequential;
  if (engine.condenses_tangents()) in_sequence = task.last && (account.sequential || task.solves_for_multipliers());
  if (!in_sequence && take(newton(engine, task, start, brief, account))) return found;
  account.sequential = take(detail::solve_in_sequence(engine, task, start, options, account));
  if (!account.sequential) take(newton(engine, task, std::move(start), options, account));
  return found;
}

}  // namespace stickslip
