/// What is read of a run's states while it goes, before it may let them go (methods/checkpoints.hpp).
#pragma once

#include <optional>
#include <vector>

#include "studies/run/accuracy.hpp"
#include "studies/run/case.hpp"

namespace stickslip {

/// Of the state of a step.
struct StepReading {
  Margins margins;
  Vector<double> responses;
  std::vector<BodyMeasures> bodies;  ///< where the state may be let go; else empty
};

class StepReader {
 public:
  /// Both must outlive it.
  StepReader(const Problem& problem, const Method& method)
      : problem_(problem), accuracy_(problem.model, problem.slots, method) {}

  /// Reads what has come since the last call. `lets_go`: the run may let states go.
  void follow(const Trajectory<double>& trajectory, bool lets_go);
  /// Per increment; none of sub-steps.
  const std::vector<std::optional<StepReading>>& steps() const { return steps_; }
  const Accuracy& accuracy() const { return accuracy_.accuracy(); }

 private:
  StepReading read(const State<double>& before, const Increment<double>& increment, bool lets_go) const;

  const Problem& problem_;
  AccuracyReader accuracy_;
  std::vector<std::optional<StepReading>> steps_;
};

}  // namespace stickslip
