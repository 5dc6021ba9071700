/// One step of a run, cut into parts if it finds no solution.
#pragma once

#include <optional>
#include <tuple>

#include "methods/stepping/diagnosis.hpp"
#include "methods/stepping/jumps.hpp"
#include "methods/stepping/stability.hpp"

namespace stickslip {

namespace detail {

/// Whether an increment failed because supports drive what touches into one another, which no smaller step mends.
template <class T>
bool drives_together(const Run<T>& run, double start, double end, const Increment<T>& failed) {
  const auto& [model, slots] = std::tie(run.model, run.slots);
  if (!prevents_penetration(run.method)) {
    if (failed.status == Status::infeasible) return true;
  } else if (!prescribed_penetration(model, slots, failed.state).empty()) {
    return true;
  }
  return cross_between(model, slots, start, end);
}

/// Displacements that are not finite are no solution. (An engine may eliminate dofs that no residual contains.) Nor is
/// a state that presses on a folded side.
template <class T>
void refuse(const Run<T>& run, Increment<T>& increment) {
  if (!increment.usable()) return;
  const auto mark = [&](Status status, std::string words) {
    increment.status = status;
    increment.cut_off = false;
    increment.message = std::move(words);
  };
  if (!increment.state.displacement.allFinite()) return mark(Status::not_finite, "the displacements are not finite");
  std::string words = detail::words_of_folded_side(run.model, run.slots, increment.state);
  if (words.empty()) return;
  mark(Status::inverted_element, std::move(words));
}

/// Whether an increment failed for a reason that is the same however short it is.
template <class T>
bool no_smaller_step_helps(const Run<T>& run, double start, double end, const Increment<T>& failed) {
  if (failed.status == Status::no_equilibrium) return unbalanced_body(run.model, run.slots, end) != balanced;
  return drives_together(run, start, end, failed);
}

/// Ends a step to the time `target` that found no solution: the failed increment is then the last.
template <class T>
void give_up(const Run<T>& run, double target, const WorkBound& bound, Increment<T> failed,
             std::vector<Increment<T>>& increments) {
  diagnose(run.model, run.slots, target, prevents_penetration(run.method), failed);
  const auto add = [&](const std::string& words) { failed.message += (failed.message.empty() ? "" : "; ") + words; };
  const bool is_named = failed.status == Status::no_equilibrium || failed.status == Status::infeasible ||
                        failed.status == Status::inverted_element;
  if (!run.free.words.empty() && !is_named) add("where the step begins, " + run.free.words);
  if (bound.is_spent() && !is_named) add(bound.in_words());
  if (!is_named && has_abrupt_friction(run.model, run.slots)) add(abrupt_friction_message);
  failed.time = target;
  failed.requested = true;
  increments.push_back(std::move(failed));
}

template <class T>
int equilibria_of(const Increment<T>& increment) {
  return std::max(1, increment.augmentations);
}

/// Iterations of increments that converged, those in vain apart.
template <class T>
long spent_on(const std::vector<Increment<T>>& increments) {
  long spent = 0;
  for (const auto& increment : increments) spent += WorkBound::due(increment.newton, equilibria_of(increment));
  return spent;
}

/// A step of a run: one increment, or parts of it.
///
///   A part that fails, or passes several critical loads at once, is halved. It may be as short as 1/1024 of the step.
///   After three parts in a row that succeed, parts grow by 1.5.
///   The step is given up if no shorter part helps, or if all that its parts spent in vain exceeds the bound
///   (methods/rescue/work_bound.hpp).
///
/// What is tried for each part: methods/rescue/rescue.hpp. Of nonlinear bodies none of which is free, long parts are
/// tried by the method alone: to halve them is cheaper than the motion.
template <class T>
class StepInParts {
 public:
  StepInParts(Run<T>& run, Trajectory<T>& trajectory, double target, Steps steps)
      : run_(run),
        trajectory_(trajectory),
        start_count_(trajectory.increments.size()),
        start_(trajectory.last_time()),
        target_(target),
        steps_(steps),
        reached_(start_),
        length_(target - start_),
        bound_(run.model, run.account.counters, newton_of(run.method).max_iterations, spent_on(trajectory.increments),
               run.free.words.empty() ? Bodies::held : Bodies::free) {}

  /// Advances the trajectory to the target. False if it gave up; the failed increment is then the last.
  bool advance() {
    while (true) {
      scales_ = run_.account.scales;
      auto part = solve_part();
      const bool is_refused = part.usable() && passes_critical_loads(part);
      if (part.usable() && !is_refused) {
        const bool is_last = part.requested;
        take(std::move(part));
        if (is_last) return true;
      } else if (!halve(std::move(part), is_refused)) {
        failed_->cutbacks = cutbacks_;
        trajectory_.increments.resize(start_count_);
        give_up(run_, target_, bound_, std::move(*failed_), trajectory_.increments);
        return false;
      }
    }
  }

 private:
  Increment<T> solve_part() {
    constexpr double patient = 0.2;  // share of the step at which nonlinear bodies turn to the motion
    const double whole = target_ - start_;
    const bool is_last = reached_ + length_ >= target_ - 1e-9 * whole;
    const bool is_free = !run_.free.words.empty(), is_short = length_ < patient * whole;
    const bool moves = run_.model.effects.linear_bulk || steps_ == Steps::whole || is_free || is_short;
    next_ = is_last ? target_ : reached_ + length_;
    run_.start = reached_;
    bound_.begin();
    factor_ = trajectory_.last_factor();
    auto part =
        find_increment(run_, trajectory_.last(), factor_, next_, bound_, moves ? Rescue::all : Rescue::no_motion);
    bound_.end(part.usable() ? equilibria_of(part) : 0);
    part.time = next_;
    part.requested = is_last;
    part.cutbacks = cutbacks_;
    refuse(run_, part);
    const int before = unresisted_before();
    part.unresisted =
        steps_ == Steps::cut ? motions_unresisted(run_, trajectory_.last(), part).value_or(before) : before;
    return part;
  }

  int unresisted_before() const {
    return trajectory_.increments.empty() ? 0 : trajectory_.increments.back().unresisted;
  }

  /// Whether a part passes more places where bodies begin to give way than it may: one; none, once a part was refused
  /// for that. A short part may pass any.
  bool passes_critical_loads(const Increment<T>& part) {
    constexpr double steady = 1.0 / 64;
    const int gained = part.unresisted - unresisted_before();
    if (gained <= (buckles_ ? 0 : 1) || bound_.is_spent() || next_ - reached_ <= steady * (target_ - start_))
      return false;
    buckles_ = true;
    run_.account.scales = scales_;
    return true;
  }

  void take(Increment<T> part) {
    constexpr double regrowth = 1.5;
    look_beside(run_, trajectory_, factor_, reached_, part);
    trajectory_.increments.push_back(std::move(part));
    reached_ = next_;
    if (++easy_ >= 3) length_ *= regrowth;
  }

  /// Halves the next part. False if that does not help, or is not allowed.
  bool halve(Increment<T> part, bool is_refused) {
    constexpr double smallest = 1.0 / 1024;
    const bool helps = is_refused || !no_smaller_step_helps(run_, reached_, next_, part);
    const bool is_folded = part.status == Status::inverted_element;  // an equilibrium, and why it is none: says most
    if (!is_refused && (!failed_ || (is_folded && failed_->status != part.status))) failed_ = std::move(part);
    easy_ = 0;
    length_ = (next_ - reached_) / 2;
    const bool vanishes = !(reached_ + length_ > reached_ && reached_ + length_ < next_);  // no number lies between
    if (steps_ == Steps::whole || !helps || vanishes || bound_.is_spent() || length_ < smallest * (target_ - start_))
      return false;
    ++cutbacks_;
    ++run_.account.counters.cutbacks;
    return true;
  }

  Run<T>& run_;
  Trajectory<T>& trajectory_;
  const std::size_t start_count_;  ///< increments before the step
  const double start_, target_;
  const Steps steps_;
  double reached_, next_ = 0, length_;  ///< begin and end of the present part, length of the next
  int easy_ = 0, cutbacks_ = 0;         ///< parts in a row that succeeded; halvings
  bool buckles_ = false;                ///< whether a part was refused for the critical loads that it passed
  RunScales scales_;                    ///< where the present part begins, as is the adaption of rho:
  std::vector<double> factor_;
  std::optional<Increment<T>> failed_;  ///< the first part that failed, or the first that is folded
  WorkBound bound_;
};

/// Advances the trajectory to the time `target` by a step. False if it gave up; the failed increment is then the last.
template <class T>
bool advance(Run<T>& run, Trajectory<T>& trajectory, double target, Steps steps) {
  run.free = {};
  if (!run.model.effects.linear_bulk)
    run.free = free_bodies(run.model, run.slots, trajectory.last(), trajectory.increments.empty());
  return StepInParts<T>(run, trajectory, target, steps).advance();
}

}  // namespace detail

}  // namespace stickslip
