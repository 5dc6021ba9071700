/// One-sided derivatives where a contact point is about to change state.
///
/// At a tie both branches give the same traction, so the scheme of the method, run with the neighbouring branch, gives
/// the derivative of the other side. For one parameter and one direction s = -1, +1 the branch of each weak point is
/// the one that its own derivative confirms:
///
///   z_N = 0          open iff s Dz_N > 0
///   |z_T| = bound    slip iff s (D|z_T| - D bound) > 0            Dz = D lambda + D(rho g), in that branch
///
/// found by flipping what is not confirmed. The history Dh then differs between the two sides, so both are carried to
/// the end of the run. Left out: a point at the apex of its cone (z_N = 0, z_T = 0) that would slip, for its direction
/// is not in its state, and the truncated scheme of Uzawa, whose sweeps have states of their own.
#pragma once

#include <optional>
#include <vector>

#include "sensitivity/differentiate.hpp"

namespace stickslip {

/// How far the nearest contact point is from a change of state: `open` between open and closed (pressure, or k g / A of
/// an open point, over the largest pressure or k / A times the largest motion); `slip` between stick and slip
/// (distance to the cone, or k |dg_T| / A of a slipping point, over the friction bound). Infinity where there is no
/// such point.
struct Margins {
  double open, slip;
};

/// Of one contact point.
Margins margins(const Model& model, const Slots<double>& slots, const State<double>& state, int point);
/// Of all: the least of each.
Margins margins(const Model& model, const Slots<double>& slots, const State<double>& state);

/// A margin up to this is none: a point is weak.
inline constexpr double weak_margin = 1e-8;

struct OneSided {
  /// Per increment: responses x parameters, from below and from above. NaN where no branch was confirmed.
  std::vector<Matrix<double>> backward, forward;
  Counters counters;
};

/// Both sides of all derivatives, if some increment has a weak point; none (and nothing is computed) otherwise.
std::optional<OneSided> one_sided_derivatives(const Model& model, const Slots<double>& slots, const Method& method,
                                              const Trajectory<double>& trajectory, Workspace<double>& workspace);

}  // namespace stickslip
