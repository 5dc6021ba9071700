/// Whether a step passes several places at once where bodies begin to give way.
///
/// Example: one step presses a slender bar beyond four of its buckling loads. The straight shape, or one near it, is an
/// equilibrium still, and Newton's method goes to it, though the bar would have bent aside. The sign of the tangent's
/// determinant (Engine::reversed) does not tell: of an even number of motions that nothing resists it is that of a
/// stable equilibrium. So they are counted, of the bodies' tangent with a stiff spring at each contact that is closed,
/// along its normal, and along the tangents too if it sticks. Tractions turn with the normals: without that, a ring
/// that is pressed from outside would seem free to turn. What friction couples while a point slips is left out, as is
/// what is not symmetric.
#pragma once

#include "core/model/point_tangent.hpp"
#include "methods/stepping/increment.hpp"

namespace stickslip {

/// A symmetric tangent of a closed point, from that of its augmented traction t = lambda + rho g at lambda + rho g = t:
///
///   A rho dg/du^T dg/du    a spring, of which `row_w` is A rho dg/du
///   (d force/du)_t         symmetric part of what a traction that stays does as its normal turns
template <class T>
Matrix<T> spring_tangent(const PointTangent<T>& at, const PointRegularisation<T>& rho, const T& area) {
  Matrix<T> spring = Matrix<T>::Constant(at.row_w.cols(), at.row_w.cols(), T(0)), turning = at.force_w;
  for (Eigen::Index c = 0; c < at.row_w.rows(); ++c) {
    const T stiffness = area * (c == 0 ? rho.normal : rho.tangential);
    if (stiffness == T(0)) continue;  // (it slips along c)
    spring += at.row_w.row(c).transpose() * at.row_w.row(c) / stiffness;
    turning -= at.force_l.col(c) * at.row_w.row(c) / stiffness;
  }
  return spring + T(0.5) * (turning + turning.transpose());
}

/// The tangents of contacts in an increment's states, as stiff springs that bear its tractions.
template <class T>
std::vector<PointTangent<T>> contact_springs(const Run<T>& run, const State<T>& previous, const Increment<T>& at) {
  constexpr double stiff = 1e4;  // times the stiffness of the nodes
  const auto& [model, slots] = std::tie(run.model, run.slots);
  const ContactField<T>& field = at.state.contact;
  RegularisationField<T> rho;
  Vector<T> multiplier = field.traction;
  std::vector<ContactState> branches;
  for (std::size_t p = 0; p < model.points.size(); ++p) {
    const auto& point = model.points[p];
    const T normal = T(stiff) * slots.stiffness[p] / slots.geometry[p].area;
    rho.push_back({normal, field.state[p] == ContactState::stick ? normal : T(0)});
    multiplier[point.multiplier] -= rho[p].normal * field.gap[p];
    for (int a = 0; a < point.tangents; ++a)
      multiplier[point.multiplier + 1 + a] -= rho[p].tangential * field.slip[tangential_offset(model, p) + a];
    const bool may_stick = field.state[p] == ContactState::slip && point.tangents > 0;
    branches.push_back(may_stick ? ContactState::stick : field.state[p]);
  }
  const ContactInput<T> input{model, slots, rho, previous.history, ConeRadius::augmented, at.time};
  const Vector<T> compact = to_compact(model, at.state.displacement);
  std::vector<PointTangent<T>> springs;
  for (std::size_t p = 0; p < model.points.size(); ++p) {
    springs.push_back(point_tangent<T>(input, static_cast<int>(p), compact, multiplier, branches[p], field.facing));
    if (branches[p] != ContactState::open)
      springs[p].force_w = spring_tangent(springs[p], rho[p], slots.geometry[p].area);
  }
  return springs;
}

/// Whether the bodies' tangent is the second derivative of an energy, of which bending is a part: not that of metal, of
/// loads that follow the bodies, nor of bars and points. It says nothing of a body that is free to move.
template <class T>
bool may_buckle(const Run<T>& run) {
  const Model& model = run.model;
  return !model.effects.linear_bulk && model.memory_count == 0 && model.followers.empty() && run.free.words.empty() &&
         std::any_of(model.bodies.begin(), model.bodies.end(),
                     [](const auto& body) { return is_continuum(body.mesh.shape); });
}

/// Number of motions that nothing resists in the equilibrium of an increment, of which the engine made the last
/// tangent. Nothing if it is not known, or if there is no equilibrium.
template <class T>
std::optional<int> motions_unresisted(Run<T>& run, const State<T>& previous, const Increment<T>& increment) {
  if (!increment.usable() || !may_buckle(run)) return std::nullopt;
  return run.engine.motions_unresisted(contact_springs(run, previous, increment), run.account.counters);
}

}  // namespace stickslip
