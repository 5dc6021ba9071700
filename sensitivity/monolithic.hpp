/// Monolithic augmented Lagrangian: exact and not iterative. lambda is part of p, so one back-solve a parameter with
/// the tangent of the converged state gives Du and D lambda together, all parameters in one block. The only history is
/// the slip placement; the last lambda is a start value and is not differentiated. The derivative with respect to rho
/// vanishes at the solution. [SLK10]
#pragma once

#include "sensitivity/direct.hpp"

namespace stickslip {

template <class E>
bool differentiate_increment(const MonolithicAL& method, Differentiation<E>& problem, const State<double>& previous,
                             const Increment<double>& increment) {
  const auto rho = initial_regularisation(problem.slots, method);
  std::vector<Vector<Direction>> lambda(problem.blocks.size(), lift(increment.state.multiplier));
  LinearisedEquilibrium<E> linearised(problem, increment.state, rho, regularisation_blocks(method, problem),
                                      cone_radius(method), increment.time, true, previous.contact.placement);
  if (!linearised.valid()) return false;
  const auto fields = linearised.solve(lambda);
  linearised.settle(fields, lambda);
  return true;
}

}  // namespace stickslip
