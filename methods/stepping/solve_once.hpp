/// An increment that is one equilibrium, found by Newton's method from where the increment starts: of methods without
/// an outer loop.
#pragma once

#include "methods/stepping/increment.hpp"

namespace stickslip {

/// `lambda`: given, or the start value of what is unknown. `objection(input, equilibrium)`: why a solution counts for
/// none, in words; empty: it counts.
template <class T, class Objection>
Increment<T> solve_once(Run<T>& run, const State<T>& previous, Multipliers multipliers, Vector<T> lambda, double time,
                        const Start<T>& start, Objection&& objection) {
  const auto rho = initial_regularisation(run.slots, run.method);
  const ContactInput<T> input{run.model, run.slots, rho, previous.history, cone_radius_of(run.method), time};
  NewtonOptions options = newton_of(run.method);
  options.tolerance = start.tolerance(options.tolerance);
  const EquilibriumTask<T> task{.contact = input,
                                .multipliers = multipliers,
                                .anchor = start.anchor,
                                .resumed = start.resumed(previous),
                                .last = &start.state,
                                .arc = start.arc,
                                .rests = start.at_rest,
                                .tells_stability = start.at_rest};
  auto u = run.engine.begin(time, start.state.displacement, previous.history.bodies);
  auto equilibrium =
      find_equilibrium<T>(run.engine, task, {std::move(u), std::move(lambda), time}, options, run.account);
  Increment<T> increment;
  account_for(increment, equilibrium, 0);
  if (is_converged(equilibrium.status) && !start.is_step())
    if (std::string words = objection(input, equilibrium); !words.empty()) {
      increment.status = Status::infeasible;
      increment.message = std::move(words);
    }
  increment.state = settle(run, input, std::move(equilibrium.unknowns), std::move(equilibrium.field));
  return increment;
}

}  // namespace stickslip
