/// Penalty: the contact traction is a stiff spring on the penetration and on the elastic part of the slip.
///
///   lambda = (0, t_T of the last increment),   t = P_mu(lambda + eps g),   R(u) = f_int - f_ext + sum A t dg = 0
///
///   eps  penalty, force per length cubed (stiffness); eps_T = tangential_ratio * eps
///   t_T  stored tangential traction: the history, beside the slip placement
///
/// The constraint holds up to t/eps, so the error falls as 1/eps until rounding, which grows as eps, takes over.
/// Not differentiable where a point changes state. Options: methods/options.hpp. [SL92], [W06]
#pragma once

#include "methods/increment.hpp"

namespace stickslip {

/// The multiplier that history supplies: zero normal part, stored tangential traction of the last increment.
template <class T>
Vector<T> stored_traction(const Model& model, const State<T>& previous) {
  Vector<T> lambda = previous.contact.traction;
  for (const auto& point : model.points) lambda[point.multiplier] = T(0);
  return lambda;
}

inline ConeRadius cone_radius(const Penalty&) { return ConeRadius::augmented; }
/// Whether a converged solution penetrates nothing.
constexpr bool prevents_penetration(const Penalty&) { return false; }

template <class T, class E>
Increment<T> solve_increment(const Penalty& method, Run<T, E>& run, const State<T>& previous,
                             const std::vector<double>&, double time) {
  Increment<T> increment;
  const auto rho = initial_regularisation(run.slots, method);
  const ContactInput<T> input{run.model, run.slots, rho, previous.contact.placement, cone_radius(method), time};
  const auto equilibrium =
      find_equilibrium(run.engine, input, run.engine.begin(time, previous.displacement),
                       stored_traction(run.model, previous), false, previous.contact.state, method.newton, run.account);
  account_for(increment, equilibrium, 0);
  increment.state = settle(run, input, equilibrium, previous.dissipation);
  return increment;
}

}  // namespace stickslip
