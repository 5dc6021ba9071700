/// What is tried for one increment, in which order, and what it ends in.
///
///   1  rest      bodies that float are moved to rest, and with them all that supports alone do not hold
///                (methods/rescue/motion.hpp): a singular tangent would send them anywhere
///   2  method    the method itself, from the last state. Its equilibria are sought by Newton's method, by the sequence
///                of linear problems, and by Newton's method again (methods/rescue/find_equilibrium.hpp). A solution
///                ends the search, unless there may be several; so does what supports drive into one another:
///                infeasible
///   3  statics   loads that no contact can balance (methods/rescue/statics.hpp): no_equilibrium
///   4  branches  of few points all combinations (methods/rescue/all_branches.hpp). If there is no solution:
///                no_equilibrium, or infeasible where points penetrate whatever bodies do. Else the method starts again
///                from the one in which the motion comes to rest
///   5  motion    the overdamped motion of all bodies from the last state to rest
///   6  branches  those of 4 where repeated constraints hide some, if nothing else was found
///
/// If the method found nothing, 4 to 6 are left out in three cases: the bound of work is spent; supports drive facets
/// through one another; or bodies are nonlinear, none of them is free, and the part is longer than a fifth of the step.
///
/// The levels below and above an increment:
///
///   corner       points that go to and fro between two patches are kept on one (methods/newton/kept_patches.hpp)
///   equilibrium  Newton's method, the sequence, Newton's method with all its iterations
///                (methods/rescue/find_equilibrium.hpp)
///   step         parts, down to 1/1024 (methods/stepping/step.hpp). What all of them spend in vain is bounded
///                (methods/rescue/work_bound.hpp)
///   path         arcs are shortened (methods/stepping/path.hpp); of this page only an increment at t = 0 is tried
///
/// There may be several solutions where the determinant of a tangent on the way has another sign, where friction may
/// hold a body between surfaces, and where mu reaches a critical value. Then the solution is taken in whose branches
/// the motion comes to rest. The path of the motion, its damping and its pace say which; rho and the method do not.
#pragma once

#include "methods/rescue/all_branches.hpp"
#include "methods/rescue/motion.hpp"
#include "methods/stepping/prescribed.hpp"

namespace stickslip {

/// What is tried where the method alone finds nothing.
enum class Rescue {
  all,       ///< 3 to 6 above
  no_motion  ///< 3 alone
};

namespace detail {

/// Adds to an increment the cost of an earlier attempt at it.
template <class T>
void add_cost(const Increment<T>& before, Increment<T>& increment) {
  increment.history.insert(increment.history.begin(), before.history.begin(), before.history.end());
  increment.newton += before.newton;
  increment.reversed |= before.reversed;
}

/// The search for one increment.
template <class T>
class IncrementSearch {
 public:
  IncrementSearch(Run<T>& run, const State<T>& previous, const std::vector<double>& rho_factor, double time,
                  const WorkBound& bound, Rescue rescue)
      : run_(run),
        previous_(previous),
        rho_factor_(rho_factor),
        time_(time),
        bound_(bound),
        rescue_(rescue),
        rescues_(!run.model.points.empty() && is_globalised(run.method)),
        before_(run.account.scales) {}

  Increment<T> find() {
    if (auto rest = rest_of_floating_bodies()) return std::move(*rest);
    found_ = solve_increment(run_, previous_, rho_factor_, time_, {.state = previous_});
    if (prevents_what_crosses()) return failed(Status::infeasible, "");
    if (!rescues_ || is_final()) return std::move(found_);
    if (!solved() && !balances()) return failed(Status::no_equilibrium, found_.message);
    if (!solved() && in_vain()) return std::move(found_);
    const auto all = try_all_branches(run_, previous_, rho_factor_, time_);
    if (all && all->complete) {
      if (all->states.empty() && !solved()) return without_solution(*all);
      if (auto taken = resting_among(*all)) return std::move(*taken);
    }
    return by_motion(all);
  }

 private:
  bool solved() const { return found_.usable(); }
  bool several() const { return uniqueness() == Uniqueness::several; }
  Uniqueness uniqueness() const { return found_.reversed ? Uniqueness::several : run_.uniqueness; }
  bool balances() const { return unbalanced_body(run_.model, run_.slots, time_) == balanced; }

  std::optional<Increment<T>> rest_of_floating_bodies() {
    if (run_.free.floating.empty() || !rescues_ || !balances()) return std::nullopt;
    auto rest = follow_motion(run_, previous_, rho_factor_, time_, Uniqueness::unique, run_.free.movable, bound_);
    if (rest.usable()) return rest;
    run_.account.scales = before_;
    return std::nullopt;
  }

  /// Whether supports drive facets further through one another, which a solution does not see once one of them is
  /// beyond the other. A penalty holds what overlaps, and so may its solution.
  bool prevents_what_crosses() const { return solved() && prevents_penetration(run_.method) && crosses(); }
  bool crosses() const { return cross_between(run_.model, run_.slots, run_.start, time_); }

  /// Whether what the method found stands.
  bool is_final() const {
    const bool prescribed =
        found_.status == Status::infeasible &&
        (!prevents_penetration(run_.method) || !prescribed_penetration(run_.model, run_.slots, found_.state).empty());
    return prescribed || (solved() && (!several() || found_.cut_off));
  }

  bool in_vain() const { return bound_.is_spent() || rescue_ == Rescue::no_motion || crosses(); }

  Increment<T> failed(Status status, std::string message) {
    found_.status = status;
    found_.message = std::move(message);
    return std::move(found_);
  }

  Increment<T> without_solution(const Solutions<T>& all) {
    if (!all.feasible)
      return failed(Status::infeasible,
                    "the contacts contradict one another: whatever the bodies do, some point penetrates");
    std::string words = "no combination of open, stick and slip of the contact points balances the loads";
    if (has_abrupt_friction(run_.model, run_.slots)) words += std::string("; ") + abrupt_friction_message;
    return failed(Status::no_equilibrium, std::move(words));
  }

  /// The solution in which the motion comes to rest. Nothing where it comes to no rest, or the method leaves it.
  std::optional<Increment<T>> resting_among(const Solutions<T>& all) {
    if (!all.resting) return std::nullopt;
    const State<T>& target = all.states[*all.resting];
    if (solved() && same_solution(run_.model, found_.state, target, all.reach)) return found_;
    const RunScales after = std::exchange(run_.account.scales, before_);
    auto taken = solve_increment(run_, previous_, rho_factor_, time_, {.state = target});
    if (!taken.usable() || !same_solution(run_.model, taken.state, target, all.reach)) {
      run_.account.scales = after;
      return std::nullopt;
    }
    add_cost(found_, taken);
    return taken;
  }

  /// The rest that the motion comes to; else what the method found. `all`: solutions to fall back on.
  Increment<T> by_motion(const std::optional<Solutions<T>>& all) {
    const RunScales after = std::exchange(run_.account.scales, before_);
    auto rest = follow_motion(run_, previous_, rho_factor_, time_, uniqueness(), {}, bound_);
    constexpr double runaway = 1e4;  // a multiplier that grows for ever makes any violation small against it
    const bool grown = found_.status == Status::infeasible && norm(values(rest.state.contact.traction)) >
                                                                  runaway * norm(values(found_.state.contact.traction));
    const bool better = rest.usable() && !grown;
    if (!better && !solved() && all && !all->complete)
      if (auto taken = resting_among(*all)) {
        add_cost(rest, *taken);
        return std::move(*taken);
      }
    if (!better) run_.account.scales = after;
    auto& taken = better ? rest : found_;
    add_cost(better ? found_ : rest, taken);
    return std::move(taken);
  }

  Run<T>& run_;
  const State<T>& previous_;
  const std::vector<double>& rho_factor_;
  double time_;
  const WorkBound& bound_;
  Rescue rescue_;
  bool rescues_;            ///< whether there is more than the method alone
  const RunScales before_;  ///< of the run; attempts that fail leave no trace in them
  Increment<T> found_;      ///< by the method alone
};

}  // namespace detail

/// One increment from `previous` to `time`; `rho_factor`: adaption of rho so far; `bound`: of the step that it is a
/// part of, begun.
template <class T>
Increment<T> find_increment(Run<T>& run, const State<T>& previous, const std::vector<double>& rho_factor, double time,
                            const WorkBound& bound, Rescue rescue = Rescue::all) {
  return detail::IncrementSearch<T>(run, previous, rho_factor, time, bound, rescue).find();
}

}  // namespace stickslip
