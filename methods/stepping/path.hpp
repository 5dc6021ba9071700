/// Paths of equilibria under one load, followed by arc length past limit points, where no equilibrium is near under a
/// slightly larger load. The factor of the load is an unknown beside the displacements. It is the time t of a step:
///
///   R(u, t) = 0        |u - u'|^2 / length^2 + (t - t')^2 / span^2 = 1        load: t / end times its value
///
///   u', t'  displacement and time at the beginning of the step
///   length  motion of a step at constant load; |u| is the root mean square over the free nodes
///   span    time of a step without motion: end over the number of steps asked for
///
/// So neither a stop that holds the bodies nor a fold of the load ends the path. Newton's method solves for both
/// unknowns by bordering: two solves with the tangent that every method has (NewtonTangent::step_along).
///
/// A step begins in the direction of the last one. If it fails or turns back, it is tried with the load reversed and
/// the motion continued, because a path has such a corner where a contact closes while the load falls. If that fails
/// too, half an arc is tried. The last step ends at the full load. Derivatives are those of the equilibria found, each
/// at its own load, as at prescribed times. [R79], [C81]
#pragma once

#include "methods/rescue/rescue.hpp"
#include "methods/stepping/diagnosis.hpp"

namespace stickslip {

template <class T>
class Path {
 public:
  Path(Run<T>& run, Trajectory<T>& trajectory)
      : run_(run),
        trajectory_(trajectory),
        end_(run.model.times.back()),
        length_(path_length(run.model, run.slots)),
        span_(end_ / run.model.scene.legs.front().steps) {
    const int D = run.model.dimension;
    for (int node = 0; node < run.model.node_count; ++node)
      nodes_ += std::any_of(&run.model.free_index[node * D], &run.model.free_index[node * D] + D,
                            [](int index) { return index >= 0; });
  }

  /// Whether the full load, or the largest number of steps, is reached.
  bool ended() const {
    const auto& increments = trajectory_.increments;
    return !increments.empty() && (increments.back().time == end_ || made_ == run_.model.scene.arc_length->max);
  }
  /// Makes one step. False if the path could not be followed; the failed increment is then the last. If displacements
  /// or tractions are not zero at t = 0, an increment at t = 0 comes first.
  bool advance() {
    if (trajectory_.increments.empty()) {
      WorkBound bound(run_.model, run_.account.counters, newton_of(run_.method).max_iterations, 0, Bodies::held);
      bound.begin();
      auto held = find_increment(run_, trajectory_.initial, {}, 0.0, bound);
      held.time = 0;
      if (!held.usable() || held.state.displacement != trajectory_.initial.displacement ||
          held.state.contact.traction != trajectory_.initial.contact.traction) {
        const bool usable = held.usable();
        if (!usable) diagnose(run_.model, run_.slots, 0, prevents_penetration(run_.method), held);
        take(std::move(held));
        if (!usable) return false;
      }
    }
    ++made_;
    int cutbacks = 0;
    for (;; ++cutbacks) {
      const RunScales before = run_.account.scales;
      auto increment = step_on(Heading::on);
      if (!goes_on(increment) && before_last().first) increment = step_on(Heading::over_a_corner);
      increment.cutbacks = cutbacks;
      if (goes_on(increment)) {
        last_share_ = share_;
        easy_ = cutbacks == 0 ? easy_ + 1 : 0;
        if (easy_ >= soon) share_ = std::min(1.0, regrowth * share_);
        take(std::move(increment));
        return true;
      }
      run_.account.scales = before;
      if (share_ / 2 < smallest) {
        if (increment.usable()) increment.status = Status::stagnated;
        increment.message = "the path could not be followed any further; try a shorter length, or more steps" +
                            (increment.message.empty() ? "" : ": " + increment.message);
        take(std::move(increment));
        return false;
      }
      share_ /= 2;
      ++run_.account.counters.cutbacks;
    }
  }
  /// Repeats an increment at its time. `guide`: start displacement of each increment; empty: none.
  bool repeat(double time, const std::vector<Vector<double>>& guide) {
    State<T> start = trajectory_.last();
    if (!guide.empty()) start.displacement = guide[trajectory_.increments.size()].template cast<T>();
    auto increment = solve_increment(run_, trajectory_.last(), trajectory_.last_factor(), time, {.state = start});
    increment.time = time;
    const bool usable = increment.usable();
    take(std::move(increment));
    return usable;
  }

 private:
  static constexpr double smallest = 1.0 / 1024, regrowth = 1.5;
  static constexpr int soon = 3;  // successive uncut steps before the share grows

  /// The state before the last, and its time; nullptr and 0 at the beginning of the path.
  std::pair<const State<T>*, double> before_last() const {
    const auto& increments = trajectory_.increments;
    if (increments.empty() || increments.back().time == 0) return {nullptr, 0};
    if (increments.size() == 1) return {&trajectory_.initial, 0};
    return {&increments[increments.size() - 2].state, increments[increments.size() - 2].time};
  }
  void take(Increment<T> increment) {
    increment.requested = true;
    trajectory_.increments.push_back(std::move(increment));
  }

  enum class Heading { on, over_a_corner };
  /// An increment along the arc, or to the full load if the arc passes it.
  Increment<T> step_on(Heading heading) {
    const State<T>& previous = trajectory_.last();
    const auto [before, then] = before_last();
    const double ahead = share_ / last_share_, now = trajectory_.last_time();
    State<T> start = previous;
    double guess = now;
    if (before) {
      start.displacement += T(ahead) * (previous.displacement - before->displacement);
      guess += (heading == Heading::on ? ahead : -ahead) * (now - then);
    }
    const Vector<double> left = values(previous.displacement);
    const Arc arc{left, now, share_ * length_, share_ * span_, nodes_, before == nullptr};
    auto increment = solve_increment(run_, previous, trajectory_.last_factor(), guess, {.state = start, .arc = &arc});
    if (!increment.usable() || increment.time < end_ * (1 - nearly) || now >= end_) return increment;
    const double part = (end_ - now) / (increment.time - now);
    start = increment.state;
    start.displacement = previous.displacement + T(part) * (increment.state.displacement - previous.displacement);
    auto landed = solve_increment(run_, previous, trajectory_.last_factor(), end_, {.state = start});
    landed.time = end_;
    landed.newton += increment.newton;
    landed.augmentations += increment.augmentations;
    return landed;
  }
  static constexpr double nearly = 1e-9;  // of the full load

  /// Whether the step converged and did not return along the path, in motion and load together. A return within a short
  /// arc is a corner of the path, and counts as progress.
  bool goes_on(const Increment<T>& increment) const {
    constexpr double is_short = 1.0 / 64;  // of the arc
    const auto [before, then] = before_last();
    if (!increment.usable()) return false;
    if (!before || share_ < is_short) return true;
    const double motion = (values(trajectory_.last().displacement) - values(before->displacement))
                              .dot(values(increment.state.displacement) - values(trajectory_.last().displacement));
    const double load = (trajectory_.last_time() - then) * (increment.time - trajectory_.last_time());
    return motion > 0 || motion / (nodes_ * length_ * length_) + load / (span_ * span_) > 0;
  }

  Run<T>& run_;
  Trajectory<T>& trajectory_;
  double end_, length_, span_, nodes_ = 0;
  double share_ = 1, last_share_ = 1;  ///< share of the arc: of the next step, of the last
  int made_ = 0, easy_ = 0;            ///< number of steps; successive steps that were not cut
};

}  // namespace stickslip
