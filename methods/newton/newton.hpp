/// Semi-smooth Newton for one equilibrium, shared by all methods.
///
///   R_u(u, lambda) = f_int(u) - f_ext + contact forces of t = P_mu(lambda + rho g) = 0
///   R_l(u, lambda) = A (t - lambda) = 0                            only where lambda is an unknown
///
/// Each iteration solves with the tangent of the branch that every point is in. Its policies stand in a file each:
///
///   methods/newton/residuals.hpp         the size of a residual, each relative to a scale of its own
///   methods/newton/newton_stop.hpp       what ends the iterations
///   methods/newton/assumed_branches.hpp  what is assumed of a point on a tie
///   methods/newton/newton_tangent.hpp    what is factorised, and what a singular tangent is taken for
///   methods/newton/line_search.hpp       how far a step is gone along
///   methods/newton/predictor.hpp         where it begins, of bodies that are not linear
///
/// What solves the problems in which it cycles is methods/rescue/sequential.hpp, where bodies or geometry are not
/// linear, and methods/rescue/motion.hpp. [AC91], [HSW08]; theory: core/README.md.
#pragma once

#include <optional>
#include <tuple>

#include "methods/newton/carried.hpp"
#include "methods/newton/line_search.hpp"
#include "methods/newton/newton_stop.hpp"
#include "methods/newton/predictor.hpp"

namespace stickslip {

namespace detail {

inline constexpr const char* redundant_message =
    "constraints repeat one another: they share the force, and their sum alone is unique";

template <class T>
IterationRecord record(const Evaluation<T>& at, const std::vector<ContactState>& before, int crossed,
                       double step_length) {
  IterationRecord r;
  r.residual = at.residuals.largest();
  r.equilibrium = at.residuals.equilibrium;
  r.normal = at.residuals.normal;
  r.tangential = at.residuals.tangential;
  r.step_length = step_length;
  r.changed = crossed;
  for (std::size_t p = 0; p < at.field.state.size(); ++p) {
    const ContactState s = at.field.state[p];
    ++(s == ContactState::open ? r.open : s == ContactState::stick ? r.stick : r.slip);
    if (!before.empty() && before[p] != s) ++r.changed;
  }
  return r;
}

inline constexpr const char* kept_message =
    "a point at a vertex of facets has no equilibrium on either of them: it is held on one; try a smooth surface, or "
    "segments";

inline constexpr const char* far_message =
    "points go to and fro between facets; try a smooth surface, segments, or more steps";

/// A solution of points on patches that they do not face, and how it ends.
template <class T>
using KeptSolution = std::tuple<NewtonEnd, Unknowns<T>, Evaluation<T>>;

/// Whether points that slide along curves give another way on from an end. States may cycle because points go to and
/// fro at a vertex: then the points are kept on their patches. From the solution of that there may be a way to a
/// solution in which all points face what they are on. Where there is none, the end is that of the kept points, and
/// says so; unless one of them is far from its vertex, for that is no solution.
template <class T, class E>
bool goes_on(Evaluator<T, E>& evaluate, NewtonStop& stop, NewtonEnd& end, Unknowns<T>& unknowns, Evaluation<T>& at,
             std::optional<KeptSolution<T>>& kept) {
  const bool wrong = evaluate.keeps_wrong(unknowns, at.field);
  const bool first = is_converged(end.status) && !kept && wrong;
  if (first) {
    kept = {end, unknowns, at};
    if (evaluate.keeps_far(at.field)) std::get<NewtonEnd>(*kept) = {Status::cycle, far_message};
    evaluate.release();
  }
  if (first || (end.status == Status::cycle && evaluate.keep_patches())) {
    stop.forget();
    at = evaluate(unknowns);
    return true;
  }
  if (kept && (!is_converged(end.status) || wrong)) {
    std::tie(end, unknowns, at) = std::move(*kept);
    if (is_converged(end.status)) end.message = kept_message;
  }
  return false;
}

}  // namespace detail

/// Solves one equilibrium from the start values `unknowns`.
template <class T, class E>
Equilibrium<T> newton(E& engine, const EquilibriumTask<T>& task, Unknowns<T> unknowns, const NewtonOptions& options,
                      Account& account) {
  const ContactInput<T>& input = task.contact;
  Evaluator<T, E> evaluate(engine, task, account);
  NewtonTangent<T, E> tangent(engine, task, account);
  NewtonStop stop(options, task.forcing, Carried<T>::newton_iterations, task.rests);
  Equilibrium<T> result;
  std::vector<ContactState> used;  // states of the last tangent
  ContactField<T> directed;        // field and branches of the last step
  std::optional<detail::KeptSolution<T>> kept;
  double step_length = 1;
  const int predictions = predict(engine, task, evaluate, tangent, account, unknowns) ? 1 : 0;
  auto at = evaluate(unknowns);
  const auto finish = [&](NewtonEnd end) {
    result.status = end.status;
    result.message = std::move(end.message);
    result.inexact = end.inexact;
    result.iterations = static_cast<int>(result.history.size()) - 1 + predictions;
    if (is_converged(end.status)) account.scales = at.scales;
    if (task.arc) engine.move_loads(unknowns.time);  // (a trial may have been of another)
    result.unknowns = std::move(unknowns);
    result.field = std::move(at.field);
    return std::move(result);
  };
  const auto tell_stability = [&] {
    if (input.model.effects.linear_bulk)
      result.reversed |= engine.reversed();
    else
      result.unstable = engine.reversed();
  };
  for (int iteration = 0;; ++iteration) {
    result.history.push_back(detail::record(at, used, evaluate.accept(at), step_length));
    if (account.trace)
      account.trace->take(input, Vector<T>(engine.spread(unknowns.u)), unknowns.multiplier, at.field,
                          result.history.back(), iteration);
    auto end = stop.judge(at.residuals, at.field, result.history);
    if (end && !detail::goes_on(evaluate, stop, *end, unknowns, at, kept)) {
      if (end->status == Status::converged && !end->inexact && tangent.redundant())
        end->message = detail::redundant_message;
      const bool untold = task.tells_stability && !input.model.effects.linear_bulk && !result.unstable;
      if (is_converged(end->status) && untold) {
        tangent.move_to(unknowns, at.field, true);
        auto branches =
            detail::step_branches(input, engine.compact(unknowns.u), at.field, unknowns.multiplier, directed);
        if (tangent.factorise(unknowns, branches)) tell_stability();
      }
      return finish(std::move(*end));
    }
    const auto evaluated = at.field.state;
    if (iteration == 0 && !task.resumed.empty())
      detail::resume_on_cone(input, unknowns.multiplier, task.resumed, at.field);
    auto branches = detail::step_branches(input, engine.compact(unknowns.u), at.field, unknowns.multiplier, directed);
    used = at.field.state;
    tangent.move_to(unknowns, at.field, iteration == 0 && predictions == 0);
    if (!tangent.factorise(unknowns, branches)) return finish({Status::singular, engine.message()});
    tell_stability();
    directed = at.field;
    directed.state = branches;
    if (branches != evaluated) evaluate.take_rows_in(branches, unknowns, at);
    const auto step =
        task.arc ? tangent.step_along(*task.arc, unknowns, at.rows_u, at.rows_l) : tangent.step(at.rows_u, at.rows_l);
    if (!step.u.allFinite() || !step.l.allFinite() || !std::isfinite(step.time))
      return finish({Status::singular, "the tangent is singular: its solution is not finite"});
    ++account.counters.newton;
    step_length = search_line(evaluate, step, used, options, unknowns, at);
  }
}

}  // namespace stickslip
