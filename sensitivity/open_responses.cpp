#include "sensitivity/open_responses.hpp"

#include <cmath>
#include <limits>

#include "core/model/objective.hpp"
#include "core/model/response.hpp"
#include "methods/newton/regularisation.hpp"

namespace stickslip {
namespace {

/// Of the tangential springs of a method that lets points slip elastically; empty for others, and without friction.
std::vector<double> tangential_compliance(const Model& model, const Slots<double>& slots, const Method& method) {
  std::vector<double> compliance;
  std::visit(
      [&](const auto& m) {
        if (m.prevents_penetration || !model.effects.friction) return;
        for (const auto& rho : initial_regularisation(slots, m)) compliance.push_back(1 / rho.tangential);
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
      return force * (response.component == Response::Component::moment ? extent : 1);
    case Response::Kind::contact_pressure:
      return traction;
    case Response::Kind::contact_half_width:
      return extent;
    default:
      return 0;
  }
}

}  // namespace

OpenResponses::OpenResponses(const Model& model, const Slots<double>& slots, const Method& method)
    : model_(model), slots_(slots), forces_(model, slots), compliance_(tangential_compliance(model, slots, method)) {}

/// (They differ where the forces that the state does not determine are others.)
std::vector<char> OpenResponses::that_hang_on(const State<double>& state, double time, const Matrix<double>& changes,
                                              const Vector<double>& values) const {
  constexpr double small = 1e-3;     // of the largest pressure: a change that lets points press
  constexpr double rounding = 1e-9;  // of what a change could do
  const double extent = (slots_.points.rowwise().maxCoeff() - slots_.points.rowwise().minCoeff()).norm();
  std::vector<char> open(model_.scene.responses.size(), 0);
  for (const auto& change : changes.colwise()) {
    State<double> other = state;
    other.contact.traction += small * change;
    double force = 0;
    for (std::size_t p = 0; p < model_.points.size(); ++p)
      force += small * geometry_in(state.contact, slots_, static_cast<int>(p)).area *
               change.segment(model_.points[p].multiplier, model_.points[p].components()).norm();
    const double traction = small * change.cwiseAbs().maxCoeff();
    const auto changed = evaluate_responses(model_, slots_, other, time);
    for (std::size_t i = 0; i < open.size(); ++i) {
      const double reach = reach_of(model_.scene.responses[i], force, traction, extent);
      open[i] |= reach > 0 && std::abs(changed[i] - values[i]) > rounding * reach;
    }
  }
  return open;
}

OpenResponses::Found OpenResponses::of(const State<double>& state, double time, const Vector<double>& values) const {
  auto forces = forces_.undetermined(state, compliance_);
  Found found;
  if (!forces.contacts.empty()) found.responses = that_hang_on(state, time, forces.changes, values);
  found.contacts = std::move(forces.contacts);
  return found;
}

std::vector<char> open_objectives(const Model& model, const Slots<double>& slots,
                                  const std::vector<std::pair<double, std::vector<char>>>& steps) {
  Vector<double> sums = Vector<double>::Zero(model.scene.objectives.size());
  for (const auto& [time, open] : steps) {
    Vector<double> responses = Vector<double>::Zero(model.scene.responses.size());
    for (std::size_t i = 0; i < open.size(); ++i)
      if (open[i]) responses[i] = std::numeric_limits<double>::quiet_NaN();
    add_contributions(model, slots.numbers, time, responses, sums);
  }
  std::vector<char> open;
  for (double sum : sums) open.push_back(std::isnan(sum));
  return open;
}

}  // namespace stickslip
