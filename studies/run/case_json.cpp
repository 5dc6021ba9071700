#include <sys/resource.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <nlohmann/json.hpp>

#include "core/model/response.hpp"
#include "methods/newton/regularisation.hpp"
#include "methods/stepping/engine_choice.hpp"
#include "sensitivity/vertex_margin.hpp"
#include "studies/input/method_options.hpp"
#include "studies/io/json_document.hpp"
#include "studies/io/provenance.hpp"
#include "studies/run/case.hpp"
#include "studies/run/contact_points.hpp"
#include "studies/run/ledger.hpp"
#include "studies/run/warnings.hpp"
#include "studies/version.hpp"

namespace stickslip {
namespace {

using nlohmann::json;

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

/// {response: {parameter: [backward, forward]}} of all; null where a side has no derivative.
json one_sided_json(const StepResult& step, const Scene& scene) {
  json out = json::object();
  for (std::size_t i = 0; step.backward.size() && i < scene.responses.size(); ++i)
    for (std::size_t j = 0; j < scene.parameters.size(); ++j)
      out[scene.responses[i].name][scene.parameters[j].name] = {finite(step.backward(i, j)),
                                                                finite(step.forward(i, j))};
  return out;
}

/// {parameter: [below, above]}; null where nothing changes.
json nearest_change_json(const StepResult& step, const Scene& scene) {
  json out = json::object();
  for (std::size_t j = 0; j < scene.parameters.size(); ++j) {
    const auto row = static_cast<Eigen::Index>(j);
    out[scene.parameters[j].name] = {finite(step.nearest_change(row, 0)), finite(step.nearest_change(row, 1))};
  }
  return out;
}

json scheme_json(const SchemeRecord& record) {
  json out = {{"passes", record.passes}, {"oversize", record.oversize}};
  if (record.contraction > 0) out["contraction"] = finite(record.contraction);
  return out;
}

}  // namespace

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
  const bool unknown = multipliers_of(result.method) == Multipliers::unknown;
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
            {"cutbacks", counts.cutbacks},
            {"repeated_increments", result.gradients.repeated}}},
          {"seconds",
           {{"total", seconds.total + result.gradients.seconds},
            {"setup", seconds.setup + result.problem->seconds.setup},
            {"assembly", seconds.assembly()},
            {"contact", seconds.contact},
            {"factorization", seconds.factorization},
            {"backsolve", seconds.backsolve},
            {"contact_search", result.problem->seconds.contact_search + seconds.contact_search},
            {"sensitivity", result.gradients.seconds},
            {"output", 0.0}}},
          {"peak_memory_mb", usage.ru_maxrss / 1024.0},
          {"condition_estimate", finite(result.condition_estimate)}};
}

std::optional<double> scale_of(const CaseResult& result, const Response& response) {
  using Kind = Response::Kind;
  const auto& points = result.problem->slots.points;
  const auto& scales = result.scales;
  const double length = std::max(scales.reach, scales.length);
  double scale = 0;
  switch (response.kind) {
    case Kind::reaction:
    case Kind::contact_force:
      scale = scales.force;
      if (response.component == Response::Component::moment)
        scale *= (points.rowwise().maxCoeff() - points.rowwise().minCoeff()).norm();
      break;
    case Kind::displacement:
    case Kind::gap:
    case Kind::slip:
      scale = length;
      break;
    case Kind::contact_pressure:
      scale = scales.traction;
      break;
    case Kind::dissipation:
    case Kind::strain_energy:
      scale = scales.force * length;
      break;
    case Kind::plastic_strain:
    case Kind::contact_half_width:
      break;
  }
  if (!std::isfinite(scale) || !(scale > 0)) return std::nullopt;
  return scale;
}

json scales_json(const CaseResult& result) {
  json out = json::object();
  for (const auto& response : result.problem->model.scene.responses)
    if (const auto scale = scale_of(result, response)) out[response.name] = *scale;
  return out;
}

namespace {

/// {parameter: [from below, from above]} of all; null where the sides of objective i are one.
json sides_of_objective(const CaseResult& result, Eigen::Index i) {
  const auto& parameters = result.problem->model.scene.parameters;
  json out;
  bool apart = false;
  for (std::size_t j = 0; result.objectives_below.size() > 0 && j < parameters.size(); ++j) {
    const auto column = static_cast<Eigen::Index>(j);
    const double below = result.objectives_below(i, column), above = result.objectives_above(i, column);
    out[parameters[j].name] = {finite(below), finite(above)};
    apart |= are_apart(below, above, result.objectives[i], parameters[j], result.method);
  }
  return apart ? out : json(nullptr);
}

}  // namespace

json objectives_json(const CaseResult& result) {
  const auto& scene = result.problem->model.scene;
  json out = json::object();
  for (std::size_t i = 0; i < scene.objectives.size(); ++i) {
    json& entry = out[scene.objectives[i].name];
    entry["value"] = has_ended(result) ? finite(result.objectives[i]) : json(nullptr);
    for (std::size_t j = 0; result.gradients.of_objectives.size() && j < scene.parameters.size(); ++j)
      entry["gradient"][scene.parameters[j].name] = finite(result.gradients.of_objectives(i, j));
    if (json sides = sides_of_objective(result, static_cast<Eigen::Index>(i)); !sides.is_null())
      entry["one_sided"] = std::move(sides);
  }
  return out;
}

/// {contact: states and forces} of a state.
json contacts_json(const Problem& problem, const State<double>& state) {
  json contacts = json::object();
  const auto summaries = summarise(problem.model, problem.slots, state);
  const auto entry = [](const ContactSummary& summary) -> json {
    return {{"open", summary.open},
            {"stick", summary.stick},
            {"slip", summary.slip},
            {"penetration", finite(summary.penetration)},
            {"normal_force", finite(summary.normal_force)},
            {"tangential_force", summary.tangential_force}};
  };
  std::map<std::string, ContactSummary> groups;  // the sums of their pairs
  for (std::size_t c = 0; c < summaries.size(); ++c) {
    const Contact& contact = problem.model.scene.contacts[c];
    contacts[contact.name] = entry(summaries[c]);
    if (!contact.group.empty()) groups[contact.group] += summaries[c];
  }
  for (const auto& [name, summary] : groups) contacts[name] = entry(summary);
  return contacts;
}

/// Solutions that were found and not taken: of each its time, contacts and responses.
json solutions_json(const CaseResult& result) {
  const auto& [model, slots, unused] = *result.problem;
  json solutions = json::array();
  for (const auto& increment : result.trajectory.increments)
    for (const auto& other : increment.others) {
      json responses = json::object();
      const auto values = evaluate_responses(model, slots, other, increment.time);
      for (std::size_t i = 0; i < model.scene.responses.size(); ++i)
        responses[model.scene.responses[i].name] = finite(values[i]);
      solutions.push_back(
          {{"time", increment.time}, {"contacts", contacts_json(*result.problem, other)}, {"responses", responses}});
    }
  return solutions;
}

/// Adds what a solved step holds: contacts, responses, margins and derivatives.
void add_answers(const CaseResult& result, const StepResult& step, json& entry) {
  const auto& scene = result.problem->model.scene;
  json sensitivities = json::object();
  for (std::size_t i = 0; i < scene.responses.size(); ++i)
    for (std::size_t j = 0; step.sensitivities.size() && j < scene.parameters.size(); ++j)
      sensitivities[scene.responses[i].name][scene.parameters[j].name] = finite(step.sensitivities(i, j));
  entry["margins"] = {{"open", finite(step.margins.open)}, {"slip", finite(step.margins.slip)}};
  if (result.problem->model.effects.plasticity) entry["margins"]["yield"] = finite(step.margins.yield);
  if (slides_along_facets(result.problem->model)) entry["margins"]["vertex"] = finite(step.margins.vertex);
  if (!scene.parameters.empty()) {
    if (scene.sensitivity_mode == SensitivityMode::direct) entry["sensitivities"] = sensitivities;
    entry["differentiable"] = step.differentiable;
    for (std::size_t i = 0; i < step.open_responses.size(); ++i)
      if (step.open_responses[i]) entry["undetermined"].push_back(scene.responses[i].name);
    if (!step.differentiable) entry["one_sided"] = one_sided_json(step, scene);
    if (step.nearest_change.size() > 0) entry["nearest_change"] = nearest_change_json(step, scene);
  }
  if (step.scheme) entry["sensitivity_scheme"] = scheme_json(*step.scheme);
}

/// A step without a solution has the last iterate of Newton's method under that name.
json steps_json(const CaseResult& result) {
  const auto& scene = result.problem->model.scene;
  json steps = json::array();
  for (const auto& step : result.steps) {
    json responses = json::object();
    for (std::size_t i = 0; i < scene.responses.size(); ++i)
      responses[scene.responses[i].name] = finite(step.responses[i]);
    json entry = {{"time", step.increment->time},
                  {"status", name_of(step.increment->status)},
                  {"newton", step.newton},
                  {"augmentations", step.augmentations},
                  {"cutbacks", step.increment->cutbacks},
                  {"history", history_json(step.history)},
                  {"kkt", kkt_json(step.kkt)}};
    const bool solved = step.increment->solved();
    json& state = solved ? entry : entry["iterate"];
    state["contacts"] = contacts_json(*result.problem, step.increment->state);
    state["responses"] = responses;
    if (solved) add_answers(result, step, entry);
    if (step.increment->contraction > 0) entry["contraction"] = step.increment->contraction;
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

std::vector<double> arc_of(const Problem& problem, int contact) {
  std::vector<double> arc;
  const ContactPoint* last = nullptr;
  for (const auto& point : problem.model.points) {
    if (point.contact != contact) continue;
    const auto& x = problem.slots.points;
    arc.push_back(last ? arc.back() + (x.col(point.nodes[0]) - x.col(last->nodes[0])).norm() : 0);
    last = &point;
  }
  return arc;
}

const char* state_name(const ContactPoint& point, ContactState state) {
  return state != ContactState::open && point.tangents == 0 ? "closed" : branch_name(state);
}

json interface_json(const CaseResult& result) {
  json contacts = json::object();
  const auto solved = solved_steps(result);
  if (solved.empty()) return contacts;
  const auto& [model, slots, unused] = *result.problem;
  const auto& state = solved.back().increment->state;
  for (std::size_t c = 0; c < model.scene.contacts.size(); ++c) {
    const json arc = arc_of(*result.problem, static_cast<int>(c));
    json x = json::array(), y = json::array(), area = json::array(), gap = json::array(), slip = json::array(),
         normal = json::array(), tangential = json::array(), states = json::array();
    for (std::size_t p = 0; p < model.points.size(); ++p) {
      const auto& point = model.points[p];
      if (point.contact != static_cast<int>(c)) continue;
      x.push_back(slots.points(0, point.nodes[0]));
      y.push_back(slots.points(1, point.nodes[0]));
      area.push_back(slots.geometry[p].area);
      gap.push_back(finite(state.contact.gap[p]));
      normal.push_back(finite(state.contact.traction[point.multiplier]));
      const bool plane = point.tangents == 1;  // one component keeps its sign; two are shown by their size
      const auto t = state.contact.traction.segment(point.multiplier + 1, point.tangents);
      const auto s = state.history.placement.segment(tangential_offset(model, static_cast<int>(p)), point.tangents);
      tangential.push_back(finite(plane ? t[0] : t.norm()));
      slip.push_back(finite(plane ? s[0] : s.norm()));
      states.push_back(state_name(point, state.contact.state[p]));
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
                    {"finite_strain", model.scene.finite_strain},
                    {"plasticity", effects.plasticity},
                    {"smoothing", effects.smoothing},
                    {"sensitivity", effects.sensitivity}};
  out["ledger"] = ledger_json(ledger(result));
  out["warnings"] = warnings_json(result);
  out["size"] = size_json(result);
  for (const auto& parameter : model.scene.parameters) out["parameters"][parameter.name] = parameter.value;
  out["steps"] = steps_json(result);
  if (json solutions = solutions_json(result); !solutions.empty()) out["solutions"] = std::move(solutions);
  if (!model.scene.objectives.empty()) out["objectives"] = objectives_json(result);
  out["cost"] = cost_json(result);
  out["provenance"] = provenance(1);
  return out;
}

}  // namespace stickslip
