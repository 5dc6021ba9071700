#include "methods/method.hpp"

#include "methods/solve.hpp"

namespace stickslip {

Trajectory<double> solve(const Model& model, const Slots<double>& slots, const Method& method,
                         const RunOptions& options, Workspace<double>& workspace) {
  return solve_in<double>(model, slots, method, options, workspace);
}

Trajectory<double> solve(const Model& model, const Slots<double>& slots, const Method& method,
                         const RunOptions& options) {
  Workspace<double> none;
  return solve_in<double>(model, slots, method, options, none);
}

void solve(const Model& model, const Slots<double>& slots, const Method& method, const RunOptions& options,
           Workspace<double>& workspace, Trajectory<double>& trajectory) {
  solve_in<double>(model, slots, method, options, workspace, trajectory);
}

}  // namespace stickslip
