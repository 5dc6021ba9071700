/// The branches that Newton's method assumes of contact points: they shape its path, not the solution.
#pragma once

#include "core/model/contact_assembly.hpp"
#include "methods/newton/equilibrium.hpp"

namespace stickslip {

namespace detail {

/// What a point's state follows from, tractions.
struct ContactTrial {
  double pressure = 0, tangential = 0, bound = 0;
  template <class T>
  ContactState state(const ContactInput<T>& input, int p, const Vector<T>& compact) const {
    const auto& point = input.model.points[p];
    const double tie = value(input.rho[p].normal) * tie_at(input, p, compact);
    const auto state = classify(Traction<double, 1>{-pressure, Vec<double, 1>(tangential)}, bound, tie);
    return is_slipping(state) && point.tangents > 0 ? input.slots.friction[point.contact].piece(pressure) : state;
  }
};

/// The trial of a point after a step in a branch that solved for its traction. The traction says the state of a closed
/// point, for its gap is what the curvature of surfaces left. The gap says that of an open one. (Where geometry is
/// linear both say the same but for rounding.) `seen`: the multipliers that stand beside gap and slip. They differ from
/// those that were solved for where these are tractions of points with given multipliers (Compliance).
template <class T>
ContactTrial trial_after(const ContactInput<T>& input, int p, const Vector<T>& multiplier, const Vector<T>& seen,
                         ContactState branch, const ContactField<T>& field) {
  const auto& point = input.model.points[p];
  const auto& rho = input.rho[p];
  ContactTrial trial;
  trial.pressure = -value(multiplier[point.multiplier]);
  if (branch == ContactState::open)
    trial.pressure = -(value(seen[point.multiplier]) + value(rho.normal) * value(field.gap[p]));
  trial.tangential = root_of_squares(point.tangents, [&](int a) {
    const int k = point.multiplier + 1 + a;
    return branch == ContactState::stick
               ? value(multiplier[k])
               : value(seen[k]) + value(rho.tangential) * value(field.slip[tangential_offset(input.model, p) + a]);
  });
  if (point.tangents > 0) trial.bound = input.slots.friction[point.contact].bound(trial.pressure);
  return trial;
}

/// Gives points that start on their cone, up to 1e-8, the branch of the last increment. Why: a point that slipped then
/// starts there, off the cone by what that increment's tolerance left, and rounding must not decide where the path
/// begins. If it slips on, the front of slip need not be found anew. If it turns back, the first step takes it inside
/// its cone.
template <class T>
void resume_on_cone(const ContactInput<T>& input, const Vector<T>& multiplier, std::span<const ContactState> last,
                    ContactField<T>& field) {
  for (int p = 0; p < static_cast<int>(input.model.points.size()); ++p) {
    const auto& point = input.model.points[p];
    if (field.state[p] == ContactState::open || point.tangents == 0) continue;
    const double trial = trial_after(input, p, multiplier, multiplier, ContactState::slip, field).tangential;
    const auto& law = input.slots.friction[point.contact];
    const double pressure = -value(field.traction[point.multiplier]), bound = law.bound(pressure);
    if (bound > 0 && std::abs(trial - bound) <= 1e-8 * bound)
      field.state[p] = is_slipping(last[p]) ? law.piece(pressure) : ContactState::stick;
  }
}

/// The branches that a Newton step is taken in: those of the evaluation, with two exceptions.
///   - A point at the apex of its cone (closed, no bound, no tangential trial) sticks, which is an element of the
///     generalised derivative there: a body that only friction holds then has a regular first tangent.
///   - A point that slipped in the last step and would now slip the other way sticks first. Far from the solution a
///     large rho turns any small overshoot of the slip into slip of the opposite sign, and points flip for ever; stick
///     lies between the two.
/// `last`: field and branches of the last step; empty at the first.
template <class T>
std::vector<ContactState> step_branches(const ContactInput<T>& input, const Vector<T>& compact,
                                        const ContactField<T>& field, const Vector<T>& multiplier,
                                        const ContactField<T>& last) {
  const Model& model = input.model;
  std::vector<ContactState> branches = field.state;
  for (int p = 0; p < static_cast<int>(model.points.size()); ++p) {
    const auto& point = model.points[p];
    if (!is_slipping(branches[p]) || point.tangents == 0 || input.slots.friction[point.contact].bears_nothing())
      continue;
    const double rounding = tie_at(input, p, compact);
    bool apex = input.slots.friction[point.contact].has_apex() &&
                std::abs(value(field.traction[point.multiplier])) <= value(input.rho[p].normal) * rounding;
    const double tie = value(input.rho[p].tangential) * rounding;
    double along_last = 0;
    for (int a = 0; a < point.tangents; ++a) {
      const int k = point.multiplier + 1 + a;
      const double slip = value(field.slip[tangential_offset(model, p) + a]);
      apex &= std::abs(value(multiplier[k]) + value(input.rho[p].tangential) * slip) <= tie;
      if (!last.state.empty()) along_last += value(field.traction[k]) * value(last.traction[k]);
    }
    const bool reversed = !last.state.empty() && is_slipping(last.state[p]) && along_last < 0;
    if (apex || reversed) branches[p] = ContactState::stick;
  }
  return branches;
}

/// Branches with all open points closed, and sticking where there is friction.
template <class T>
std::vector<ContactState> presume_contact(const ContactInput<T>& input, std::vector<ContactState> branches) {
  for (std::size_t p = 0; p < branches.size(); ++p) {
    const auto& point = input.model.points[p];
    if (branches[p] != ContactState::open) continue;
    const bool rough = point.tangents > 0 && !input.slots.friction[point.contact].bears_nothing();
    branches[p] = rough ? ContactState::stick : ContactState::slip;
  }
  return branches;
}

}  // namespace detail

}  // namespace stickslip
