#include "studies/run/step_reader.hpp"

#include "core/model/response.hpp"
#include "sensitivity/vertex_margin.hpp"
#include "studies/run/warnings.hpp"

namespace stickslip {
namespace {

/// Whether bodies move in an increment; where they rest, what is on its bound stays there.
bool flows_on(const State<double>& from, const State<double>& to) {
  constexpr double rest = 1e-12;  // of the displacement: rounding
  return (to.displacement - from.displacement).cwiseAbs().maxCoeff() > rest * to.displacement.cwiseAbs().maxCoeff();
}

}  // namespace

StepReading StepReader::read(const State<double>& before, const Increment<double>& increment, bool lets_go) const {
  const auto& [model, slots, unused] = problem_;
  const State<double>& state = increment.state;
  StepReading step;
  step.margins = margins(model, slots, state);
  if (model.effects.plasticity && flows_on(before, state))
    step.margins.yield = yield_margin(model, slots, {state.displacement, before.history.bodies});
  step.margins.vertex = vertex_margin(model, slots, state, increment.time);
  step.responses = evaluate_responses(model, slots, state, increment.time);
  for (std::size_t b = 0; lets_go && b < model.bodies.size(); ++b)
    step.bodies.push_back(measures_of_body(problem_, state, b));
  return step;
}

void StepReader::follow(const Trajectory<double>& trajectory, bool lets_go) {
  for (std::size_t n = steps_.size(); n < trajectory.increments.size(); ++n) {
    const auto& increment = trajectory.increments[n];
    const auto& before = n == 0 ? trajectory.initial : trajectory.increments[n - 1].state;
    accuracy_.read(before, increment);
    steps_.emplace_back();
    if (increment.requested) steps_.back() = read(before, increment, lets_go);
  }
}

}  // namespace stickslip
