/// The adjoint of one equilibrium, what all schemes share.
///
/// The residual, the contact and the responses of an increment are recorded once, in reverse scalars, at its converged
/// state; the bodies' forces enter the record as variables. For an objective with derivatives c_u, c_l by displacement
/// and multiplier (from its own share and from what later increments make of this one's history),
///
///   K^T a = -c,      DJ += a . dR/dslots      history <- a . dR/dhistory
///
/// where a is the force's weight along free dofs, and -dJ/d(reaction) along prescribed ones, so that these need no case
/// of their own. An increment solves for a at the contact, in the engine's unknowns. a inside the bodies, and what it
/// weighs there, is found for many increments together (pull_back_bodies.hpp). The schemes differ in what becomes of
/// the derivative by lambda.
/// Path-dependent adjoint: [MTV94]
#pragma once

#include <utility>

#include "core/algebra/reverse.hpp"
#include "core/model/objective.hpp"
#include "methods/method.hpp"
#include "sensitivity/tangent.hpp"

namespace stickslip {

/// Derivatives of an objective by what the next increment reads of a state.
struct HistoryDerivative {
  History<double> local;
  Vector<double> traction;
};
inline HistoryDerivative no_derivative(const History<double>& like, Eigen::Index traction) {
  HistoryDerivative none{like, Vector<double>::Zero(traction)};
  for_each_part([](Vector<double>& part) { part.setZero(); }, none.local);
  return none;
}

/// Weights a and motions u of an objective, a column an increment, all dofs in the axes.
struct WorkPairs {
  Matrix<double> weights, motions;  ///< weights empty: of the memory alone
  Matrix<double> last_memory;       ///< what bodies remember of the last increment
  Matrix<double> memory;            ///< weights of what bodies remember of this increment; empty: none
  std::vector<FlowBranches> flows;  ///< per column
};

/// Derivatives by motion (no rows where no body remembers), and by what bodies remember of the last increment.
struct WorkDerivative {
  Matrix<double> motion, last_memory;
};

/// Adds the share of the pairs to `by`, the derivatives by the entries of the tape. An element of a continuum is
/// differentiated by its own inputs, which are few (core/solids/element_work.hpp); the chain goes on from there. An
/// element of two nodes is recorded at the end of the tape, which is then rewound.
WorkDerivative pull_back_bodies(const Model& model, const Slots<Reverse>& slots, Tape& tape, const WorkPairs& pairs,
                                std::vector<double>& by);

/// The share of an equilibrium inside the bodies, which waits for other increments.
struct InteriorShare {
  Vector<double> motion;               ///< u, all dofs in the axes
  Vector<double> last_memory;          ///< what bodies remember of the last increment
  Vector<double> by_last_memory = {};  ///< derivative by `last_memory`, through what bodies remember of this increment
  double time = 0;
  Vector<double> forces;     ///< of bodies and contact, all dofs; empty where no node has a frame of its own
  Vector<double> weights;    ///< weights of the bodies' forces in what the objective reads, all dofs in the axes
  Matrix<double> u, others;  ///< solution for -c, engine dofs; what reduce() kept of c for expand()
  FlowBranches flow;
};

/// One objective on its way back.
struct BackwardSweep {
  std::vector<double> adjoint;  ///< derivative by each entry of the tape
  HistoryDerivative history;
  std::vector<InteriorShare> waiting;  ///< of the increments that wait
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
  std::vector<BackwardSweep>& objectives;
  ElementLists at_supports;      ///< elements with a dof that is prescribed: reactions are forces of these
  bool energies = false;         ///< an objective reads the bodies' forces everywhere
  std::vector<int> read_forces;  ///< dofs of which the bodies' forces are read: of nodes at supports, or all
  long waiting_bytes = 0;        ///< largest, of what waited inside the bodies
  bool follows = false;          ///< the engine has the factor of the increment that came last
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
  /// Largest derivative by a nodal force so far.
  double force_weight(int objective) const {
    const auto largest = [](const auto& m) { return m.size() ? m.cwiseAbs().maxCoeff() : 0.0; };
    return std::max(largest(interior_[objective].weights), largest(interior_[objective].u));
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
  void pull_back_memory(int objective);
  void clear_free(int objective);
  void seed_contact(int objective, const BlockVector<double>& solution);
  void clear_held(Matrix<double>& rows);
  std::vector<double>& adjoint(int objective) { return problem_.objectives[objective].adjoint; }
  Vector<double> gather(int objective, const Vector<Reverse>& leaves);
  static void seed(std::vector<double>& by, const Vector<Reverse>& at, const Vector<double>& derivative) {
    for (Eigen::Index i = 0; i < at.size(); ++i)
      if (at[i].entry >= 0) by[at[i].entry] += derivative[i];
  }

  AdjointProblem<E>& problem_;
  const State<double>& at_;
  Vector<double> scale_;  ///< rho of each multiplier component
  bool unknown_, valid_ = false, redundant_ = false;
  int outcome_start_ = 0;  ///< place on the tape; behind it: functions of the variables below
  Vector<Reverse> prescribed_, displacement_, multiplier_;
  int first_read_ = 0;        ///< entry of the first of AdjointProblem::read_forces
  Vector<double> forces_;     ///< of the bodies, where they are read
  Vector<Reverse> memory_;    ///< what bodies remember of the increment
  History<Reverse> history_;  ///< that the increment starts from
  State<Reverse> state_;
  Vector<Reverse> rows_, multiplier_rows_;  ///< residual, in the frames of the nodes
  std::vector<Reverse> shares_;             ///< of this increment in each objective
  std::vector<InteriorShare> interior_;     ///< per objective
};

template <class E>
struct RecordedEquilibrium<E>::Gathered {
  std::vector<double> adjoint;
  InteriorShare interior;
};

template <class E>
RecordedEquilibrium<E>::RecordedEquilibrium(AdjointProblem<E>& problem, const State<double>& previous,
                                            const State<double>& at, const RegularisationField<Reverse>& rho,
                                            ConeRadius cone, double time, bool unknown, bool objectives)
    : problem_(problem), at_(at), scale_(problem.model.multiplier_count), unknown_(unknown) {
  const Model& model = problem.model;
  RegularisationField<double> plain;
  for (const auto& r : rho) plain.push_back({r.normal.v, r.tangential.v});
  for (std::size_t p = 0; p < model.points.size(); ++p)
    for (int c = 0; c < model.points[p].components(); ++c)
      scale_[model.points[p].multiplier + c] = c == 0 ? plain[p].normal : plain[p].tangential;
  const ContactInput<double> input{model, problem.slots, plain, previous.history, cone, time, &at.contact.facing};
  valid_ = (problem.follows && reuse_factor(problem, input, at, unknown)) ||
           factorise_converged(problem, input, at, unknown, redundant_);
  problem.follows = valid_ && !redundant_;
  if (!valid_) return;
  record(previous, rho, cone, time, objectives);
  Vector<double> forces;
  if (!model.framed.empty()) {
    forces = forces_;
    add_compact(model, values(contact_forces(model, problem.recorded, state_.contact)), forces);
  }
  for (auto& objective : problem.objectives) {
    objective.adjoint.resize(problem.slots_end);
    objective.adjoint.resize(problem.tape.size(), 0);
    interior_.push_back({at.displacement,
                         previous.history.bodies,
                         Vector<double>::Zero(model.memory_count),
                         time,
                         forces,
                         Vector<double>::Zero(model.dof_count()),
                         {},
                         {},
                         at.flow});
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
  const Vector<double> memory = bulk_flow(model, problem_.slots, at_.displacement, previous.history.bodies, at_.flow);
  // (more than the derivative of forces is read at supports alone, but for energies)
  forces_ =
      bulk_forces(model, problem_.slots, at_.displacement, memory, problem_.energies ? nullptr : &problem_.at_supports);
  Vector<Reverse> internal = forces_.unaryExpr([](double x) { return Reverse(x); });
  first_read_ = tape.size();
  for (int dof : problem_.read_forces) internal[dof] = Reverse::leaf(forces_[dof], tape);
  memory_ = leaves(memory, tape);
  multiplier_ = leaves(at_.multiplier, tape);
  for_each_part([&](const Vector<double>& values, Vector<Reverse>& part) { part = leaves(values, tape); },
                previous.history, history_);
  history_.patch = previous.history.patch;
  history_.faces = previous.history.faces;
  const ContactInput<Reverse> input{model, slots, rho, history_, cone, time, &at_.contact.facing};
  state_.displacement = displacement_;
  state_.multiplier = multiplier_;
  state_.contact = evaluate_contact<Reverse>(input, to_compact(model, displacement_), multiplier_, &at_.contact.state);
  problem_.counters.contact_evaluations += static_cast<long>(model.points.size());
  take_rays(input, multiplier_, at_.contact.ray, state_.contact);
  state_.history = next_history(input, state_.contact, multiplier_);
  state_.history.bodies = memory_;
  const Vector<Reverse> balance = nodal_balance(model, slots, state_, internal, time);
  // (the engine has the tangent of pressures that follow the bodies; rows_ has their other derivatives)
  rows_ = balance;
  if (!model.followers.empty()) {
    const Vector<Reverse> still = at_.displacement.unaryExpr([](double x) { return Reverse(x); });
    rows_ = internal - external_forces(model, slots, time, still);
    add_compact(model, contact_forces(model, slots, state_.contact), rows_);
  }
  rows_ = into_frames(model, slots.frames, Layout::all, std::move(rows_));
  if (unknown_) multiplier_rows_ = multiplier_residual(model, slots, state_.contact.traction, multiplier_);
  if (!objectives) return;
  const NodalForces<Reverse> forces{internal, support_forces(model, slots, balance)};
  for (const auto& objective : model.scene.objectives)
    shares_.push_back(contributes(objective, time, model.times.back())
                          ? contribution(objective, evaluate_response(model, slots, objective.response, state_, forces),
                                         time, slots.numbers)
                          : Reverse());
}

/// Derivatives by variables that stand one behind the other on the tape.
template <class E>
Vector<double> RecordedEquilibrium<E>::gather(int objective, const Vector<Reverse>& leaves) {
  if (leaves.size() == 0) return {};
  return Eigen::Map<const Vector<double>>(adjoint(objective).data() + leaves[0].entry, leaves.size());
}

template <class E>
void RecordedEquilibrium<E>::seed_outcome(int objective) {
  if (!shares_.empty() && shares_[objective].entry >= 0) adjoint(objective)[shares_[objective].entry] += 1;
  const auto& history = problem_.objectives[objective].history;
  seed(adjoint(objective), state_.contact.traction, history.traction);
  for_each_part([&](const Vector<Reverse>& part,
                    const Vector<double>& derivative) { seed(adjoint(objective), part, derivative); },
                state_.history, history.local);
}

template <class E>
void RecordedEquilibrium<E>::seed_traction(int objective, const Vector<double>& derivative) {
  seed(adjoint(objective), state_.contact.traction, derivative);
}

/// Moves what is seeded to the variables of the increment. Takes out, and returns, the weights of the bodies' forces.
template <class E>
Vector<double> RecordedEquilibrium<E>::pull_back(int objective) {
  problem_.tape.pull_back(adjoint(objective), outcome_start_);
  Vector<double> weight = Vector<double>::Zero(problem_.model.dof_count());
  int entry = first_read_;
  for (int dof : problem_.read_forces) weight[dof] = std::exchange(adjoint(objective)[entry++], 0);
  return weight;
}

/// Moves the derivative by what bodies remember of the increment to its displacement, to the slots, and to what they
/// remembered before.
template <class E>
void RecordedEquilibrium<E>::pull_back_memory(int objective) {
  auto& inside = interior_[objective];
  const Vector<double> weight = gather(objective, memory_);
  if (weight.size() == 0 || weight.cwiseAbs().maxCoeff() == 0) return;
  for (const auto& x : memory_) adjoint(objective)[x.entry] = 0;
  const auto left = pull_back_bodies(problem_.model, problem_.recorded, problem_.tape,
                                     {{}, inside.motion, inside.last_memory, weight, {at_.flow}}, adjoint(objective));
  seed(adjoint(objective), displacement_, left.motion);
  inside.by_last_memory += left.last_memory;
}

/// Clears the derivative by the free displacements: a solve has taken it up.
template <class E>
void RecordedEquilibrium<E>::clear_free(int objective) {
  const auto& frames = problem_.slots.frames;
  Vector<double> left = into_frames(problem_.model, frames, Layout::all, gather(objective, displacement_));
  for (int dof : problem_.model.free_dofs) left[dof] = 0;
  left = out_of_frames(problem_.model, frames, Layout::all, std::move(left));
  for (Eigen::Index i = 0; i < left.size(); ++i) adjoint(objective)[displacement_[i].entry] = left[i];
}

template <class E>
void RecordedEquilibrium<E>::clear_held(Matrix<double>& rows) {
  for (Eigen::Index i = 0; i < rows.rows(); ++i)
    if (!problem_.engine.is_free(i)) rows.row(i).setZero();
}

/// Moves the weights that a solution gives the rows of the contact. The bodies' share in these rows waits.
template <class E>
void RecordedEquilibrium<E>::seed_contact(int objective, const BlockVector<double>& solution) {
  const Model& model = problem_.model;
  const int D = model.dimension;
  const Vector<double> compact = into_frames(model, problem_.slots.frames, Layout::compact,
                                             problem_.engine.compact(Vector<double>(solution.u.col(0))));
  for (std::size_t n = 0; n < model.contact_nodes.size(); ++n)
    for (int i = 0; i < D; ++i)
      if (const int dof = model.contact_nodes[n] * D + i; model.free_index[dof] >= 0 && rows_[dof].entry >= 0)
        adjoint(objective)[rows_[dof].entry] += compact[n * D + i];
  if (unknown_) seed(adjoint(objective), multiplier_rows_, solution.l.col(0));
  pull_back(objective);
}

template <class E>
void RecordedEquilibrium<E>::balance(int objective) {
  const Model& model = problem_.model;
  auto& inside = interior_[objective];
  const Vector<double> weight = pull_back(objective);
  pull_back_memory(objective);
  if (weight.size() > 0 && weight.cwiseAbs().maxCoeff() > 0) {  // (the bodies' tangent is symmetric)
    inside.weights += weight;
    seed(adjoint(objective), displacement_,
         bulk_tangent_times(model, problem_.slots, {at_.displacement, inside.last_memory, 0, &at_.flow}, weight));
  }
  const auto in_frames = [&] {
    return Matrix<double>(into_frames(model, problem_.slots.frames, Layout::all, gather(objective, displacement_)));
  };
  const auto of_multiplier = [&]() -> Matrix<double> {
    if (!unknown_) return Matrix<double>::Zero(model.multiplier_count, 1);
    return gather(objective, multiplier_).cwiseProduct(scale_);
  };
  const auto largest = [](const Matrix<double>& m) { return m.size() ? m.cwiseAbs().maxCoeff() : 0.0; };
  const Reduction<double> load = problem_.engine.reduce(in_frames());
  const Matrix<double>& reduced = load.kept;
  clear_free(objective);
  Matrix<double> rows = reduced, rows_l = of_multiplier(), u = Matrix<double>::Zero(reduced.rows(), 1);
  clear_held(rows);
  const double first = std::max(largest(rows), largest(rows_l));
  for (int pass = 0; pass <= refinements && first > 0; ++pass) {
    if (pass > 0 && !redundant_ && std::max(largest(rows), largest(rows_l)) <= 1e-13 * first) break;
    const auto a = problem_.engine.solve({-rows, -rows_l}, Solving::transposed);
    problem_.counters.sensitivity_backsolves += problem_.engine.solves();
    u += a.u;
    seed_contact(objective, a);
    if (!unknown_) break;
    rows = reduced + problem_.engine.apply_stiffness(u, true) +
           problem_.engine.scatter(to_compact<double>(model, in_frames().col(0)));
    clear_held(rows);
    rows_l = of_multiplier();
  }
  clear_free(objective);
  const auto add = [](Matrix<double>& sum, const Matrix<double>& x) { sum = sum.size() ? Matrix<double>(sum + x) : x; };
  add(inside.u, u);
  add(inside.others, load.others);
}

template <class E>
Vector<double> RecordedEquilibrium<E>::take_multiplier(int objective) {
  const Vector<double> derivative = gather(objective, multiplier_);
  for (const auto& x : multiplier_) adjoint(objective)[x.entry] = 0;
  return derivative;
}

template <class E>
typename RecordedEquilibrium<E>::Gathered RecordedEquilibrium<E>::gathered(int objective) const {
  return {problem_.objectives[objective].adjoint, interior_[objective]};
}

template <class E>
void RecordedEquilibrium<E>::restore(int objective, const Gathered& gathered) {
  adjoint(objective) = gathered.adjoint;
  interior_[objective] = gathered.interior;
}

template <class E>
HistoryDerivative RecordedEquilibrium<E>::finish(int objective) {
  seed(adjoint(objective), prescribed_, gather(objective, displacement_));
  HistoryDerivative history{{}, Vector<double>::Zero(scale_.size())};
  for_each_part([&](Vector<double>& part, const Vector<Reverse>& of) { part = gather(objective, of); }, history.local,
                history_);
  if (interior_[objective].by_last_memory.size() > 0) history.local.bodies += interior_[objective].by_last_memory;
  problem_.tape.pull_back(adjoint(objective), problem_.slots_end);
  problem_.objectives[objective].waiting.push_back(std::move(interior_[objective]));
  return history;
}

}  // namespace stickslip
