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

/// Per contact, whether a point with friction is at a free end of its master in a step: held on what counts as the
/// master past the end, or let go although it pressed before. Empty if there is none.
std::vector<char> contacts_at_ends(const Model& model, const State<double>& before, const State<double>& state) {
  constexpr double rounding = 1e-9;  // of a facet
  std::vector<char> contacts;
  if (!model.slides_on_surfaces()) return contacts;
  for (std::size_t p = 0; p < model.points.size(); ++p) {
    const auto& point = model.points[p];
    if (point.surface < 0 || point.tangents == 0 || model.surfaces[point.surface].is_integrated()) continue;
    const Facing &now = state.contact.facing[p], &last = before.contact.facing[p];
    const auto is_past_end = [&] {
      return with_dimension(model.dimension, [&]<int D>() {
        return is_past_border(model.surfaces[point.surface].patches<D>()[now.patch], now.at, rounding);
      });
    };
    const bool is_held = state.contact.state[p] != ContactState::open && now.patch != no_patch && is_past_end();
    const bool is_let_go =
        before.contact.state[p] != ContactState::open && last.patch != no_patch && now.patch == no_patch;
    if (!is_held && !is_let_go) continue;
    contacts.resize(model.scene.contacts.size());
    contacts[point.contact] = 1;
  }
  return contacts;
}

}  // namespace

StepReader::StepReader(const Problem& problem, const Method& method)
    : problem_(problem), accuracy_(problem.model, problem.slots, method), open_(problem.model, problem.slots, method) {}

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
  step.at_vertex = contacts_at_vertices(model, slots, before, start, state, increment.time, open_.compliance());
  step.at_end = contacts_at_ends(model, before, state);
  step.responses = evaluate_responses(model, slots, state, increment.time);
  if (open_.is_called_for()) step.open = open_.of(state, increment.time, step.responses);
  for (std::size_t b = 0; lets_go && b < model.bodies.size(); ++b)
    step.bodies.push_back(measures_of_body(problem_, state, b));
  for (std::size_t c = 0; lets_go && c < model.scene.contacts.size(); ++c)
    step.contacts.push_back(measures_of_contact(problem_, state, increment.time, static_cast<int>(c)));
  return step;
}

void StepReader::follow(const Trajectory<double>& trajectory, bool lets_go) {
  for (std::size_t n = steps_.size(); n < trajectory.increments.size(); ++n) {
    const auto& increment = trajectory.increments[n];
    const auto& before = trajectory.before(n);
    const double start = n == 0 ? 0 : trajectory.increments[n - 1].time;
    accuracy_.read(before, increment);
    steps_.emplace_back();
    if (increment.requested) steps_.back() = read(before, start, increment, lets_go);
  }
}

}  // namespace stickslip
