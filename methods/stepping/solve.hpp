/// Runs of any method and scalar: steps in time, or along a path. solve_in() is the template, which the oracle of the
/// tests instantiates in complex numbers. solve() of methods/method.hpp is solve_in() in double.
///
/// The way of the state through one step:
///
///   march             reads the last state, Trajectory::last(), and asks for each time of the scene
///   StepInParts       cuts the step into parts if it must                      methods/stepping/step.hpp
///   IncrementSearch   what is tried for a part, in which order                 methods/rescue/rescue.hpp
///   solve_increment   the method: (u, lambda) of the last state -> the next    methods/penalty.hpp, uzawa.hpp, ...
///   find_equilibrium  what is tried for one equilibrium                        methods/rescue/find_equilibrium.hpp
///   newton            iterates; its solution has u, lambda and ContactField    methods/newton/newton.hpp
///   settle            makes the next State of them, with its History           methods/stepping/increment.hpp
///   StepInParts       appends the increment to the trajectory
#pragma once

#include <stdexcept>

#include "methods/stepping/checkpoints.hpp"
#include "methods/stepping/engine_choice.hpp"
#include "methods/stepping/path.hpp"
#include "methods/stepping/step.hpp"

namespace stickslip {

namespace detail {

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
  const Steps steps = repeats ? Steps::whole : Steps::cut;
  const auto& times = repeats ? options.replay : model.times;
  workspace.checkpoints.reset();
  if (const auto plan = plan_checkpoints(model, options))
    workspace.checkpoints = std::make_shared<Checkpoints<T>>(*plan, times, steps);
  if (workspace.checkpoints) workspace.checkpoints->pass(run, trajectory);
  std::optional<Path<T>> path;
  if (model.scene.arc_length) path.emplace(run, trajectory);
  const auto ended = [&](std::size_t n) { return path && !repeats ? path->ended() : n == times.size(); };
  const auto step = [&](std::size_t n) {
    if (!path) return advance(run, trajectory, times[n], steps);
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
