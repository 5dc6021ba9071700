/// The scheme of each method, in a file of its own that says what it does: penalty.cpp, uzawa.cpp, monolithic.cpp.
#pragma once

#include "sensitivity/direct.hpp"
#include "sensitivity/pull_back.hpp"

namespace stickslip {

/// Differentiates one increment: the blocks' current states are then its derivative, but for the displacement, which
/// expand() finds from Differentiation::unexpanded. False, with status and message in `problem`, if there is none.
///
///   problem    its blocks' previous states are the derivative of the increment before
///   previous   state that the increment started from
inline bool differentiate_increment(Differentiation& problem, const State<double>& previous,
                                    const Increment<double>& increment) {
  return std::visit([&](const auto& method) { return method.differentiate_increment(problem, previous, increment); },
                    problem.method);
}

/// Takes one increment back: each objective's derivative by the history at its end becomes that by the history at its
/// beginning, and what the increment adds to the gradient is added. False, with status and message in `problem`, if
/// there is none.
inline bool pull_back_increment(AdjointProblem& problem, const State<double>& previous,
                                const Increment<double>& increment) {
  return std::visit([&](const auto& method) { return method.pull_back_increment(problem, previous, increment); },
                    problem.method);
}

/// Differentiates one increment and expands its displacements. The blocks then have its complete state.
inline bool differentiate_alone(Differentiation& problem, const State<double>& previous,
                                const Increment<double>& increment) {
  if (!differentiate_increment(problem, previous, increment)) return false;
  auto displacement = expand(problem, {std::move(*problem.unexpanded)});
  for (std::size_t b = 0; b < problem.blocks.size(); ++b)
    problem.blocks[b].current.displacement = std::move(displacement[0][b]);
  return true;
}

}  // namespace stickslip
