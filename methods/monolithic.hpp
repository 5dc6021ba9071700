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

#include "methods/rescue/sequential.hpp"
#include "methods/stepping/increment.hpp"

namespace stickslip {

inline ConeRadius cone_radius(const MonolithicAL& method) {
  return method.cone == MonolithicAL::Cone::augmented ? ConeRadius::augmented : ConeRadius::multiplier;
}

/// Whether methods/rescue/motion.hpp continues where an increment fails.
constexpr bool is_globalised(const MonolithicAL&) { return true; }

template <class T, class E>
Increment<T> solve_increment(const MonolithicAL& method, Run<T, E>& run, const State<T>& previous,
                             const std::vector<double>&, double time, const Start<T>& start) {
  Increment<T> increment;
  const auto rho = initial_regularisation(run.slots, method);
  const ContactInput<T> input{run.model, run.slots, rho, previous.history, cone_radius(method), time};
  NewtonOptions options = method.newton;
  options.tolerance = start.tolerance(options.tolerance);
  const EquilibriumTask<T> task{input,
                                Multipliers::unknown,
                                start.anchor,
                                start.resumed(previous),
                                0,
                                &start.state.displacement,
                                nullptr,
                                start.arc,
                                rests(run, start),
                                start.at_rest && run.floating.empty()};
  auto u = run.engine.begin(time, start.state.displacement, previous.history.bodies);
  auto equilibrium =
      find_equilibrium<T>(run.engine, task, {std::move(u), start.state.contact.traction, time}, options, run.account);
  account_for(increment, equilibrium, 0);
  increment.state = settle(run, input, std::move(equilibrium.unknowns), std::move(equilibrium.field));
  return increment;
}

}  // namespace stickslip
