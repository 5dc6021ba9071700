/// Augmented Lagrangian with Uzawa updates: Newton with lambda frozen, then lambda <- t, until the update is small.
///
///   repeat  solve  R(u) = f_int - f_ext + sum A t dg = 0,   t = P_mu(lambda + rho g)     (lambda fixed)
///           lambda <- t
///
///   rho           scale, force per length cubed; adapt: times 4 where an augmentation left more than 1/4 of the
///                 violation
///   acceleration  lambda <- an extrapolation of the last t, put back onto the cone (methods/acceleration.hpp)
///   cone          augmented: radius -mu z_N; the tangent of slip is unsymmetric
///                 frozen: radius -mu lambda_N of the last augmentation; the tangent is symmetric. The radius is a
///                 fixed point iteration of its own: an augmentation multiplies its error by -mu/s, s the slope of the
///                 load path (tangential over normal stiffness of the unloading). For mu > s it ends in a two-cycle
///
/// An augmentation shrinks the error to 1/(1 + rho s_min) of itself, s_min the smallest compliance of the active
/// constraints (S = B K^-1 B^T A). So a large rho needs few augmentations, of harder inner problems. Slip is always
/// measured from the last converged increment, never from the last augmentation. lambda starts as the last increment's.
///
/// The loop ends where update, violation and states have settled to `tolerance`. It gives up where the updates undo
/// each other (cycle), or where a gap does not answer to its multiplier (infeasible). Inner solves on the way end at a
/// hundredth of the residual that they start from; the last is exact. The truncated scheme differentiates each of them,
/// so there all are exact. Options: methods/options.hpp. The update lambda <- t is AugmentationLoop::update; its
/// derivative is take_derivatives() of sensitivity/uzawa.hpp. [SL92]
#pragma once

#include "methods/augmentation.hpp"
#include "methods/sequential.hpp"

namespace stickslip {

inline ConeRadius cone_radius(const UzawaAL& method) {
  return method.cone == UzawaAL::Cone::augmented ? ConeRadius::augmented : ConeRadius::multiplier;
}
/// Whether the motion of methods/motion.hpp stands in where an increment fails. A frozen cone is there to be studied as
/// it is.
inline bool is_globalised(const UzawaAL& method) { return method.cone == UzawaAL::Cone::augmented; }

namespace detail {

/// Raises the factor of the points whose violation did not fall to a quarter, up to 1e3 nodal stiffnesses. True where
/// one was raised.
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

/// The nearest multiplier in the cones, along their axes: pressure kept, or none where it would be tension, and the
/// tangential part cut down to the bound.
template <class T>
Vector<T> into_cones(const Model& model, const Slots<T>& slots, Vector<T> multiplier) {
  for (const auto& point : model.points) {
    T& normal = multiplier[point.multiplier];
    if (value(normal) > 0) normal = T(0);
    if (point.tangents == 0) continue;
    auto tangential = multiplier.segment(point.multiplier + 1, point.tangents);
    const auto& law = slots.friction[point.contact];
    const double bound = law.bound(-value(normal)), length = values(tangential).norm();
    if (length > bound) tangential *= law.bound(T(-normal), law.piece(-value(normal))) / norm(tangential);
  }
  return multiplier;
}

/// Where an inner solve may end while more augmentations follow, as a share of the residual that the last update of
/// lambda left it with. An exact solve would change the states of points that hardly slip, down to rounding, each time
/// anew. At a hundredth the augmentations do not notice, and the contraction that they show is off by a hundredth.
inline constexpr double forcing = 0.01;

/// Newton's options of an inner solve. The last updates are 1 - q times the error that the outer tolerance allows, q
/// the contraction. An inner residual above them would stall them, so the inner tolerance is a hundredth of them, if it
/// is not smaller already; it goes down to 1e-15.
inline NewtonOptions inner_options(const UzawaAL& method, double contraction) {
  constexpr double least = 1e-15;
  NewtonOptions inner = method.newton;
  const double rest = contraction < 1 ? 1 - contraction : 1;
  inner.tolerance =
      std::max(std::min(inner.tolerance, 0.01 * method.tolerance * rest), std::min(inner.tolerance, least));
  return inner;
}

/// Augmentations in a row that may change nothing but states, for points at a tie go to and fro for ever.
inline constexpr int patience_at_ties = 4;

inline constexpr const char* frozen_advice =
    ", as a frozen cone does where the friction coefficient exceeds the slope of the load path; use the augmented cone";

/// How the augmentations stand. `done`: they end, with `status`.
struct Standing {
  Status status = Status::converged;
  bool done = false;
  bool within_tolerance = false;  ///< update and violation are within the tolerance, whatever the states do
  std::string message;
  double negligible = 0;  ///< a violation that counts as none: that of the tolerance, or of rounding
};

/// Where the augmentations stand after the last one. `reach`: largest displacement of a contact node. `noise`: nodal
/// force that rounding left of the inner solve; 0: its tolerance ended it.
///
///   gap        what rounding of the displacements makes of a gap
///   traction   what rounding makes of an update: rho gap, and rounding of the tractions; 1 + mu times that, because in
///              slip the bound turns the rounding of the pressure into one of the tangential traction
///   drowned    updates no longer fall, and ten times `noise` explains all that is left: a stiff body on a soft one
///              rounds so, in tractions, and in gaps through the soft one
template <class T>
Standing judge(const UzawaAL& method, const Slots<T>& slots, const RegularisationField<T>& rho, double reach,
               double noise, const RunScales& scales, const Augmentations<T>& progress) {
  const double gap = 10 * unit_roundoff * reach, violation = method.tolerance * scales.length;
  double stiffest = 0, friction = 0;
  for (const auto& r : rho) stiffest = std::max(stiffest, value(r.normal));
  for (const auto& law : slots.friction) friction = std::max(friction, value(law.slope_at_apex()));
  const double traction = (1 + friction) * (stiffest * gap + 10 * unit_roundoff * scales.traction);
  const bool small = progress.error_left() <= method.tolerance * scales.traction;
  const bool drowned = noise > 0 && progress.stalled() && progress.is_within(10 * noise);
  // Rounding ends the augmentations in one of four cases: drowned; nothing falls, and violation and update are
  // rounding; nothing has fallen for 50 augmentations, and the violation is within 1e3 roundings of a gap (a stiff body
  // on a soft one); nothing has fallen for 50, of a map that contracts fast, and the violation is within its tolerance.
  const bool at_roundoff = drowned ||
                           (progress.stalled() && progress.violation() <= gap && progress.update() <= traction) ||
                           (progress.exhausted() && progress.violation() <= 1e3 * gap) ||
                           (progress.exhausted() && progress.converges() && progress.violation() <= violation);
  Standing now;
  now.negligible = std::max(violation, gap);
  now.within_tolerance = small && progress.violation() <= now.negligible;
  auto end = [&](Status status, std::string message = "") {
    now.status = status;
    now.done = true;
    now.message = std::move(message);
    return now;
  };
  if ((progress.settled() || progress.update() == 0) && ((small && progress.violation() <= violation) || at_roundoff))
    return end(small ? Status::converged : Status::converged_at_roundoff);
  if (progress.violation() <= gap) return now;
  if (const std::string point = progress.unanswered(violation); !point.empty()) return end(Status::infeasible, point);
  if (!progress.alternates()) return now;
  const std::string cycle = "the augmentations go to and fro between two multipliers";
  return end(Status::cycle, cycle + (is_globalised(method) ? "; try more steps" : frozen_advice));
}

/// Status and message as things stand: the outer tolerance decides, not the stricter one of the inner solves.
template <class T>
void conclude(const Standing& now, bool at_limit, Increment<T>& increment) {
  if (!now.done && !at_limit) return;
  increment.status = now.done ? now.status : Status::cap;
  increment.cut_off = !now.done;
  increment.message =
      now.done ? now.message : "max_augmentations reached; try a larger scale, adapt, or an acceleration";
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
    // (the truncated scheme's derivative begins with the last increment's lambda: so does the loop that it
    // differentiates)
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
  /// The inner solve: lambda stays as it is.
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
                                  start_.arc};
    auto equilibrium =
        find_equilibrium(run_.engine, task, unknowns_, inner_options(method_, progress_.contraction()), run_.account);
    account_for(increment_, equilibrium, ++increment_.augmentations);
    ++run_.account.counters.augmentations;
    if (equilibrium.status == Status::cycle && !is_globalised(method_)) increment_.message += frozen_advice;
    return equilibrium;
  }

  /// Whether the increment ends with this inner solve, as solved or given up; its status and message then stand.
  bool ends_with(const ContactInput<T>& input, const Equilibrium<T>& equilibrium) {
    if (truncated_ && run_.model.effects.sensitivity)
      increment_.augmented.push_back(
          {settle(run_, input, equilibrium.unknowns, equilibrium.field), increment_.rho_factor});
    const double reach = largest_nodal_norm(run_.engine.compact(equilibrium.unknowns.u), run_.model.dimension);
    const double first = equilibrium.history.front().residual, rest = equilibrium.history.back().residual;
    const double noise = equilibrium.status == Status::converged_at_roundoff
                             ? equilibrium.history.back().equilibrium * run_.account.scales.force
                             : 0;
    progress_.record(unknowns_.multiplier, equilibrium.field, reach, first > 0 ? rest / first : 0);
    increment_.contraction = progress_.contraction();
    now_ = judge(method_, run_.slots, input.rho, reach, noise, run_.account.scales, progress_);
    times_within_ = now_.within_tolerance && !equilibrium.inexact ? times_within_ + 1 : 0;
    inexact_ &= !now_.within_tolerance;
    now_.done |= times_within_ >= patience_at_ties;  // the states that still change are those of a tie
    const bool at_limit = increment_.augmentations >= limit_;
    conclude(now_, at_limit, increment_);
    const bool over = now_.done && !equilibrium.inexact;
    return at_limit || (over && (!is_converged(now_.status) || truncated_ || !progress_.carried_moves()));
  }

  /// The update lambda <- t, or an extrapolation of it; rho is adapted. Its derivative D lambda <- D t is
  /// take_derivatives() of sensitivity/uzawa.hpp.
  void update(const Equilibrium<T>& equilibrium) {
    inexact_ &= !now_.done;
    const bool raised = method_.adapt && progress_.settled() && !now_.done &&
                        adapt(run_.slots, initial_, progress_.last_violations(), progress_.violations(),
                              now_.negligible, increment_.rho_factor);
    if (raised) {  // it is another map now
      accelerator_ = Accelerator<T>(method_.acceleration);
      progress_.change_map();
    }
    resumed_ = {};
    const auto cones = [&](Vector<T> x) { return into_cones(run_.model, run_.slots, std::move(x)); };
    const Vector<T>& traction = equilibrium.field.traction;
    unknowns_.u = equilibrium.unknowns.u;
    unknowns_.time = equilibrium.unknowns.time;
    unknowns_.multiplier = raised || now_.done ? traction
                                               : accelerator_.next(unknowns_.multiplier, traction, progress_.settled(),
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
  const RunScales before_;                 ///< at the increment's start: an extrapolated lambda may overshoot
  std::span<const ContactState> resumed_;  ///< at the first augmentation
  Unknowns<T> unknowns_;
  Augmentations<T> progress_;
  Accelerator<T> accelerator_;
  Standing now_;
  bool inexact_ = !truncated_;  ///< whether the next inner solve may end short of its tolerance
  int times_within_ = 0;        ///< augmentations in a row that were within the tolerance
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
