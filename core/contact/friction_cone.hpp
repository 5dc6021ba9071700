/// Friction cone: unilateral contact with friction as one projection. All methods use this projection and have none of
/// their own.
///
///     trial  z = lambda + rho g        traction  t = P_mu(z)
///
///   z = (z_N, z_T)   trial traction, force per area; z_N < 0: compression
///   open:  z_N > 0                    t = 0
///   stick: z_N <= 0, |z_T| <= bound   t = z
///   slip:  z_N <= 0, |z_T| >  bound   t_N = z_N,  t_T = bound z_T/|z_T|,     bound: core/contact/friction_law.hpp
///
/// Signs: t_N <= 0. t_T has the direction of the slip dg_T, because it enters the residual R = f_int - f_ext + sum A t
/// dg. Not differentiable at z_N = 0 and at |z_T| = bound; there the branch that classify() returns is differentiated.
/// Source: [AC91], [SL92]; theory of the projection: core/README.md.
#pragma once

#include "core/contact/friction_law.hpp"

namespace stickslip {

/// Normal traction and tangential components in the frame of a point, force per area. Tangents = 0: frictionless.
template <class T, int Tangents>
struct Traction {
  T normal{};
  Vec<T, Tangents> tangential = Vec<T, Tangents>::Zero();
};

/// Share of the bound within which |z_T| counts as equal to it. Why: a rule and not rounding must decide a tie.
inline constexpr double tie_band = 1e-12;

/// Branch of a trial traction.
///
///   bound       friction bound >= 0, force per area
///   tie_normal  z_N up to this counts as closed, force per area
///
/// Ties: z_N = 0 is closed; |z_T| = bound > 0 sticks; bound = 0 slips.
template <class T, int Tangents>
ContactState classify(const Traction<T, Tangents>& trial, double bound, double tie_normal) {
  if (value(trial.normal) > tie_normal) return ContactState::open;
  if constexpr (Tangents == 0) return ContactState::slip;
  if (bound > 0 && norm(values(trial.tangential)) <= bound * (1 + tie_band)) return ContactState::stick;
  return ContactState::slip;
}

/// Traction P_mu(trial) in the branch `state`, force per area. `bound`: friction bound, read in slip only.
template <class T, int Tangents>
Traction<T, Tangents> project_onto_cone(const Traction<T, Tangents>& trial, const T& bound, ContactState state) {
  Traction<T, Tangents> t;
  if (state == ContactState::open) return t;
  t.normal = trial.normal;
  if constexpr (Tangents > 0) {
    if (state == ContactState::stick) {
      t.tangential = trial.tangential;
    } else if (norm(values(trial.tangential)) > 0) {  // z_T = 0 has no direction: t_T = 0
      const T magnitude = norm(trial.tangential);
      for (int a = 0; a < Tangents; ++a) t.tangential[a] = bound * trial.tangential[a] / magnitude;
    }
  }
  return t;
}

}  // namespace stickslip
