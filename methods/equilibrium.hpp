/// One equilibrium of a method: Newton's method, and where friction makes it fail, the path of solutions from full
/// stick.
///
/// An increment of Coulomb's law may have several solutions, and Newton's method may find another one than its path
/// leads to, or go to and fro between two of them: a body that friction alone holds can as well be thrown out along a
/// slope, however slight, until nothing presses on it. The solution that is looked for is the one that is reached from
/// full stick as friction falls to what it is,
///
///   mu_k = f_k mu,   f = 1e6, 8, 8 / 2^(1/4), ..., 2^(1/4), 1,
///
/// each solution the start of the next, so that in each of these solves only a few points begin to slip. (Of 384 runs
/// of a block pressed on slopes of 1e-4 to 0.1, by three methods, 97 failed and 85 ended elsewhere without it and the
/// limit on the steps of newton(); 7 and 7 with them, nearly all of equal friction above and below, where both contacts
/// give way at once.)
#pragma once

#include "methods/newton.hpp"

namespace stickslip {

namespace detail {

/// Follows the solutions from full stick; what the first solve that fails left where one does.
template <class T, class E>
Equilibrium<T> follow_friction(E& engine, const ContactInput<T>& input, const Vector<T>& u, const Vector<T>& multiplier,
                               bool unknown, const NewtonOptions& options, Account& account, double forcing) {
  constexpr double stick = 1e6, most = 8;
  const double ratio = std::pow(2.0, 0.25);
  std::vector<double> factors{stick};
  for (double f = most; f > std::sqrt(ratio); f /= ratio) factors.push_back(f);
  NewtonOptions on_the_way = options;
  on_the_way.tolerance = std::sqrt(options.tolerance);
  const RunScales scales = account.scales;
  Slots<T> slots = input.slots;
  const ContactInput<T> eased{input.model, slots, input.rho, input.previous_placement, input.cone, input.time};
  Equilibrium<T> found;
  found.u = u;
  found.multiplier = multiplier;
  std::vector<IterationRecord> history;
  int iterations = 0;
  const auto take = [&](const ContactInput<T>& of, const NewtonOptions& with, double rough) {
    account.scales = scales;
    found = newton(engine, of, std::move(found.u), std::move(found.multiplier), unknown, {}, with, account, rough);
    history.insert(history.end(), found.history.begin(), found.history.end());
    iterations += found.iterations;
    return is_converged(found.status);
  };
  bool reached = true;
  for (std::size_t k = 0; k < factors.size() && reached; ++k) {
    for (std::size_t c = 0; c < slots.friction.size(); ++c) slots.friction[c] = T(factors[k]) * input.slots.friction[c];
    reached = take(eased, on_the_way, 0);
  }
  if (reached) take(input, options, forcing);
  found.history = std::move(history);
  found.iterations = iterations;
  return found;
}

}  // namespace detail

/// Solves one equilibrium as newton() does, with its arguments. Where there is friction and that fails, or goes twice
/// as far as its first step did while friction alone may hold a body between surfaces, the solutions from full stick
/// are followed. Theirs is taken if it is the only one, or the one with less than half of the motion.
template <class T, class E>
Equilibrium<T> find_equilibrium(E& engine, const ContactInput<T>& input, const Vector<T>& u,
                                const Vector<T>& multiplier, bool unknown, const std::vector<ContactState>& last,
                                const NewtonOptions& options, Account& account, double forcing = 0) {
  const RunScales before = account.scales;
  auto direct = newton(engine, input, u, multiplier, unknown, last, options, account, forcing);
  const bool solved = is_converged(direct.status);
  const bool thrown = direct.motion > 2 * direct.first && detail::is_wedged(input);
  if (!input.model.effects.friction || (solved && !thrown)) return direct;
  const RunScales after = std::exchange(account.scales, before);
  auto followed = detail::follow_friction(engine, input, u, multiplier, unknown, options, account, forcing);
  const bool better = is_converged(followed.status) && (!solved || 2 * followed.motion < direct.motion);
  auto& other = better ? direct : followed;
  auto& taken = better ? followed : direct;
  taken.history.insert(taken.history.begin(), other.history.begin(), other.history.end());
  taken.iterations += other.iterations;
  if (!better) account.scales = after;
  return std::move(taken);
}

}  // namespace stickslip
