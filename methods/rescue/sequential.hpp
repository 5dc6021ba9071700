/// Equilibria of nonlinear bodies as a sequence of contact problems of linear bodies.
///
/// Newton's method changes the bodies' tangent and the branches of the points at once. While the branches are wrong,
/// the bodies are far from their solution, and their tangent says nothing about it. Example: metal that a die presses
/// flat for one iterate flows as a whole. So if Newton's method does not converge soon, bodies and points are solved in
/// turns:
///
///   1. The bodies are linearised about the last iterate u_k.
///   2. Pivoting finds the branches of their contact problem; its solution is u_{k+1}.
///   3. Once the branches stay the same, each of these steps is a Newton step.
///
/// Where a change of branches costs no factor of the bodies (core/engine/condensed_tangent.hpp), their tangent serves
/// for up to three contact problems, each with the forces at the last one's solution. These come in place of u_{k+1} as
/// long as the residual falls to a tenth. So a tangent does more than Newton's: three of them are of fourth order.
/// (J. F. Traub, Iterative Methods for the Solution of Equations, 1964: several values of f to one derivative.)
///
/// Two more measures make this converge on curved surfaces. First, the branch of a closed point follows from its
/// traction alone, because its gap is an error of the linearisation. Second, if multipliers are given, the tractions of
/// points are unknowns (Compliance). Why: a step that slides by s over a radius R changes the gap by s^2/2R, and a
/// stiff point would turn that into many times its traction. At the end Newton's method solves the task as it was
/// given.
///
/// Pivoting: J. J. Judice, F. M. Pires, Comput. Oper. Res. 21 (1994) 587-596. Tractions as unknowns of the iteration
/// alone: D. Magisano, L. Leonetti, G. Garcea, Comput. Methods Appl. Mech. Engrg. 313 (2017) 829-850.
#pragma once

#include <set>

#include "methods/newton/newton.hpp"

namespace stickslip {

namespace detail {

/// Block pivoting: which points change their branches at once. As long as the number of wrong points falls: all of
/// them. If it has not fallen for three steps: those with the largest error. If the branches then repeat: the last
/// wrong point alone. This rule of Murty ends for every P-matrix, but depends on the order of the points.
class Pivoting {
 public:
  /// The next branches. `taken`: branches of the last solve; `wanted`: branches of its solution; `by`: error of each
  /// point.
  std::vector<ContactState> advance(const std::vector<ContactState>& taken, const std::vector<ContactState>& wanted,
                                    const std::vector<double>& by) {
    constexpr double as_far = 1 - 1e-6;  // symmetric points change together
    int wrong = 0;
    std::size_t last = 0;
    double furthest = 0;
    for (std::size_t p = 0; p < taken.size(); ++p)
      if (taken[p] != wanted[p]) {
        ++wrong;
        last = p;
        furthest = std::max(furthest, by[p]);
      }
    left_ = wrong < fewest_ ? patience : left_ - 1;
    fewest_ = std::min(fewest_, wrong);
    if (!is_careful()) return wanted;
    std::vector<ContactState> next = taken;
    for (std::size_t p = 0; p < taken.size(); ++p)
      if (taken[p] != wanted[p] && (one_by_one_ ? p == last : by[p] >= as_far * furthest)) next[p] = wanted[p];
    if (met_.insert(next).second) return next;
    repeats_ = one_by_one_;
    one_by_one_ = true;
    met_.clear();
    return next;
  }
  /// Whether fewer points change than are wrong.
  bool is_careful() const { return left_ < 0; }
  /// Whether the branches repeat under the last rule too.
  bool repeats() const { return repeats_; }

 private:
  static constexpr int patience = 3;
  int fewest_ = std::numeric_limits<int>::max(), left_ = patience;
  bool one_by_one_ = false, repeats_ = false;
  std::set<std::vector<ContactState>> met_;
};

/// The steps of one equilibrium.
template <class T>
class Sequence {
 public:
  Sequence(Engine<T>& engine, const EquilibriumTask<T>& task, Unknowns<T> start, const NewtonOptions& options,
           Account& account)
      : engine_(engine),
        task_(task),
        options_(options),
        account_(account),
        evaluate_(engine, task, account),
        tangent_(engine, task, account),
        unknowns_(std::move(start)) {}

  /// Runs the sequence. True if it converged; at given multipliers, to the tolerance of the compliant task.
  bool find() {
    // The 1200 equilibria found in the shipped scenes took at most 2 and 3 of these. For a die on facets of its own
    // size, 8 and 12 find a few more, at half as many iterations again in all.
    constexpr int most_unsettled = 3, patience = 6;
    const int most = std::min(40, options_.max_iterations);
    double least_residual = std::numeric_limits<double>::infinity();
    int waited = 0;  // steps since the least residual was halved
    Vector<T> about = unknowns_.u;
    if (task_.last)
      about = into_frames(task_.contact.model, task_.contact.slots.frames, NodalLayout::all, task_.last->displacement);
    const auto closed = [](ContactState s) { return s != ContactState::open; };
    if (std::any_of(task_.resumed.begin(), task_.resumed.end(), closed))
      branches_.assign(task_.resumed.begin(), task_.resumed.end());
    for (int step = 0; step < most; ++step) {
      const auto before = branches_;
      const int unsettled_before = unsettled_;
      const bool again = step == 0 && engine_.has_tangent_near({engine_.spread(about), task_.contact.previous.bodies});
      if (!solve_linear(about, again ? FixedTangent::last : FixedTangent::at_motion)) return false;
      auto at = evaluate_(unknowns_);
      for (int halvings = 0; !at.residuals.finite() && halvings < 6; ++halvings) {
        unknowns_.u -= T(0.5) * (unknowns_.u - about);
        for (int dof = 0; dof < static_cast<int>(unknowns_.u.size()); ++dof)
          if (!engine_.is_free(dof)) unknowns_.u[dof] = prescribed_[dof];
        at = evaluate_(unknowns_);
      }
      if (engine_.condenses_tangents()) solve_with_last_tangent(history_.empty() ? 1 : history_.back().residual, at);
      history_.push_back(record(at, {}, (before == branches_ ? 0 : 1) + evaluate_.patches().accept(at.field), 1));
      if (account_.trace) {
        account_.trace->take(task_.contact, Vector<T>(engine_.spread(unknowns_.u)), unknowns_.multiplier, at.field,
                             history_.back(), step);
        account_.trace->iterates.back().in_sequence = true;
      }
      if (!at.residuals.finite()) return false;
      const double residual = at.residuals.largest();
      waited = 2 * residual < least_residual ? 0 : waited + 1;
      if (waited == 0) least_residual = residual;
      const bool falls = history_.size() < 2 || 2 * residual < history_[history_.size() - 2].residual;
      const bool near = at.residuals.within(std::sqrt(options_.tolerance));
      const bool solved = at.residuals.within_rounding(options_.tolerance);
      // (If branches repeat although the residuals are rounding, they are at a tie.)
      const bool is_tie = unsettled_ > unsettled_before;
      if ((solved && (before == branches_ || is_tie)) || (near && !falls && before == branches_)) return true;
      if (waited > patience || unsettled_ > most_unsettled) return false;
      about = unknowns_.u;
    }
    return false;
  }
  Unknowns<T>& unknowns() { return unknowns_; }
  std::vector<IterationRecord>& history() { return history_; }
  int iterations() const { return iterations_; }
  /// Whether the last tangent had a determinant of the other sign; of tractions with a compliance of their own.
  bool reversed() const { return reversed_; }

 private:
  /// Solves the contact problem of the bodies linearised about a displacement, starting from `branches_`, if there are
  /// any. False if it has no solution.
  bool solve_linear(const Vector<T>& about, FixedTangent tangent) {
    const Vector<T> moved = engine_.spread(about);
    {
      const Stopwatch time(account_.seconds.bodies);
      engine_.fix_linearisation({moved, task_.contact.previous.bodies, task_.contact.time}, unknowns_.u, tangent);
    }
    prescribed_ = unknowns_.u;
    const bool solved = pivot();
    engine_.release_linearisation();
    return solved;
  }

  /// Solves further contact problems with the last tangent, as long as that pays. `last`: residual before it; `at`: of
  /// its solution, and then of the best.
  void solve_with_last_tangent(double last, detail::Evaluation<T>& at) {
    constexpr double enough = 0.1;
    constexpr int most = 2;
    for (int n = 0; n < most && at.residuals.largest() <= enough * last; ++n) {
      if (at.residuals.within_rounding(options_.tolerance)) return;
      last = at.residuals.largest();
      const Unknowns<T> found = unknowns_;
      const auto branches = branches_;
      const int unsettled = unsettled_;
      const bool solved = solve_linear(found.u, FixedTangent::last);
      auto next = evaluate_(unknowns_);
      if (!solved || !next.residuals.finite() || next.residuals.largest() >= last) {
        unknowns_ = found;
        branches_ = branches;
        unsettled_ = unsettled;
        return;
      }
      at = std::move(next);
    }
  }

  /// False if all branches give a singular tangent. If branches repeat, none are right, since friction may have no
  /// solution or several; then the next linear problem starts from the last branches.
  bool pivot() {
    constexpr int most = 100;
    Pivoting pivoting;
    ContactField<T> directed;
    auto at = evaluate_(unknowns_);
    auto wanted = branches_.empty() ? branches_in(at.field, unknowns_, directed) : branches_;
    auto branches = wanted;
    for (int i = 0; i < most; ++i) {
      tangent_.face(at.field);
      if (!pivoting.is_careful() || !tangent_.factorise_in(branches, unknowns_)) {
        branches = wanted;  // (the points that changed may be all that held a body)
        if (!tangent_.factorise(unknowns_, branches)) return false;
      }
      reversed_ = engine_.reversed();
      if (branches != at.field.state) evaluate_.take_rows_in(branches, unknowns_, at);
      const auto step = tangent_.step(at.rows_u, at.rows_l);
      if (!step.u.allFinite() || !step.l.allFinite()) return false;
      ++account_.counters.newton;
      ++iterations_;
      directed = at.field;
      directed.state = branches;
      const auto faced = at.field.facing;
      const double length = search_line(evaluate_, step, branches, options_, unknowns_, at);
      branches_ = branches;
      wanted = branches_in(at.field, unknowns_, directed);
      if (wanted == branches && count_crossings(at.field, faced) == 0 && length == 1) return true;
      branches = pivoting.advance(branches_, wanted, distances_to(wanted, at.field));
      if (pivoting.repeats()) break;
    }
    ++unsettled_;
    return true;
  }

  /// The branches of the points at an iterate after a step in the branches of `directed`.
  std::vector<ContactState> branches_in(ContactField<T> field, const Unknowns<T>& at, const ContactField<T>& directed) {
    const Vector<T> compact = engine_.compact(at.u), seen = seen_by_points(at.multiplier);
    if (!directed.state.empty() && task_.has_multiplier_rows())
      for (std::size_t p = 0; p < field.state.size(); ++p) {
        const auto trial =
            trial_after(task_.contact, static_cast<int>(p), at.multiplier, seen, directed.state[p], field);
        field.state[p] = trial.state(task_.contact, static_cast<int>(p), compact);
      }
    return step_branches(task_.contact, compact, field, seen, directed);
  }
  Vector<T> seen_by_points(const Vector<T>& multiplier) const {
    return task_.compliance ? task_.compliance->seen(multiplier) : multiplier;
  }

  /// Error of each point: distance, as a traction, from its present branch to `wanted`.
  std::vector<double> distances_to(const std::vector<ContactState>& wanted, const ContactField<T>& field) {
    std::vector<double> distances;
    const Vector<T> seen = seen_by_points(unknowns_.multiplier);
    for (std::size_t p = 0; p < wanted.size(); ++p) {
      // (from open, distances are gaps times rho)
      const auto from = task_.has_multiplier_rows() ? branches_[p] : ContactState::open;
      const auto trial = trial_after(task_.contact, static_cast<int>(p), unknowns_.multiplier, seen, from, field);
      const bool opens = branches_[p] == ContactState::open || wanted[p] == ContactState::open;
      distances.push_back(std::abs(opens ? trial.pressure : trial.tangential - trial.bound));
    }
    return distances;
  }

  Engine<T>& engine_;
  const EquilibriumTask<T>& task_;
  const NewtonOptions& options_;
  Account& account_;
  Evaluator<T> evaluate_;
  NewtonTangent<T> tangent_;
  Unknowns<T> unknowns_;
  Vector<T> prescribed_;                ///< displacement with the prescribed values
  std::vector<ContactState> branches_;  ///< of the last linear problem; empty before the first
  std::vector<IterationRecord> history_;
  bool reversed_ = false;
  int iterations_ = 0, unsettled_ = 0;  ///< number in all; number of linear problems whose branches repeated
};

/// rho, but at most the local stiffness k / A of each point. Why: points then have comparable weights.
template <class T>
RegularisationField<T> softened(const ContactInput<T>& input) {
  RegularisationField<T> rho = input.rho;
  for (std::size_t p = 0; p < rho.size(); ++p) {
    const T local = input.slots.stiffness[p] / input.slots.geometry[p].area;
    for (T* each : {&rho[p].normal, &rho[p].tangential})
      if (value(local) < value(*each)) *each = local;
  }
  return rho;
}

/// Compliance for tractions that are unknowns with a regularisation `rho` of their own.
template <class T>
Compliance<T> compliance_of(const ContactInput<T>& input, const Vector<T>& given, const RegularisationField<T>& rho) {
  Compliance<T> compliance{given, Vector<T>(given.size())};
  for (std::size_t p = 0; p < rho.size(); ++p) {
    const auto& point = input.model.points[p];
    compliance.share[point.multiplier] = rho[p].normal / input.rho[p].normal;
    for (int a = 0; a < point.tangents; ++a)
      compliance.share[point.multiplier + 1 + a] = rho[p].tangential / input.rho[p].tangential;
  }
  return compliance;
}

/// The equilibrium by the sequence of linear problems and then Newton's method. Status cycle if the sequence fails.
template <class T>
Equilibrium<T> solve_in_sequence(Engine<T>& engine, const EquilibriumTask<T>& task, const Unknowns<T>& start,
                                 const NewtonOptions& options, Account& account) {
  const auto& input = task.contact;
  const bool compliant = !task.solves_for_multipliers() && input.model.effects.current_geometry;
  const auto rho = compliant || task.solves_for_multipliers() ? softened(input) : input.rho;
  const auto compliance = compliant ? compliance_of(input, start.multiplier, rho) : Compliance<T>{};
  const ContactInput<T> seen{input.model, input.slots, rho, input.previous, input.cone, input.time};
  const EquilibriumTask<T> turns{.contact = seen,
                                 .multipliers = task.multipliers,
                                 .anchor = task.anchor,
                                 .resumed = task.resumed,
                                 .last = task.last,
                                 .compliance = compliant ? &compliance : nullptr};
  Sequence<T> sequence(engine, turns, start, options, account);
  Equilibrium<T> equilibrium;
  equilibrium.status = Status::cycle;
  if (sequence.find()) {
    const EquilibriumTask<T> last{.contact = input,
                                  .multipliers = task.multipliers,
                                  .anchor = task.anchor,
                                  .forcing = task.forcing,
                                  .tells_stability = sequence.reversed()};
    Unknowns<T> at = std::move(sequence.unknowns());
    if (!task.solves_for_multipliers()) at.multiplier = start.multiplier;
    equilibrium = newton(engine, last, std::move(at), options, account);
  }
  equilibrium.history.insert(equilibrium.history.begin(), sequence.history().begin(), sequence.history().end());
  equilibrium.iterations += sequence.iterations();
  return equilibrium;
}

}  // namespace detail

}  // namespace stickslip
