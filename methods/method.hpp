/// Solution of a model by any method of the closed set, in double. The method is asked for in each increment
/// (methods/stepping/increment.hpp).
#pragma once

#include "methods/stepping/run_options.hpp"

namespace stickslip {

/// Trajectory of a model by a method. It never throws for numerical reasons: status and message of the trajectory say
/// how the run ended, and the increments up to there are kept. differentiate() continues from the workspace.
Trajectory<double> solve(const Model& model, const Slots<double>& slots, const Method& method,
                         const RunOptions& options, Workspace<double>& workspace);
Trajectory<double> solve(const Model& model, const Slots<double>& slots, const Method& method,
                         const RunOptions& options = {});
/// The same into an empty trajectory, which on_step (RunOptions) may read after each step.
void solve(const Model& model, const Slots<double>& slots, const Method& method, const RunOptions& options,
           Workspace<double>& workspace, Trajectory<double>& trajectory);

}  // namespace stickslip
