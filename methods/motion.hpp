/// One increment of a method: what the method solves from the last increment's state, and where that fails, the bodies'
/// overdamped motion from there to rest.
///
/// Plain semi-smooth Newton cycles where friction couples points strongly, and stops where points that all slip leave a
/// body free to move. The motion does not: each step of it solves
///
///   R(u, lambda) + alpha D (u - u_k) = 0,   u_{k+1} = u          an implicit Euler step of  D du/ds = -R,  ds =
///   1/alpha
///
/// by the method itself, with D the local stiffness at the contact nodes, the same in all directions. Its tangent is
/// regular, and for a large alpha the points know little of each other. alpha starts at 1, falls to a fifth after each
/// step and grows eightfold where one fails. After each step the method tries without the term: nothing but a solution
/// of the unmodified equations counts.
///
/// Where there may be several solutions (a tangent on the way has the other sign of its determinant, friction may hold
/// a body between surfaces, or mu reaches a critical value), the one is taken in whose branches the motion comes to
/// rest: path, D and alpha say which, not rho and not the method. Proximal point method: R. T. Rockafellar, SIAM J.
/// Control Optim. 14 (1976) 877-898; measured against others in core/README.md.
#pragma once

#include "methods/monolithic.hpp"
#include "methods/penalty.hpp"
#include "methods/solutions.hpp"
#include "methods/statics.hpp"
#include "methods/uzawa.hpp"

namespace stickslip {

namespace detail {

/// Whether friction alone may hold some body between surfaces that are not parallel: one without a support that touches
/// what it touches along more than one normal.
template <class T>
bool is_wedged(const Model& model, const Slots<T>& slots) {
  constexpr double parallel = 1e-9;
  if (!model.effects.friction) return false;
  return std::any_of(model.bodies.begin(), model.bodies.end(), [&](const BodyMesh& body) {
    const auto owns = [&](int node) {
      return node >= body.first_node && node < body.first_node + body.mesh.node_count;
    };
    if (std::any_of(model.constraints.begin(), model.constraints.end(),
                    [&](const Constraint& constraint) { return owns(constraint.dof / model.dimension); }))
      return false;
    Vector<double> first;  // normal into the body
    for (std::size_t p = 0; p < model.points.size(); ++p) {
      const auto& nodes = model.points[p].nodes;
      if (!owns(nodes.front()) && !owns(nodes.back())) continue;
      const Vector<double> normal = values(slots.geometry[p].normal) * (owns(nodes.front()) ? 1 : -1);
      if (first.size() == 0) first = normal;
      if ((normal - first).norm() > parallel) return true;
    }
    return false;
  });
}

/// D of the contact nodes, force per length: the largest local stiffness of the points that a node belongs to.
template <class T>
Vector<double> damping(const Model& model, const Slots<T>& slots) {
  Vector<double> stiffness = Vector<double>::Zero(static_cast<Eigen::Index>(model.contact_nodes.size()));
  for (std::size_t p = 0; p < model.points.size(); ++p)
    for (int place : model.points[p].places) stiffness[place] = std::max(stiffness[place], value(slots.stiffness[p]));
  return stiffness;
}

/// Adds to an increment what an attempt at it cost.
template <class T>
void add_cost(const Increment<T>& attempt, std::vector<IterationRecord>& history, int& iterations) {
  history.insert(history.end(), attempt.history.begin(), attempt.history.end());
  iterations += attempt.newton;
}

/// Follows the overdamped motion from `previous` until the method solves the unmodified equations. `several`: there may
/// be more solutions; then that solution must have the branches of the step before, and neither it nor any step but the
/// first may be farther away than all the way so far: it could as well belong to another one. Its history holds all
/// iterations; where no attempt succeeds its status is that of the last.
template <class M, class T, class E>
Increment<T> follow_motion(const M& method, Run<T, E>& run, const State<T>& previous, const std::vector<double>& factor,
                           double time, bool several) {
  constexpr double slower = 8, faster = 0.2, slowest = 1e9, fastest = 1e-15;  // below it the term is rounding
  constexpr double farthest = 1;
  constexpr int most_steps = 300;
  const Vector<double> D = damping(run.model, run.slots);
  const RunScales scales = run.account.scales;
  std::vector<IterationRecord> history;
  int iterations = 0;
  bool roughly = !several;  // (multipliers that are not unique keep what a rough step leaves)
  const auto attempt = [&](const State<T>& from, double alpha) {
    run.account.scales = scales;  // iterates on the way do not count
    Start<T> start{from, {}, roughly};
    if (alpha > 0) start.anchor = {alpha * D, to_compact(run.model, from.displacement)};
    auto found = solve_increment(method, run, previous, factor, time, start);
    add_cost(found, history, iterations);
    return found;
  };
  Increment<T> result;
  State<T> rest = previous;
  double alpha = 1, way = 0;
  for (int step = 0; step < most_steps && alpha >= fastest && alpha <= slowest; ++step) {
    auto moved = attempt(rest, alpha);
    const double length =
        largest_nodal_norm(Vector<T>(moved.state.displacement - rest.displacement), run.model.dimension);
    const bool strays = several && way > 0 && length > farthest * way;
    if (!moved.usable() || strays) {
      alpha *= slower;
      if (moved.usable()) moved.status = Status::cycle;
      moved.cut_off = false;  // a step is no solution, whatever becomes of it
      result = std::move(moved);
      continue;
    }
    way += length;
    rest = std::move(moved.state);
    result = attempt(rest, 0);
    const bool near = largest_nodal_norm(Vector<T>(result.state.displacement - rest.displacement),
                                         run.model.dimension) <= farthest * way;
    const bool settled = !several || (near && result.state.contact.state == rest.contact.state);
    if (result.usable() && settled) break;
    if (result.usable()) {
      result.status = Status::cycle;
      result.cut_off = false;
      result.message = "the motion does not come to rest";
    }
    if (length == 0 && roughly)  // so near to rest that a rough step begins solved
      roughly = false;
    else
      alpha *= faster;
  }
  result.history = std::move(history);
  result.newton = iterations;
  return result;
}

}  // namespace detail

/// Solves one increment from `previous`, to `time`; `factor`: adaption of rho so far.
template <class M, class T, class E>
Increment<T> find_increment(const M& method, Run<T, E>& run, const State<T>& previous,
                            const std::vector<double>& factor, double time) {
  const RunScales before = run.account.scales;
  auto direct = solve_increment(method, run, previous, factor, time, Start<T>{previous, {}});
  const bool solved = direct.usable();
  const bool several = run.several || direct.reversed;
  const bool prescribed =
      direct.status == Status::infeasible &&
      (!prevents_penetration(method) || !prescribed_penetration(run.model, run.slots, direct.state).empty());
  const bool final = prescribed || (solved && (!several || direct.cut_off));
  if (final || run.model.points.empty() || !is_globalised(method)) return direct;
  if (!solved && unbalanced_body(run.model, run.slots, time) != balanced) {
    direct.status = Status::no_equilibrium;
    return direct;
  }
  const RunScales after = std::exchange(run.account.scales, before);
  auto rest = detail::follow_motion(method, run, previous, factor, time, several);
  // a multiplier that grows for ever makes any violation small against it
  constexpr double runaway = 1e4;
  const bool grown = direct.status == Status::infeasible && values(rest.state.contact.traction).norm() >
                                                                runaway * values(direct.state.contact.traction).norm();
  const bool better = rest.usable() && !grown;
  if (!better) run.account.scales = after;
  auto& taken = better ? rest : direct;
  const auto& other = better ? direct : rest;
  taken.history.insert(taken.history.begin(), other.history.begin(), other.history.end());
  taken.newton += other.newton;
  taken.reversed |= other.reversed;
  return std::move(taken);
}

}  // namespace stickslip
