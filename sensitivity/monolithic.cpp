/// Monolithic augmented Lagrangian: exact and not iterative. lambda is part of p, so Du and D lambda come from one
/// back-solve per parameter with the tangent of the converged state, all parameters in one block. The only history is
/// the slip placement; the last lambda is a start value and is not differentiated. The derivative by rho vanishes at
/// the solution. Adjoint: one transposed solve. [SLK10]

#include "sensitivity/direct.hpp"
#include "sensitivity/pull_back.hpp"
#include "sensitivity/schemes.hpp"

namespace stickslip {

bool MonolithicAL::differentiate_increment(Differentiation& problem, const State<double>& previous,
                                           const Increment<double>& increment) const {
  const auto rho = initial_regularisation(problem.slots, *this);
  std::vector<Vector<Direction>> lambda(problem.blocks.size(), lift(increment.state.multiplier));
  LinearisedEquilibrium linearised(problem, increment.state, rho, regularisation_blocks(problem), cone_radius(),
                                   increment.time, multipliers, previous.history);
  if (!linearised.solve(lambda)) return false;
  linearised.store_state(lambda);
  return true;
}

bool MonolithicAL::pull_back_increment(AdjointProblem& problem, const State<double>& previous,
                                       const Increment<double>& increment) const {
  problem.tape.rewind(problem.slots_end);
  const auto rho = initial_regularisation(problem.slots, *this);
  RecordedEquilibrium recorded(problem, previous, increment.state, constant<Reverse>(rho), cone_radius(),
                               increment.time, multipliers, increment.requested);
  if (!recorded.valid()) return false;
  for (int j = 0; j < static_cast<int>(problem.objectives.size()); ++j) {
    recorded.seed_outcome(j);
    recorded.balance(j);
    problem.objectives[j].history = recorded.finish(j);
  }
  return true;
}

}  // namespace stickslip
