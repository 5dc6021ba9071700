/// Time stepping for any method and scalar: increments in time, step cutting and rollback. solve_in() is the template,
/// which the oracle of the tests instantiates in complex numbers. solve() of methods/method.hpp is solve_in() in
/// double.
#pragma once

#include <stdexcept>
#include <tuple>

#include "methods/rescue/rescue.hpp"
#include "methods/stepping/checkpoints.hpp"
#include "methods/stepping/diagnosis.hpp"
#include "methods/stepping/drive.hpp"
#include "methods/stepping/engine_choice.hpp"
#include "methods/stepping/path.hpp"
#include "methods/stepping/stability.hpp"

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
std::optional<double> find_jump(Run<T>& run, const State<T>& previous, const std::vector<double>& factor, double start,
                                double end, const State<T>& reached) {
  constexpr int halvings = 10;
  constexpr double much = 0.25, nothing = 1e-9;
  const auto moved = [&](const State<T>& from, const State<T>& to) {
    return largest_nodal_norm(Vector<T>(to.displacement - from.displacement), run.model.dimension);
  };
  const RunScales scales = run.account.scales;
  Trace* const trace = std::exchange(run.account.trace, nullptr);
  State<T> before = previous, after = reached;
  bool solved = true;
  WorkBound bound(run.model, run.account.counters, newton_of(run.method).max_iterations, 0);
  bound.begin();
  for (int level = 0; level < halvings && solved; ++level) {
    const double middle = (start + end) / 2;
    auto half = find_increment(run, before, factor, middle, bound);
    solved = half.usable();
    if (!solved) break;
    const bool near = moved(before, half.state) < much * moved(before, after);
    auto rest = find_increment(run, half.state, factor, end, bound);
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
void look_beside(Run<T>& run, const Trajectory<T>& trajectory, const std::vector<double>& factor, double start,
                 Increment<T>& increment) {
  const auto& before = trajectory.increments;
  const State<T>& previous = before.empty() ? trajectory.initial : before.back().state;
  count_solutions(run, previous, increment.time, increment);
  const bool folded =
      increment.reversed || !increment.others.empty() || (!before.empty() && !before.back().others.empty());
  increment.pace =
      pace_of(run.model, previous, increment.state, increment.time - (before.empty() ? 0 : before.back().time));
  const bool sudden = is_sudden(run.model, run.slots, before, increment.time, increment.pace);
  if ((increment.counted && folded) || sudden)
    increment.jump = find_jump(run, previous, factor, start, increment.time, increment.state);
}

/// Whether an increment failed because supports drive what touches into one another, which no smaller step mends.
template <class T>
bool drives_together(const Run<T>& run, double start, double end, const Increment<T>& failed) {
  const auto& [model, slots] = std::tie(run.model, run.slots);
  if (!prevents_penetration(run.method)) {
    if (failed.status == Status::infeasible) return true;
  } else if (!prescribed_penetration(model, slots, failed.state).empty()) {
    return true;
  }
  return cross_between(model, slots, start, end);
}

/// Displacements that are not finite are no solution. (An engine may eliminate dofs that no residual contains.) Nor is a
/// state that presses on a folded side.
template <class T>
void refuse(const Run<T>& run, Increment<T>& increment) {
  if (!increment.usable()) return;
  const auto mark = [&](Status status, std::string words) {
    increment.status = status;
    increment.cut_off = false;
    increment.message = std::move(words);
  };
  if (!increment.state.displacement.allFinite()) return mark(Status::not_finite, "the displacements are not finite");
  std::string words = detail::words_of_folded_side(run.model, run.slots, increment.state);
  if (words.empty()) return;
  mark(Status::inverted_element, std::move(words));
}

/// Whether an increment failed for a reason that is the same however short it is.
template <class T>
bool no_smaller_step_helps(const Run<T>& run, double start, double end, const Increment<T>& failed) {
  if (failed.status == Status::no_equilibrium) return unbalanced_body(run.model, run.slots, end) != balanced;
  return drives_together(run, start, end, failed);
}

/// Ends a step to the time `target` that found no solution: the increment that failed first is then the last.
template <class T>
void give_up(const Run<T>& run, double target, const WorkBound& bound, Increment<T> failed,
             std::vector<Increment<T>>& increments) {
  diagnose(run.model, run.slots, target, prevents_penetration(run.method), failed);
  const auto add = [&](const std::string& words) { failed.message += (failed.message.empty() ? "" : "; ") + words; };
  const bool is_named = failed.status == Status::no_equilibrium || failed.status == Status::infeasible ||
                        failed.status == Status::inverted_element;
  if (!run.free.words.empty() && !is_named) add("where the step begins, " + run.free.words);
  if (bound.is_spent() && !is_named) add(bound.in_words());
  if (!is_named && has_abrupt_friction(run.model, run.slots)) add(abrupt_friction_message);
  failed.time = target;
  failed.requested = true;
  increments.push_back(std::move(failed));
}

template <class T>
int equilibria_of(const Increment<T>& increment) {
  return std::max(1, increment.augmentations);
}

/// Iterations of increments that converged, those in vain apart.
template <class T>
long spent_on(const std::vector<Increment<T>>& increments) {
  long spent = 0;
  for (const auto& increment : increments) spent += WorkBound::due(increment.newton, equilibria_of(increment));
  return spent;
}

/// Advances the trajectory to the time `target`. False if it gave up; the failed increment is then the last.
template <class T>
bool advance(Run<T>& run, Trajectory<T>& trajectory, double target, bool may_cut) {
  constexpr double smallest = 1.0 / 1024, regrowth = 1.5;
  constexpr double patient = 0.2;      // share of the step at which nonlinear bodies turn to the motion
  constexpr double steady = 1.0 / 64;  // share to which a step is cut so that it ends in a stable equilibrium
  const std::size_t start_count = trajectory.increments.size();
  const double start = start_count ? trajectory.increments.back().time : 0;
  double reached = start, step = target - start;
  int easy = 0, cutbacks = 0;
  bool buckles = false;  // whether an attempt passed several places where bodies begin to give way: then none is passed
  std::optional<Increment<T>> failed;
  WorkBound bound(run.model, run.account.counters, newton_of(run.method).max_iterations,
                  spent_on(trajectory.increments));
  const bool linear = run.model.effects.linear_bulk;
  run.free = {};
  if (!linear)
    run.free = free_bodies(run.model, run.slots, start_count ? trajectory.increments.back().state : trajectory.initial,
                           start_count == 0);
  while (true) {
    const bool last = reached + step >= target - 1e-9 * (target - start);
    const double next = last ? target : reached + step;
    const auto& increments = trajectory.increments;
    const State<T>& previous = increments.empty() ? trajectory.initial : increments.back().state;
    const auto factor = increments.empty() ? std::vector<double>{} : increments.back().rho_factor;
    const bool may_move = linear || !may_cut || !run.free.words.empty() || step < patient * (target - start);
    const RunScales scales = run.account.scales;
    bound.begin();
    run.start = reached;
    auto increment = find_increment(run, previous, factor, next, bound, may_move);
    bound.end(increment.usable() ? equilibria_of(increment) : 0);
    increment.time = next;
    increment.requested = last;
    increment.cutbacks = cutbacks;
    refuse(run, increment);
    const int before = increments.empty() ? 0 : increments.back().unresisted;
    increment.unresisted = may_cut ? motions_unresisted(run, previous, increment).value_or(before) : before;
    const bool passes = increment.usable() && increment.unresisted - before > (buckles ? 0 : 1) && !bound.is_spent() &&
                        next - reached > steady * (target - start);
    buckles |= passes;
    if (passes) run.account.scales = scales;
    if (increment.usable() && !passes) {
      look_beside(run, trajectory, factor, reached, increment);
      trajectory.increments.push_back(std::move(increment));
      if (last) return true;
      reached = next;
      if (++easy >= 3) step *= regrowth;
      continue;
    }
    const bool impossible = !passes && no_smaller_step_helps(run, reached, next, increment);
    if (!failed && !passes) failed = std::move(increment);
    easy = 0;
    step = (next - reached) / 2;
    const bool vanishes = !(reached + step > reached && reached + step < next);  // no number lies between
    if (!may_cut || impossible || vanishes || bound.is_spent() || step < smallest * (target - start)) break;
    ++cutbacks;
    ++run.account.counters.cutbacks;
  }
  failed->cutbacks = cutbacks;
  trajectory.increments.resize(start_count);
  give_up(run, target, bound, std::move(*failed), trajectory.increments);
  return false;
}

/// Whether increments may have several solutions, as far as can be known before the first. Three criteria: friction may
/// hold a body between surfaces; with few points, the determinants of all combinations of branches; with many, mu of a
/// point exceeds k_t / |k_nt| of its stiffness with all others held, so that it could jump on its own.
template <class T>
Uniqueness uniqueness_of(Run<T>& run) {
  const Model& model = run.model;
  if (!model.effects.friction || !model.effects.linear_bulk) return Uniqueness::unique;
  if (is_wedged(model, run.slots)) return Uniqueness::several;
  if constexpr (std::is_same_v<T, double>) {
    if (!can_try_all_branches(model)) {
      const bool jumps = run.condensation && run.condensation->valid() &&
                         exceeds_critical_friction(model, run.slots, run.condensation->schur());
      return jumps ? Uniqueness::several : Uniqueness::unique;
    }
    if (!run.condensation)
      run.condensation = std::make_shared<Condensation<double>>(model, run.slots, Backend::automatic);
    if (!run.condensation->valid()) return Uniqueness::unique;
    const RegularisationField<double> rho(model.points.size(), {1, 1});
    const auto start = initial_state<double>(model, run.slots);
    auto engine = condensed_engine(model, run.slots, SystemKind{}, run.condensation);  // (factorises nothing)
    const ContactInput<double> input{model, run.slots, rho, start.history};
    const auto u = engine.begin(0, start.displacement, {});
    return uniqueness_of(contact_problem<double>(input, engine, u, run.condensation->schur(), nullptr));
  }
  return Uniqueness::unique;
}

template <class T>
void march(const Method& method, const Model& model, const Slots<T>& slots, Engine<T>& engine,
           const RunOptions& options, Workspace<T>& workspace, Trajectory<T>& trajectory) {
  Run<T> run{.method = method,
             .model = model,
             .slots = slots,
             .engine = engine,
             .account = {},
             .condensation = workspace.condensation};
  run.uniqueness = uniqueness_of(run);
  run.account.trace = options.trace;
  trajectory.initial = initial_state<T>(model, slots);
  const bool repeats = !options.replay.empty();
  const auto& times = repeats ? options.replay : model.times;
  workspace.checkpoints.reset();
  if (const auto plan = plan_checkpoints(model, options))
    workspace.checkpoints = std::make_shared<Checkpoints<T>>(*plan, times, !repeats);
  if (workspace.checkpoints) workspace.checkpoints->pass(run, trajectory);
  std::optional<Path<T>> path;
  if (model.scene.arc_length) path.emplace(run, trajectory);
  const auto ended = [&](std::size_t n) { return path && !repeats ? path->ended() : n == times.size(); };
  const auto step = [&](std::size_t n) {
    if (!path) return advance(run, trajectory, times[n], !repeats);
    return repeats ? path->repeat(times[n], options.guide) : path->advance();
  };
  bool reached = true;
  for (std::size_t n = 0; reached && !ended(n); ++n) {
    const std::size_t before = trajectory.increments.size();
    reached = step(n);
    for (std::size_t k = before; k < trajectory.increments.size();
         ++k) {  // status of the first increment that is not plainly converged
      const auto& increment = trajectory.increments[k];
      if (increment.status == Status::converged || (trajectory.status != Status::converged && reached)) continue;
      trajectory.status = increment.status;
      trajectory.message = increment.message;
    }
    if (options.on_step) {
      double aside = 0;  // seconds of on_step, which are not those of the run
      {
        const Stopwatch clock(aside);
        options.on_step();
      }
      trajectory.seconds.total -= aside;
    }
    if (reached && workspace.checkpoints) workspace.checkpoints->pass(run, trajectory);
  }
  if (repeats && !path)
    for (auto& increment : trajectory.increments)
      increment.requested = std::binary_search(model.times.begin(), model.times.end(), increment.time);
  trajectory.counters += run.account.counters;
  trajectory.seconds.contact_search += run.account.seconds.contact_search;
  trajectory.seconds.contact += run.account.seconds.contact;
  trajectory.seconds.bodies += run.account.seconds.bodies;
  trajectory.seconds.factorization += run.account.seconds.factorization;
  trajectory.seconds.backsolve += run.account.seconds.backsolve;
  trajectory.engine = engine.name();
  trajectory.reduced_unknowns = engine.unknowns();
}

}  // namespace detail

/// Solves a model by a method into an empty trajectory, which grows step by step. `model` and `slots` must outlive the
/// workspace's engine. Throws std::invalid_argument if options of the method contradict each other (conflict()).
template <class T>
void solve_in(const Model& model, const Slots<T>& slots, const Method& method, const RunOptions& options,
              Workspace<T>& workspace, Trajectory<T>& trajectory) {
  const auto [option, reason] = std::visit([](const auto& m) { return m.conflict(); }, method);
  if (!option.empty())
    throw std::invalid_argument(std::string(name_of(method)) + ": " + std::string(option) + " " + std::string(reason));
  const Stopwatch total(trajectory.seconds.total);
  const bool reused = workspace.condensation != nullptr;
  {
    const Stopwatch setup(trajectory.seconds.setup);
    make_engine<T>(model, slots, method, options, workspace);
  }
  if (workspace.condensation && !reused) trajectory.counters += workspace.condensation->counters;
  detail::march(method, model, slots, *workspace.engine, options, workspace, trajectory);
}
template <class T>
Trajectory<T> solve_in(const Model& model, const Slots<T>& slots, const Method& method, const RunOptions& options,
                       Workspace<T>& workspace) {
  Trajectory<T> trajectory;
  solve_in(model, slots, method, options, workspace, trajectory);
  return trajectory;
}

}  // namespace stickslip
