/// Overlaps that a penalty's solution has because supports or other contacts prescribe them: no stiffness removes
/// those.
#pragma once

#include "core/model/contact_assembly.hpp"
#include "core/model/point_tangent.hpp"
#include "methods/stepping/increment.hpp"
#include "methods/stepping/prescribed.hpp"

namespace stickslip {

namespace detail {

/// Indices of closed points whose constraints could contradict others. A point is left out if its slave node belongs to
/// no other point and is free along the normal. Segment-integrated points with present geometry share the nodes of
/// their slave facets; this sharing is no contradiction.
template <class T>
std::vector<int> shared_points(const Model& model, const Slots<T>& slots, const ContactField<T>& field) {
  std::vector<int> users(model.node_count, 0);
  for (const auto& point : model.points)
    for (std::size_t n = 0; n < point.nodes.size(); ++n) {
      const bool beside = n > 0 && static_cast<int>(n) < point.slave_nodes;
      if (!beside || !model.effects.current_geometry) ++users[point.nodes[n]];
    }
  std::vector<int> shared;
  for (std::size_t p = 0; p < model.points.size(); ++p) {
    if (field.state[p] == ContactState::open) continue;
    const int node = model.points[p].nodes[0];
    if (users[node] > 1 || is_held(model, slots, node, values(slots.geometry[p].normal)))
      shared.push_back(static_cast<int>(p));
  }
  return shared;
}

}  // namespace detail

/// A point whose overlap no stiffness removes, in words; empty if there is none.
///
/// One augmentation from the solution finds it, with 1e8 nodal stiffnesses. Tangential tractions stay, and points are
/// closed and opened until tractions and gaps agree. With present geometry Newton's method goes on until that is
/// solved. An overlap to which bodies can yield falls to some 1e-8 of itself. An overlap that supports or other
/// contacts prescribe stays, there or elsewhere; its force is stiffness times overlap. The augmentation is skipped
/// unless points share a node or are held by supports.
template <class T>
std::string unyielding_point(Run<T>& run, const ContactInput<T>& found, const Equilibrium<T>& equilibrium) {
  constexpr double stiff = 1e8, left = 1e-5, negligible = 1e-9;
  constexpr int most_rounds = 10;
  const Model& model = run.model;
  const auto shared = detail::shared_points(model, run.slots, equilibrium.field);
  double worst = negligible * run.account.scales.length;
  int point = -1;
  for (int p : shared)
    if (const double overlap = -value(equilibrium.field.gap[p]); overlap > worst) {
      worst = overlap;
      point = p;
    }
  if (point < 0) return "";
  RegularisationField<T> rho;
  for (std::size_t p = 0; p < model.points.size(); ++p) {
    const T nodal = T(stiff) * run.slots.stiffness[p] / run.slots.geometry[p].area;
    rho.push_back({nodal, nodal / T(stiff * stiff)});  // (so tangential tractions stay)
  }
  const ContactInput<T> input{model, run.slots, rho, found.previous, found.cone, found.time, &equilibrium.field.facing};
  const auto& traction = equilibrium.field.traction;
  const auto closed = [&](int p) { return model.points[p].tangents > 0 ? ContactState::stick : ContactState::slip; };
  std::vector<ContactState> states = equilibrium.field.state;
  for (std::size_t p = 0; p < states.size(); ++p)
    if (states[p] != ContactState::open) states[p] = closed(static_cast<int>(p));
  auto u = equilibrium.unknowns.u;
  double rest = 0;
  for (int round = 0; round < most_rounds; ++round) {
    const Vector<T> compact = run.engine.compact(u);
    const auto pushed = evaluate_contact<T>(input, compact, traction, &states);
    ForceScale unused;
    Vector<T> rows = run.engine.residual(u, contact_forces(model, run.slots, pushed), unused);
    for (Eigen::Index row = 0; row < rows.size(); ++row)
      if (!run.engine.is_free(row)) rows[row] = T(0);
    std::vector<PointTangent<T>> tangents;
    for (int p = 0; p < static_cast<int>(model.points.size()); ++p)
      tangents.push_back(point_tangent<T>(input, p, compact, traction, states[p], equilibrium.field.facing));
    if (!run.engine.factorise(tangents, run.account.counters)) return "";
    u += run.engine.solve({-rows, {}}).u.col(0);
    ++run.account.counters.backsolves;
    const auto after = evaluate_contact<T>(input, run.engine.compact(u), traction, &states);
    run.account.counters.contact_evaluations += 2 * static_cast<long>(model.points.size());
    rest = 0;
    bool settled = true;
    for (int p = 0; p < static_cast<int>(model.points.size()); ++p) {
      const double gap = value(after.gap[p]);
      const double trial = value(traction[model.points[p].multiplier]) + value(rho[p].normal) * gap;
      const bool is_open = states[p] == ContactState::open;
      rest = std::max(rest, -gap);
      if (is_open ? -gap <= left * worst : trial <= 0) continue;
      states[p] = is_open ? closed(p) : ContactState::open;
      settled = false;
    }
    if (settled && (rest <= left * worst || !model.effects.current_geometry)) break;
  }
  if (rest <= left * worst) return "";
  return name_of_point(model, run.slots, point) + " overlaps by " + short_number(worst) +
         ", which no stiffness removes: supports or other contacts prescribe it, and the force is stiffness times "
         "overlap";
}

}  // namespace stickslip
