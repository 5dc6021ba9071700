/// Penalty: one linear solve a parameter, as for elastoplasticity. D lambda = (0, D t_T of the last increment): the
/// stored traction is history, so its derivative travels from increment to increment. Exact for the penalised problem.
/// [MTV94], [SLK10 sec. 3]
#pragma once

#include "sensitivity/direct.hpp"

namespace stickslip {

template <class E>
bool differentiate_increment(const Penalty& method, Differentiation<E>& problem, const State<double>& previous,
                             const Increment<double>& increment) {
  const auto rho = initial_regularisation(problem.slots, method);
  std::vector<Vector<Direction>> lambda;
  for (auto& block : problem.blocks) lambda.push_back(stored_traction(problem.model, block.previous));
  LinearisedEquilibrium<E> linearised(problem, increment.state, rho, regularisation_blocks(method, problem),
                                      ConeRadius::augmented, increment.time, false, previous.contact.placement);
  if (!linearised.valid()) return false;
  linearised.settle(linearised.solve(lambda), lambda);
  return true;
}

}  // namespace stickslip
