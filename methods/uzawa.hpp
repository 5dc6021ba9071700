/// Augmented Lagrangian with Uzawa updates: Newton with lambda frozen, then lambda <- t, until the update is small.
///
///   repeat  solve  R(u) = f_int - f_ext + sum A t dg = 0,   t = P_mu(lambda + rho g)     (lambda fixed)
///           lambda <- t
///
///   rho           scale, force per length cubed; adapt: times 4 where an augmentation left more than 1/4 of the
///                 violation
///   acceleration  lambda <- an extrapolation of the last t, put back onto the cone (methods/acceleration.hpp)
///   cone          augmented: radius -mu z_N, the tangent of slip is unsymmetric
///                 frozen: radius -mu lambda_N of the last augmentation. The tangent is symmetric, but the radius is
///                 one more fixed point iteration, whose error changes by -mu/s an augmentation where the load path has
///                 the slope s (tangential over normal stiffness of the unloading): beyond s it ends in a two-cycle
///
/// The error shrinks by 1/(1 + rho s_min) an augmentation (s_min: smallest compliance of the active
/// constraints, S = B K^-1 B^T A), so a large rho needs few augmentations of harder inner problems. Slip is always
/// measured from the last converged increment, never from the last augmentation. Start: the last increment's lambda.
/// Stops where update, violation and states have settled to `tolerance`; gives up where the updates undo each other
/// (cycle) or a constraint does not yield (infeasible). Inner solves on the way go to a hundredth of the residual they
/// start from (the truncated scheme differentiates each of them, and takes them exact); the last is exact. Options:
/// methods/options.hpp. [SL92]
#pragma once

#include "methods/augmentation.hpp"

namespace stickslip {

inline ConeRadius cone_radius(const UzawaAL& method) {
  return method.cone == UzawaAL::Cone::augmented ? ConeRadius::augmented : ConeRadius::multiplier;
}
/// Whether a converged solution penetrates nothing.
constexpr bool prevents_penetration(const UzawaAL&) { return true; }
/// Whether the motion of methods/motion.hpp stands in where an increment fails. A frozen cone is there to be studied as
/// it is.
inline bool is_globalised(const UzawaAL& method) { return method.cone == UzawaAL::Cone::augmented; }

namespace detail {

/// Raises the factor of the points whose violation did not fall to a quarter; capped at 1e3 nodal stiffnesses. True
/// where one was raised.
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
    const double bound = -value(slots.friction[point.contact]) * value(normal), length = values(tangential).norm();
    if (length > bound) tangential *= -slots.friction[point.contact] * normal / norm(tangential);
  }
  return multiplier;
}

/// Share of its first residual, which the last update of lambda leaves, to which an inner solve goes while more
/// augmentations follow. Points that hardly slip would change their states in it down to rounding, each time anew; at a
/// hundredth the augmentations do not notice, and the contraction they show is off by as little.
inline constexpr double forcing = 0.01;

/// An inner residual above the error that the outer tolerance allows would stall the updates: the last of them are by
/// 1 - q smaller than that error.
inline NewtonOptions inner_options(const UzawaAL& method, double contraction) {
  constexpr double least = 1e-15;
  NewtonOptions inner = method.newton;
  const double rest = contraction < 1 ? 1 - contraction : 1;
  inner.tolerance =
      std::max(std::min(inner.tolerance, 0.01 * method.tolerance * rest), std::min(inner.tolerance, least));
  return inner;
}

/// Augmentations in a row that change nothing but states: points at a tie go to and fro for ever.
inline constexpr int patience_at_ties = 4;

inline constexpr const char* frozen_advice =
    ", as a frozen cone does where the friction coefficient exceeds the slope of the load path; use the augmented cone";

/// How the augmentations stand: the status they could end with, if `done`.
struct Standing {
  Status status = Status::converged;
  bool done = false;
  bool within = false;  ///< update and violation are within the tolerance, whatever the states do
  std::string message;
  double negligible = 0;  ///< a violation that counts as none: that of the tolerance, or of rounding
};

/// `reach`: largest displacement of a contact node; `noise`: force that rounding leaves of the inner solve, 0 where the
/// tolerance ended it.
template <class T>
Standing judge(const UzawaAL& method, const Slots<T>& slots, const RegularisationField<T>& rho, double reach,
               double noise, const RunScales& scales, const Augmentations<T>& progress) {
  const double gap = 10 * unit_roundoff * reach, violation = method.tolerance * scales.length;
  double stiffest = 0, friction = 0;
  for (const auto& r : rho) stiffest = std::max(stiffest, value(r.normal));
  for (const auto& mu : slots.friction) friction = std::max(friction, value(mu));
  // in slip the bound passes the rounding of the pressure on
  const double traction = (1 + friction) * (stiffest * gap + 10 * unit_roundoff * scales.traction);
  const bool small = progress.error_left() <= method.tolerance * scales.traction;
  // a stiff body on a soft one: what its rounding leaves to the tractions, and to the gaps through the soft one
  const bool drowned = noise > 0 && progress.stalled() && progress.is_within(10 * noise);
  // where nothing falls any more, rounding may have met the condition of a stiff body on a soft one
  const bool at_roundoff = drowned ||
                           (progress.stalled() && progress.violation() <= gap && progress.update() <= traction) ||
                           (progress.exhausted() && progress.violation() <= 1e3 * gap) ||
                           (progress.exhausted() && progress.converges() && progress.violation() <= violation);
  Standing now;
  now.negligible = std::max(violation, gap);
  now.within = small && progress.violation() <= now.negligible;
  auto end = [&](Status status, std::string message = "") {
    now.status = status;
    now.done = true;
    now.message = std::move(message);
    return now;
  };
  if ((progress.settled() || progress.update() == 0) && ((small && progress.violation() <= violation) || at_roundoff))
    return end(small ? Status::converged : Status::converged_at_roundoff);
  if (progress.violation() <= gap) return now;
  if (const std::string point = progress.unyielding(violation); !point.empty()) return end(Status::infeasible, point);
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

}  // namespace detail

template <class T, class E>
Increment<T> solve_increment(const UzawaAL& options, Run<T, E>& run, const State<T>& previous,
                             const std::vector<double>& previous_factor, double time, const Start<T>& start) {
  const Model& model = run.model;
  UzawaAL method = options;
  method.tolerance = start.tolerance(options.tolerance);
  const bool truncated = method.sensitivity == UzawaAL::Sensitivity::truncated;
  const int limit = method.max_augmentations * (std::is_same_v<T, double> || truncated ? 1 : 20);
  Increment<T> increment;
  increment.rho_factor = previous_factor.empty() ? std::vector<double>(model.points.size(), 1.0) : previous_factor;
  const auto initial = initial_regularisation(run.slots, method);
  const RunScales before = run.account.scales;  // without what an extrapolated lambda may overshoot by
  // (a loop that is differentiated as it was cut off begins with the last increment's lambda, as its derivative does)
  const State<T>& with_lambda = truncated && !start.is_step() ? previous : start.from;
  Vector<T> u = run.engine.begin(time, start.from.displacement), lambda = with_lambda.contact.traction;
  std::vector<ContactState> last = start.resumed(previous);  // at the first augmentation
  Augmentations<T> progress(model, run.slots, method.acceleration);
  Accelerator<T> accelerator(method.acceleration);
  const auto cones = [&](Vector<T> x) { return detail::into_cones(model, run.slots, std::move(x)); };
  bool rough = !truncated;  // whether the next inner solve may end short of its tolerance
  int within = 0;           // augmentations in a row that were
  while (true) {
    rough &= increment.augmentations + 1 < limit;
    const auto rho = adapted(initial, increment.rho_factor);
    const ContactInput<T> input{model, run.slots, rho, previous.contact.placement, cone_radius(method), time};
    run.account.scales = before;
    const auto equilibrium =
        newton(run.engine, input, u, lambda, false, last, detail::inner_options(method, progress.contraction()),
               run.account, rough ? detail::forcing : 0, start.anchor);
    account_for(increment, equilibrium, ++increment.augmentations);
    ++run.account.counters.augmentations;
    auto keep = [&] {
      increment.state = settle(run, input, equilibrium, previous.dissipation);
      return increment;
    };
    if (equilibrium.status == Status::cycle && !is_globalised(method)) increment.message += detail::frozen_advice;
    if (!is_converged(equilibrium.status)) return keep();
    if (truncated && model.effects.sensitivity)
      increment.sweeps.push_back({settle(run, input, equilibrium, previous.dissipation), increment.rho_factor});

    const double reach = largest_nodal_norm(run.engine.compact(equilibrium.u), model.dimension);
    const double first = equilibrium.history.front().residual, rest = equilibrium.history.back().residual;
    const double noise = equilibrium.status == Status::converged_at_roundoff
                             ? equilibrium.history.back().equilibrium * run.account.scales.force
                             : 0;
    progress.record(lambda, equilibrium.field, reach, first > 0 ? rest / first : 0);
    increment.contraction = progress.contraction();
    auto now = detail::judge(method, run.slots, rho, reach, noise, run.account.scales, progress);
    within = now.within && !equilibrium.rough ? within + 1 : 0;
    rough &= !now.within;
    now.done |= within >= detail::patience_at_ties;  // the states that still change are those of a tie
    const bool at_limit = increment.augmentations >= limit;
    detail::conclude(now, at_limit, increment);
    const bool over = now.done && !equilibrium.rough;
    if (at_limit || (over && (!is_converged(now.status) || truncated || !progress.derivative_moves()))) return keep();
    rough &= !now.done;
    const bool raised = method.adapt && progress.settled() && !now.done &&
                        detail::adapt(run.slots, initial, progress.last_violations(), progress.violations(),
                                      now.negligible, increment.rho_factor);
    if (raised) {  // it is another map now
      accelerator = Accelerator<T>(method.acceleration);
      progress.change_map();
    }
    last.clear();
    u = equilibrium.u;
    lambda = raised || now.done ? equilibrium.field.traction
                                : accelerator.next(lambda, equilibrium.field.traction, progress.settled(),
                                                   progress.contraction(), cones);
  }
}

}  // namespace stickslip
