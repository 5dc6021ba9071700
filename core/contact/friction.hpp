/// Unilateral contact with friction as one projection: the kernel that every method shares.
///
///     trial  z = lambda + rho g        traction  t = P_mu(z)
///
///   z = (z_N, z_T)   trial traction, force per area; compression is negative
///   open:  z_N > 0                    t = 0
///   stick: z_N <= 0, |z_T| <= bound   t = z
///   slip:  z_N <= 0, |z_T| >  bound   t_N = z_N,  t_T = bound z_T/|z_T|,     bound: core/contact/friction_law.hpp
///
/// Not differentiable at z_N = 0 and at |z_T| = bound; there the branch that classify() names is differentiated.
/// Source: [AC91], [SL92]; theory of the projection: core/README.md.
#pragma once

#include "core/contact/friction_law.hpp"

namespace stickslip {

/// Normal part and tangential components in the frame of the point. Tangents = 0: frictionless.
template <class T, int Tangents>
struct Traction {
  T normal{};
  Vec<T, Tangents> tangential = Vec<T, Tangents>::Zero();
};

/// Relative width of the band in which a tie is decided by rule and not by rounding.
inline constexpr double tie_band = 1e-12;

/// The branch of a trial traction. `bound`: friction bound >= 0; `tie_normal`: z_N up to this counts as closed.
/// Ties: a body that just rests is closed; a point on the cone sticks; a point whose bound is zero slips.
template <class T, int Tangents>
ContactState classify(const Traction<T, Tangents>& trial, double bound, double tie_normal) {
  if (value(trial.normal) > tie_normal) return ContactState::open;
  if constexpr (Tangents == 0) return ContactState::slip;
  if (bound > 0 && values(trial.tangential).norm() <= bound * (1 + tie_band)) return ContactState::stick;
  return ContactState::slip;
}

/// P_mu in the branch `state`. `bound` is the friction bound of a slipping point (not read otherwise).
template <class T, int Tangents>
Traction<T, Tangents> project_onto_cone(const Traction<T, Tangents>& trial, const T& bound, ContactState state) {
  Traction<T, Tangents> t;
  if (state == ContactState::open) return t;
  t.normal = trial.normal;
  if constexpr (Tangents > 0) {
    if (state == ContactState::stick) {
      t.tangential = trial.tangential;
    } else if (values(trial.tangential).norm() > 0) {  // at the apex no direction exists, and no traction
      const T length = norm(trial.tangential);
      for (int a = 0; a < Tangents; ++a) t.tangential[a] = bound * trial.tangential[a] / length;
    }
  }
  return t;
}

}  // namespace stickslip
