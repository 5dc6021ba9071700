/// Penalty: one linear solve per parameter, as in elastoplasticity. D lambda = (0, D t_T of the last increment): the
/// stored traction is history, and its derivative is carried from increment to increment. Exact for the penalised
/// problem. Adjoint: one transposed solve; the derivative by lambda_T is added to that by the stored traction. [MTV94],
/// [SLK10 sec. 3]

#include "methods/stepping/increment.hpp"
#include "sensitivity/direct.hpp"
#include "sensitivity/pull_back.hpp"
#include "sensitivity/schemes.hpp"

namespace stickslip {

bool Penalty::differentiate_increment(Differentiation& problem, const State<double>& previous,
                                      const Increment<double>& increment) const {
  const auto rho = initial_regularisation(problem.slots, *this);
  std::vector<Vector<Direction>> lambda;
  for (auto& block : problem.blocks) lambda.push_back(stored_traction(problem.model, block.previous));
  LinearisedEquilibrium linearised(problem, increment.state, rho, regularisation_blocks(problem), ConeRadius::augmented,
                                   increment.time, multipliers, previous.history);
  if (!linearised.solve(lambda)) return false;
  linearised.store_state(lambda);
  return true;
}

bool Penalty::pull_back_increment(AdjointProblem& problem, const State<double>& previous,
                                  const Increment<double>& increment) const {
  problem.tape.rewind(problem.slots_end);
  RecordedEquilibrium recorded(problem, previous, increment.state, initial_regularisation(problem.recorded, *this),
                               ConeRadius::augmented, increment.time, multipliers, increment.requested);
  if (!recorded.valid()) return false;
  for (int j = 0; j < static_cast<int>(problem.objectives.size()); ++j) {
    recorded.seed_outcome(j);
    recorded.balance(j);
    auto& history = problem.objectives[j].history;
    Vector<double> stored = recorded.take_multiplier(j);
    for (const auto& point : problem.model.points) stored[point.multiplier] = 0;
    history = recorded.finish(j);
    history.traction = stored;
  }
  return true;
}

}  // namespace stickslip
