/// The adjoint of one equilibrium, what all schemes share.
///
/// The residual, the contact and the responses of an increment are recorded once, in reverse scalars, at its converged
/// state; the bodies' forces enter the record as variables. For an objective with derivatives c_u, c_l by displacement
/// and multiplier (from its own share and from what later increments make of this one's history),
///
///   K^T a = -c,      DJ += a . dR/dslots      history <- a . dR/dhistory
///
/// where a is the force's weight along free dofs and -dJ/d(reaction) along prescribed ones, which then need no case of
/// their own. The bodies' share of a . dR/dslots is collected as pairs (a, u) and taken at the end, for all increments
/// in one visit of each element. The schemes differ in what becomes of the derivative by lambda.
/// Path-dependent adjoint: [MTV94]
#pragma once

#include "core/algebra/reverse.hpp"
#include "core/model/objective.hpp"
#include "methods/method.hpp"
#include "sensitivity/tangent.hpp"

namespace stickslip {

/// Derivatives of an objective by what the next increment reads of a state.
struct HistoryDerivative {
  Vector<double> placement, traction, dissipation;
};

/// One objective on its way back.
struct Backward {
  std::vector<double> by;  ///< derivative by each entry of the tape
  HistoryDerivative history;
  std::vector<Vector<double>> weights, motions;  ///< pairs (a, u), all dofs in the axes
};

/// Everything a scheme reads to take one increment back.
template <class E>
struct AdjointProblem {
  const Model& model;
  const Slots<double>& slots;
  E& engine;
  Tape& tape;
  const Slots<Reverse>& recorded;
  int slots_end = 0;  ///< on the tape
  std::vector<Backward>& objectives;
  Counters counters;
  Status status = Status::singular;  ///< why a scheme gave up
  std::string message;
};

template <class E>
class RecordedEquilibrium {
 public:
  /// `at`: the state (its multiplier is the lambda of its equilibrium). `unknown`: lambda is part of p. `rho`: recorded
  /// after rewinding the tape to slots_end. `objectives`: the increment is a step that they may be about.
  RecordedEquilibrium(AdjointProblem<E>& problem, const State<double>& previous, const State<double>& at,
                      const RegularisationField<Reverse>& rho, ConeRadius cone, double time, bool unknown,
                      bool objectives);

  bool valid() const { return valid_; }

  /// Seeds what the objective reads of this increment: its own share, and the history.
  void seed_outcome(int objective);
  /// Seeds a derivative by the traction t.
  void seed_traction(int objective, const Vector<double>& by);
  /// Moves what is seeded to displacement and lambda, and balances the displacement (and an unknown lambda).
  void balance(int objective);
  /// Takes the derivative by lambda out.
  Vector<double> take_multiplier(int objective);
  /// Largest derivative by a nodal force, of those that were added up on the way.
  double force_weight(int objective) const {
    const auto largest = [](const auto& m) { return m.size() ? m.cwiseAbs().maxCoeff() : 0.0; };
    return std::max(largest(weights_[objective]), largest(aside_[objective].solution.u));
  }
  /// All that an objective has gathered so far, to go back to it.
  struct Gathered;
  Gathered gathered(int objective) const;
  void restore(int objective, const Gathered& gathered);
  /// Moves all that is left to the slots; derivatives by the history that the increment started from.
  HistoryDerivative finish(int objective);

 private:
  static constexpr int refinements = 2;
  void record(const State<double>& previous, const RegularisationField<Reverse>& rho, ConeRadius cone, double time,
              bool objectives);
  Vector<double> pull_back(int objective);
  void pull_back_bodies(int objective, const Vector<double>& weight);
  void clear_free(int objective);
  /// An increment in engine layout that -c belongs to: c over all dofs, in the frames, and in engine rows.
  struct Solution {
    Matrix<double> u, c, reduced;
  };
  template <class Which>
  void seed_rows(int objective, const Solution& solution, Which&& which);
  void put_aside(int objective, const Solution& solution);
  std::vector<double>& by(int objective) { return problem_.objectives[objective].by; }
  Vector<double> gather(int objective, const Vector<Reverse>& at);
  static void seed(std::vector<double>& by, const Vector<Reverse>& at, const Vector<double>& derivative) {
    for (Eigen::Index i = 0; i < at.size(); ++i)
      if (at[i].at >= 0) by[at[i].at] += derivative[i];
  }

  AdjointProblem<E>& problem_;
  const State<double>& at_;
  Vector<double> scale_;  ///< rho of each multiplier component
  bool unknown_, valid_ = false, redundant_ = false;
  int outcome_start_ = 0;  ///< on the tape: behind it, functions of the variables below
  Vector<Reverse> prescribed_, displacement_, internal_, multiplier_, placement_, dissipation_;
  State<Reverse> state_;
  Vector<Reverse> rows_, multiplier_rows_;  ///< residual, in the frames of the nodes
  std::vector<Reverse> shares_;             ///< of this increment in each objective
  std::vector<Vector<double>> weights_;     ///< per objective: a, gathered
  struct Aside {
    Vector<double> bodies;  ///< weights of the bodies' forces, still to be moved to what is prescribed
    Solution solution;
  };
  std::vector<Aside> aside_;  ///< per objective, where lambda is given
};

template <class E>
struct RecordedEquilibrium<E>::Gathered {
  std::vector<double> by;
  Vector<double> weights;
  Aside aside;
};

template <class E>
RecordedEquilibrium<E>::RecordedEquilibrium(AdjointProblem<E>& problem, const State<double>& previous,
                                            const State<double>& at, const RegularisationField<Reverse>& rho,
                                            ConeRadius cone, double time, bool unknown, bool objectives)
    : problem_(problem), at_(at), scale_(problem.model.multiplier_count), unknown_(unknown) {
  const Model& model = problem.model;
  RegularisationField<double> values;
  for (const auto& r : rho) values.push_back({r.normal.v, r.tangential.v});
  for (std::size_t p = 0; p < model.points.size(); ++p)
    for (int c = 0; c < model.points[p].components(); ++c)
      scale_[model.points[p].multiplier + c] = c == 0 ? values[p].normal : values[p].tangential;
  const ContactInput<double> input{model, problem.slots, values, previous.contact.placement, cone, time};
  valid_ = factorise_converged(problem, input, at, unknown, redundant_);
  if (!valid_) return;
  record(previous, rho, cone, time, objectives);
  for (auto& objective : problem.objectives) {
    objective.by.resize(problem.slots_end);
    objective.by.resize(problem.tape.size(), 0);
    weights_.push_back(Vector<double>::Zero(model.dof_count()));
    aside_.push_back({weights_.back(), {}});
  }
}

template <class E>
void RecordedEquilibrium<E>::record(const State<double>& previous, const RegularisationField<Reverse>& rho,
                                    ConeRadius cone, double time, bool objectives) {
  const Model& model = problem_.model;
  const auto& slots = problem_.recorded;
  Tape& tape = problem_.tape;
  prescribed_ = at_.displacement.unaryExpr([](double x) { return Reverse(x); });
  prescribe(model, slots, time, prescribed_);
  outcome_start_ = tape.size();
  displacement_ = leaves(at_.displacement, tape);
  internal_ = leaves(bulk_forces(model, problem_.slots, at_.displacement), tape);
  multiplier_ = leaves(at_.multiplier, tape);
  placement_ = leaves(previous.contact.placement, tape);
  dissipation_ = leaves(previous.dissipation, tape);
  const ContactInput<Reverse> input{model, slots, rho, placement_, cone, time};
  state_.displacement = displacement_;
  state_.multiplier = multiplier_;
  state_.contact = evaluate_contact<Reverse>(input, to_compact(model, displacement_), multiplier_, &at_.contact.state);
  problem_.counters.contact_evaluations += static_cast<long>(model.points.size());
  take_rays(input, multiplier_, at_.contact.ray, state_.contact);
  state_.dissipation = dissipated(input, state_.contact, multiplier_, dissipation_);
  const Vector<Reverse> balance = nodal_balance(model, slots, state_, internal_, time);
  rows_ = into_frames(model, slots.frames, Layout::all, balance);
  if (unknown_) multiplier_rows_ = multiplier_residual(model, slots, state_.contact.traction, multiplier_);
  if (!objectives) return;
  const NodalForces<Reverse> forces{internal_, support_forces(model, slots, balance)};
  for (const auto& objective : model.scene.objectives)
    shares_.push_back(contributes(objective, time, model.times.back())
                          ? contribution(objective, evaluate_response(model, slots, objective.response, state_, forces),
                                         time, slots.numbers)
                          : Reverse());
}

template <class E>
Vector<double> RecordedEquilibrium<E>::gather(int objective, const Vector<Reverse>& at) {
  return at.unaryExpr([&](const Reverse& x) { return by(objective)[x.at]; });
}

template <class E>
void RecordedEquilibrium<E>::seed_outcome(int objective) {
  if (!shares_.empty() && shares_[objective].at >= 0) by(objective)[shares_[objective].at] += 1;
  const auto& history = problem_.objectives[objective].history;
  seed(by(objective), state_.contact.placement, history.placement);
  seed(by(objective), state_.contact.traction, history.traction);
  seed(by(objective), state_.dissipation, history.dissipation);
}

template <class E>
void RecordedEquilibrium<E>::seed_traction(int objective, const Vector<double>& derivative) {
  seed(by(objective), state_.contact.traction, derivative);
}

/// Moves what is seeded to the variables of the increment, but for the bodies' forces: takes their weights out.
template <class E>
Vector<double> RecordedEquilibrium<E>::pull_back(int objective) {
  problem_.tape.pull_back(by(objective), outcome_start_);
  const Vector<double> weight = gather(objective, internal_);
  for (const auto& x : internal_) by(objective)[x.at] = 0;
  weights_[objective] += weight;
  return weight;
}

/// Moves weights of the bodies' forces to the displacement: their tangent is symmetric.
template <class E>
void RecordedEquilibrium<E>::pull_back_bodies(int objective, const Vector<double>& weight) {
  if (weight.size() > 0 && weight.cwiseAbs().maxCoeff() > 0)
    seed(by(objective), displacement_, bulk_tangent_times(problem_.model, problem_.slots, at_.displacement, weight));
}

/// A solve took the derivative by the free displacements up.
template <class E>
void RecordedEquilibrium<E>::clear_free(int objective) {
  const auto& frames = problem_.slots.frames;
  Vector<double> left = into_frames(problem_.model, frames, Layout::all, gather(objective, displacement_));
  for (int dof : problem_.model.free_dofs) left[dof] = 0;
  left = out_of_frames(problem_.model, frames, Layout::all, std::move(left));
  for (Eigen::Index i = 0; i < left.size(); ++i) by(objective)[displacement_[i].at] = left[i];
}

template <class E>
void RecordedEquilibrium<E>::balance(int objective) {
  const Model& model = problem_.model;
  pull_back_bodies(objective, pull_back(objective));
  double first = 0;
  for (int pass = 0; pass <= refinements; ++pass) {
    const Matrix<double> c = into_frames(model, problem_.slots.frames, Layout::all, gather(objective, displacement_));
    Matrix<double> l = Matrix<double>::Zero(model.multiplier_count, 1);
    if (unknown_) l = gather(objective, multiplier_).cwiseProduct(scale_);
    double size = l.size() ? l.cwiseAbs().maxCoeff() : 0;
    for (int dof : model.free_dofs) size = std::max(size, std::abs(c(dof, 0)));
    if (pass == 0) first = size;
    if (size == 0 || (pass > 0 && !redundant_ && size <= 1e-13 * first)) return;
    const Matrix<double> reduced = problem_.engine.reduce(c);
    const auto a = problem_.engine.solve({-reduced, -l}, Solving::transposed);
    ++problem_.counters.sensitivity_backsolves;
    if (!unknown_) return put_aside(objective, {a.u, c, reduced});
    seed_rows(objective, {a.u, c, reduced}, [](int) { return true; });
    seed(by(objective), multiplier_rows_, a.l);
    pull_back_bodies(objective, pull_back(objective));
  }
}

/// Seeds the rows of free dofs with a solution.
template <class E>
template <class Which>
void RecordedEquilibrium<E>::seed_rows(int objective, const Solution& solution, Which&& which) {
  const Vector<double> all = problem_.engine.expand(solution.u, -solution.c, -solution.reduced);
  const Vector<double> weight = into_frames(problem_.model, problem_.slots.frames, Layout::all, all);
  for (int dof : problem_.model.free_dofs)
    if (which(dof / problem_.model.dimension)) by(objective)[rows_[dof].at] += weight[dof];
}

/// Where lambda is given, it only feels the solution at the contact nodes; the rest is added up for finish().
template <class E>
void RecordedEquilibrium<E>::put_aside(int objective, const Solution& solution) {
  const Model& model = problem_.model;
  const int D = model.dimension;
  const Vector<double> compact = into_frames(model, problem_.slots.frames, Layout::compact,
                                             problem_.engine.compact(Vector<double>(solution.u.col(0))));
  for (std::size_t n = 0; n < model.contact_nodes.size(); ++n)
    for (int i = 0; i < D; ++i)
      if (const int dof = model.contact_nodes[n] * D + i; model.free_index[dof] >= 0)
        by(objective)[rows_[dof].at] += compact[n * D + i];
  auto& aside = aside_[objective];
  aside.bodies += pull_back(objective);
  const auto add = [](Matrix<double>& sum, const Matrix<double>& x) { sum = sum.size() ? Matrix<double>(sum + x) : x; };
  add(aside.solution.u, solution.u);
  add(aside.solution.c, solution.c);
  add(aside.solution.reduced, solution.reduced);
  clear_free(objective);
}

template <class E>
Vector<double> RecordedEquilibrium<E>::take_multiplier(int objective) {
  const Vector<double> derivative = gather(objective, multiplier_);
  for (const auto& x : multiplier_) by(objective)[x.at] = 0;
  return derivative;
}

template <class E>
typename RecordedEquilibrium<E>::Gathered RecordedEquilibrium<E>::gathered(int objective) const {
  return {problem_.objectives[objective].by, weights_[objective], aside_[objective]};
}

template <class E>
void RecordedEquilibrium<E>::restore(int objective, const Gathered& gathered) {
  by(objective) = gathered.by;
  weights_[objective] = gathered.weights;
  aside_[objective] = gathered.aside;
}

template <class E>
HistoryDerivative RecordedEquilibrium<E>::finish(int objective) {
  auto& aside = aside_[objective];
  if (aside.solution.u.size()) {
    const auto& nodes = problem_.model.contact_nodes;
    seed_rows(objective, aside.solution,
              [&](int node) { return !std::binary_search(nodes.begin(), nodes.end(), node); });
    aside.bodies += pull_back(objective);
    pull_back_bodies(objective, aside.bodies);
    clear_free(objective);
  }
  seed(by(objective), prescribed_, gather(objective, displacement_));
  const HistoryDerivative history{gather(objective, placement_), Vector<double>::Zero(scale_.size()),
                                  gather(objective, dissipation_)};
  problem_.tape.pull_back(by(objective), problem_.slots_end);
  problem_.objectives[objective].weights.push_back(weights_[objective]);
  problem_.objectives[objective].motions.push_back(at_.displacement);
  return history;
}

}  // namespace stickslip
