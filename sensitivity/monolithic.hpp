/// Monolithic augmented Lagrangian: exact and not iterative. lambda is part of p, so Du and D lambda come from one
/// back-solve per parameter with the tangent of the converged state, all parameters in one block. The only history is
/// the slip placement; the last lambda is a start value and is not differentiated. The derivative by rho vanishes at
/// the solution. Adjoint: one transposed solve. [SLK10]
#pragma once

#include "methods/monolithic.hpp"
#include "sensitivity/direct.hpp"
#include "sensitivity/pull_back.hpp"

namespace stickslip {

template <class E>
bool differentiate_increment(const MonolithicAL& method, Differentiation<E>& problem, const State<double>& previous,
                             const Increment<double>& increment) {
  const auto rho = initial_regularisation(problem.slots, method);
  std::vector<Vector<Direction>> lambda(problem.blocks.size(), lift(increment.state.multiplier));
  LinearisedEquilibrium<E> linearised(problem, increment.state, rho, regularisation_blocks(method, problem),
                                      cone_radius(method), increment.time, true, previous.history);
  if (!linearised.valid()) return false;
  std::vector<ContactField<Direction>> fields;
  if (!linearised.solve(lambda, fields)) return false;
  linearised.store_state(fields, lambda);
  return true;
}

template <class E>
bool pull_back_increment(const MonolithicAL& method, AdjointProblem<E>& problem, const State<double>& previous,
                         const Increment<double>& increment) {
  problem.tape.rewind(problem.slots_end);
  const auto rho = initial_regularisation(problem.slots, method);
  RecordedEquilibrium<E> recorded(problem, previous, increment.state, constant<Reverse>(rho), cone_radius(method),
                                  increment.time, true, increment.requested);
  if (!recorded.valid()) return false;
  for (int j = 0; j < static_cast<int>(problem.objectives.size()); ++j) {
    recorded.seed_outcome(j);
    recorded.balance(j);
    problem.objectives[j].history = recorded.finish(j);
  }
  return true;
}

}  // namespace stickslip
