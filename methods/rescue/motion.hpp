/// The bodies' overdamped motion to rest, where a method finds no solution of an increment.
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
/// Where a body floats, as nothing holds it and nothing presses on it where the increment begins, bodies are moved so
/// first, and D is theirs alone whom supports alone do not hold: what floats may be pressed against any of them, and a
/// contact of one node lets each of them roll. Until something touches a body it stays where it is. As long as what
/// touches bodies moves them on, the method does not try without the term. A body that floats still keeps it there, for
/// the tangent of what nothing holds is singular; the solution counts if it bears no force. Proximal point method: R. T.
/// Rockafellar, SIAM J. Control Optim. 14 (1976) 877-898; measured against others in core/README.md.
#pragma once

#include "methods/rescue/motion_pace.hpp"
#include "methods/rescue/statics.hpp"
#include "methods/rescue/work_bound.hpp"
#include "methods/stepping/diagnosis.hpp"
#include "methods/stepping/increment.hpp"

namespace stickslip {

/// Whether the damping alpha D of a step from one state to another is next to nothing: what is left of it moves nothing
/// else. `damping`: D per contact node.
template <class T>
bool is_slow(const Model& model, const Vector<double>& damping, double alpha, const State<T>& from,
             const State<T>& to) {
  constexpr double slow = 1e-6;
  Vector<T> way = to_compact(model, Vector<T>(to.displacement - from.displacement));
  for (Eigen::Index i = 0; i < way.size(); ++i)
    if (!(damping[i / model.dimension] > 0)) way[i] = T(0);
  return alpha * largest_nodal_norm(way, model.dimension) <=
         slow * largest_nodal_norm(to.displacement, model.dimension);
}

/// D of the bodies that floated where the increment began and that nothing presses on in a state either; empty if there
/// are none.
template <class T>
Vector<double> of_floating(const Run<T>& run, const State<T>& at) {
  auto floating = run.floating;
  for (std::size_t b = 0; b < floating.size(); ++b)
    floating[b] = floating[b] && !detail::is_pressed(run.model, run.slots, b, at);
  if (std::ranges::find(floating, 1) == floating.end()) return {};
  return damping(run.model, run.slots, floating);
}

/// Follows the overdamped motion from `previous` until the method solves the unmodified equations. `damped`: per body,
/// whether D is its own; empty: all are damped, and the method tries after each step. `several`: there may be more
/// solutions. Then the solution must have the branches of the step before. Neither the solution, nor any step
/// but the first, may then be farther away than all the way so far: it could as well belong to another solution. The
/// history holds all iterations. Where no attempt succeeds the status is that of the last.
template <class T>
Increment<T> follow_motion(Run<T>& run, const State<T>& previous, const std::vector<double>& factor, double time,
                           bool several, const std::vector<char>& damped, const WorkBound& bound) {
  constexpr const char* restless = "the motion does not come to rest";
  const Vector<double> D = damping(run.model, run.slots, damped);
  const RunScales scales = run.account.scales;
  std::vector<IterationRecord> history;
  int iterations = 0;
  // (multipliers that are not unique, and bodies that float, keep what an inexact step leaves)
  bool inexact_step = !several && run.floating.empty();
  const auto bears_force = [&](const Anchor<T>& anchor, const State<T>& at) {
    const Vector<T> force = anchor.force(to_compact(run.model, at.displacement), run.model.dimension);
    return largest_nodal_norm(force, run.model.dimension) > newton_of(run.method).tolerance * run.account.scales.force;
  };
  const auto attempt = [&](const State<T>& from, double alpha) {
    run.account.scales = scales;  // iterates on the way do not count
    Start<T> start{from, {}, inexact_step};
    start.at_rest = alpha == 0;
    const Vector<double> held = alpha > 0 ? Vector<double>(alpha * D) : of_floating(run, from);
    if (held.size() > 0) start.anchor = {held, to_compact(run.model, from.displacement)};
    auto found = solve_increment(run, previous, factor, time, start);
    history.insert(history.end(), found.history.begin(), found.history.end());
    iterations += found.newton;
    if (alpha == 0 && found.usable() && held.size() > 0 && bears_force(start.anchor, found.state)) {
      found.status = Status::cycle;
      found.message = restless;
    }
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
    const bool may_rest = damped.empty() || is_slow(run.model, D, pace.alpha(), rest, moved.state);
    rest = moved.state;
    result = may_rest ? attempt(rest, 0) : std::move(moved);
    const bool near = pace.is_near(distance(rest, result.state));
    const bool settled = may_rest && (!several || (near && result.state.contact.state == rest.contact.state));
    if (result.usable() && settled) break;
    if (result.usable()) {
      result.status = Status::cycle;
      result.cut_off = false;
      result.message = restless;
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

}  // namespace stickslip
