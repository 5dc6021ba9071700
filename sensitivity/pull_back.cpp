#include "sensitivity/pull_back.hpp"

namespace stickslip {

HistoryDerivative no_derivative(const History<double>& like, Eigen::Index traction) {
  HistoryDerivative none{like, Vector<double>::Zero(traction)};
  for_each_part([](Vector<double>& part) { part.setZero(); }, none.local);
  return none;
}

RecordedEquilibrium::RecordedEquilibrium(AdjointProblem& problem, const State<double>& previous,
                                         const State<double>& at, const RegularisationField<Reverse>& rho,
                                         ConeRadius cone, double time, Multipliers multipliers, bool objectives)
    : problem_(problem), at_(at), scale_(problem.model.multiplier_count), multipliers_(multipliers) {
  const Model& model = problem.model;
  RegularisationField<double> plain;
  for (const auto& r : rho) plain.push_back({r.normal.v, r.tangential.v});
  for (std::size_t p = 0; p < model.points.size(); ++p)
    for (int c = 0; c < model.points[p].components(); ++c)
      scale_[model.points[p].multiplier + c] = c == 0 ? plain[p].normal : plain[p].tangential;
  const ContactInput<double> input{model, problem.slots, plain, previous.history, cone, time, &at.contact.facing};
  valid_ = (problem.follows && reuse_factor(problem, input, at, multipliers)) ||
           factorise_converged(problem, input, at, multipliers, redundant_);
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

void RecordedEquilibrium::record(const State<double>& previous, const RegularisationField<Reverse>& rho,
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
  history_.faced = previous.history.faced;
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
  rows_ = into_frames(model, slots.frames, NodalLayout::all, std::move(rows_));
  if (solves_for_multipliers())
    multiplier_rows_ = multiplier_residual(model, slots, state_.contact.traction, multiplier_);
  if (!objectives) return;
  const NodalForces<Reverse> forces{internal, support_forces(model, slots, balance)};
  for (const auto& objective : model.scene.objectives)
    shares_.push_back(contributes(objective, time, model.times.back())
                          ? contribution(objective, evaluate_response(model, slots, objective.response, state_, forces),
                                         time, slots.numbers)
                          : Reverse());
}

/// Derivatives by variables that stand one behind the other on the tape.
Vector<double> RecordedEquilibrium::gather(int objective, const Vector<Reverse>& leaves) {
  if (leaves.size() == 0) return {};
  return Eigen::Map<const Vector<double>>(adjoint(objective).data() + leaves[0].entry, leaves.size());
}

void RecordedEquilibrium::seed_outcome(int objective) {
  if (!shares_.empty() && shares_[objective].entry >= 0) adjoint(objective)[shares_[objective].entry] += 1;
  const auto& history = problem_.objectives[objective].history;
  seed(adjoint(objective), state_.contact.traction, history.traction);
  for_each_part([&](const Vector<Reverse>& part,
                    const Vector<double>& derivative) { seed(adjoint(objective), part, derivative); },
                state_.history, history.local);
}

void RecordedEquilibrium::seed_traction(int objective, const Vector<double>& derivative) {
  seed(adjoint(objective), state_.contact.traction, derivative);
}

/// Moves what is seeded to the variables of the increment. Takes out, and returns, the weights of the bodies' forces.
Vector<double> RecordedEquilibrium::pull_back(int objective) {
  problem_.tape.pull_back(adjoint(objective), outcome_start_);
  Vector<double> weight = Vector<double>::Zero(problem_.model.dof_count());
  int entry = first_read_;
  for (int dof : problem_.read_forces) weight[dof] = std::exchange(adjoint(objective)[entry++], 0);
  return weight;
}

/// Moves the derivative by what bodies remember of the increment to its displacement, to the slots, and to what they
/// remembered before.
void RecordedEquilibrium::pull_back_memory(int objective) {
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
void RecordedEquilibrium::clear_free(int objective) {
  const auto& frames = problem_.slots.frames;
  Vector<double> left = into_frames(problem_.model, frames, NodalLayout::all, gather(objective, displacement_));
  for (int dof : problem_.model.free_dofs) left[dof] = 0;
  left = out_of_frames(problem_.model, frames, NodalLayout::all, std::move(left));
  for (Eigen::Index i = 0; i < left.size(); ++i) adjoint(objective)[displacement_[i].entry] = left[i];
}

void RecordedEquilibrium::clear_held(Matrix<double>& rows) {
  for (Eigen::Index i = 0; i < rows.rows(); ++i)
    if (!problem_.engine.is_free(i)) rows.row(i).setZero();
}

/// Moves the weights that a solution gives the rows of the contact. The bodies' share in these rows waits.
void RecordedEquilibrium::seed_contact(int objective, const BlockVector<double>& solution) {
  const Model& model = problem_.model;
  const int D = model.dimension;
  const Vector<double> compact = into_frames(model, problem_.slots.frames, NodalLayout::compact,
                                             problem_.engine.compact(Vector<double>(solution.u.col(0))));
  for (std::size_t n = 0; n < model.contact_nodes.size(); ++n)
    for (int i = 0; i < D; ++i)
      if (const int dof = model.contact_nodes[n] * D + i; model.free_index[dof] >= 0 && rows_[dof].entry >= 0)
        adjoint(objective)[rows_[dof].entry] += compact[n * D + i];
  if (solves_for_multipliers()) seed(adjoint(objective), multiplier_rows_, solution.l.col(0));
  pull_back(objective);
}

void RecordedEquilibrium::balance(int objective) {
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
    return Matrix<double>(
        into_frames(model, problem_.slots.frames, NodalLayout::all, gather(objective, displacement_)));
  };
  const auto of_multiplier = [&]() -> Matrix<double> {
    if (!solves_for_multipliers()) return Matrix<double>::Zero(model.multiplier_count, 1);
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
    if (!solves_for_multipliers()) break;
    rows = reduced + problem_.engine.apply_stiffness(u, Taken::transposed) +
           problem_.engine.scatter(to_compact<double>(model, in_frames().col(0)));
    clear_held(rows);
    rows_l = of_multiplier();
  }
  clear_free(objective);
  const auto add = [](Matrix<double>& sum, const Matrix<double>& x) { sum = sum.size() ? Matrix<double>(sum + x) : x; };
  add(inside.u, u);
  add(inside.others, load.others);
}

Vector<double> RecordedEquilibrium::take_multiplier(int objective) {
  const Vector<double> derivative = gather(objective, multiplier_);
  for (const auto& x : multiplier_) adjoint(objective)[x.entry] = 0;
  return derivative;
}

RecordedEquilibrium::Gathered RecordedEquilibrium::gathered(int objective) const {
  return {problem_.objectives[objective].adjoint, interior_[objective]};
}

void RecordedEquilibrium::restore(int objective, const Gathered& gathered) {
  adjoint(objective) = gathered.adjoint;
  interior_[objective] = gathered.interior;
}

HistoryDerivative RecordedEquilibrium::finish(int objective) {
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
