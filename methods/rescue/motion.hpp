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
/// If a body floats, as nothing holds it and nothing presses on it where the increment begins, bodies are moved so
/// first. Only bodies that their supports alone leave free are damped then, also those that do not float: what floats
/// may be pressed against any of them, and a contact of one node lets each of them roll. Until something touches a body
/// it stays where it is. As long as what touches bodies moves them on, the method does not try without the term. A body
/// that floats still keeps it there, for the tangent of what nothing holds is singular; the solution counts if it bears
/// no force. Proximal point method: R. T. Rockafellar, SIAM J. Control Optim. 14 (1976) 877-898; measured against
/// others in docs/decisions.md.
#pragma once

#include "methods/rescue/motion_pace.hpp"
#include "methods/rescue/statics.hpp"
#include "methods/rescue/work_bound.hpp"
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
  auto floating = run.free.floating;
  for (std::size_t b = 0; b < floating.size(); ++b)
    floating[b] = floating[b] && !is_pressed(run.model, run.slots, b, at);
  if (std::find(floating.begin(), floating.end(), 1) == floating.end()) return {};
  return damping(run.model, run.slots, floating);
}

namespace detail {

/// The motion of one increment.
template <class T>
class OverdampedMotion {
 public:
  OverdampedMotion(Run<T>& run, const State<T>& previous, const std::vector<double>& rho_factor, double time,
                   Uniqueness uniqueness, const std::vector<char>& damped)
      : run_(run),
        previous_(previous),
        rho_factor_(rho_factor),
        time_(time),
        several_(uniqueness == Uniqueness::several),
        all_damped_(damped.empty()),
        damping_(damping(run.model, run.slots, damped)),
        scales_(run.account.scales),
        inexact_step_(!several_ && run.free.floating.empty()) {}

  Increment<T> follow(const WorkBound& bound) {
    State<T> place = previous_;
    Increment<T> result;
    do {
      result = move_on(place);
    } while (!result.usable() && pace_.goes_on() && !bound.is_spent());
    result.history = std::move(history_);
    result.newton = iterations_;
    return result;
  }

 private:
  /// A step of the motion from `place` to the next, and from there, where it may rest, the method. Usable: the
  /// solution.
  Increment<T> move_on(State<T>& place) {
    auto moved = step(place);
    const double length = distance(place, moved.state);
    if (!moved.usable() || (several_ && !pace_.allows(length))) {
      pace_.fail();
      return no_solution(std::move(moved));
    }
    pace_.move(length);
    const bool may_rest = all_damped_ || is_slow(run_.model, damping_, pace_.alpha(), place, moved.state);
    place = moved.state;
    auto result = may_rest ? rest(place) : std::move(moved);
    const bool near = pace_.is_near(distance(place, result.state));
    if (result.usable() && may_rest && (!several_ || (near && result.state.contact.state == place.contact.state)))
      return result;
    if (length == 0 && inexact_step_)  // so near to rest that an inexact step begins solved
      inexact_step_ = false;
    else
      pace_.hasten();
    return result.usable() ? no_solution(std::move(result)) : result;
  }

  Increment<T> step(const State<T>& from) {
    return attempt({from, {pace_.alpha() * damping_, compact(from)}, inexact_step_});
  }

  /// The unmodified equations, but for bodies that float still.
  Increment<T> rest(const State<T>& from) {
    Start<T> start{.state = from, .inexact_step = inexact_step_, .at_rest = true};
    const Vector<double> held = of_floating(run_, from);
    if (held.size() > 0) start.anchor = {held, compact(from)};
    auto found = attempt(start);
    if (held.size() == 0 || !found.usable()) return found;
    const double force =
        largest_nodal_norm(start.anchor.force(compact(found.state), run_.model.dimension), run_.model.dimension);
    const bool bears = force > newton_of(run_.method).tolerance * run_.account.scales.force;
    return bears ? no_solution(std::move(found)) : found;
  }

  Increment<T> attempt(const Start<T>& start) {
    run_.account.scales = scales_;  // iterates on the way do not count
    auto found = solve_increment(run_, previous_, rho_factor_, time_, start);
    history_.insert(history_.end(), found.history.begin(), found.history.end());
    iterations_ += found.newton;
    return found;
  }

  /// A step of the motion, or an attempt, that is no solution, whatever becomes of it.
  static Increment<T> no_solution(Increment<T> increment) {
    if (increment.usable()) {
      increment.status = Status::cycle;
      increment.message = "the motion does not come to rest";
    }
    increment.cut_off = false;
    return increment;
  }

  Vector<T> compact(const State<T>& at) const { return to_compact(run_.model, at.displacement); }
  double distance(const State<T>& from, const State<T>& to) const {
    return largest_nodal_norm(Vector<T>(to.displacement - from.displacement), run_.model.dimension);
  }

  Run<T>& run_;
  const State<T>& previous_;
  const std::vector<double>& rho_factor_;
  const double time_;
  const bool several_, all_damped_;
  const Vector<double> damping_;  ///< D
  const RunScales scales_;
  bool inexact_step_;  ///< (multipliers that are not unique, and bodies that float, keep what an inexact step leaves)
  MotionPace pace_;
  std::vector<IterationRecord> history_;
  int iterations_ = 0;
};

}  // namespace detail

/// Follows the overdamped motion from `previous` until the method solves the unmodified equations. `damped`: per body,
/// whether D is its own; empty: all are damped, and the method tries after each step. If there may be several
/// solutions, the solution must have the branches of the step before. No step but the first may then be longer
/// than the way covered so far, nor the solution farther from the last step: it could belong to another branch. The
/// history holds all iterations. Where no attempt succeeds the status is that of the last.
template <class T>
Increment<T> follow_motion(Run<T>& run, const State<T>& previous, const std::vector<double>& rho_factor, double time,
                           Uniqueness uniqueness, const std::vector<char>& damped, const WorkBound& bound) {
  return detail::OverdampedMotion<T>(run, previous, rho_factor, time, uniqueness, damped).follow(bound);
}

}  // namespace stickslip
