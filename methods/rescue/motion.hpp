/// One increment of a method: what the method solves from the last increment's state, and where that fails, the bodies'
/// overdamped motion from there to rest.
///
/// Plain semi-smooth Newton cycles where friction couples points strongly, and stops where points that all slip leave a
/// body free to move. The motion does not: each step of it solves
///
///   R(u, lambda) + alpha D (u - u_k) = 0,   u_{k+1} = u      an implicit Euler step of  D du/ds = -R,  ds = 1 / alpha
///
/// by the method itself, with D the local stiffness at the contact nodes, the same in all directions. Its tangent is
/// regular, and for a large alpha the points know little of each other (alpha: methods/rescue/motion_pace.hpp). After
/// each step the method tries without the term: nothing but a solution of the unmodified equations counts.
///
/// Bodies that float, as nothing holds them and nothing presses on them where the increment begins, are moved so first,
/// and D is theirs alone: until something touches them they stay where they are.
///
/// There may be several solutions where the determinant of a tangent on the way has another sign, where friction may
/// hold a body between surfaces, and where mu reaches a critical value. Then the solution is taken in whose branches
/// the motion comes to rest. Path, D and alpha say which; rho and the method do not. With few points the motion is
/// followed by trying all branches (methods/rescue/solutions.hpp): that also tells that there is no solution. The
/// method then starts from the one found. Proximal point method: R. T. Rockafellar, SIAM J. Control Optim. 14 (1976)
/// 877-898; measured against others in core/README.md.
#pragma once

#include "methods/all_methods.hpp"
#include "methods/rescue/motion_pace.hpp"
#include "methods/rescue/solutions.hpp"
#include "methods/rescue/statics.hpp"
#include "methods/rescue/work_bound.hpp"

namespace stickslip {

namespace detail {

/// Whether friction alone may hold some body between surfaces that are not parallel: a body without a support whose
/// contacts have more than one normal.
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

/// Adds to an increment the cost of an earlier attempt at it.
template <class T>
void add_cost(const Increment<T>& before, Increment<T>& increment) {
  increment.history.insert(increment.history.begin(), before.history.begin(), before.history.end());
  increment.newton += before.newton;
  increment.reversed |= before.reversed;
}

/// Whether two states of an increment are the same solution, as far as a method's tolerance tells.
template <class T>
bool same_solution(const Model& model, const State<T>& a, const State<T>& b, double least_length) {
  constexpr double same = 1e-6;
  const int D = model.dimension;
  const double length =
      std::max({largest_nodal_norm(a.displacement, D), largest_nodal_norm(b.displacement, D), least_length});
  const double traction = std::max(norm(values(a.contact.traction)), norm(values(b.contact.traction)));
  return largest_nodal_norm(Vector<T>(a.displacement - b.displacement), D) <= same * length &&
         norm(values(a.contact.traction - b.contact.traction)) <= same * traction;
}

/// All solutions of an increment with few contact points.
template <class T>
struct Solutions {
  std::vector<State<T>> states;
  std::optional<std::size_t> resting;  ///< the one that is taken (methods/rescue/solutions.hpp)
  double reach = 0;                    ///< length beside which differences of solutions may be rounding
  bool complete = true;                ///< but for rounding, there are no others
  bool feasible = true;                ///< some motion violates no constraint
};

/// Nothing where there are too many points, or bodies can move although all points stick.
template <class M, class T, class E>
std::optional<Solutions<T>> try_all_branches(const M& method, Run<T, E>& run, const State<T>& previous,
                                             const std::vector<double>& factor, double time) {
  if (!can_try_all_branches(run.model)) return std::nullopt;
  if (!run.condensation) run.condensation = std::make_shared<Condensation<T>>(run.model, run.slots, Backend::automatic);
  if (!run.condensation->valid()) return std::nullopt;
  CondensedEngine<T> engine(run.model, run.slots, false, ConeRadius::augmented, run.condensation);
  const auto initial = initial_regularisation(run.slots, method);
  const auto rho = factor.empty() ? initial : adapted(initial, factor);
  const ContactInput<T> input{run.model, run.slots, rho, previous.history, ConeRadius::augmented, time};
  const Vector<T> u = engine.begin(time, previous.displacement, {}), stored = stored_traction(run.model, previous);
  const ContactProblem problem =
      contact_problem(input, engine, u, run.condensation->schur(), method.prevents_penetration ? nullptr : &stored);
  const auto all = all_solutions(problem);
  if (!all) return std::nullopt;
  Solutions<T> solutions;
  for (const auto& solution : *all) {
    solutions.states.push_back(as_state(input, engine, u, problem, solution));
    solutions.states.back().history.work = previous.history.work;
  }
  solutions.complete = !has_repeated_constraints(problem);
  solutions.resting = resting_solution(problem, *all);
  solutions.reach = std::max(largest_nodal_norm(u, run.model.dimension), reach_of(problem));
  if (all->empty()) {
    constexpr double nearly = 1e-6;  // what misses its branches by less is not taken for nothing
    solutions.complete = solutions.complete && all_solutions(problem, 0, {}, nearly)->empty();
    solutions.feasible = is_feasible(problem);
  }
  return solutions;
}

/// An increment that `direct` did not solve and that has no solution, with the reason.
template <class T>
Increment<T> without_solution(const Model& model, const Slots<T>& slots, Increment<T> direct, bool feasible) {
  direct.status = feasible ? Status::no_equilibrium : Status::infeasible;
  direct.message = feasible ? "no combination of open, stick and slip of the contact points balances the loads"
                            : "the contacts contradict one another: whatever the bodies do, some point penetrates";
  if (feasible && has_abrupt_friction(model, slots)) direct.message += std::string("; ") + abrupt_friction_message;
  return direct;
}

/// The increment in that one of all solutions in which the motion comes to rest. Nothing where the motion comes to no
/// rest, or the method leaves the solution. `direct`: what the method found on its own. `before`: scales before that.
template <class M, class T, class E>
std::optional<Increment<T>> take_resting_solution(const M& method, Run<T, E>& run, const State<T>& previous,
                                                  const std::vector<double>& factor, double time,
                                                  const Increment<T>& direct, const RunScales& before,
                                                  const Solutions<T>& solutions) {
  if (!solutions.resting) return std::nullopt;
  const State<T>& target = solutions.states[*solutions.resting];
  if (direct.usable() && same_solution(run.model, direct.state, target, solutions.reach)) return direct;
  const RunScales after = std::exchange(run.account.scales, before);
  auto found = solve_increment(method, run, previous, factor, time, Start<T>{target, {}});
  if (!found.usable() || !same_solution(run.model, found.state, target, solutions.reach)) {
    run.account.scales = after;
    return std::nullopt;
  }
  add_cost(direct, found);
  return found;
}

/// Follows the overdamped motion from `previous` until the method solves the unmodified equations. `several`: there may
/// be more solutions. Then the solution must have the branches of the step before. Neither the solution, nor any step
/// but the first, may then be farther away than all the way so far: it could as well belong to another solution. The
/// history holds all iterations. Where no attempt succeeds the status is that of the last.
template <class M, class T, class E>
Increment<T> follow_motion(const M& method, Run<T, E>& run, const State<T>& previous, const std::vector<double>& factor,
                           double time, bool several, const WorkBound& bound) {
  const Vector<double> D = damping(run.model, run.slots, run.floating);
  const RunScales scales = run.account.scales;
  std::vector<IterationRecord> history;
  int iterations = 0;
  // (multipliers that are not unique, and bodies that float, keep what an inexact step leaves)
  bool inexact_step = !several && run.floating.empty();
  const auto attempt = [&](const State<T>& from, double alpha) {
    run.account.scales = scales;  // iterates on the way do not count
    Start<T> start{from, {}, inexact_step};
    start.at_rest = alpha == 0;
    if (alpha > 0) start.anchor = {alpha * D, to_compact(run.model, from.displacement)};
    auto found = solve_increment(method, run, previous, factor, time, start);
    history.insert(history.end(), found.history.begin(), found.history.end());
    iterations += found.newton;
    return found;
  };
  const auto distance = [&](const State<T>& from, const State<T>& to) {
    return largest_nodal_norm(Vector<T>(to.displacement - from.displacement), run.model.dimension);
  };
  Increment<T> result;
  State<T> rest = previous;
  MotionPace pace;
  do {
    auto moved = attempt(rest, pace.alpha());
    const double length = distance(rest, moved.state);
    if (!moved.usable() || (several && !pace.allows(length))) {
      pace.fail();
      if (moved.usable()) moved.status = Status::cycle;
      moved.cut_off = false;  // a step is no solution, whatever becomes of it
      result = std::move(moved);
      continue;
    }
    pace.move(length);
    rest = std::move(moved.state);
    result = attempt(rest, 0);
    const bool near = pace.is_near(distance(rest, result.state));
    const bool settled = !several || (near && result.state.contact.state == rest.contact.state);
    if (result.usable() && settled) break;
    if (result.usable()) {
      result.status = Status::cycle;
      result.cut_off = false;
      result.message = "the motion does not come to rest";
    }
    if (length == 0 && inexact_step)  // so near to rest that an inexact step begins solved
      inexact_step = false;
    else
      pace.hasten();
  } while (pace.goes_on() && !bound.is_spent());
  result.history = std::move(history);
  result.newton = iterations;
  return result;
}

}  // namespace detail

/// Solves one increment from `previous`, to `time`; `factor`: adaption of rho so far. `may_move`: whether the motion
/// stands in where the method alone finds nothing. `bound`: of the step that it is a part of, begun.
template <class M, class T, class E>
Increment<T> find_increment(const M& method, Run<T, E>& run, const State<T>& previous,
                            const std::vector<double>& factor, double time, const WorkBound& bound,
                            bool may_move = true) {
  const RunScales before = run.account.scales;
  const bool may_rest = !run.floating.empty() && !run.model.points.empty() && is_globalised(method);
  if (may_rest && unbalanced_body(run.model, run.slots, time) == balanced) {  // a singular tangent sends it anywhere
    auto rest = detail::follow_motion(method, run, previous, factor, time, false, bound);
    if (rest.usable()) return rest;
    run.account.scales = before;
  }
  auto direct = solve_increment(method, run, previous, factor, time, Start<T>{previous, {}});
  const bool solved = direct.usable();
  const bool several = run.several || direct.reversed;
  const bool prescribed =
      direct.status == Status::infeasible &&
      (!method.prevents_penetration || !prescribed_penetration(run.model, run.slots, direct.state).empty());
  const bool final = prescribed || (solved && (!several || direct.cut_off));
  if (final || run.model.points.empty() || !is_globalised(method)) return direct;
  if (!solved && unbalanced_body(run.model, run.slots, time) != balanced) {
    direct.status = Status::no_equilibrium;
    return direct;
  }
  const bool in_vain = bound.is_spent() || !may_move || cross_between(run.model, run.slots, run.start, time);
  if (!solved && in_vain) return direct;
  const auto all = detail::try_all_branches(method, run, previous, factor, time);
  const auto take_among_all = [&] {
    return detail::take_resting_solution(method, run, previous, factor, time, direct, before, *all);
  };
  if (all && all->complete) {
    if (all->states.empty() && !solved)
      return detail::without_solution(run.model, run.slots, std::move(direct), all->feasible);
    if (auto taken = take_among_all()) return std::move(*taken);
  }
  const RunScales after = std::exchange(run.account.scales, before);
  auto rest = detail::follow_motion(method, run, previous, factor, time, several, bound);
  // a multiplier that grows for ever makes any violation small against it
  constexpr double runaway = 1e4;
  const bool grown = direct.status == Status::infeasible &&
                     norm(values(rest.state.contact.traction)) > runaway * norm(values(direct.state.contact.traction));
  const bool better = rest.usable() && !grown;
  if (!better && !solved && all && !all->complete)  // as a last resort
    if (auto taken = take_among_all()) {
      detail::add_cost(rest, *taken);
      return std::move(*taken);
    }
  if (!better) run.account.scales = after;
  auto& taken = better ? rest : direct;
  detail::add_cost(better ? direct : rest, taken);
  return std::move(taken);
}

}  // namespace stickslip
