#include "sensitivity/pull_back_inside.hpp"

#include "core/model/storage.hpp"

namespace stickslip {

namespace {

/// a of the waiting equilibria over all dofs in the axes, zero where motion is prescribed.
Matrix<double> weights_inside(AdjointProblem& problem, const std::vector<InteriorShare>& waiting) {
  const Model& model = problem.model;
  const auto count = static_cast<Eigen::Index>(waiting.size());
  const auto join = [&](Matrix<double> InteriorShare::*part) {
    Matrix<double> all((waiting[0].*part).rows(), count);
    for (Eigen::Index n = 0; n < count; ++n) all.col(n) = waiting[n].*part;
    return all;
  };
  Matrix<double> all = problem.engine.expand(join(&InteriorShare::u), -join(&InteriorShare::others));
  for (Eigen::Index n = 0; n < count; ++n) {
    Vector<double> a = into_frames(model, problem.slots.frames, NodalLayout::all, Vector<double>(all.col(n)));
    for (Eigen::Index dof = 0; dof < a.size(); ++dof)
      if (model.free_index[dof] < 0) a[dof] = 0;
    all.col(n) = out_of_frames(model, problem.slots.frames, NodalLayout::all, std::move(a));
  }
  return all;
}

/// Weights of the rows that are solved inside the bodies, in the frames of the nodes: zero where motion is prescribed,
/// and at the contact, whose rows have been moved already.
Vector<double> inside_alone(const Model& model, Vector<double> weights) {
  const int D = model.dimension;
  for (int node : model.contact_nodes) weights.segment(node * D, D).setZero();
  for (Eigen::Index dof = 0; dof < weights.size(); ++dof)
    if (model.free_index[dof] < 0) weights[dof] = 0;
  return weights;
}

/// Moves weights of the rows less the loads, in the axes, to the forces of the loads and their factors.
void pull_back_dead_forces(const Model& model, const Slots<Reverse>& slots, double time, const Vector<double>& weights,
                           std::vector<double>& by, Tape& tape) {
  for (std::size_t l = 0; l < slots.loads.size(); ++l) {
    const auto& history = model.scene.loads[l].history;
    const Reverse factor = history ? evaluate(*history, time, slots.numbers) : Reverse(1);
    const auto& load = slots.loads[l];
    double work = 0;
    for (std::size_t k = 0; k < load.dofs.size(); ++k) {
      const double weight = weights[load.dofs[k]];
      work += load.forces[k].v * weight;
      if (load.forces[k].entry >= 0) by[load.forces[k].entry] -= factor.v * weight;
    }
    by.resize(tape.size(), 0);
    if (factor.entry >= 0) by[factor.entry] -= work;
  }
}

/// Whether the motion that supports prescribe is on the tape.
bool moves_on_tape(const Model& model, const Slots<Reverse>& slots, double time) {
  return !model.framed.empty() ||
         std::any_of(model.constraints.begin(), model.constraints.end(), [&](const Constraint& constraint) {
           const auto place = slots.points.col(constraint.dof / model.dimension);
           return prescribed_value<Reverse>(model.scene, constraint, place, time, slots.numbers).entry >= 0;
         });
}

/// Moves weights `a` (all dofs, in the axes) inside the bodies to loads, frames and prescribed motion. What no
/// parameter touches is not put in reverse scalars: of a vector over all dofs these alone would cost as much as the
/// elements.
void pull_back_loads(AdjointProblem& problem, const InteriorShare& of, const Vector<double>& a,
                     std::vector<double>& by) {
  const Model& model = problem.model;
  const auto& slots = problem.recorded;
  const auto& frames = problem.slots.frames;
  Tape& tape = problem.tape;
  tape.rewind(problem.slots_end);
  by.resize(problem.slots_end);
  const auto constant = [](double x) { return Reverse(x); };
  const auto seed = [&](const Vector<Reverse>& rows, const Vector<double>& weights) {
    by.resize(tape.size(), 0);
    for (Eigen::Index i = 0; i < rows.size(); ++i)
      if (rows[i].entry >= 0) by[rows[i].entry] += weights[i];
  };
  const Vector<double> in_frames = inside_alone(model, into_frames(model, frames, NodalLayout::all, a));
  const Vector<double> weights = out_of_frames(model, frames, NodalLayout::all, Vector<double>(in_frames));
  pull_back_dead_forces(model, slots, of.time, weights, by, tape);
  if (!model.followers.empty()) {
    const Vector<Reverse> still = of.motion.unaryExpr(constant);
    seed(-follower_forces(model, slots, of.time, still), weights);
  }
  if (!model.framed.empty()) {
    const Vector<double> forces = of.forces - external_forces(model, problem.slots, of.time, of.motion);
    seed(into_frames(model, slots.frames, NodalLayout::all, Vector<Reverse>(forces.unaryExpr(constant))), in_frames);
  }
  if (moves_on_tape(model, slots, of.time)) {
    Vector<Reverse> prescribed = of.motion.unaryExpr(constant);
    prescribe(model, slots, of.time, prescribed);
    Vector<double> held =
        into_frames(model, frames, NodalLayout::all,
                    tangent_times(model, problem.slots, {of.motion, of.last_memory, of.time, &of.flow}, a,
                                  Taken::transposed, &problem.at_supports));
    for (int dof : model.free_dofs) held[dof] = 0;
    seed(prescribed, out_of_frames(model, frames, NodalLayout::all, std::move(held)));
  }
  by.resize(tape.size(), 0);
  tape.pull_back(by, problem.slots_end);
}

}  // namespace

void pull_back_inside(AdjointProblem& problem) {
  long waiting = 0;
  for (const auto& objective : problem.objectives)
    for (const auto& of : objective.waiting)
      waiting +=
          bytes_of(of.motion) + bytes_of(of.forces) + bytes_of(of.weights) + bytes_of(of.u) + bytes_of(of.others);
  problem.waiting_bytes = std::max(problem.waiting_bytes, waiting);
  for (auto& objective : problem.objectives) {
    auto& waiting = objective.waiting;
    if (waiting.empty()) continue;
    WorkPairs pairs{weights_inside(problem, waiting), {}, {}, {}, {}};
    pairs.motions.resize(pairs.weights.rows(), pairs.weights.cols());
    pairs.last_memory.resize(problem.model.memory_count, pairs.weights.cols());
    for (std::size_t n = 0; n < waiting.size(); ++n) {
      const auto k = static_cast<Eigen::Index>(n);
      pull_back_loads(problem, waiting[n], pairs.weights.col(k), objective.adjoint);
      pairs.weights.col(k) += waiting[n].weights;
      pairs.motions.col(k) = waiting[n].motion;
      pairs.last_memory.col(k) = waiting[n].last_memory;
      pairs.flows.push_back(waiting[n].flow);
    }
    problem.tape.rewind(problem.slots_end);
    objective.adjoint.resize(problem.slots_end);
    const auto left = pull_back_bodies(problem.model, problem.recorded, problem.tape, pairs, objective.adjoint);
    if (left.last_memory.size() > 0) objective.history.local.bodies += left.last_memory.rowwise().sum();
    waiting.clear();
  }
}

}  // namespace stickslip
