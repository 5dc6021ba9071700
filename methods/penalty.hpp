/// Penalty: the contact traction is that of stiff springs on the penetration and on the elastic part of the slip.
///
///   lambda = (0, t_T of the last increment),   t = P_mu(lambda + eps g),   R(u) = f_int - f_ext + sum A t dg = 0
///
///   eps  penalty, force per length cubed (stiffness); eps_T = tangential_ratio * eps
///   t_T  stored tangential traction: history, together with the slip placement
///
/// The constraint is violated by t/eps. So the error falls as 1/eps, until rounding, which grows as eps, exceeds it.
/// Not differentiable where a point changes state. Options: methods/options.hpp. [SL92], [W06]
#pragma once

#include "methods/rescue/unyielding.hpp"
#include "methods/stepping/solve_once.hpp"

namespace stickslip {

template <class T>
Increment<T> Penalty::solve_increment(Run<T>& run, const State<T>& previous, const std::vector<double>&, double time,
                                      const Start<T>& start) const {
  const auto unyielding = [&](const ContactInput<T>& input, const Equilibrium<T>& equilibrium) {
    return unyielding_point(run, input, equilibrium);
  };
  return solve_once(run, previous, Multipliers::given, stored_traction(run.model, previous), time, start, unyielding);
}

}  // namespace stickslip
