#include "studies/run/step_reader.hpp"

#include "core/model/response.hpp"
#include "sensitivity/vertex_margin.hpp"
#include "studies/run/contact_warnings.hpp"
#include "studies/run/warnings.hpp"

namespace stickslip {
namespace {

/// Whether bodies move in an increment; where they rest, what is on its bound stays there.
bool flows_on(const State<double>& from, const State<double>& to) {
  constexpr double rest = 1e-12;  // of the displacement: rounding
  return (to.displacement - from.displacement).cwiseAbs().maxCoeff() > rest * to.displacement.cwiseAbs().maxCoeff();
}

/// Of the tangential springs of a method that lets points slip elastically; empty for others, and without friction.
std::vector<double> tangential_compliance(const Problem& problem, const Method& method) {
  std::vector<double> compliance;
  std::visit(
      [&](const auto& m) {
        if (m.prevents_penetration || !problem.model.effects.friction) return;
        for (const auto& rho : initial_regularisation(problem.slots, m)) compliance.push_back(1 / rho.tangential);
      },
      method);
  return compliance;
}

/// How much a change of tractions may change a response of a kind: what is less by far is rounding. 0 where it hangs on
/// no traction. `force`, `traction`: of the change; `extent` of the model.
double reach_of(const Response& response, double force, double traction, double extent) {
  switch (response.kind) {
    case Response::Kind::reaction:
    case Response::Kind::contact_force:
      return force * (response.component == "moment" ? extent : 1);
    case Response::Kind::contact_pressure:
      return traction;
    case Response::Kind::contact_half_width:
      return extent;
    default:
      return 0;
  }
}

/// Responses that differ where forces that a state does not determine are others.
std::vector<char> responses_that_hang_on(const Problem& problem, const State<double>& state, double time,
                                         const Matrix<double>& changes, const Vector<double>& values) {
  constexpr double small = 1e-3;     // of the largest pressure: a change that lets points press
  constexpr double rounding = 1e-9;  // of what a change could do
  const auto& [model, slots, unused] = problem;
  const double extent = (slots.points.rowwise().maxCoeff() - slots.points.rowwise().minCoeff()).norm();
  std::vector<char> open(model.scene.responses.size(), 0);
  for (const auto& change : changes.colwise()) {
    State<double> other = state;
    other.contact.traction += small * change;
    double force = 0;
    for (std::size_t p = 0; p < model.points.size(); ++p)
      force += small * geometry_in(state.contact, slots, static_cast<int>(p)).area *
               change.segment(model.points[p].multiplier, model.points[p].components()).norm();
    const double traction = small * change.cwiseAbs().maxCoeff();
    const auto changed = evaluate_responses(model, slots, other, time);
    for (std::size_t i = 0; i < open.size(); ++i) {
      const double reach = reach_of(model.scene.responses[i], force, traction, extent);
      open[i] |= reach > 0 && std::abs(changed[i] - values[i]) > rounding * reach;
    }
  }
  return open;
}

}  // namespace

StepReader::StepReader(const Problem& problem, const Method& method)
    : problem_(problem),
      accuracy_(problem.model, problem.slots, method),
      forces_(problem.model, problem.slots),
      compliance_(tangential_compliance(problem, method)) {}

StepReading StepReader::read(const State<double>& before, double start, const Increment<double>& increment,
                             bool lets_go) const {
  const auto& [model, slots, unused] = problem_;
  const State<double>& state = increment.state;
  StepReading step;
  step.margins = margins(model, slots, state);
  if (model.effects.plasticity && flows_on(before, state))
    step.margins.yield = yield_margin(model, slots, {state.displacement, before.history.bodies});
  step.margins.vertex = vertex_margin(model, slots, state, increment.time);
  step.at_master_kink =
      step.margins.vertex <= weak_margin && integration_margin(model, slots, state, increment.time) <= weak_margin;
  step.at_vertex = contacts_at_vertices(model, slots, before, start, state, increment.time, compliance_);
  step.responses = evaluate_responses(model, slots, state, increment.time);
  if (forces_.is_called_for()) {
    auto found = forces_.undetermined(state, compliance_);
    if (!found.contacts.empty())
      step.open_responses = responses_that_hang_on(problem_, state, increment.time, found.changes, step.responses);
    step.undetermined = std::move(found.contacts);
  }
  for (std::size_t b = 0; lets_go && b < model.bodies.size(); ++b)
    step.bodies.push_back(measures_of_body(problem_, state, b));
  for (std::size_t c = 0; lets_go && c < model.scene.contacts.size(); ++c)
    step.contacts.push_back(measures_of_contact(problem_, state, increment.time, static_cast<int>(c)));
  return step;
}

void StepReader::follow(const Trajectory<double>& trajectory, bool lets_go) {
  for (std::size_t n = steps_.size(); n < trajectory.increments.size(); ++n) {
    const auto& increment = trajectory.increments[n];
    const auto& before = n == 0 ? trajectory.initial : trajectory.increments[n - 1].state;
    const double start = n == 0 ? 0 : trajectory.increments[n - 1].time;
    accuracy_.read(before, increment);
    steps_.emplace_back();
    if (increment.requested) steps_.back() = read(before, start, increment, lets_go);
  }
}

}  // namespace stickslip
