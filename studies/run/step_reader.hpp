/// Reads the states of a run while they are whole, before the run may thin them (methods/stepping/checkpoints.hpp).
#pragma once

#include <optional>
#include <vector>

#include "sensitivity/open_responses.hpp"
#include "studies/run/accuracy.hpp"
#include "studies/run/case.hpp"

namespace stickslip {

/// What is read of the state of a step.
struct StepReading {
  Margins margins;
  Vector<double> responses;
  std::vector<BodyMeasures> bodies;       ///< empty unless the state may be thinned
  std::vector<ContactMeasures> contacts;  ///< likewise
  OpenResponses::Found open;
  std::vector<char> at_vertex;  ///< per contact, whether a point is or was on a vertex (contacts_at_vertices())
  std::vector<char> at_end;  ///< likewise, whether one with friction is held by an end of its master, or let go there
  bool at_master_kink = false;  ///< integration_margin() counts as zero: no side of a derivative is known
};

class StepReader {
 public:
  /// Both must outlive it.
  StepReader(const Problem& problem, const Method& method);

  /// Reads the increments since the last call. `lets_go`: the run may thin states.
  void follow(const Trajectory<double>& trajectory, bool lets_go);
  /// Per increment; none for sub-steps.
  const std::vector<std::optional<StepReading>>& steps() const { return steps_; }
  const Accuracy& accuracy() const { return accuracy_.accuracy(); }

 private:
  /// `start`: time of the state before.
  StepReading read(const State<double>& before, double start, const Increment<double>& increment, bool lets_go) const;

  const Problem& problem_;
  AccuracyReader accuracy_;
  OpenResponses open_;
  std::vector<std::optional<StepReading>> steps_;
};

}  // namespace stickslip
