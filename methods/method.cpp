#include "methods/method.hpp"

#include "methods/stepping/solve.hpp"
#include "methods/stepping/solve_again.hpp"

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

Stretch<double> solve_again(const Model& model, const Slots<double>& slots, const Method& method,
                            const Trajectory<double>& trajectory, std::size_t n, Workspace<double>& workspace,
                            Counters& counters) {
  return detail::solve_again(method, model, slots, *workspace.engine, *workspace.checkpoints, trajectory, n, counters);
}

}  // namespace stickslip
