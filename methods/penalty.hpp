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

/// Whether the motion of methods/motion.hpp stands in where an increment fails.
constexpr bool is_globalised(const Penalty&) { return true; }

template <class T, class E>
Increment<T> solve_increment(const Penalty& method, Run<T, E>& run, const State<T>& previous,
                             const std::vector<double>&, double time, const Start<T>& start) {
  Increment<T> increment;
  const auto rho = initial_regularisation(run.slots, method);
  const ContactInput<T> input{run.model, run.slots, rho, previous.contact.placement, cone_radius(method), time};
  NewtonOptions options = method.newton;
  options.tolerance = start.tolerance(options.tolerance);
  const auto equilibrium =
      newton(run.engine, input, run.engine.begin(time, start.from.displacement), stored_traction(run.model, previous),
             false, start.resumed(previous), options, run.account, 0, start.anchor);
  account_for(increment, equilibrium, 0);
  increment.state = settle(run, input, equilibrium, previous.dissipation);
  return increment;
}

}  // namespace stickslip
