/// Augmented Lagrangian with Uzawa updates: Newton's method at fixed lambda, then lambda <- t, until the update is
/// small.
///
///   repeat  solve  R(u) = f_int - f_ext + sum A t dg = 0,   t = P_mu(lambda + rho g)     (lambda fixed)
///           lambda <- t                                                                  (AugmentationLoop::update)
///
///   rho           scale, force per length cubed. With `adapt` it grows (augmentation/adaption.hpp)
///   acceleration  lambda <- an extrapolation of the last t, put back onto the cone (augmentation/acceleration.hpp)
///   cone          augmented: radius -mu z_N; the tangent of slip is unsymmetric
///                 frozen: radius -mu lambda_N of the last augmentation; the tangent is symmetric. The radius is then a
///                 fixed point iteration of its own. An augmentation multiplies its error by -mu/s, s the slope of the
///                 load path (tangential over normal stiffness of the unloading). For mu > s it ends in a two-cycle
///
/// An augmentation multiplies the error by 1/(1 + rho s_min), s_min the smallest compliance of the active constraints
/// (S = B K^-1 B^T A). So a large rho needs few augmentations, but its inner problems are harder. Slip is measured from
/// the last converged increment, never from the last augmentation. lambda starts as the last increment's.
///
/// The loop ends when update and violation are within `tolerance` and the states repeat. It gives up when the updates
/// undo each other (status cycle), or when a gap does not change with its multiplier (infeasible). An inner solve
/// before the last ends at a hundredth of its first residual; the last one is exact. The truncated scheme
/// differentiates every inner solve, so there all are exact. Options: methods/options.hpp. The derivative of the update
/// lambda <- t is update_derivatives() of sensitivity/uzawa.cpp. [SL92]
#pragma once

#include "methods/augmentation/augmentation_status.hpp"
#include "methods/augmentation/projection.hpp"

namespace stickslip {

namespace detail {

/// The augmentations of one increment.
template <class T>
class AugmentationLoop {
 public:
  AugmentationLoop(const UzawaAL& method, Run<T>& run, const State<T>& previous, std::vector<double> rho_factor,
                   double time, const Start<T>& start)
      : method_(method),
        run_(run),
        previous_(previous),
        start_(start),
        time_(time),
        initial_(initial_regularisation(run.slots, method)),
        before_(run.account.scales),
        resumed_(start.resumed(previous)),
        progress_(run.model, run.slots, method.acceleration),
        accelerator_(method.acceleration) {
    increment_.rho_factor = first_factors(run.slots, initial_, std::move(rho_factor));
    // (The truncated scheme differentiates the loop from the lambda of the last increment on, so the loop begins
    // there.)
    const State<T>& with_lambda = truncated_ && !start.is_step() ? previous : start.state;
    unknowns_ = {run.engine.begin(time, start.state.displacement, previous.history.bodies),
                 with_lambda.contact.traction, time};
  }

  Increment<T> solve() {
    while (true) {
      const auto rho = adapted(initial_, increment_.rho_factor);
      const ContactInput<T> input{run_.model, run_.slots, rho, previous_.history, method_.cone_radius(), time_};
      auto equilibrium = balance(input);
      if (!is_converged(equilibrium.status) || equilibrium.forceless || ends_with(input, equilibrium)) {
        increment_.state = settle(run_, input, std::move(equilibrium.unknowns), std::move(equilibrium.field));
        return std::move(increment_);
      }
      update(equilibrium);
    }
  }

 private:
  /// Inner solve at fixed lambda.
  Equilibrium<T> balance(const ContactInput<T>& input) {
    inexact_ &= increment_.augmentations + 1 < limit_;
    const bool first = increment_.augmentations == 0;
    run_.account.scales = before_;
    const EquilibriumTask<T> task{.contact = input,
                                  .multipliers = Multipliers::given,
                                  .anchor = start_.anchor,
                                  .resumed = resumed_,
                                  .forcing = inexact_ ? forcing : 0,
                                  .last = first ? &start_.state : nullptr,
                                  .arc = start_.arc,
                                  .rests = first && start_.at_rest,
                                  .tells_stability = first && start_.at_rest};
    auto equilibrium =
        find_equilibrium(run_.engine, task, unknowns_, inner_options(method_, progress_.contraction()), run_.account);
    account_for(increment_, equilibrium, ++increment_.augmentations);
    ++run_.account.counters.augmentations;
    if (equilibrium.status == Status::cycle && !method_.is_globalised()) increment_.message += frozen_advice;
    return equilibrium;
  }

  /// Whether the increment ends with this inner solve. If so, its status and message are set.
  bool ends_with(const ContactInput<T>& input, const Equilibrium<T>& equilibrium) {
    if (truncated_ && run_.model.effects.sensitivity)
      increment_.augmented.push_back(
          {settle(run_, input, equilibrium.unknowns, equilibrium.field), increment_.rho_factor});
    status_ = judge(method_, run_, input, unknowns_, equilibrium, progress_);
    increment_.contraction = progress_.contraction();
    // A state that needs no inner solve is solved if its violation is: of one state no contraction is known, and where
    // a body is free the next inner solve is singular.
    const bool unmoved = start_.at_rest && increment_.augmentations == 1 && equilibrium.iterations == 0;
    status_.done |= unmoved && progress_.violation() <= status_.negligible;
    inexact_ &= !status_.within_tolerance;
    const bool at_limit = increment_.augmentations >= limit_;
    conclude(status_, at_limit, increment_);
    const bool over = status_.done && !equilibrium.inexact;
    return at_limit || (over && (!is_converged(status_.status) || truncated_ || !progress_.has_carried_updates()));
  }

  /// The Uzawa update: lambda <- t, or an extrapolation of it. First rho is adapted. The derivative D lambda <- D t is
  /// update_derivatives() of sensitivity/uzawa.cpp.
  void update(const Equilibrium<T>& equilibrium) {
    inexact_ &= !status_.done;
    const bool raised = method_.adapt && progress_.has_same_states() && !status_.done &&
                        adapt(run_.slots, initial_, progress_.last_violations(), progress_.violations(),
                              status_.negligible, !start_.is_of_motion(), increment_.rho_factor);
    if (raised) {  // another rho is another map
      accelerator_ = Accelerator<T>(method_.acceleration);
      progress_.change_map();
    }
    resumed_ = {};
    const auto cones = [&](Vector<T> x) { return projected_multiplier(run_.model, run_.slots, std::move(x)); };
    const Vector<T>& traction = equilibrium.field.traction;
    unknowns_.u = equilibrium.unknowns.u;
    unknowns_.time = equilibrium.unknowns.time;
    unknowns_.multiplier = raised || status_.done
                               ? traction
                               : accelerator_.next(unknowns_.multiplier, traction, progress_.has_same_states(),
                                                   progress_.contraction(), cones);
  }

  const UzawaAL& method_;
  Run<T>& run_;
  const State<T>& previous_;
  const Start<T>& start_;
  double time_;
  const bool truncated_ = method_.sensitivity == UzawaAL::Sensitivity::truncated;
  const int limit_ = method_.max_augmentations * (truncated_ ? 1 : Carried<T>::augmentations);
  const RegularisationField<T> initial_;
  const RunScales before_;  ///< of each augmentation's start, so that a lambda that overshoots does not raise them
  std::span<const ContactState> resumed_;  ///< states assumed by the first augmentation
  Unknowns<T> unknowns_;
  AugmentationProgress<T> progress_;
  Accelerator<T> accelerator_;
  AugmentationStatus status_;
  bool inexact_ = !truncated_;  ///< whether the next inner solve may end short of its tolerance
  Increment<T> increment_;
};

}  // namespace detail

template <class T>
Increment<T> UzawaAL::solve_increment(Run<T>& run, const State<T>& previous, const std::vector<double>& previous_factor,
                                      double time, const Start<T>& start) const {
  UzawaAL method = *this;
  method.tolerance = start.tolerance(tolerance);
  return detail::AugmentationLoop<T>(method, run, previous, previous_factor, time, start).solve();
}

}  // namespace stickslip
