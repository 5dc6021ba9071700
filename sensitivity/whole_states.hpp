/// The increments of a run for those who go through all of them: as they are where they are whole, solved again where
/// they are thin (methods/checkpoints.hpp).
#pragma once

#include "methods/method.hpp"

namespace stickslip {

class WholeStates {
 public:
  /// All must outlive it; the workspace is that of the run.
  WholeStates(const Model& model, const Slots<double>& slots, const Method& method,
              const Trajectory<double>& trajectory, Workspace<double>& workspace)
      : model_(model), slots_(slots), method_(method), trajectory_(trajectory), workspace_(workspace) {}

  std::size_t count() const { return trajectory_.increments.size(); }
  /// Increment n, whole. It and the state before it are there together, until others are asked for: between two
  /// stretches of thin ones there is one that is not.
  const Increment<double>& increment(std::size_t n);
  /// The state that increment n began from.
  const State<double>& before(std::size_t n) { return n == 0 ? trajectory_.initial : increment(n - 1).state; }

  long repeated() const { return repeated_; }  ///< increments that were solved again
  long bytes() const { return bytes_; }        ///< of the stretch that took most
  /// What they took, since it was asked for last.
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
