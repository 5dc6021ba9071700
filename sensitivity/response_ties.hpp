/// Ties of responses that are the largest or smallest of several values: where values tie, a derivative has two sides.
#pragma once

#include "core/model/response.hpp"
#include "sensitivity/differentiation.hpp"

namespace stickslip {

/// Whether several values share the largest or smallest that some response takes at a state.
bool has_tied_responses(const Model& model, const Slots<double>& slots, const State<double>& state);

/// Gives a response whose values tie the derivative of one side, if the sides differ by more than the rounding of the
/// motion. `of`: derivatives of all responses, in the columns of the block's parameters; `at`: the state with
/// derivatives.
void take_side_of_ties(const Model& model, const ParameterBlock& block, const State<Direction>& at, Ties side,
                       Matrix<double>& of);

}  // namespace stickslip
