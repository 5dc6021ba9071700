/// The closed set of methods and its one dispatch: from a model to a trajectory in double.
#pragma once

#include "methods/run.hpp"

namespace stickslip {

/// Solves the model with the method. Never throws for numerical reasons: the trajectory's status and message say how it
/// ended, and the increments up to there are kept. The workspace is what differentiate() goes on from.
Trajectory<double> solve(const Model& model, const Slots<double>& slots, const Method& method,
                         const RunOptions& options, Workspace<double>& workspace);
Trajectory<double> solve(const Model& model, const Slots<double>& slots, const Method& method,
                         const RunOptions& options = {});
/// The same into an empty trajectory, which grows step by step (RunOptions::on_step).
void solve(const Model& model, const Slots<double>& slots, const Method& method, const RunOptions& options,
           Workspace<double>& workspace, Trajectory<double>& trajectory);

}  // namespace stickslip
