/// The closed set of methods and its one dispatch: from a model to a trajectory in double.
#pragma once

#include "methods/checkpoints.hpp"

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

/// Increments of a run around its increment n, which is thin, whole again. The workspace is that of the run, and is
/// left as it was; what it takes is added to `counters`.
Stretch<double> solve_again(const Model& model, const Slots<double>& slots, const Method& method,
                            const Trajectory<double>& trajectory, std::size_t n, Workspace<double>& workspace,
                            Counters& counters);

}  // namespace stickslip
