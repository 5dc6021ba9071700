/// What is looked for beside the solution of an increment: further solutions, and a jump to it.
#pragma once

#include <tuple>

#include "methods/rescue/rescue.hpp"
#include "methods/stepping/drive.hpp"

namespace stickslip {

namespace detail {

/// Looks for all solutions of a solved increment, if there may be several and points are few.
template <class T>
void count_solutions(Run<T>& run, const State<T>& previous, double time, Increment<T>& increment) {
  if (run.uniqueness == Uniqueness::unique && !increment.reversed) return;
  auto all = try_all_branches(run, previous, increment.rho_factor, time);
  increment.counted = all.has_value();
  if (!all) return;
  for (auto& state : all->states) {
    if (same_solution(run.model, state, increment.state, all->reach)) continue;
    state.history.work = increment.state.history.work;
    increment.others.push_back(std::move(state));
  }
}

/// Time at which the solution jumps in an increment: the branch of solutions that leads there ends. It is the end of
/// the thousandth of the increment that contains at least a quarter of its motion; never the first thousandth of a run.
/// None if there is no jump. The search is made in two cases: solutions were counted, and either end has several or a
/// tangent on the way had a determinant of the other sign; or nonlinear bodies move suddenly.
template <class T>
std::optional<double> find_jump(Run<T>& run, const State<T>& previous, const std::vector<double>& rho_factor,
                                double start, double end, const State<T>& reached) {
  constexpr int halvings = 10;
  constexpr double much = 0.25, nothing = 1e-9;
  const auto moved = [&](const State<T>& from, const State<T>& to) {
    return largest_nodal_norm(Vector<T>(to.displacement - from.displacement), run.model.dimension);
  };
  const RunScales scales = run.account.scales;
  Trace* const trace = std::exchange(run.account.trace, nullptr);
  State<T> before = previous, after = reached;
  bool solved = true;
  WorkBound bound(run.model, run.account.counters, newton_of(run.method).max_iterations, 0, Bodies::held);
  bound.begin();
  for (int level = 0; level < halvings && solved; ++level) {
    const double middle = (start + end) / 2;
    auto half = find_increment(run, before, rho_factor, middle, bound);
    solved = half.usable();
    if (!solved) break;
    const bool near = moved(before, half.state) < much * moved(before, after);
    auto rest = find_increment(run, half.state, rho_factor, end, bound);
    solved = rest.usable() || near;  // (what still stands near the start jumps later, found or not)
    if (!solved) break;
    const bool first = rest.usable() && moved(before, half.state) >= moved(half.state, rest.state);
    (first ? end : start) = middle;
    if (first)
      after = std::move(half.state);
    else
      before = std::move(half.state);
    if (!first && rest.usable()) after = std::move(rest.state);
  }
  run.account.scales = scales;
  run.account.trace = trace;
  const double all = moved(previous, reached);
  if (start == 0) return std::nullopt;  // what is applied at once moves bodies at once
  if (!solved || all <= nothing * scales.length || moved(before, after) < much * all) return std::nullopt;
  return end;
}

/// Pace of bodies that are not linear.
template <class T>
double pace_of(const Model& model, const State<T>& from, const State<T>& to, double duration) {
  if (model.effects.linear_bulk) return 0;
  return largest_nodal_norm(Vector<T>(to.displacement - from.displacement), model.dimension) / duration;
}

/// Whether bodies that are not linear move at four times the pace of the increment before, and of what drives them, or
/// more: so they would beyond a limit point, if the solution jumps there.
template <class T>
bool is_sudden(const Model& model, const Slots<T>& slots, const std::vector<Increment<T>>& before, double end,
               double pace) {
  constexpr double sudden = 4;
  if (before.empty() || !(pace > sudden * before.back().pace)) return false;
  const double start = before.back().time;
  const Vector<double> driven = driven_motion(model, slots, end) - driven_motion(model, slots, start);
  return pace > sudden * largest_nodal_norm(driven, model.dimension) / (end - start);
}

/// Counts the solutions of an increment that was solved from `start` to its end, and looks for a jump to it where there
/// may be one.
template <class T>
void look_beside(Run<T>& run, const Trajectory<T>& trajectory, const std::vector<double>& rho_factor, double start,
                 Increment<T>& increment) {
  const auto& before = trajectory.increments;
  const State<T>& previous = trajectory.last();
  count_solutions(run, previous, increment.time, increment);
  const bool folded =
      increment.reversed || !increment.others.empty() || (!before.empty() && !before.back().others.empty());
  increment.pace = pace_of(run.model, previous, increment.state, increment.time - trajectory.last_time());
  const bool sudden = is_sudden(run.model, run.slots, before, increment.time, increment.pace);
  if ((increment.counted && folded) || sudden)
    increment.jump = find_jump(run, previous, rho_factor, start, increment.time, increment.state);
}

}  // namespace detail

}  // namespace stickslip
