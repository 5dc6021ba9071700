/// What goes on between the inner solves of Uzawa's augmentations: whether they have ended and how, and what the next
/// inner solve is asked for.
#pragma once

#include "methods/augmentation/adaption.hpp"
#include "methods/augmentation/augmentation_progress.hpp"

namespace stickslip {

namespace detail {

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
  //   no update has fallen for 50 augmentations, and the violation is within 1e3 roundings of a gap (a stiff body
  //     on a soft one)
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
  return end(Status::cycle, cycle + (method.is_globalised() ? "" : frozen_advice));
}

/// Records an inner solve, and judges whether the augmentations have ended.
template <class T>
AugmentationStatus judge(const UzawaAL& method, const Run<T>& run, const ContactInput<T>& input, const Unknowns<T>& at,
                         const Equilibrium<T>& equilibrium, AugmentationProgress<T>& progress) {
  const auto &first = equilibrium.history.front(), &last = equilibrium.history.back();
  const double moved = largest_nodal_norm(run.engine.compact(equilibrium.unknowns.u), run.model.dimension);
  const bool is_rounding = equilibrium.status == Status::converged_at_roundoff;
  progress.record(at.multiplier, equilibrium.field, moved, first.residual > 0 ? last.residual / first.residual : 0);
  auto status =
      augmentation_status(method, run.slots, input.rho, moved,
                          is_rounding ? last.equilibrium * run.account.scales.force : 0, run.account.scales, progress);
  status.done |= progress.times_within(status.within_tolerance && !equilibrium.inexact) >= patience_at_ties;
  return status;
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

}  // namespace detail

}  // namespace stickslip
