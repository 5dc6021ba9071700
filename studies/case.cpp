#include "studies/case.hpp"

#include <sys/resource.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "core/model/response.hpp"
#include "studies/json_document.hpp"
#include "studies/method_options.hpp"
#include "studies/provenance.hpp"
#include "studies/version.hpp"
#include "studies/warnings.hpp"

namespace stickslip {
namespace {

using nlohmann::json;

/// Whether two one-sided derivatives differ by more than their rounding, or than their scheme is off by. `size`:
/// |response| / |parameter|.
bool is_kink(const Method& method, double backward, double forward, double size) {
  const auto* uzawa = std::get_if<UzawaAL>(&method);
  const bool oversized = uzawa && uzawa->sensitivity == UzawaAL::Sensitivity::oversized;
  const double rounding = oversized ? 10 / uzawa->oversize.value_or(UzawaAL::automatic_oversize) : 1e-9;
  return !(std::abs(forward - backward) <= rounding * std::max({std::abs(backward), std::abs(forward), size}));
}

const char* name_of(ContactState state) {
  return state == ContactState::open ? "open" : state == ContactState::stick ? "stick" : "slip";
}

/// JSON has no infinity.
json finite(double x) { return std::isfinite(x) ? json(x) : json(nullptr); }

json history_json(const std::vector<IterationRecord>& history) {
  json out = json::array();
  for (const auto& r : history)
    out.push_back({{"residual", finite(r.residual)},
                   {"equilibrium", finite(r.equilibrium)},
                   {"normal", finite(r.normal)},
                   {"tangential", finite(r.tangential)},
                   {"open", r.open},
                   {"stick", r.stick},
                   {"slip", r.slip},
                   {"changed", r.changed},
                   {"step_length", r.step_length},
                   {"augmentation", r.augmentation}});
  return out;
}

double size_of(const StepResult& step, const Scene& scene, std::size_t response, std::size_t parameter) {
  const double value = scene.parameters[parameter].value;
  return value == 0 ? 0 : std::abs(step.responses[response] / value);
}

/// Fills in the one-sided derivatives of increment n, and whether they are one.
void take_sides(const CaseResult& result, std::size_t n, StepResult& step) {
  const auto& scene = result.problem->model.scene;
  if (scene.sensitivity_mode == SensitivityMode::adjoint)  // (which has no sides)
    step.differentiable = std::min(step.margins.open, step.margins.slip) > weak_margin;
  const auto take = [&](const auto& backward, const auto& forward) {
    if (n >= backward.size()) return;
    step.backward = backward[n];
    step.forward = forward[n];
  };
  if (result.one_sided)
    take(result.one_sided->backward, result.one_sided->forward);
  else
    take(result.gradients.below, result.gradients.above);
  if (step.backward.size() == 0) return;
  for (std::size_t i = 0; i < scene.responses.size(); ++i)
    for (std::size_t j = 0; j < scene.parameters.size(); ++j)
      if (is_kink(result.method, step.backward(i, j), step.forward(i, j), size_of(step, scene, i, j)))
        step.differentiable = false;
}

/// {response: {parameter: [backward, forward]}} of all; null where a side has no derivative.
json one_sided_json(const StepResult& step, const Scene& scene) {
  json out = json::object();
  for (std::size_t i = 0; step.backward.size() && i < scene.responses.size(); ++i)
    for (std::size_t j = 0; j < scene.parameters.size(); ++j) {
      out[scene.responses[i].name][scene.parameters[j].name] = {finite(step.backward(i, j)),
                                                                finite(step.forward(i, j))};
    }
  return out;
}

std::vector<StepResult> gather_steps(const CaseResult& result) {
  const auto& [model, slots, unused] = *result.problem;
  const auto errors = kkt_errors(model, slots, result.trajectory);
  std::vector<StepResult> steps;
  StepResult step;
  for (std::size_t n = 0; n < result.trajectory.increments.size(); ++n) {
    const auto& increment = result.trajectory.increments[n];
    step.newton += increment.newton;
    step.augmentations += increment.augmentations;
    step.history.insert(step.history.end(), increment.history.begin(), increment.history.end());
    if (!increment.requested) continue;
    step.increment = &increment;
    step.kkt = errors[n];
    step.margins = margins(model, slots, increment.state);
    step.responses = evaluate_responses(model, slots, increment.state, increment.time);
    if (n < result.gradients.of.size()) step.sensitivities = result.gradients.of[n];
    if (n < result.gradients.records.size()) step.scheme = result.gradients.records[n];
    take_sides(result, n, step);
    steps.push_back(std::move(step));
    step = {};
  }
  return steps;
}

/// A body that no support holds and no contact point touches: nothing determines where it is. nullptr where all are
/// held.
const Body* loose_body(const Model& model) {
  for (std::size_t b = 0; b < model.bodies.size(); ++b) {
    const auto in_body = [&, first = model.bodies[b].first_node](int node) {
      return node >= first && node < first + model.bodies[b].mesh.node_count;
    };
    const bool held = std::any_of(model.constraints.begin(), model.constraints.end(),
                                  [&](const Constraint& c) { return in_body(c.dof / model.dimension); });
    const bool touched = std::any_of(model.contact_nodes.begin(), model.contact_nodes.end(), in_body);
    if (!held && !touched) return &model.scene.bodies[b];
  }
  return nullptr;
}

/// Says of a run with a loose body why it has no answer, or where no load acts, none of its own.
void name_loose_body(const Model& model, Trajectory<double>& trajectory) {
  const Body* const loose = loose_body(model);
  if (!loose) return;
  if (is_converged(trajectory.status)) trajectory.status = Status::non_unique;
  trajectory.message =
      loose->name + " is free to move: no support holds it and no contact touches it; add a support or a contact";
}

/// Whether the run ended with a tangent that derivatives can be taken of.
bool has_tangent(const Trajectory<double>& trajectory) {
  const Status status = trajectory.status;
  return !trajectory.increments.empty() && status != Status::singular && status != Status::not_finite &&
         status != Status::no_equilibrium && status != Status::non_unique;
}

void differentiate_case(Workspace<double>& workspace, CaseResult& result) {
  const auto& [model, slots, unused] = *result.problem;
  if (model.scene.sensitivity_mode == SensitivityMode::adjoint) {
    result.gradients = adjoint(model, slots, result.method, result.trajectory, workspace);
    return;
  }
  result.gradients = differentiate(model, slots, result.method, result.trajectory, workspace);
  result.gradients.of_objectives = objective_gradients(model, slots, result.trajectory, result.gradients);
  const Stopwatch time(result.gradients.seconds);
  result.one_sided = one_sided_derivatives(model, slots, result.method, result.trajectory, workspace);
  if (result.one_sided) result.gradients.counters += result.one_sided->counters;
}

/// Whether a support, or an anchor, holds a node of a side.
bool is_held(const Model& model, const std::string& side) {
  const auto nodes = model.side(side).nodes;
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
    if (response.kind == Response::Kind::reaction && !is_held(model, response.on))
      throw ModelError("no support acts on " + response.on + ", so there is no reaction", pointer + "/reaction/on");
    const int p = model.response_places[i].contact_point;
    if (p < 0) continue;
    const auto& point = model.points[static_cast<std::size_t>(p)];
    double squared = 0;
    for (std::size_t k = 0; k < response.at.size(); ++k)
      squared += std::pow(response.at[k].value - slots.points(static_cast<Eigen::Index>(k), point.nodes[0]), 2);
    if (point.mesh_size > 0 && std::sqrt(squared) > point.mesh_size)
      throw ModelError("the point of \"at\" is off the contact: " + shown(std::sqrt(squared)) +
                           " from its nearest node, where its facets are " + shown(point.mesh_size) + " long",
                       pointer);
  }
}

}  // namespace

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
  return trajectory.status != Status::converged ? trajectory.status : gradients.status;
}

std::string CaseResult::message() const {
  return trajectory.status != Status::converged || gradients.message.empty() ? trajectory.message : gradients.message;
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
  Workspace<double> workspace{condensation, {}};
  result.trajectory = solve(problem->model, problem->slots, method, options, workspace);
  condensation = workspace.condensation;
  std::visit([&](auto& engine) { result.nonzeros = engine.nonzeros(); }, *workspace.engine);
  name_loose_body(problem->model, result.trajectory);
  if (has_tangent(result.trajectory)) {
    if (result.trajectory.counters.newton > 0)  // otherwise nothing was factorised
      result.condition_estimate =
          std::visit([](auto& engine) { return engine.condition_estimate(); }, *workspace.engine);
    differentiate_case(workspace, result);
  }
  result.steps = gather_steps(result);
  result.objectives = objective_values(problem->model, problem->slots, result.trajectory);
  return result;
}

json kkt_json(const KktError& e) {
  return {{"equilibrium", finite(e.equilibrium)},
          {"gap", finite(e.gap)},
          {"complementarity", finite(e.complementarity)},
          {"cone", finite(e.cone)},
          {"stick", finite(e.stick)},
          {"slip_direction", finite(e.slip_direction)}};
}

json size_json(const CaseResult& result) {
  const auto& model = result.problem->model;
  const bool unknown = std::holds_alternative<MonolithicAL>(result.method);
  return {{"displacements", model.free_dofs.size()},
          {"multipliers", unknown ? model.multiplier_count : 0},
          {"nonzeros", result.nonzeros},
          {"contact_points", model.points.size()},
          {"reduced_unknowns", result.trajectory.reduced_unknowns},
          {"engine", result.trajectory.engine}};
}

json cost_json(const CaseResult& result) {
  Counters counts = result.trajectory.counters;
  counts += result.gradients.counters;
  const auto& seconds = result.trajectory.seconds;
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  return {{"counts",
           {{"assemblies", counts.assemblies},
            {"factorizations", counts.factorizations},
            {"analyses", counts.analyses},
            {"backsolves", counts.backsolves},
            {"sensitivity_backsolves", counts.sensitivity_backsolves},
            {"sensitivity_factorizations", counts.sensitivity_factorizations},
            {"newton", counts.newton},
            {"augmentations", counts.augmentations},
            {"cutbacks", counts.cutbacks}}},
          {"seconds",
           {{"total", seconds.total + result.gradients.seconds},
            {"setup", seconds.setup + result.problem->seconds.setup},
            {"assembly", seconds.assembly},
            {"factorization", seconds.factorization},
            {"backsolve", seconds.backsolve},
            {"contact_search", result.problem->seconds.contact_search},
            {"sensitivity", result.gradients.seconds},
            {"output", 0.0}}},
          {"peak_memory_mb", usage.ru_maxrss / 1024.0},
          {"condition_estimate", finite(result.condition_estimate)}};
}

json scheme_json(const SchemeRecord& record) {
  json out = {{"passes", record.passes}, {"oversize", record.oversize}};
  if (record.contraction > 0) out["contraction"] = finite(record.contraction);
  return out;
}

json objectives_json(const CaseResult& result) {
  const auto& scene = result.problem->model.scene;
  json out = json::object();
  for (std::size_t i = 0; i < scene.objectives.size(); ++i) {
    json& entry = out[scene.objectives[i].name];
    entry["value"] = finite(result.objectives[i]);
    for (std::size_t j = 0; result.gradients.of_objectives.size() && j < scene.parameters.size(); ++j)
      entry["gradient"][scene.parameters[j].name] = finite(result.gradients.of_objectives(i, j));
  }
  return out;
}

json steps_json(const CaseResult& result) {
  const auto& scene = result.problem->model.scene;
  json steps = json::array();
  for (const auto& step : result.steps) {
    json contacts = json::object(), responses = json::object(), sensitivities = json::object();
    const auto summaries = summarise(result.problem->model, result.problem->slots, step.increment->state);
    for (std::size_t c = 0; c < summaries.size(); ++c)
      contacts[scene.contacts[c].name] = {{"open", summaries[c].open},
                                          {"stick", summaries[c].stick},
                                          {"slip", summaries[c].slip},
                                          {"penetration", finite(summaries[c].penetration)},
                                          {"normal_force", finite(summaries[c].normal_force)},
                                          {"tangential_force", summaries[c].tangential_force}};
    for (std::size_t i = 0; i < scene.responses.size(); ++i) {
      responses[scene.responses[i].name] = finite(step.responses[i]);
      for (std::size_t j = 0; step.sensitivities.size() && j < scene.parameters.size(); ++j)
        sensitivities[scene.responses[i].name][scene.parameters[j].name] = finite(step.sensitivities(i, j));
    }
    json entry = {{"time", step.increment->time},
                  {"status", name_of(step.increment->status)},
                  {"newton", step.newton},
                  {"augmentations", step.augmentations},
                  {"cutbacks", step.increment->cutbacks},
                  {"history", history_json(step.history)},
                  {"contacts", contacts},
                  {"kkt", kkt_json(step.kkt)},
                  {"margins", {{"open", finite(step.margins.open)}, {"slip", finite(step.margins.slip)}}},
                  {"responses", responses}};
    if (!scene.parameters.empty()) {
      if (scene.sensitivity_mode == SensitivityMode::direct) entry["sensitivities"] = sensitivities;
      entry["differentiable"] = step.differentiable;
      if (!step.differentiable) entry["one_sided"] = one_sided_json(step, scene);
    }
    if (step.increment->contraction > 0) entry["contraction"] = step.increment->contraction;
    if (step.scheme) entry["sensitivity_scheme"] = scheme_json(*step.scheme);
    if (!step.increment->message.empty()) entry["message"] = step.increment->message;
    steps.push_back(std::move(entry));
  }
  return steps;
}

json regularisation_json(const CaseResult& result) {
  const auto& slots = result.problem->slots;
  const auto initial = std::visit([&](const auto& m) { return initial_regularisation(slots, m); }, result.method);
  const auto last =
      result.trajectory.increments.empty() ? std::vector<double>{} : result.trajectory.increments.back().rho_factor;
  const auto used = adapted(initial, last);
  double low = 0, high = 0, low_multiple = 0, high_multiple = 0;
  for (std::size_t p = 0; p < used.size(); ++p) {
    const double rho = used[p].normal, multiple = rho * slots.geometry[p].area / slots.stiffness[p];
    low = p == 0 ? rho : std::min(low, rho);
    high = std::max(high, rho);
    low_multiple = p == 0 ? multiple : std::min(low_multiple, multiple);
    high_multiple = std::max(high_multiple, multiple);
  }
  return {{"absolute", {{"min", low}, {"max", high}}}, {"multiple", {{"min", low_multiple}, {"max", high_multiple}}}};
}

json interface_json(const CaseResult& result) {
  json contacts = json::object();
  if (result.steps.empty()) return contacts;
  const auto& [model, slots, unused] = *result.problem;
  const auto& state = result.steps.back().increment->state;
  for (std::size_t c = 0; c < model.scene.contacts.size(); ++c) {
    json x = json::array(), y = json::array(), arc = json::array(), area = json::array(), gap = json::array(),
         slip = json::array(), normal = json::array(), tangential = json::array(), states = json::array();
    double along = 0;
    const ContactPoint* last = nullptr;
    for (std::size_t p = 0; p < model.points.size(); ++p) {
      const auto& point = model.points[p];
      if (point.contact != static_cast<int>(c)) continue;
      if (last) along += (slots.points.col(point.nodes[0]) - slots.points.col(last->nodes[0])).norm();
      last = &point;
      x.push_back(slots.points(0, point.nodes[0]));
      y.push_back(slots.points(1, point.nodes[0]));
      arc.push_back(along);
      area.push_back(slots.geometry[p].area);
      gap.push_back(finite(state.contact.gap[p]));
      normal.push_back(finite(state.contact.traction[point.multiplier]));
      const bool plane = point.tangents == 1;  // one component keeps its sign; two are shown by their size
      const auto t = state.contact.traction.segment(point.multiplier + 1, point.tangents);
      const auto s = state.contact.placement.segment(tangential_offset(model, static_cast<int>(p)), point.tangents);
      tangential.push_back(finite(plane ? t[0] : t.norm()));
      slip.push_back(finite(plane ? s[0] : s.norm()));
      states.push_back(name_of(state.contact.state[p]));
    }
    contacts[model.scene.contacts[c].name] = {
        {"x", x},         {"y", y},       {"arc", arc},       {"area", area},
        {"gap", gap},     {"slip", slip}, {"normal", normal}, {"tangential", tangential},
        {"state", states}};
  }
  return contacts;
}

json result_json(const CaseResult& result, const std::string& scene_text) {
  const auto& model = result.problem->model;
  const auto& effects = model.effects;
  json out;
  out["stickslip"] = version::number;
  out["scene"] = {{"title", model.scene.title}, {"hash", fingerprint(scene_text)}};
  out["method"] = to_json(result.method);
  out["regularisation"] = regularisation_json(result);
  out["status"] = name_of(result.status());
  out["message"] = result.message();
  out["effects"] = {{"friction", effects.friction},
                    {"finite_strain", false},
                    {"plasticity", false},
                    {"smoothing", false},
                    {"sensitivity", effects.sensitivity}};
  out["warnings"] = warnings_of(result);
  out["size"] = size_json(result);
  out["steps"] = steps_json(result);
  if (!model.scene.objectives.empty()) out["objectives"] = objectives_json(result);
  out["cost"] = cost_json(result);
  out["provenance"] = provenance(1);
  return out;
}

}  // namespace stickslip
