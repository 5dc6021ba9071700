#include "sensitivity/adjoint.hpp"

#include "core/model/element_nodes.hpp"
#include "core/model/objective.hpp"
#include "core/model/storage.hpp"
#include "sensitivity/one_sided.hpp"
#include "sensitivity/pull_back_inside.hpp"
#include "sensitivity/recording.hpp"
#include "sensitivity/schemes.hpp"
#include "sensitivity/whole_states.hpp"

namespace stickslip {
namespace {

DerivativeStorage storage_of(Recording& recording, const std::vector<BackwardSweep>& objectives, long waiting) {
  DerivativeStorage storage;
  storage.adjoints = waiting;
  storage.slots = slot_bytes(recording.slots()).all();
  storage.tape = recording.tape().bytes();
  for (const auto& objective : objectives) {
    storage.adjoints += static_cast<long>(objective.adjoint.capacity() * sizeof(double));
  }
  return storage;
}

/// Whether the motion of a node is prescribed along some direction.
bool has_prescribed(const Model& model, int node) {
  const auto first = model.free_index.begin() + static_cast<std::ptrdiff_t>(node) * model.dimension;
  return std::any_of(first, first + model.dimension, [](int index) { return index < 0; });
}

/// Elements with a dof that is prescribed.
ElementLists elements_at_supports(const Model& model) {
  ElementLists lists(model.bodies.size());
  for (std::size_t b = 0; b < lists.size(); ++b)
    for (int e = 0; e < model.bodies[b].mesh.element_count(); ++e) {
      const auto nodes = detail::element_nodes(model.bodies[b], e);
      if (std::any_of(nodes.begin(), nodes.end(), [&](int node) { return has_prescribed(model, node); }))
        lists[b].push_back(e);
    }
  return lists;
}

/// Whether an objective is of an energy.
bool reads_energies(const Scene& scene) {
  return std::any_of(scene.objectives.begin(), scene.objectives.end(), [&](const Objective& objective) {
    return scene.responses[objective.response].kind == Response::Kind::strain_energy;
  });
}

/// Dofs of which the bodies' forces are read. `energies`: by the energy of all.
std::vector<int> dofs_read(const Model& model, bool energies) {
  std::vector<int> dofs;
  for (int node = 0; node < model.node_count; ++node)
    for (int i = 0; (energies || has_prescribed(model, node)) && i < model.dimension; ++i)
      dofs.push_back(node * model.dimension + i);
  return dofs;
}

/// Moves the derivatives by the history that the run began with to the slots that it is a function of.
void pull_back_initial_history(AdjointProblem& problem) {
  if (!problem.model.effects.current_geometry) return;
  problem.tape.rewind(problem.slots_end);
  const auto initial = initial_history<Reverse>(problem.model, problem.recorded);
  for (auto& objective : problem.objectives) {
    objective.adjoint.resize(problem.slots_end);
    objective.adjoint.resize(problem.tape.size(), 0);
    const auto seed = [&](const Vector<Reverse>& part, const Vector<double>& derivative) {
      for (Eigen::Index i = 0; i < part.size(); ++i)
        if (part[i].entry >= 0) objective.adjoint[part[i].entry] += derivative[i];
    };
    for_each_part(seed, initial, objective.history.local);
    problem.tape.pull_back(objective.adjoint, problem.slots_end);
  }
}

/// `taken`: the branches at ties; empty where there are none.
bool run(AdjointProblem& problem, WholeStates& states, const std::vector<TakenBranches>& taken) {
  const Model& model = problem.model;
  for (auto& objective : problem.objectives)
    objective.history = no_derivative(states.before(0).history, model.multiplier_count);
  for (std::size_t n = states.count(); n-- > 0;) {
    const auto& increment = states.increment(n);
    const auto& previous = states.before(n);
    std::optional<Increment<double>> with_branches;
    if (n < taken.size()) taken[n].give(with_branches.emplace(increment));
    if (!pull_back_increment(problem, previous, with_branches ? *with_branches : increment)) return false;
    const std::size_t together = model.effects.plasticity ? 1 : columns_together;  // history needs what is inside
    if (problem.objectives.front().waiting.size() >= together) pull_back_inside(problem);
  }
  pull_back_inside(problem);
  pull_back_initial_history(problem);
  return true;
}

}  // namespace

Vector<double> objective_values(const Model& model, const Slots<double>& slots, const Trajectory<double>& trajectory) {
  Vector<double> values = Vector<double>::Zero(model.scene.objectives.size());
  if (values.size() == 0) return values;
  for (const auto& increment : trajectory.increments)
    if (increment.requested)
      add_contributions(model, slots.numbers, increment.time,
                        evaluate_responses(model, slots, increment.state, increment.time), values);
  return values;
}

Matrix<double> objective_gradients(const Model& model, const Trajectory<double>& trajectory,
                                   const std::vector<Vector<double>>& responses,
                                   const std::vector<Matrix<double>>& of_responses) {
  const auto& objectives = model.scene.objectives;
  const int parameters = static_cast<int>(model.scene.parameters.size());
  if (objectives.empty() || parameters == 0 || of_responses.size() < trajectory.increments.size()) return {};
  Matrix<double> of = Matrix<double>::Zero(objectives.size(), parameters);
  for (int first = 0; first < parameters; first += directions) {
    std::vector<int> block;
    for (int j = first; j < std::min(parameters, first + directions); ++j) block.push_back(j);
    const auto numbers = seeded(model.scene, block);
    for (std::size_t n = 0; n < trajectory.increments.size(); ++n) {
      const auto& increment = trajectory.increments[n];
      if (!increment.requested) continue;
      for (std::size_t i = 0; i < objectives.size(); ++i) {
        const auto& objective = objectives[i];
        if (!contributes(objective, increment.time, model.times.back())) continue;
        Direction response(responses[n][objective.response]);
        for (std::size_t d = 0; d < block.size(); ++d) response.d[d] = of_responses[n](objective.response, block[d]);
        const Direction share = contribution(objective, response, increment.time, numbers);
        for (std::size_t d = 0; d < block.size(); ++d) of(i, block[d]) += share.d[d];
      }
    }
  }
  return of;
}

Matrix<double> objective_gradients(const Model& model, const Slots<double>& slots, const Trajectory<double>& trajectory,
                                   const std::vector<Matrix<double>>& of_responses) {
  if (model.scene.objectives.empty()) return {};
  std::vector<Vector<double>> responses;
  for (const auto& increment : trajectory.increments)
    responses.push_back(increment.requested ? evaluate_responses(model, slots, increment.state, increment.time)
                                            : Vector<double>());
  return objective_gradients(model, trajectory, responses, of_responses);
}

Gradients adjoint(const Model& model, const Slots<double>& slots, const Method& method,
                  const Trajectory<double>& trajectory, Workspace<double>& workspace) {
  Gradients gradients;
  const auto& scene = model.scene;
  if (scene.objectives.empty() || scene.parameters.empty()) return gradients;
  WholeStates states(model, slots, method, trajectory, workspace);
  if (states.count() < trajectory.increments.size()) return gradients;
  const Stopwatch time(gradients.seconds);
  std::vector<TakenBranches> taken;
  {
    const Stopwatch searching(gradients.search_seconds);
    taken = consistent_at_ties(model, slots, method, trajectory, states, workspace, gradients.search);
  }
  gradients.counters += gradients.search;
  const bool with_rho = scheme_of(method).reads_regularisation;
  Recording recording(model, slots, with_rho);
  Tape& tape = recording.tape();
  std::vector<BackwardSweep> objectives(scene.objectives.size());
  const bool energies = reads_energies(scene);
  for (auto& objective : objectives) objective.adjoint.resize(tape.size(), 0);
  AdjointProblem problem{method, model, slots, *workspace.engine, tape, recording.slots(), tape.size(), objectives};
  problem.at_supports = elements_at_supports(model);
  problem.energies = energies;
  problem.read_forces = dofs_read(model, energies);
  const bool done = run(problem, states, taken);
  tape.rewind(problem.slots_end);
  gradients.counters += problem.counters;
  gradients.message = problem.message;
  if (!done) gradients.status = problem.status;
  gradients.counters += states.take_counters();
  gradients.repeated = states.repeated();
  if (!done) return gradients;
  for (auto& objective : objectives) objective.adjoint.resize(tape.size());
  gradients.storage = storage_of(recording, objectives, problem.waiting_bytes);
  gradients.storage.states = states.bytes();
  if (workspace.checkpoints) gradients.storage.adjoints += workspace.checkpoints->bytes();
  gradients.of_objectives = Matrix<double>::Zero(objectives.size(), scene.parameters.size());
  for (std::size_t i = 0; i < objectives.size(); ++i) {
    const Vector<double> by = recording.by_numbers(objectives[i].adjoint);
    for (std::size_t j = 0; j < scene.parameters.size(); ++j)
      for (const auto& [slot, weight] : scene.parameters[j].slots) gradients.of_objectives(i, j) += weight * by[slot];
  }
  return gradients;
}

}  // namespace stickslip
