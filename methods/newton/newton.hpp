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
///   methods/newton/kept_patches.hpp      points that go to and fro at a corner
///
/// What is tried where it cycles: methods/rescue/rescue.hpp. [AC91], [HSW08]; theory: core/README.md.
#pragma once

#include <optional>

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

inline constexpr const char* vertex_message = "a point at a vertex of facets has no equilibrium on either of them";

/// The iterations of one equilibrium.
template <class T>
class NewtonIterations {
 public:
  NewtonIterations(Engine<T>& engine, const EquilibriumTask<T>& task, Unknowns<T> unknowns,
                   const NewtonOptions& options, Account& account)
      : engine_(engine),
        task_(task),
        options_(options),
        account_(account),
        evaluate_(engine, task, account),
        tangent_(engine, task, account),
        stop_(options, task.forcing, Carried<T>::newton_iterations, task.rests),
        unknowns_(std::move(unknowns)),
        predictions_(!closes_without_force() && predict(engine, task, evaluate_, tangent_, account, unknowns_) ? 1 : 0),
        at_(evaluate_(unknowns_)) {}

  Equilibrium<T> solve() {
    for (int iteration = 0;; ++iteration) {
      record(iteration);
      if (iteration == 0 && at_.forceless) return rest();
      auto end = stop_.judge(at_.residuals, at_.field, history());
      if (end && !goes_on(*end)) return result_of(std::move(*end));
      if (auto failure = step(iteration)) return result_of(std::move(*failure));
    }
  }

 private:
  std::vector<IterationRecord>& history() { return result_.history; }

  void record(int iteration) {
    history().push_back(detail::record(at_, used_, evaluate_.patches().accept(at_.field), step_length_));
    if (account_.trace)
      account_.trace->take(task_.contact, Vector<T>(engine_.spread(unknowns_.u)), unknowns_.multiplier, at_.field,
                           history().back(), iteration);
  }

  /// Whether the start values need no force, in a run that has had none: then nothing is predicted.
  bool closes_without_force() {
    return task_.last && !is_linear() && account_.scales.force == 0 && evaluate_(unknowns_).forceless;
  }

  /// Contact that closes without a force: its tractions are zero, and nothing moves.
  Equilibrium<T> rest() {
    unknowns_.multiplier.setZero();
    at_.field.traction.setZero();
    at_.scales = account_.scales;
    result_.forceless = true;
    return result_of({});
  }

  /// Factorises the tangent of the branches that the points are in, and goes a step with it. Returns why there is none.
  std::optional<NewtonEnd> step(int iteration) {
    const auto evaluated = at_.field.state;
    if (iteration == 0 && !task_.resumed.empty())
      resume_on_cone(task_.contact, unknowns_.multiplier, task_.resumed, at_.field);
    auto branches = branches_here();
    used_ = at_.field.state;
    const bool begins = iteration == 0 && predictions_ == 0;
    tangent_.move_to(unknowns_, at_.field, begins ? Linearise::unless_near : Linearise::always);
    if (!tangent_.factorise(unknowns_, branches)) return NewtonEnd{Status::singular, engine_.message()};
    tell_stability();
    directed_ = at_.field;
    directed_.state = branches;
    if (branches != evaluated) evaluate_.take_rows_in(branches, unknowns_, at_);
    const auto step = task_.arc ? tangent_.step_along(*task_.arc, unknowns_, at_.rows_u, at_.rows_l)
                                : tangent_.step(at_.rows_u, at_.rows_l);
    if (!step.u.allFinite() || !step.l.allFinite() || !std::isfinite(step.time))
      return NewtonEnd{Status::singular, "the tangent is singular: its solution is not finite"};
    ++account_.counters.newton;
    step_length_ = search_line(evaluate_, step, used_, options_, unknowns_, at_);
    return std::nullopt;
  }

  std::vector<ContactState> branches_here() const {
    return step_branches(task_.contact, engine_.compact(unknowns_.u), at_.field, unknowns_.multiplier, directed_);
  }

  /// Takes the sign of the last tangent's determinant.
  void tell_stability() {
    if (is_linear())
      result_.reversed |= engine_.reversed();
    else
      result_.unstable = engine_.reversed();
  }
  bool is_linear() const { return task_.contact.model.effects.linear_bulk; }

  bool is_kept_wrong() {
    const auto& patches = evaluate_.patches();
    return !patches.kept().empty() && patches.is_wrong(task_.contact, engine_.compact(unknowns_.u), at_.field);
  }

  /// Whether points that slide along surfaces give another way on from an end (methods/newton/kept_patches.hpp): from a
  /// cycle, points kept on their patches; once, from a wrong solution of that, points let go.
  bool goes_on(NewtonEnd& end) {
    const bool wrong = is_converged(end.status) && is_kept_wrong();
    const bool first = wrong && !released_;
    if (first) {
      released_ = true;
      evaluate_.patches().release();
    }
    if (first || (end.status == Status::cycle && evaluate_.patches().keep(task_.contact.model))) {
      stop_.forget();
      at_ = evaluate_(unknowns_);
      return true;
    }
    if (wrong || (released_ && !is_converged(end.status))) end = {Status::cycle, vertex_message};
    return false;
  }

  Equilibrium<T> result_of(NewtonEnd end) {
    if (end.status == Status::converged && !end.inexact && tangent_.redundant()) end.message = redundant_message;
    if (is_converged(end.status) && task_.tells_stability && !is_linear() && !result_.unstable) {
      tangent_.move_to(unknowns_, at_.field, Linearise::unless_near);
      auto branches = branches_here();
      if (tangent_.factorise(unknowns_, branches)) tell_stability();
    }
    result_.status = end.status;
    result_.message = std::move(end.message);
    result_.inexact = end.inexact;
    result_.iterations = static_cast<int>(history().size()) - 1 + predictions_;
    if (is_converged(end.status)) account_.scales = at_.scales;
    if (task_.arc) engine_.move_loads(unknowns_.time);  // (a trial may have been of another)
    result_.unknowns = std::move(unknowns_);
    result_.field = std::move(at_.field);
    return std::move(result_);
  }

  Engine<T>& engine_;
  const EquilibriumTask<T>& task_;
  const NewtonOptions& options_;
  Account& account_;
  Evaluator<T> evaluate_;
  NewtonTangent<T> tangent_;
  NewtonStop stop_;
  Unknowns<T> unknowns_;
  int predictions_;                 ///< iterations that the predictor took: 0 or 1
  Evaluation<T> at_;                ///< of the unknowns
  std::vector<ContactState> used_;  ///< states of the last tangent
  ContactField<T> directed_;        ///< field and branches of the last step
  bool released_ = false;           ///< whether points were kept on patches, and then let go
  double step_length_ = 1;
  Equilibrium<T> result_;
};

}  // namespace detail

/// Solves one equilibrium from the start values `unknowns`.
template <class T>
Equilibrium<T> newton(Engine<T>& engine, const EquilibriumTask<T>& task, Unknowns<T> unknowns,
                      const NewtonOptions& options, Account& account) {
  return detail::NewtonIterations<T>(engine, task, std::move(unknowns), options, account).solve();
}

}  // namespace stickslip
