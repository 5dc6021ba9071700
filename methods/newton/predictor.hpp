/// Where Newton's method begins when supports or obstacles move bodies that are not linear: displaced along the tangent
/// of the state that is left,
///
///   K du_free = -R(u, t) - K du_prescribed,
///
/// Without it a step taken by the nodes at the supports alone would crush the elements there, and an obstacle that
/// withdraws would leave all that it touches. R is that of obstacles where they have moved to, and what touched them
/// follows.
#pragma once

#include "core/model/point_tangent.hpp"
#include "methods/newton/newton_tangent.hpp"

namespace stickslip {

namespace detail {

/// Adds what a motion of the contact nodes (compact) makes of contact forces (compact) and multiplier rows.
template <class T>
void add_tangent_times(const Model& model, const Slots<T>& slots, const std::vector<PointTangent<T>>& tangents,
                       const Vector<T>& motion, Vector<T>& forces, Vector<T>& rows) {
  for (std::size_t p = 0; p < tangents.size(); ++p) {
    const auto& tangent = tangents[p];
    const Vector<T> u = gather(model, slots, p, tangent, motion);
    scatter(model, slots, p, tangent, Vector<T>(tangent.force_w * u), forces);
    if (rows.size() > 0) rows.segment(model.points[p].multiplier, tangent.row_w.rows()) += tangent.row_w * u;
  }
}

/// Whether the obstacle of a point moves.
inline bool moves(const Model& model, const ContactPoint& point) {
  if (point.obstacle < 0) return false;
  const auto& obstacle = model.scene.obstacles[point.obstacle];
  return !obstacle.move.empty() || obstacle.rotate.has_value();
}

/// Branches in which points that pressed on an obstacle that moves go on with it. `resumed`: their states; empty: none.
template <class T>
void follow_obstacles(const Model& model, const State<T>& last, std::span<const ContactState> resumed,
                      std::vector<ContactState>& branches) {
  for (std::size_t p = 0; p < resumed.size(); ++p) {
    const auto& point = model.points[p];
    const bool pressed = resumed[p] != ContactState::open && value(last.contact.traction[point.multiplier]) < 0;
    if (pressed && moves(model, point)) branches[p] = resumed[p];
  }
}

}  // namespace detail

/// Takes the first step of a path, along the load: where it begins the residual vanishes.
template <class T>
bool begin_path(Engine<T>& engine, const EquilibriumTask<T>& task, Evaluator<T>& evaluate, NewtonTangent<T>& tangent,
                Account& account, Unknowns<T>& unknowns) {
  auto at = evaluate(unknowns);
  auto branches = detail::step_branches(task.contact, engine.compact(unknowns.u), at.field, unknowns.multiplier, {});
  tangent.move_to(unknowns, at.field, Linearise::unless_near);
  if (!tangent.factorise(unknowns, branches)) return false;
  evaluate.take_rows_in(branches, unknowns, at);
  const auto step = tangent.step_along(*task.arc, unknowns, at.rows_u, at.rows_l);
  ++account.counters.newton;
  Unknowns<T> moved{unknowns.u + step.u.col(0), unknowns.multiplier, unknowns.time + step.time};
  if (step.l.size() > 0) moved.multiplier += step.l.col(0);
  if (!moved.u.allFinite() || !evaluate(moved).residuals.finite()) return false;
  unknowns = std::move(moved);
  return true;
}

/// Moves the unknowns of an equilibrium there; false, and nothing is changed, where nothing moves or the place is out
/// of bounds.
template <class T>
bool predict(Engine<T>& engine, const EquilibriumTask<T>& task, Evaluator<T>& evaluate, NewtonTangent<T>& tangent,
             Account& account, Unknowns<T>& unknowns) {
  const Model& model = task.contact.model;
  const auto& slots = task.contact.slots;
  if (!task.last) return false;
  if (task.arc) return task.arc->begins && begin_path(engine, task, evaluate, tangent, account, unknowns);
  if (model.effects.linear_bulk) return false;
  Unknowns<T> start{into_frames(model, slots.frames, NodalLayout::all, task.last->displacement), unknowns.multiplier};
  const Vector<T> prescribed = unknowns.u - start.u;
  const auto& points = model.points;
  const bool pushed = std::any_of(points.begin(), points.end(), [&](const auto& p) { return detail::moves(model, p); });
  if (!pushed && values(prescribed).cwiseAbs().maxCoeff() == 0) return false;
  auto at = evaluate(start);
  if (!at.residuals.finite()) return false;
  if (!task.resumed.empty()) detail::resume_on_cone(task.contact, start.multiplier, task.resumed, at.field);
  auto branches = detail::step_branches(task.contact, engine.compact(start.u), at.field, start.multiplier, {});
  detail::follow_obstacles(model, *task.last, task.resumed, branches);
  tangent.move_to(start, at.field, Linearise::unless_near);
  if (!tangent.factorise(start, branches)) return false;
  evaluate.take_rows_in(branches, start, at);
  const Vector<T> motion = engine.spread(prescribed);
  Vector<T> forces = Vector<T>::Constant(static_cast<Eigen::Index>(model.contact_nodes.size()) * model.dimension, T(0));
  detail::add_tangent_times(model, slots, tangent.tangents(), Vector<T>(engine.compact(prescribed)), forces, at.rows_l);
  const BodyMotion<T> at_start{task.last->displacement, task.contact.previous.bodies, task.contact.time};
  Vector<T> rows;
  {
    const Stopwatch time(account.seconds.bodies);
    rows = engine.tangent_times(at_start, motion);
  }
  add_compact(model, forces, rows);
  rows = at.rows_u + into_frames(model, slots.frames, NodalLayout::all, std::move(rows));
  for (Eigen::Index row = 0; row < rows.size(); ++row)
    if (!engine.is_free(row)) rows[row] = T(0);
  const auto step = tangent.step(rows, at.rows_l);
  ++account.counters.newton;
  Unknowns<T> moved{unknowns.u + step.u.col(0), unknowns.multiplier};
  if (step.l.size() > 0) moved.multiplier += step.l.col(0);
  if (!moved.u.allFinite() || !evaluate(moved).residuals.finite()) return false;
  unknowns = std::move(moved);
  return true;
}

}  // namespace stickslip
