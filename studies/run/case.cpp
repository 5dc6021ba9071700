#include "studies/run/case.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "core/model/objective.hpp"
#include "core/model/pairing.hpp"
#include "methods/stepping/engine_choice.hpp"
#include "sensitivity/vertex_margin.hpp"
#include "studies/io/json_document.hpp"
#include "studies/run/failed_contact.hpp"
#include "studies/run/solution_warnings.hpp"
#include "studies/run/step_reader.hpp"
#include "studies/run/warnings.hpp"

namespace stickslip {
namespace {

/// Fills in the one-sided derivatives of increment n, and whether they are one. `at_master_kink`: of its StepReading.
void take_sides(const CaseResult& result, std::size_t n, bool at_master_kink, StepResult& step) {
  const auto& scene = result.problem->model.scene;
  const auto take = [&](const auto& backward, const auto& forward) {
    if (n >= backward.size()) return;
    step.backward = backward[n];
    step.forward = forward[n];
  };
  if (result.one_sided)
    take(result.one_sided->backward, result.one_sided->forward);
  else
    take(result.gradients.from_below, result.gradients.from_above);
  if (result.one_sided && result.one_sided->backward.empty())  // (too many parameters for their sides)
    step.differentiable = n < result.one_sided->first;
  if (at_master_kink) {
    step.differentiable = false;  // and neither side is known
    step.backward = step.forward = Matrix<double>::Constant(static_cast<Eigen::Index>(scene.responses.size()),
                                                            static_cast<Eigen::Index>(scene.parameters.size()),
                                                            std::numeric_limits<double>::quiet_NaN());
  }
  if (step.backward.size() == 0) return;
  for (std::size_t i = 0; i < scene.responses.size(); ++i)
    for (std::size_t j = 0; j < scene.parameters.size(); ++j)
      if (step.has_kink(scene, result.method, i, j)) step.differentiable = false;
}

/// Takes the derivatives away of responses that are not determined.
void refuse_open_responses(StepResult& step) {
  constexpr double none = std::numeric_limits<double>::quiet_NaN();
  for (std::size_t i = 0; i < step.open_responses.size(); ++i)
    for (auto* of : {&step.sensitivities, &step.backward, &step.forward})
      if (step.open_responses[i] && of->size() > 0) of->row(static_cast<Eigen::Index>(i)).setConstant(none);
}

/// And of objectives of such responses.
void refuse_open_objectives(CaseResult& result) {
  const Model& model = result.problem->model;
  if (result.gradients.of_objectives.size() == 0) return;
  std::vector<std::pair<double, std::vector<char>>> steps;
  for (const auto& step : result.steps) steps.emplace_back(step.increment->time, step.open_responses);
  const auto open = open_objectives(model, result.problem->slots, steps);
  for (std::size_t j = 0; j < open.size(); ++j)
    if (open[j])
      result.gradients.of_objectives.row(static_cast<Eigen::Index>(j))
          .setConstant(std::numeric_limits<double>::quiet_NaN());
}

/// The least of the distances of increments.
void take_nearest_change(const CaseResult& result, std::size_t n, StepResult& step) {
  if (n >= result.gradients.nearest_change.size()) return;
  const auto& of = result.gradients.nearest_change[n];
  step.nearest_change = step.nearest_change.size() == 0 ? of : Matrix<double>(step.nearest_change.cwiseMin(of));
}

std::vector<StepResult> gather_steps(const CaseResult& result, const StepReader& reader) {
  std::vector<StepResult> steps;
  StepResult step;
  for (std::size_t n = 0; n < result.trajectory.increments.size(); ++n) {
    const auto& increment = result.trajectory.increments[n];
    take_nearest_change(result, n, step);
    step.newton += increment.newton;
    step.augmentations += increment.augmentations;
    step.history.insert(step.history.end(), increment.history.begin(), increment.history.end());
    if (!increment.requested) continue;
    step.increment = &increment;
    step.kkt = reader.accuracy().errors[n];
    const auto& read = *reader.steps()[n];
    step.margins = read.margins;
    step.responses = read.responses;
    step.bodies = read.bodies;
    step.undetermined = read.open.contacts;
    step.open_responses = read.open.responses;
    step.at_vertex = read.at_vertex;
    step.at_end = read.at_end;
    step.contacts = read.contacts;
    if (n < result.gradients.of_responses.size()) step.sensitivities = result.gradients.of_responses[n];
    if (n < result.gradients.records.size()) step.scheme = result.gradients.records[n];
    take_sides(result, n, read.at_master_kink, step);
    refuse_open_responses(step);
    steps.push_back(std::move(step));
    step = {};
  }
  return steps;
}

Vector<double> objectives_of(const CaseResult& result) {
  const Model& model = result.problem->model;
  Vector<double> values = Vector<double>::Zero(model.scene.objectives.size());
  for (const auto& step : result.steps)
    add_contributions(model, result.problem->slots.numbers, step.increment->time, step.responses, values);
  return values;
}

/// Derivatives of the objectives on one side; of steps that have one derivative it is that of both.
Matrix<double> side_of_objectives(const CaseResult& result, Matrix<double> StepResult::*side) {
  const auto& model = result.problem->model;
  std::vector<Matrix<double>> of_increments(result.trajectory.increments.size());
  std::vector<Vector<double>> responses(of_increments.size());
  std::size_t n = 0;
  for (const auto& step : result.steps) {
    while (!result.trajectory.increments[n].requested) ++n;
    responses[n] = step.responses;
    auto& of = of_increments[n++] = (step.*side).size() > 0 ? step.*side : step.sensitivities;
    if (of.size() == 0)
      of.setConstant(static_cast<Eigen::Index>(model.scene.responses.size()),
                     static_cast<Eigen::Index>(model.scene.parameters.size()),
                     std::numeric_limits<double>::quiet_NaN());
  }
  return objective_gradients(model, result.trajectory, responses, of_increments);
}

/// Says of a run that failed with a loose body why it has no answer.
void name_loose_body(const Model& model, Trajectory<double>& trajectory) {
  const Body* const loose = loose_body(model);
  if (!loose || is_converged(trajectory.status)) return;
  if (trajectory.status == Status::singular) trajectory.status = Status::no_equilibrium;  // nothing balances its load
  trajectory.message =
      loose->name + " is free to move: no support holds it and no contact touches it; add a support or a contact";
}

/// Says of derivatives that a singular tangent does not have whether a body floats there or before, and what to do.
void name_floating_body(CaseResult& result) {
  auto& gradients = result.gradients;
  const auto& increments = result.trajectory.increments;
  if (!is_converged(result.trajectory.status) || gradients.status != Status::singular) return;
  const auto floating = bodies_that_float(result);
  const auto first =
      std::min_element(floating.begin(), floating.end(), [](auto& a, auto& b) { return a.first < b.first; });
  if (first == floating.end()) return;
  const std::size_t known = gradients.of_responses.size();  // increments with derivatives; 0 in adjoint mode
  if (known > 0 && known < increments.size() && first->first > increments[known].time) return;
  result.gradients.message = fmt::format(
      "there are no derivatives: {} floats at the end of the step at t = {:.6g}, where it is free to move {}. "
      "Nothing but damping holds it, so the tangent of the converged state is singular. Hold it by a support, "
      "or leave out the parameters",
      first->name, first->first, first->motion);
}

/// Whether the run ended with a tangent that was factorised.
bool has_tangent(const Trajectory<double>& trajectory) {
  const Status status = trajectory.status;
  return trajectory.counters.newton > 0 && status != Status::singular && status != Status::not_finite &&
         status != Status::no_equilibrium;
}

bool is_adjoint(const Model& model) { return model.scene.sensitivity_mode == SensitivityMode::adjoint; }

/// `derivatives`: what followed the run, unless it is adjoint.
void differentiate_case(Workspace<double>& workspace, Derivatives& derivatives, CaseResult& result) {
  const auto& [model, slots, unused] = *result.problem;
  auto& gradients = result.gradients;
  if (is_adjoint(model)) {
    gradients = adjoint(model, slots, result.method, result.trajectory, workspace);
  } else {
    gradients = derivatives.finish(result.trajectory);
    gradients.of_objectives = objective_gradients(model, slots, result.trajectory, gradients.of_responses);
  }
  {
    const Stopwatch time(result.one_sided_seconds);
    result.one_sided = one_sided_derivatives(model, slots, result.method, result.trajectory, workspace);
  }
  gradients.seconds += result.one_sided_seconds;
  if (!result.one_sided) return;
  gradients.counters += result.one_sided->counters;
  gradients.repeated += result.one_sided->repeated;
}

/// What of a step that converged is not finite, in words; empty where all is.
std::string overflow_of(const CaseResult& result, const StepResult& step) {
  const auto& [model, slots, unused] = *result.problem;
  const State<double>& state = step.increment->state;
  const auto& contact = state.contact;
  if (!state.displacement.allFinite()) return "the displacements are";
  for (const auto* field :
       {&contact.gap, &contact.slip, &contact.traction, &state.history.placement, &state.history.work})
    if (!field->allFinite()) return "gaps, slips or tractions are";
  const auto summaries = summarise(model, slots, state);
  for (std::size_t c = 0; c < summaries.size(); ++c)
    if (!summaries[c].is_finite()) return "the forces of " + model.scene.contacts[c].name + " are";
  for (std::size_t i = 0; i < model.scene.responses.size(); ++i)
    if (!std::isfinite(step.responses[i])) return "the response " + model.scene.responses[i].name + " is";
  return std::isfinite(step.kkt.largest()) ? "" : "the method-blind error is";
}

/// Which derivative is not finite, in words; empty where all are.
std::string overflow_of(const Gradients& gradients, const Scene& scene) {
  for (const auto& of : gradients.of_responses)
    for (Eigen::Index i = 0; i < of.rows(); ++i)
      for (Eigen::Index j = 0; j < of.cols(); ++j)
        if (!std::isfinite(of(i, j)))
          return "the derivative of " + scene.responses[i].name + " by " + scene.parameters[j].name;
  if (!gradients.of_objectives.allFinite()) return "the derivative of an objective";
  return gradients.last_displacement.allFinite() ? "" : "the derivative of the displacements";
}

/// Gives what says it converged, and holds a number that is none, the status not_finite.
void refuse_overflow(CaseResult& result) {
  const auto refuse = [](auto& part, const std::string& words) {
    if (words.empty() || !is_converged(part.status)) return;
    part.status = Status::not_finite;
    part.message = words + " not finite; choose units in which the numbers are of moderate size";
  };
  std::size_t n = 0;
  for (auto& increment : result.trajectory.increments) {
    if (!increment.requested) continue;
    const std::string words = overflow_of(result, result.steps[n++]);
    refuse(increment, words);
    refuse(result.trajectory, words);
  }
  if (!result.objectives.allFinite()) refuse(result.trajectory, "an objective is");
  const std::string words = overflow_of(result.gradients, result.problem->model.scene);
  if (!words.empty()) refuse(result.gradients, words + " is");
}

/// Whether a support, or an anchor, holds one of the nodes.
bool is_held(const Model& model, const std::vector<int>& nodes) {
  return std::any_of(model.constraints.begin(), model.constraints.end(), [&](const Constraint& constraint) {
    return std::find(nodes.begin(), nodes.end(), constraint.dof / model.dimension) != nodes.end();
  });
}

/// Throws ModelError where a response is taken of what is not there: a reaction without a support, a contact at a point
/// that is farther from it than one of its facets is long.
void check_responses(const Model& model, const Slots<double>& slots) {
  for (std::size_t i = 0; i < model.scene.responses.size(); ++i) {
    const auto& response = model.scene.responses[i];
    const std::string pointer = child_pointer("/responses", response.name);
    const auto& place = model.response_places[i];
    if (response.kind == Response::Kind::reaction && !is_held(model, place.nodes))
      throw ModelError("no support acts on " + response.on + ", so there is no reaction", pointer + "/reaction/on");
    if (response.at.empty() || place.points.empty()) continue;
    const auto& point = model.points[place.points[0]];
    const auto distance = [&](int node) {
      double squared = 0;
      for (std::size_t k = 0; k < response.at.size(); ++k)
        squared += std::pow(response.at[k].value - slots.points(static_cast<Eigen::Index>(k), node), 2);
      return std::sqrt(squared);
    };
    const double nearest = distance(point.nodes[0]);
    for (const int c : place.contacts)
      for (const int node : nodes_without_area(model, slots.points, c))
        if (distance(node) < nearest)
          throw ModelError("the point of \"at\" is the node of " + model.scene.contacts[c].slave +
                               " on the axis of revolution, where quadratic elements have no area, so that it has no "
                               "contact of its own; take the place of a neighbour, or linear elements",
                           pointer);
    constexpr double rounding = 1e-9;  // of a facet
    if (point.mesh_size > 0 && nearest > (1 + rounding) * point.mesh_size)
      throw ModelError("the point of \"at\" is off the contact: " + shown(nearest) +
                           " from its nearest node, where its facets are " + shown(point.mesh_size) + " long",
                       pointer);
  }
}

}  // namespace

bool are_apart(double below, double above, double value, const Parameter& by, const Method& method) {
  const double allowed = scheme_of(method).error, rounding = allowed > 0 ? allowed : 1e-9;
  const double size = by.value == 0 ? 0 : std::abs(value / by.value);
  return !(std::abs(above - below) <= rounding * std::max({std::abs(below), std::abs(above), size}));
}

bool StepResult::has_kink(const Scene& scene, const Method& method, std::size_t response, std::size_t parameter) const {
  return are_apart(backward(response, parameter), forward(response, parameter), responses[response],
                   scene.parameters[parameter], method);
}

Problem::Problem(const Scene& scene) {
  {
    const Stopwatch time(seconds.setup);
    model = make_model(scene, seconds);
    slots = make_slots<double>(model, scene.as<double>());
    check_responses(model, slots);
  }
  seconds.setup -= seconds.contact_search;
}

Status CaseResult::status() const {
  const bool derivatives_failed = is_converged(trajectory.status) && !is_converged(gradients.status);
  return derivatives_failed || trajectory.status == Status::converged ? gradients.status : trajectory.status;
}

std::string CaseResult::message() const {
  const bool own = trajectory.status != Status::converged && status() == trajectory.status;
  return own || gradients.message.empty() ? trajectory.message : gradients.message;
}

std::shared_ptr<Condensation<double>> condense(const Problem& problem, const RunOptions& options) {
  Workspace<double> workspace;
  make_engine<double>(problem.model, problem.slots, Penalty{}, options, workspace);
  return workspace.condensation;
}

CaseResult run_case(std::shared_ptr<const Problem> problem, const Method& method, const RunOptions& options,
                    std::shared_ptr<Condensation<double>>& condensation) {
  CaseResult result;
  result.problem = problem;
  result.method = method;
  const double solved_before = condensation ? condensation->backsolves() : 0;
  const bool shared = condensation != nullptr;
  Workspace<double> workspace{condensation, {}};
  Derivatives derivatives(problem->model, problem->slots, result.method, workspace);
  StepReader reader(*problem, result.method);
  RunOptions followed = options;
  if (!is_adjoint(problem->model)) followed.state_memory = std::numeric_limits<double>::infinity();
  followed.on_step = [&] {
    reader.follow(result.trajectory, workspace.checkpoints != nullptr);
    if (!is_adjoint(problem->model)) derivatives.follow(result.trajectory);
    if (options.on_step) options.on_step();
  };
  solve(problem->model, problem->slots, method, followed, workspace, result.trajectory);
  condensation = workspace.condensation;
  result.nonzeros = workspace.engine->nonzeros();
  result.engine = workspace.engine->report();
  if (condensation && !shared) result.condensing = condensation->counters;
  if (result.engine.body_solves > 0)
    result.body_solves =
        result.engine.body_solves - (shared ? solved_before : static_cast<double>(result.condensing.backsolves));
  mark_inaccurate(reader.accuracy(), result.trajectory);
  name_loose_body(problem->model, result.trajectory);
  explain_failed_contact(*problem, result.trajectory);
  if (has_tangent(result.trajectory)) result.condition_estimate = workspace.engine->condition_estimate();
  if (result.trajectory.solved_count() > 0) {  // a step that failed takes nothing from those before
    differentiate_case(workspace, derivatives, result);
    result.sensitivity_body_solves = workspace.engine->report().body_solves - result.engine.body_solves;
  }
  result.steps = gather_steps(result, reader);
  result.scales = reader.accuracy().scales;
  result.objectives = objectives_of(result);
  const auto has_sides = [](const StepResult& step) { return !step.differentiable; };
  if (has_ended(result) && std::any_of(result.steps.begin(), result.steps.end(), has_sides)) {
    result.objectives_below = side_of_objectives(result, &StepResult::backward);
    result.objectives_above = side_of_objectives(result, &StepResult::forward);
  }
  refuse_overflow(result);
  refuse_open_objectives(result);
  name_floating_body(result);
  return result;
}

bool has_ended(const CaseResult& result) { return solved_steps(result).size() == result.steps.size(); }

std::span<const StepResult> solved_steps(const CaseResult& result) {
  const auto end = std::find_if(result.steps.begin(), result.steps.end(),
                                [](const StepResult& step) { return !step.increment->solved(); });
  return std::span(result.steps).first(static_cast<std::size_t>(end - result.steps.begin()));
}

}  // namespace stickslip
