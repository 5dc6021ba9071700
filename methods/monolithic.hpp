/// Monolithic augmented Lagrangian: displacements and multipliers are solved together by semi-smooth Newton.
///
///   t = P_mu(lambda + rho g),   R_u = f_int - f_ext + sum A t dg = 0,   R_l = A (t - lambda) = 0
///
///   rho  scale, force per length cubed: it affects the iterates of Newton's method, not the solution
///   cone augmented: radius -mu z_N, z = lambda + rho g;  multiplier: radius -mu lambda_N. The solutions are the
///        same, the iterates differ
///
/// At the solution lambda = t satisfies the conditions of Signorini and Coulomb to rounding, for every rho > 0. The
/// only history is the slip placement; the last lambda is a start value. Options: methods/options.hpp. [AC91], [PC99]
#pragma once

#include "methods/stepping/solve_once.hpp"

namespace stickslip {

template <class T>
Increment<T> MonolithicAL::solve_increment(Run<T>& run, const State<T>& previous, const std::vector<double>&,
                                           double time, const Start<T>& start) const {
  const auto none = [](const ContactInput<T>&, const Equilibrium<T>&) { return std::string(); };
  return solve_once(run, previous, Multipliers::unknown, start.state.contact.traction, time, start, none);
}

}  // namespace stickslip
