/// Checkpoints: which states of a run stay whole if all of them would take too much memory, and how the others are
/// restored.
///
/// The displacement of a state and the memory of its bodies grow with the bodies; a state without them is thin. Of N
/// steps the first n leave thin states, except every s-th. Thin states are restored one stretch at a time: the s - 1
/// steps after a whole state are solved again. With room for M whole states
///
///   whole  N - n + n / s + (s - 1) <= M,      solved again  n - n / s
///
/// s is the least for which there is room. So hardly more steps are solved again than the memory requires. If there is
/// room for no s, s = sqrt(N) needs the least memory, 2 sqrt(N) states. A stretch begins with the scales and the factor
/// that the run had there, so its states come out the same, bit for bit. Compare [GW00].
#pragma once

#include <memory>
#include <optional>
#include <vector>

#include "methods/stepping/increment.hpp"
#include "methods/stepping/run_options.hpp"

namespace stickslip {

/// Bytes by which a whole state exceeds a thin one.
double thinned_bytes(const Model& model);

/// Which steps stay whole.
struct CheckpointPlan {
  std::size_t steps = 0, thinned = 0, stride = 1;  ///< N, n, s
  std::size_t output_every = 0;                    ///< RunOptions::output_every
  bool operator==(const CheckpointPlan&) const = default;
  /// Whether the states of a step stay whole; steps count from 1.
  bool keeps(std::size_t step) const {
    return step > thinned || step % stride == 0 || step == steps || (output_every > 0 && step % output_every == 0);
  }
  std::size_t whole() const;     ///< number of steps whose states stay whole
  std::size_t repeated() const;  ///< number of steps that are solved again
};

/// Plan of a run; none if there is room for the states of all steps, or if all are to stay. It depends on counts alone,
/// so it is the same on every machine. `room`: whole states that fit into memory.
std::optional<CheckpointPlan> plan_checkpoints(const Model& model, const RunOptions& options);
std::optional<CheckpointPlan> plan_checkpoints(std::size_t steps, double room);

/// Increments that were solved again. `first`: index of the first in the trajectory.
template <class T>
struct Stretch {
  std::size_t first = 0;
  std::vector<Increment<T>> increments;
};

inline bool is_whole(const State<double>& state) { return state.displacement.size() > 0; }

/// What is needed to solve steps of a run with thin states again.
template <class T>
class Checkpoints {
 public:
  /// Beginning of a stretch: the step before it, and the account and the engine of the run after that step.
  struct Start {
    std::size_t step = 0;
    Account account;
    EngineMemory<T> engine;
  };

  /// `times`: ends of the steps; `steps`: what became of those that failed.
  Checkpoints(CheckpointPlan plan, std::vector<double> times, Steps steps)
      : plan_(plan), steps_(steps), times_(std::move(times)) {}

  /// Records the run after each step, and once before the first. Thins the states of the previous step.
  void pass(const Run<T>& run, Trajectory<T>& trajectory) {
    uniqueness_ = run.uniqueness;
    condensation_ = run.condensation;
    ends_.push_back(trajectory.increments.size());
    const std::size_t step = ends_.size() - 1;
    if (step % plan_.stride == 0 && step < plan_.thinned) {
      starts_.push_back({step, run.account, run.engine.memory()});
      starts_.back().account.trace = nullptr;
      starts_.back().account.counters = {};
    }
    if (step < 2 || plan_.keeps(step - 1)) return;
    for (std::size_t n = ends_[step - 2]; n < ends_[step - 1]; ++n) thin(trajectory.increments[n]);
  }

  const CheckpointPlan& plan() const { return plan_; }
  const std::vector<double>& times() const { return times_; }
  Steps steps() const { return steps_; }
  Uniqueness uniqueness() const { return uniqueness_; }
  const std::shared_ptr<Condensation<T>>& condensation() const { return condensation_; }
  /// Number of increments up to the end of a step.
  std::size_t end(std::size_t step) const { return ends_[step]; }
  /// Beginning of the stretch that contains the thin increment n.
  const Start& start_of(std::size_t n) const {
    std::size_t k = starts_.size();
    while (k > 1 && end(starts_[k - 1].step) > n) --k;
    return starts_[k - 1];
  }
  /// Last step of a stretch.
  std::size_t last_step(const Start& start) const {
    // (the last step reached is whole)
    return std::min({start.step + plan_.stride - 1, plan_.thinned, ends_.size() - 2});
  }
  /// Bytes of the factors that stretches begin with.
  long bytes() const {
    long sum = 0;
    for (const auto& start : starts_) sum += start.engine.bytes();
    return sum;
  }

 private:
  static void thin(State<T>& state) { state.displacement = state.history.bodies = Vector<T>(); }
  static void thin(Increment<T>& increment) {
    thin(increment.state);
    for (auto& sweep : increment.augmented) thin(sweep.state);
  }

  CheckpointPlan plan_;
  Steps steps_;
  Uniqueness uniqueness_ = Uniqueness::unique;
  std::vector<double> times_;
  std::vector<std::size_t> ends_;
  std::vector<Start> starts_;
  std::shared_ptr<Condensation<T>> condensation_;
};

/// The stretch of a run that contains the thin increment n, whole again. `workspace`: that of the run; it is left as it
/// was. The work is added to `counters`.
Stretch<double> solve_again(const Model& model, const Slots<double>& slots, const Method& method,
                            const Trajectory<double>& trajectory, std::size_t n, Workspace<double>& workspace,
                            Counters& counters);

}  // namespace stickslip
