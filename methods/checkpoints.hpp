/// A run whose states would take more memory than they may: which of them stay whole, and how the others come back.
///
/// The displacement in a state, and what bodies remember, grow with the bodies; a state without them is thin. Of N
/// steps the first n leave thin states behind, but for every s-th. Thin states come back a stretch at a time: its s - 1
/// steps are solved again from the last whole state. With room for M whole states
///
///   whole  N - n + n / s + (s - 1) <= M,      solved again  n - n / s
///
/// s is the least that there is room for, so that hardly more steps are solved again than there is no room for. Where
/// there is room for no s, s = sqrt(N) needs the least, 2 sqrt(N) states. A stretch begins with the scales and the
/// factor that the run had there, and so comes out the same to the last bit. Compare [GW00].
#pragma once

#include <memory>
#include <optional>
#include <variant>
#include <vector>

#include "methods/increment.hpp"
#include "methods/run.hpp"

namespace stickslip {

/// Bytes of a whole state beyond those of a thin one.
double thinned_bytes(const Model& model);

struct CheckpointPlan {
  std::size_t steps = 0, thinned = 0, stride = 1;  ///< N, n, s
  std::size_t output_every = 0;                    ///< RunOptions::output_every
  bool operator==(const CheckpointPlan&) const = default;
  /// Whether the states of a step stay whole; steps count from 1.
  bool keeps(std::size_t step) const {
    return step > thinned || step % stride == 0 || step == steps || (output_every > 0 && step % output_every == 0);
  }
  std::size_t whole() const;     ///< steps that stay so
  std::size_t repeated() const;  ///< steps that are solved again
};

/// None where there is room for the states of all steps, or all are to stay. Made of counts alone, hence the same on
/// every machine.
std::optional<CheckpointPlan> plan_checkpoints(const Model& model, const RunOptions& options);
std::optional<CheckpointPlan> plan_checkpoints(std::size_t steps, double room);

/// Increments that were solved again; `first`: place of the first of them in the trajectory.
template <class T>
struct Stretch {
  std::size_t first = 0;
  std::vector<Increment<T>> increments;
};

inline bool is_whole(const State<double>& state) { return state.displacement.size() > 0; }

/// What a run with thin states leaves to solve some of its steps again.
template <class T>
class Checkpoints {
 public:
  using Carried = std::variant<typename SparseEngine<T>::Carried, typename CondensedEngine<T>::Carried>;
  /// Where a stretch begins: the step before it, the account of the run after that, and its engine.
  struct Start {
    std::size_t step = 0;
    Account account;
    Carried engine;
  };

  /// `times`: ends of the steps; `may_cut`: whether those that fail are taken in smaller ones.
  Checkpoints(CheckpointPlan plan, std::vector<double> times, bool may_cut)
      : plan_(plan), may_cut_(may_cut), times_(std::move(times)) {}

  /// Takes in what a run is after another step, the first time before all; thins the states of the step before.
  template <class E>
  void pass(const Run<T, E>& run, Trajectory<T>& trajectory) {
    several_ = run.several;
    condensation_ = run.condensation;
    ends_.push_back(trajectory.increments.size());
    const std::size_t step = ends_.size() - 1;
    if (step % plan_.stride == 0 && step < plan_.thinned) {
      starts_.push_back({step, run.account, run.engine.carried()});
      starts_.back().account.trace = nullptr;
      starts_.back().account.counters = {};
    }
    if (step < 2 || plan_.keeps(step - 1)) return;
    for (std::size_t n = ends_[step - 2]; n < ends_[step - 1]; ++n) thin(trajectory.increments[n]);
  }

  const CheckpointPlan& plan() const { return plan_; }
  const std::vector<double>& times() const { return times_; }
  bool may_cut() const { return may_cut_; }
  bool several() const { return several_; }
  const std::shared_ptr<Condensation<T>>& condensation() const { return condensation_; }
  /// Increments up to the end of a step.
  std::size_t end(std::size_t step) const { return ends_[step]; }
  /// Where the stretch that holds increment n, which is thin, begins.
  const Start& start_of(std::size_t n) const {
    std::size_t k = starts_.size();
    while (k > 1 && end(starts_[k - 1].step) > n) --k;
    return starts_[k - 1];
  }
  std::size_t last_step(const Start& start) const {
    return std::min({start.step + plan_.stride - 1, plan_.thinned, ends_.size() - 2});  // (the last reached is whole)
  }
  /// Of what is kept of the factors that stretches begin with.
  long bytes() const {
    long sum = 0;
    for (const auto& start : starts_) sum += std::visit([](const auto& c) { return c.bytes(); }, start.engine);
    return sum;
  }

 private:
  static void thin(State<T>& state) { state.displacement = state.history.bodies = Vector<T>(); }
  static void thin(Increment<T>& increment) {
    thin(increment.state);
    for (auto& sweep : increment.augmented) thin(sweep.state);
  }

  CheckpointPlan plan_;
  bool may_cut_, several_ = false;
  std::vector<double> times_;
  std::vector<std::size_t> ends_;
  std::vector<Start> starts_;
  std::shared_ptr<Condensation<T>> condensation_;
};

}  // namespace stickslip
