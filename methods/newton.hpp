/// Semi-smooth Newton for one equilibrium, shared by all methods.
///
///   R_u(u, lambda) = f_int(u) - f_ext + contact forces of t = P_mu(lambda + rho g) = 0
///   R_l(u, lambda) = A (t - lambda) = 0                            only where lambda is an unknown
///
/// Each iteration solves with the tangent of the branch that every point is in. Residuals are relative, each to a scale
/// of its own, the largest among the run's equilibria and the iterate at hand:
///   equilibrium   largest nodal |R_u|                / largest nodal force of any kind
///   normal        closed: |t_N - lambda_N|/rho = |g_N| / largest of A|t|/k and of the relative displacement;
///   tangential    stick: |dg_T| likewise; open and slip: |t - lambda| / largest traction
/// Converged: all within the tolerance and no state changed since the last tangent. Where a residual stops falling at
/// the level of its own rounding the status is converged_at_roundoff; where it does so above it, but close to the
/// solution, stagnated. The full step is taken when it lands in another active set, for that is how the set is found;
/// within one set the residual must fall: backtracking, down to 1/64. A set that is met again without half of its
/// residual gone is a cycle: in 2D a step depends on the set alone, so that all would repeat. What solves these
/// problems is methods/motion.hpp. Where a tangent is singular while points are open, as of a body that nothing
/// holds but the contact it is about to make, they are presumed closed for one step: those that should not be are in
/// tension then, and open. [AC91], [HSW08]; theory: core/README.md.
#pragma once

#include <unordered_map>

#include "core/model/engine.hpp"
#include "core/model/loading.hpp"
#include "methods/options.hpp"
#include "methods/trace.hpp"

namespace stickslip {

/// Largest force, length and traction among the equilibria of the run so far. Iterates on the way do not count: a first
/// iterate may overshoot by any factor.
struct RunScales {
  double force = 0, length = 0, traction = 0;
};

/// What a run carries from solve to solve; owned by the caller.
struct Account {
  RunScales scales;
  Counters counters;
  Seconds seconds;
  Trace* trace = nullptr;  ///< not owned; gathers every iterate where it is there
};

template <class T>
struct Equilibrium {
  Status status = Status::converged;
  std::string message;
  Vector<T> u;           ///< engine dofs
  Vector<T> multiplier;  ///< lambda
  ContactField<T> field;
  int iterations = 0;
  bool rough = false;     ///< ended by `forcing`, short of the tolerance
  bool reversed = false;  ///< a tangent on the way was (Engine::reversed): there may be other solutions
  std::vector<IterationRecord> history;
};

/// Springs between the contact nodes and a place, which join the equilibrium with their forces.
template <class T>
struct Anchor {
  Vector<double> stiffness;  ///< of each contact node, the same in all directions, force per length; empty: none
  Vector<T> place;           ///< compact displacements
  /// Their forces at compact displacements.
  Vector<T> force(const Vector<T>& compact, int dimension) const {
    Vector<T> f = compact - place;
    for (Eigen::Index i = 0; i < f.size(); ++i) f[i] *= stiffness[i / dimension];
    return f;
  }
};

namespace detail {

/// Relative size; nothing is small against a scale that is not finite.
inline double ratio(double x, double scale) {
  return x == 0 ? 0 : std::isfinite(scale) ? x / scale : std::numeric_limits<double>::quiet_NaN();
}

struct Residuals {
  double equilibrium = 0, normal = 0, tangential = 0;
  double floor_equilibrium = 0, floor_length = 0, floor_traction = 0;  ///< what rounding alone may leave of them
  double largest() const { return larger(larger(equilibrium, normal), tangential); }
  bool finite() const { return std::isfinite(equilibrium) && std::isfinite(normal) && std::isfinite(tangential); }
  bool within(double tolerance) const { return finite() && largest() <= tolerance; }
  bool within_rounding(double tolerance) const {
    return finite() && equilibrium <= std::max(tolerance, floor_equilibrium) &&
           normal <= std::max(tolerance, floor_length) &&
           tangential <= std::max({tolerance, floor_length, floor_traction});
  }
};

/// Largest displacement that supports prescribe at a time.
template <class T>
double prescribed_motion(const Model& model, const Slots<T>& slots, double time) {
  Vector<T> displacement = Vector<T>::Constant(model.dof_count(), T(0));
  prescribe(model, slots, time, displacement);
  return largest_nodal_norm(displacement, model.dimension);
}

/// Forces of contact, and of the anchor where there is one, on the contact nodes.
template <class T>
Vector<T> acting_forces(const ContactInput<T>& input, const Vector<T>& compact, const Vector<T>& traction,
                        const Anchor<T>& anchor) {
  Vector<T> forces = contact_forces(input.model, input.slots, traction);
  if (anchor.stiffness.size() > 0) forces += anchor.force(compact, input.model.dimension);
  return forces;
}

/// One point of the Newton path, evaluated.
template <class T>
struct Evaluation {
  ContactField<T> field;
  Vector<T> rows_u, rows_l;
  Residuals residuals;
  RunScales scales;  ///< of the run, and of this iterate
};

template <class T, class E>
Evaluation<T> evaluate(E& engine, const ContactInput<T>& input, const Vector<T>& u, const Vector<T>& multiplier,
                       bool unknown, double prescribed, const RunScales& of_run, const Anchor<T>& anchor) {
  constexpr double rounding_factor = 100;  // several hundred terms meet in a row; each rounds once
  // Rounding of this share of the forces means displacements 1e9 times those that they cause in the stiffest body: one
  // that drifts off on a nearly singular tangent, and no equilibrium that rounding hides; unless supports move it as
  // far, or a softer one yields as far.
  constexpr double adrift = 1e-5, carried = 10, yielded = 1e3;
  const Model& model = input.model;
  Evaluation<T> at;
  RunScales& scales = at.scales;
  scales = of_run;
  const Vector<T> compact = engine.compact(u);
  at.field = evaluate_contact<T>(input, compact, multiplier, nullptr);
  ForceScale force{scales.force, 0};
  at.rows_u = engine.residual(u, acting_forces(input, compact, at.field.traction, anchor), force);
  scales.force = force.force;
  double contact_rounding = 0, distance = 0, elastic = 0,
         stiffest = 0;                                       // elastic: largest k / A; stiffest: largest rho
  double softest = std::numeric_limits<double>::infinity();  // least k
  for (std::size_t p = 0; p < model.points.size(); ++p) {
    const auto& point = model.points[p];
    const double area = value(input.slots.geometry[p].area), stiffness = value(input.slots.stiffness[p]);
    double moved = value(at.field.gap[p]) - value(input.slots.geometry[p].gap);
    moved *= moved;
    double traction = value(at.field.traction[point.multiplier]);
    traction *= traction;
    for (int a = 0; a < point.tangents; ++a) {
      const double s = value(at.field.placement[tangential_offset(model, static_cast<int>(p)) + a]);
      const double t = value(at.field.traction[point.multiplier + 1 + a]);
      moved += s * s;
      traction += t * t;
    }
    traction = std::sqrt(traction);
    scales.traction = std::max(scales.traction, traction);
    scales.length = std::max({scales.length, std::sqrt(moved), area * traction / stiffness});
    contact_rounding = std::max(contact_rounding, area * value(input.rho[p].normal));
    if (at.field.state[p] != ContactState::open)  // an initial gap rounds as a displacement does
      distance = std::max(distance, std::abs(value(input.slots.geometry[p].gap)));
    elastic = std::max(elastic, stiffness / area);
    softest = std::min(softest, stiffness);
    stiffest = std::max(stiffest, value(input.rho[p].normal));
  }
  const double reach = largest_nodal_norm(compact, model.dimension);
  for (Eigen::Index row = 0; row < at.rows_u.size(); ++row)
    if (!engine.is_free(row)) at.rows_u[row] = T(0);
  at.residuals.equilibrium = ratio(largest_nodal_norm(at.rows_u, model.dimension), scales.force);
  const double bulk_floor = rounding_factor * ratio(force.rounding, scales.force);
  if (bulk_floor <= adrift || reach <= carried * prescribed || softest * reach <= yielded * scales.force)
    at.residuals.floor_equilibrium =
        bulk_floor +
        rounding_factor * ratio(unit_roundoff * contact_rounding * std::max(reach, distance), scales.force);
  at.residuals.floor_length = rounding_factor * ratio(unit_roundoff * reach, scales.length);
  // in slip the bound passes on what rounding makes of the pressure lambda_N + rho g_N
  at.residuals.floor_traction = rounding_factor * ratio(unit_roundoff * stiffest * reach, scales.traction);
  if (!unknown) return at;
  at.rows_l = multiplier_residual(model, input.slots, at.field.traction, multiplier);
  // a body that slides where nothing presses: all its tractions are what rounding makes of its displacements
  const bool presses = scales.traction > rounding_factor * unit_roundoff * elastic * reach;
  for (std::size_t p = 0; p < model.points.size(); ++p)
    for (int c = 0; c < model.points[p].components(); ++c) {
      const int k = model.points[p].multiplier + c;
      const double defect = std::abs(value(at.field.traction[k]) - value(multiplier[k]));
      const ContactState state = at.field.state[p];
      const bool is_length = c == 0 ? state != ContactState::open : state == ContactState::stick;
      const double rho = value(c == 0 ? input.rho[p].normal : input.rho[p].tangential);
      const double traction_scale = scales.traction > 0 ? scales.traction : defect;  // all open, lambda not yet zero
      const double relative = is_length ? ratio(defect / rho, scales.length)
                              : presses ? ratio(defect, traction_scale)
                                        : 0;
      double& worst = c == 0 ? at.residuals.normal : at.residuals.tangential;
      worst = larger(worst, relative);
    }
  return at;
}

inline std::size_t signature(const std::vector<ContactState>& states) {
  std::size_t hash = 1469598103934665603ull;
  for (ContactState s : states) hash = (hash ^ static_cast<std::size_t>(s)) * 1099511628211ull;
  return hash;
}

template <class T>
IterationRecord record(const Evaluation<T>& at, const std::vector<ContactState>& before, double step_length) {
  IterationRecord r;
  r.residual = at.residuals.largest();
  r.equilibrium = at.residuals.equilibrium;
  r.normal = at.residuals.normal;
  r.tangential = at.residuals.tangential;
  r.step_length = step_length;
  for (std::size_t p = 0; p < at.field.state.size(); ++p) {
    const ContactState s = at.field.state[p];
    ++(s == ContactState::open ? r.open : s == ContactState::stick ? r.stick : r.slip);
    if (!before.empty() && before[p] != s) ++r.changed;
  }
  return r;
}

/// Gives points that start on their cone, up to 1e-8, the branch of the last increment: one that slipped then starts
/// there, off it by what that increment's tolerance left, and rounding must not decide where the path begins. If it
/// slips on, the front of slip need not be found anew; if it turns back, the first step takes it inside its cone.
template <class T>
void resume_on_cone(const ContactInput<T>& input, const Vector<T>& multiplier, const std::vector<ContactState>& last,
                    ContactField<T>& field) {
  for (int p = 0; p < static_cast<int>(input.model.points.size()); ++p) {
    const auto& point = input.model.points[p];
    if (field.state[p] == ContactState::open || point.tangents == 0) continue;
    double trial = 0;
    for (int a = 0; a < point.tangents; ++a) {
      const double slip = value(field.slip[tangential_offset(input.model, p) + a]);
      const double z = value(multiplier[point.multiplier + 1 + a]) + value(input.rho[p].tangential) * slip;
      trial += z * z;
    }
    const double bound = -value(input.slots.friction[point.contact]) * value(field.traction[point.multiplier]);
    if (bound > 0 && std::abs(std::sqrt(trial) - bound) <= 1e-8 * bound)
      field.state[p] = last[p] == ContactState::slip ? ContactState::slip : ContactState::stick;
  }
}

/// The branches that a Newton step is taken in: those of the evaluation, with two exceptions.
///   - A point at the apex of its cone (closed, no bound, no tangential trial) sticks, which is an element of the
///     generalised derivative there: a body that only friction holds then has a regular first tangent.
///   - A point that slipped in the last step and would now slip the other way sticks first. Far from the solution a
///     large rho turns any small overshoot of the slip into slip of the opposite sign, and points flip for ever; stick
///     lies between the two.
/// `last`: field and branches of the last step; empty at the first.
template <class T>
std::vector<ContactState> step_branches(const Model& model, const ContactInput<T>& input, const Vector<T>& compact,
                                        const ContactField<T>& field, const Vector<T>& multiplier,
                                        const ContactField<T>& last) {
  std::vector<ContactState> branches = field.state;
  for (int p = 0; p < static_cast<int>(model.points.size()); ++p) {
    const auto& point = model.points[p];
    if (branches[p] != ContactState::slip || point.tangents == 0 || value(input.slots.friction[point.contact]) == 0)
      continue;
    const double rounding = detail::tie_at(input, p, compact);
    bool apex = std::abs(value(field.traction[point.multiplier])) <= value(input.rho[p].normal) * rounding;
    const double tie = value(input.rho[p].tangential) * rounding;
    double along_last = 0;
    for (int a = 0; a < point.tangents; ++a) {
      const int k = point.multiplier + 1 + a;
      const double slip = value(field.slip[tangential_offset(model, p) + a]);
      apex &= std::abs(value(multiplier[k]) + value(input.rho[p].tangential) * slip) <= tie;
      if (!last.state.empty()) along_last += value(field.traction[k]) * value(last.traction[k]);
    }
    const bool reversed = !last.state.empty() && last.state[p] == ContactState::slip && along_last < 0;
    if (apex || reversed) branches[p] = ContactState::stick;
  }
  return branches;
}

/// A constraint that supports decide takes its multiplier from the gap as a penalty of the local stiffness k / A would,
/// step by step, also where rho is smaller: steps of rho would not get to the bound of friction.
template <class T>
void yield_decided(const ContactInput<T>& input, const std::vector<char>& decided,
                   std::vector<PointTangent<T>>& tangents) {
  constexpr double nothing = 1e-8;
  for (std::size_t p = 0; p < tangents.size(); ++p) {
    auto& tangent = tangents[p];
    const double local = value(input.slots.stiffness[p]) / value(input.slots.geometry[p].area);
    const double share = std::min(1.0, value(input.rho[p].normal) / local);
    for (Eigen::Index c = 0; c < tangent.row_l.rows(); ++c) {
      if (!decided[input.model.points[p].multiplier + c]) continue;
      const double own = values(tangent.row_l.row(c)).cwiseAbs().maxCoeff();
      const double along = values(tangent.row_w.row(c)).cwiseAbs().maxCoeff();
      if (own <= nothing * along) tangent.row_l(c, c) -= T(share * along);
    }
  }
}

/// Branches with all open points closed, and sticking where there is friction.
template <class T>
std::vector<ContactState> presume_contact(const ContactInput<T>& input, std::vector<ContactState> branches) {
  for (std::size_t p = 0; p < branches.size(); ++p) {
    const auto& point = input.model.points[p];
    if (branches[p] != ContactState::open) continue;
    const bool rough = point.tangents > 0 && value(input.slots.friction[point.contact]) > 0;
    branches[p] = rough ? ContactState::stick : ContactState::slip;
  }
  return branches;
}

/// Rows of an evaluation anew, in given branches.
template <class T, class E>
void rows_in(E& engine, const ContactInput<T>& input, const Vector<T>& u, const Vector<T>& multiplier, bool unknown,
             const std::vector<ContactState>& branch, const Anchor<T>& anchor, Evaluation<T>& at) {
  const Vector<T> compact = engine.compact(u);
  const auto field = evaluate_contact<T>(input, compact, multiplier, &branch);
  ForceScale unused;
  at.rows_u = engine.residual(u, acting_forces(input, compact, field.traction, anchor), unused);
  if (unknown) at.rows_l = multiplier_residual(input.model, input.slots, field.traction, multiplier);
}

inline constexpr const char* redundant_message =
    "constraints repeat one another: they share the force, and their sum alone is unique";

/// Whether the derivative that rides on a scalar still moves: nothing rides on a double; the oracle's imaginary part
/// follows the real one an iteration later.
template <class T>
constexpr int extra_iterations() {
  return std::is_same_v<T, double> ? 0 : 3;
}

}  // namespace detail

/// Solves one equilibrium from the start values `u` (engine dofs) and `multiplier`. `unknown`: lambda is solved for;
/// otherwise it stays as it is. `last`: states of the last increment, which points resume that start on their cone;
/// empty where none is to. `forcing`: share of its first residual at which a solve that is one of many may also end,
/// while states still change; 0: it does not.
template <class T, class E>
Equilibrium<T> newton(E& engine, const ContactInput<T>& input, Vector<T> u, Vector<T> multiplier, bool unknown,
                      const std::vector<ContactState>& last, const NewtonOptions& options, Account& account,
                      double forcing = 0, const Anchor<T>& anchor = {}) {
  const Model& model = input.model;
  constexpr double shortest_step = 1.0 / 64;
  constexpr int patience = 10;  // iterations in one active set that leave more than half of the residual
  Equilibrium<T> result;
  std::vector<ContactState> used;                // states of the last tangent
  ContactField<T> directed;                      // field and branches of the last step
  std::unordered_map<std::size_t, double> seen;  // active set -> smallest residual met with it
  bool redundant = false;                        // constraints repeat one another
  const auto decided = unknown ? decided_elsewhere(model, input.slots) : std::vector<char>();
  int extra = detail::extra_iterations<T>(), steady = 0, presumptions = 3;
  double step_length = 1;
  const double prescribed = detail::prescribed_motion(model, input.slots, input.time);
  const long points = static_cast<long>(model.points.size());
  auto at = detail::evaluate(engine, input, u, multiplier, unknown, prescribed, account.scales, anchor);
  account.counters.contact_evaluations += points;
  for (int iteration = 0;; ++iteration) {
    result.history.push_back(detail::record(at, used, step_length));
    result.history.back().changed = iteration == 0 ? 0 : result.history.back().changed;
    if (account.trace) account.trace->take(input, multiplier, at.field, result.history.back(), iteration);
    const bool unchanged = iteration == 0 || result.history.back().changed == 0;
    auto finish = [&](Status status, std::string message = "") {
      result.status = status;
      result.message = std::move(message);
      result.iterations = iteration;
      if (is_converged(status)) account.scales = at.scales;
      result.u = std::move(u);
      result.multiplier = std::move(multiplier);
      result.field = std::move(at.field);
      return std::move(result);
    };
    if (!at.residuals.finite()) return finish(Status::not_finite, "the residual is not finite");
    steady = unchanged && iteration > 0 ? steady + 1 : 0;
    bool repeats = false;
    if (!unchanged) {
      const auto [entry, fresh] = seen.try_emplace(detail::signature(at.field.state), at.residuals.largest());
      repeats = !fresh && at.residuals.largest() > 0.5 * entry->second;
      entry->second = std::min(entry->second, at.residuals.largest());
    }
    // (sets that repeat although nothing is left of the residuals are those of a tie)
    if ((unchanged || repeats) && at.residuals.within(options.tolerance)) {
      if (extra-- == 0) return finish(Status::converged, redundant ? detail::redundant_message : "");
    } else if (at.residuals.within_rounding(options.tolerance) &&
               (repeats || (steady >= 2 && 2 * at.residuals.largest() > result.history[iteration - 1].residual))) {
      if (extra-- == 0)
        return finish(Status::converged_at_roundoff, "the residual stopped falling at the level of rounding");
    } else if (iteration > 0 && at.residuals.within(forcing * result.history[0].residual)) {
      result.rough = true;
      return finish(Status::converged);
    } else if (repeats) {
      return finish(Status::cycle, "the active set repeats; try a smaller stiffness or scale, or more steps");
    }
    const bool close = at.residuals.within(std::sqrt(options.tolerance));  // where a step should square the residual
    if (steady >= patience && 2 * at.residuals.largest() > result.history[iteration - patience].residual)
      return finish(close ? Status::stagnated : Status::cycle,
                    "no step lowers the residual any more; try a smaller stiffness or scale");
    if (iteration >= options.max_iterations)
      return finish(Status::cap, "Newton's method reached max_iterations; try more steps");

    const auto evaluated = at.field.state;
    if (iteration == 0 && !last.empty()) detail::resume_on_cone(input, multiplier, last, at.field);
    auto branch = detail::step_branches(model, input, engine.compact(u), at.field, multiplier, directed);
    used = at.field.state;
    const auto factorise = [&] {
      std::vector<PointTangent<T>> tangents;
      {
        const Stopwatch time(account.seconds.assembly);
        const Vector<T> compact = engine.compact(u);
        for (int p = 0; p < static_cast<int>(model.points.size()); ++p)
          tangents.push_back(point_tangent<T>(input, p, compact, multiplier, branch[p]));
      }
      if (!decided.empty()) detail::yield_decided(input, decided, tangents);
      if (!redundant) {
        const Stopwatch time(account.seconds.backsolve);
        if (engine.update(tangents, account.counters, anchor.stiffness)) return true;
      }
      const Stopwatch time(account.seconds.factorization);
      return unknown ? factorise_sharing(engine, model, {}, std::move(tangents), redundant, account.counters,
                                         anchor.stiffness)
                     : engine.factorise(tangents, account.counters, anchor.stiffness);
    };
    if (!factorise()) {
      const auto closed = detail::presume_contact(input, branch);
      if (closed == branch || presumptions-- == 0) return finish(Status::singular, engine.message());
      branch = closed;
      if (!factorise()) return finish(Status::singular, engine.message());
    }
    result.reversed |= engine.reversed();
    directed = at.field;
    directed.state = branch;
    BlockVector<T> step;
    {
      const Stopwatch time(account.seconds.backsolve);
      if (branch != evaluated) {
        detail::rows_in(engine, input, u, multiplier, unknown, branch, anchor, at);
        account.counters.contact_evaluations += points;
      }
      step = engine.solve({-at.rows_u, unknown ? Matrix<T>(-at.rows_l) : Matrix<T>()});
      account.counters.backsolves += engine.solves();
    }
    if (!step.u.allFinite() || !step.l.allFinite())
      return finish(Status::singular, "the tangent is singular: its solution is not finite");
    ++account.counters.newton;
    if (unknown)
      for (std::size_t p = 0; p < model.points.size(); ++p)
        for (int c = 0; c < model.points[p].components(); ++c)
          step.l(model.points[p].multiplier + c, 0) *= c == 0 ? input.rho[p].normal : input.rho[p].tangential;

    const Stopwatch time(account.seconds.assembly);
    const double before = at.residuals.largest();
    double best = std::numeric_limits<double>::infinity();
    const Vector<T> u0 = u, multiplier0 = multiplier;
    for (double length = 1; length >= shortest_step; length /= 2) {
      const Vector<T> u1 = u0 + T(length) * step.u.col(0);
      const Vector<T> multiplier1 = unknown ? Vector<T>(multiplier0 + T(length) * step.l.col(0)) : multiplier0;
      auto trial = detail::evaluate(engine, input, u1, multiplier1, unknown, prescribed, account.scales, anchor);
      account.counters.contact_evaluations += points;
      const double merit = trial.residuals.largest();
      if (merit < best || !std::isfinite(best)) {
        best = merit;
        step_length = length;
        u = u1;
        multiplier = multiplier1;
        at = std::move(trial);
      }
      const bool new_branch = length == 1 && at.field.state != used;
      if (!options.line_search || merit < 0.9 * before || new_branch) break;
      if (at.residuals.within_rounding(options.tolerance)) break;
    }
  }
}

}  // namespace stickslip
