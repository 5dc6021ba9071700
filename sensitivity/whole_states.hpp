/// Whole increments of a run, one after another: as they are, or solved again if they are thin
/// (methods/stepping/checkpoints.hpp).
#pragma once

#include "methods/method.hpp"
#include "methods/stepping/checkpoints.hpp"

namespace stickslip {

class WholeStates {
 public:
  /// The arguments must outlive it. `workspace`: that of the run.
  WholeStates(const Model& model, const Slots<double>& slots, const Method& method,
              const Trajectory<double>& trajectory, Workspace<double>& workspace)
      : model_(model), slots_(slots), method_(method), trajectory_(trajectory), workspace_(workspace) {}

  /// Number of increments that have derivatives.
  std::size_t count() const { return trajectory_.solved_count(); }
  /// Increment n, whole. Its reference, and that of before(n), are valid until another increment is asked for. Both
  /// exist together, because a whole increment lies between two stretches of thin ones.
  const Increment<double>& increment(std::size_t n);
  /// State at the beginning of increment n.
  const State<double>& before(std::size_t n) { return n == 0 ? trajectory_.initial : increment(n - 1).state; }

  long repeated() const { return repeated_; }  ///< number of increments that were solved again
  long bytes() const { return bytes_; }        ///< of the largest stretch
  /// Work of solving again since the last call.
  Counters take_counters() { return std::exchange(counters_, {}); }

 private:
  const Model& model_;
  const Slots<double>& slots_;
  const Method& method_;
  const Trajectory<double>& trajectory_;
  Workspace<double>& workspace_;
  Stretch<double> stretch_;
  Counters counters_;
  long repeated_ = 0, bytes_ = 0;
};

}  // namespace stickslip
