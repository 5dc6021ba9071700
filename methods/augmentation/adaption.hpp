/// How rho of each contact point is adapted between Uzawa's augmentations.
#pragma once

#include <algorithm>
#include <vector>

#include "methods/newton/regularisation.hpp"

namespace stickslip {

namespace detail {

/// The factor that makes rho of point p a multiple of its nodal stiffness over its area.
template <class T>
double factor_to(double multiple, const Slots<T>& slots, const RegularisationField<T>& initial, std::size_t p) {
  return multiple * value(slots.stiffness[p]) / value(slots.geometry[p].area) / value(initial[p].normal);
}

/// The factors that an increment begins with: those of the last (none at the start: 1), but none that makes rho larger
/// than the automatic one. Why: a larger rho costs little in the last augmentations, where states no longer change, and
/// much in the first, where points come and go. A rho far below the automatic one need not rise in each increment.
template <class T>
std::vector<double> first_factors(const Slots<T>& slots, const RegularisationField<T>& initial,
                                  std::vector<double> last) {
  const double automatic = UzawaAL::automatic_multiple.of(slots.normals_turn);
  last.resize(initial.size(), 1);
  for (std::size_t p = 0; p < last.size(); ++p)
    last[p] = std::min(last[p], std::max(1.0, factor_to(automatic, slots, initial, p)));
  return last;
}

/// Raises rho_factor of each point whose violation did not fall to a quarter, fourfold, up to 1e3 nodal stiffnesses.
/// `eager`: also where it did not fall to a hundredth, up to the automatic rho of fixed normals. `before`, `now`:
/// violations per point, length; a violation up to `negligible` counts as zero. True if a factor rose.
template <class T>
bool adapt(const Slots<T>& slots, const RegularisationField<T>& initial, const std::vector<double>& before,
           const std::vector<double>& now, double negligible, bool eager, std::vector<double>& rho_factor) {
  bool raised = false;
  for (std::size_t p = 0; p < before.size(); ++p) {
    const bool slow = now[p] > 0.25 * before[p], poor = eager && now[p] > 0.01 * before[p];
    if (now[p] <= negligible || !(slow || poor)) continue;
    const double most = slow ? 1e3 : UzawaAL::automatic_multiple.fixed;
    const double wanted = std::min(4 * rho_factor[p], factor_to(most, slots, initial, p));
    if (!(wanted > 1.001 * rho_factor[p])) continue;  // (rounding must not decide whether rho is there already)
    rho_factor[p] = wanted;
    raised = true;
  }
  return raised;
}

}  // namespace detail

}  // namespace stickslip
