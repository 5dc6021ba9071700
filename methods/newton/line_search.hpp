/// How far Newton's method goes along a step.
#pragma once

#include <limits>

#include "methods/newton/residuals.hpp"

namespace stickslip {

namespace detail {

/// Whether what does not balance in a trial is less than `unbalanced`, force, in a run that has had hardly any force.
/// Why: bodies that move as rigid ones bear less and less in each iterate. All of it is residual, so that beside the
/// forces of the iterate the residual does not fall.
template <class T>
bool falls_to_nothing(const Evaluation<T>& trial, double unbalanced, double force_of_run) {
  constexpr double hardly = 1e-3;
  const double left = trial.residuals.equilibrium * trial.scales.force;
  return trial.residuals.equilibrium == trial.residuals.largest() && force_of_run < hardly * left &&
         left < 0.9 * unbalanced;
}

}  // namespace detail

/// Moves the unknowns, and their evaluation, along a step; returns the share of the step. A full step that lands in
/// another active set is taken, for that is how the set is found. Within one set the residual must fall: backtracking,
/// down to 1/64. A trial that is not finite is always halved; where all are, the full step is taken as it is. Points
/// that slide over other surfaces go no further than a facet at once, beyond which the tangent knows nothing. `used`:
/// states of the last tangent.
template <class T>
double search_line(Evaluator<T>& evaluate, const NewtonStep<T>& step, const std::vector<ContactState>& used,
                   const NewtonOptions& options, Unknowns<T>& unknowns, detail::Evaluation<T>& at) {
  const double whole = evaluate.good_share(step.u), shortest_step = whole / 64;
  const double before = at.residuals.largest(), unbalanced = at.residuals.equilibrium * at.scales.force;
  double best = std::numeric_limits<double>::infinity(), taken = whole;
  const Unknowns<T> start = unknowns;
  const std::vector<Facing> faced = at.field.facing;
  for (double length = whole; length >= shortest_step; length /= 2) {
    Unknowns<T> moved{start.u + T(length) * step.u.col(0), start.multiplier, start.time + length * step.time};
    if (step.l.size() > 0) moved.multiplier += T(length) * step.l.col(0);
    auto trial = evaluate(moved);
    const bool finite = trial.residuals.finite();
    const double merit = trial.residuals.largest();
    if (length == whole || (finite && !(merit >= best))) {
      if (finite) best = merit;
      taken = length;
      unknowns = std::move(moved);
      at = std::move(trial);
    }
    if (!finite) continue;
    const bool new_branch = length == whole && (at.field.state != used || detail::count_crossings(at.field, faced) > 0);
    if (!options.line_search || merit < 0.9 * before || new_branch) break;
    if (detail::falls_to_nothing(at, unbalanced, evaluate.force_of_run())) break;
    if (at.residuals.within_rounding(options.tolerance)) break;
  }
  return taken;
}

}  // namespace stickslip
