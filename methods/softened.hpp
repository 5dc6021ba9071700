/// Equilibria with given multipliers of points that slide over curves.
///
/// A step that slides by s over a radius R changes the gap by s^2/2R, which a stiff point answers with many times its
/// traction: Newton's method opens and closes it for ever. Where it does not end soon, the points are first made
/// softer, down to the local stiffness, and stiffened tenfold from solve to solve: what is closed stays closed by its
/// own overlap, and the last solve is the one that was asked for.
#pragma once

#include <algorithm>
#include <vector>

#include "methods/newton.hpp"

namespace stickslip {

/// newton() for a task whose multipliers are given.
template <class T, class E>
Equilibrium<T> newton_softened(E& engine, const EquilibriumTask<T>& task, Unknowns<T> start,
                               const NewtonOptions& options, Account& account) {
  constexpr int soon = 15;
  constexpr double softest = 1, stiffer = 10;  // local stiffnesses; times, from solve to solve
  const auto& input = task.contact;
  if (!input.model.effects.current_geometry) return newton(engine, task, std::move(start), options, account);
  double multiple = 0;
  for (std::size_t p = 0; p < input.rho.size(); ++p)
    multiple = std::max(
        multiple, value(input.rho[p].normal) * value(input.slots.geometry[p].area) / value(input.slots.stiffness[p]));
  if (multiple <= softest) return newton(engine, task, start, options, account);
  NewtonOptions brief = options, rough = options;
  brief.max_iterations = std::min(options.max_iterations, soon);
  rough.tolerance = std::sqrt(options.tolerance);
  rough.max_iterations = std::min(options.max_iterations, 2 * soon);
  const RunScales before = account.scales;
  auto direct = newton(engine, task, start, brief, account);
  if (is_converged(direct.status)) return direct;
  std::vector<IterationRecord> history = std::move(direct.history);
  int iterations = direct.iterations;
  Unknowns<T> at = start;
  bool first = true;
  for (double share = softest / multiple; share < 1; share *= stiffer) {
    RegularisationField<T> rho = input.rho;
    for (auto& r : rho) {
      r.normal *= T(share);
      r.tangential *= T(share);
    }
    account.scales = before;
    const ContactInput<T> soft{input.model, input.slots, rho, input.previous, input.cone, input.time};
    const EquilibriumTask<T> step{soft, Multipliers::given, task.anchor, {}, 0, first ? task.from : nullptr};
    auto found = newton(engine, step, at, rough, account);
    history.insert(history.end(), found.history.begin(), found.history.end());
    iterations += found.iterations;
    if (!is_converged(found.status)) break;
    at = std::move(found.at);
    first = false;
  }
  account.scales = before;
  const EquilibriumTask<T> last{input, Multipliers::given, task.anchor, {}, task.forcing, first ? task.from : nullptr};
  auto found = newton(engine, last, first ? start : at, options, account);
  found.history.insert(found.history.begin(), history.begin(), history.end());
  found.iterations += iterations;
  return found;
}

}  // namespace stickslip
