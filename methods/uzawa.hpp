/// Augmented Lagrangian with Uzawa updates: Newton's method at fixed lambda, then lambda <- t, until the update is
/// small.
///
///   repeat  solve  R(u) = f_int - f_ext + sum A t dg = 0,   t = P_mu(lambda + rho g)     (lambda fixed)
///           lambda <- t                                                                  (AugmentationLoop::update)
///
///   rho           scale, force per length cubed. With `adapt`, rho of a point grows fourfold if an augmentation leaves
///                 more than 1/4 of its violation
///   acceleration  lambda <- an extrapolation of the last t, put back onto the cone
///   (methods/augmentation/acceleration.hpp) cone          augmented: radius -mu z_N; the tangent of slip is
///   unsymmetric
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
/// lambda <- t is update_derivatives() of sensitivity/uzawa.hpp. [SL92]
#pragma once

#include "methods/augmentation/augmentation_progress.hpp"
#include "methods/rescue/sequential.hpp"

namespace stickslip {

inline ConeRadius cone_radius(const UzawaAL& method) {
  return method.cone == UzawaAL::Cone::augmented ? ConeRadius::augmented : ConeRadius::multiplier;
}
/// Whether methods/rescue/motion.hpp continues where an increment fails. Not with a frozen cone: its failures are a
/// subject of study.
inline bool is_globalised(const UzawaAL& method) { return method.cone == UzawaAL::Cone::augmented; }

namespace detail {

/// Raises rho_factor of each point whose violation did not fall to a quarter, fourfold, up to 1e3 nodal stiffnesses.
/// `before`, `now`: violations per point, length; a violation up to `negligible` counts as zero. True if a factor rose.
template <class T>
bool adapt(const Slots<T>& slots, const RegularisationField<T>& initial, const std::vector<double>& before,
           const std::vector<double>& now, double negligible, std::vector<double>& factor) {
  bool raised = false;
  for (std::size_t p = 0; p < before.size(); ++p) {
    if (now[p] <= negligible || now[p] <= 0.25 * before[p]) continue;
    const double cap = 1e3 * value(slots.stiffness[p]) / value(slots.geometry[p].area) / value(initial[p].normal);
    const double wanted = std::min(4 * factor[p], cap);
    raised |= wanted > factor[p];
    factor[p] = std::max(factor[p], wanted);
  }
  return raised;
}

/// The multiplier in the friction cones. Compression is kept and tension set to zero; the tangential part is shortened
/// to the bound.
template <class T>
Vector<T> projected_multiplier(const Model& model, const Slots<T>& slots, Vector<T> multiplier) {
  for (const auto& point : model.points) {
    T& normal = multiplier[point.multiplier];
    if (value(normal) > 0) normal = T(0);
    if (point.tangents == 0) continue;
    auto tangential = multiplier.segment(point.multiplier + 1, point.tangents);
    const auto& law = slots.friction[point.contact];
    const double bound = law.bound(-value(normal)), magnitude = norm(values(tangential));
    if (magnitude > bound) tangential *= law.bound(T(-normal), law.piece(-value(normal))) / norm(tangential);
  }
  return multiplier;
}

/// Share of its first residual at which an inner solve may end while more augmentations follow. Why: an exact solve
/// would change, by rounding, the states of points that hardly slip. A share of 0.01 does not slow the augmentations
/// down, and changes the measured contraction by about 0.01 of itself.
inline constexpr double forcing = 0.01;

/// Newton's options of an inner solve. Its tolerance is the least of its own option and 0.01 (1 - q) times the outer
/// tolerance, but not below 1e-15; q: contraction. Why: the last updates are 1 - q times the error that the outer
/// tolerance allows, and a larger inner residual would stall them.
inline NewtonOptions inner_options(const UzawaAL& method, double contraction) {
  constexpr double least = 1e-15;
  NewtonOptions inner = method.newton;
  const double complement = contraction < 1 ? 1 - contraction : 1;
  inner.tolerance =
      std::max(std::min(inner.tolerance, 0.01 * method.tolerance * complement), std::min(inner.tolerance, least));
  return inner;
}

/// Number of successive augmentations within the tolerance after which changing states no longer prolong the loop. Why:
/// a point at a tie may alternate between two states for ever.
inline constexpr int patience_at_ties = 4;

inline constexpr const char* frozen_advice =
    ", as a frozen cone does where the friction coefficient exceeds the slope of the load path; use the augmented cone";

/// Whether the augmentations have ended, and how.
struct AugmentationStatus {
  Status status = Status::converged;  ///< valid if `done`
  bool done = false;
  bool within_tolerance = false;  ///< update and violation are within the tolerance; the states may still change
  std::string message;
  double negligible = 0;  ///< violation that counts as zero, length: the larger of tolerance and rounding
};

/// Status after an augmentation.
///
///   largest_displacement  of a contact node, length
///   noise                 nodal force that rounding left of the inner solve; 0: the solve ended by its tolerance
///
/// Estimates of rounding in its body:
///
///   gap       rounding of a gap, from that of the displacements, and from that of a traction, which is rho times a gap
///   traction  rounding of an update: rho gap, and rounding of the tractions, both times 1 + mu. In slip the bound
///             turns the rounding of the pressure into one of the tangential traction
///   drowned   updates no longer fall, and 10 `noise` explains every update and violation. Example: a stiff body on a
///             soft one, whose rounding appears in tractions, and through the soft body in gaps
template <class T>
AugmentationStatus augmentation_status(const UzawaAL& method, const Slots<T>& slots, const RegularisationField<T>& rho,
                                       double largest_displacement, double noise, const RunScales& scales,
                                       const AugmentationProgress<T>& progress) {
  double stiffest = 0, friction = 0;
  for (const auto& r : rho) stiffest = std::max(stiffest, value(r.normal));
  for (const auto& law : slots.friction) friction = std::max(friction, value(law.slope_at_apex()));
  const double carried = stiffest > 0 ? scales.traction / stiffest : 0;
  const double gap = 10 * unit_roundoff * (largest_displacement + carried),
               violation = method.tolerance * scales.length;
  const double traction = (1 + friction) * (stiffest * gap + 10 * unit_roundoff * scales.traction);
  const bool small = progress.error_left() <= method.tolerance * scales.traction;
  const bool drowned = noise > 0 && progress.is_stalled() && progress.is_within(10 * noise);
  // Rounding ends the augmentations in one of four cases:
  //   drowned
  //   updates no longer fall, and violation and update are rounding
  //   no update has fallen for 50 augmentations, and the violation is within 1e3 roundings of a gap (a stiff body on a
  //   soft one)
  //   no update has fallen for 50 augmentations of a map that contracts fast, and the violation is within its tolerance
  const bool at_roundoff = drowned ||
                           (progress.is_stalled() && progress.violation() <= gap && progress.update() <= traction) ||
                           (progress.is_exhausted() && progress.violation() <= 1e3 * gap) ||
                           (progress.is_exhausted() && progress.contracts_fast() && progress.violation() <= violation);
  AugmentationStatus result;
  result.negligible = std::max(violation, gap);
  result.within_tolerance = small && progress.violation() <= result.negligible;
  auto end = [&](Status status, std::string message = "") {
    result.status = status;
    result.done = true;
    result.message = std::move(message);
    return result;
  };
  if ((progress.has_same_states() || progress.update() == 0) &&
      ((small && progress.violation() <= violation) || at_roundoff))
    return end(small ? Status::converged : Status::converged_at_roundoff);
  if (progress.violation() <= gap) return result;
  if (const std::string point = progress.infeasible_point(violation); !point.empty())
    return end(Status::infeasible, point);
  if (!progress.is_two_cycle()) return result;
  const std::string cycle = "the augmentations go to and fro between two multipliers";
  return end(Status::cycle, cycle + (is_globalised(method) ? "; try more steps" : frozen_advice));
}

/// Sets status and message of the increment, if the augmentations are done or their number is at its limit. The outer
/// tolerance decides, not the stricter one of the inner solves.
template <class T>
void conclude(const AugmentationStatus& outer, bool at_limit, Increment<T>& increment) {
  if (!outer.done && !at_limit) return;
  increment.status = outer.done ? outer.status : Status::cap;
  increment.cut_off = !outer.done;
  increment.message =
      outer.done ? outer.message : "max_augmentations reached; try a larger scale, adapt, or an acceleration";
}

/// The augmentations of one increment.
template <class T, class E>
class AugmentationLoop {
 public:
  AugmentationLoop(const UzawaAL& method, Run<T, E>& run, const State<T>& previous, std::vector<double> rho_factor,
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
    increment_.rho_factor = std::move(rho_factor);
    // (The truncated scheme differentiates the loop from the lambda of the last increment on, so the loop begins
    // there.)
    const State<T>& with_lambda = truncated_ && !start.is_step() ? previous : start.state;
    unknowns_ = {run.engine.begin(time, start.state.displacement, previous.history.bodies),
                 with_lambda.contact.traction, time};
  }

  Increment<T> solve() {
    while (true) {
      const auto rho = adapted(initial_, increment_.rho_factor);
      const ContactInput<T> input{run_.model, run_.slots, rho, previous_.history, cone_radius(method_), time_};
      auto equilibrium = balance(input);
      if (!is_converged(equilibrium.status) || ends_with(input, equilibrium)) {
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
    const EquilibriumTask<T> task{input,
                                  Multipliers::given,
                                  start_.anchor,
                                  resumed_,
                                  inexact_ ? forcing : 0,
                                  first ? &start_.state.displacement : nullptr,
                                  nullptr,
                                  start_.arc,
                                  first && rests(run_, start_),
                                  first && start_.at_rest && run_.floating.empty()};
    auto equilibrium =
        find_equilibrium(run_.engine, task, unknowns_, inner_options(method_, progress_.contraction()), run_.account);
    account_for(increment_, equilibrium, ++increment_.augmentations);
    ++run_.account.counters.augmentations;
    if (equilibrium.status == Status::cycle && !is_globalised(method_)) increment_.message += frozen_advice;
    return equilibrium;
  }

  /// Whether the increment ends with this inner solve, as converged or as failed. If so, its status and message are
  /// set.
  bool ends_with(const ContactInput<T>& input, const Equilibrium<T>& equilibrium) {
    if (truncated_ && run_.model.effects.sensitivity)
      increment_.augmented.push_back(
          {settle(run_, input, equilibrium.unknowns, equilibrium.field), increment_.rho_factor});
    const double largest_displacement =
        largest_nodal_norm(run_.engine.compact(equilibrium.unknowns.u), run_.model.dimension);
    const double first = equilibrium.history.front().residual, rest = equilibrium.history.back().residual;
    const double noise = equilibrium.status == Status::converged_at_roundoff
                             ? equilibrium.history.back().equilibrium * run_.account.scales.force
                             : 0;
    progress_.record(unknowns_.multiplier, equilibrium.field, largest_displacement, first > 0 ? rest / first : 0);
    increment_.contraction = progress_.contraction();
    status_ = augmentation_status(method_, run_.slots, input.rho, largest_displacement, noise, run_.account.scales,
                                  progress_);
    // A state that needs no inner solve is solved if its violation is: of one state no contraction is known, and where
    // a body is free the next inner solve is singular.
    const bool unmoved = start_.at_rest && increment_.augmentations == 1 && equilibrium.iterations == 0;
    status_.done |= unmoved && progress_.violation() <= status_.negligible;
    times_within_ = status_.within_tolerance && !equilibrium.inexact ? times_within_ + 1 : 0;
    inexact_ &= !status_.within_tolerance;
    status_.done |= times_within_ >= patience_at_ties;  // only states at a tie still change
    const bool at_limit = increment_.augmentations >= limit_;
    conclude(status_, at_limit, increment_);
    const bool over = status_.done && !equilibrium.inexact;
    return at_limit || (over && (!is_converged(status_.status) || truncated_ || !progress_.has_carried_updates()));
  }

  /// The Uzawa update: lambda <- t, or an extrapolation of it. First rho is adapted. The derivative D lambda <- D t is
  /// update_derivatives() of sensitivity/uzawa.hpp.
  void update(const Equilibrium<T>& equilibrium) {
    inexact_ &= !status_.done;
    const bool raised = method_.adapt && progress_.has_same_states() && !status_.done &&
                        adapt(run_.slots, initial_, progress_.last_violations(), progress_.violations(),
                              status_.negligible, increment_.rho_factor);
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
  Run<T, E>& run_;
  const State<T>& previous_;
  const Start<T>& start_;
  double time_;
  const bool truncated_ = method_.sensitivity == UzawaAL::Sensitivity::truncated;
  const int limit_ = method_.max_augmentations * (truncated_ ? 1 : Carried<T>::augmentations);
  const RegularisationField<T> initial_;
  const RunScales
      before_;  ///< of each augmentation's start. Why: an extrapolated lambda may overshoot, which must not raise them
  std::span<const ContactState> resumed_;  ///< states assumed by the first augmentation
  Unknowns<T> unknowns_;
  AugmentationProgress<T> progress_;
  Accelerator<T> accelerator_;
  AugmentationStatus status_;
  bool inexact_ = !truncated_;  ///< whether the next inner solve may end short of its tolerance
  int times_within_ = 0;        ///< successive augmentations within the tolerance
  Increment<T> increment_;
};

}  // namespace detail

template <class T, class E>
Increment<T> solve_increment(const UzawaAL& options, Run<T, E>& run, const State<T>& previous,
                             const std::vector<double>& previous_factor, double time, const Start<T>& start) {
  UzawaAL method = options;
  method.tolerance = start.tolerance(options.tolerance);
  auto factor = previous_factor.empty() ? std::vector<double>(run.model.points.size(), 1.0) : previous_factor;
  return detail::AugmentationLoop<T, E>(method, run, previous, std::move(factor), time, start).solve();
}

}  // namespace stickslip
