#include "studies/sweep/measured_peer.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <set>

#include "studies/io/result_rows.hpp"
#include "studies/run/solution_file.hpp"

namespace stickslip {
namespace {

using nlohmann::json;

/// The tractions of a step on the contact points of a problem, with the signs of multipliers: those on the master. Not
/// a number of a friction in space.
Vector<double> tractions_of(const verify::Step& step, const Model& model) {
  Vector<double> t = Vector<double>::Constant(model.multiplier_count, NAN);
  for (const auto& point : model.points) {
    const auto contact = step.tractions.find(model.scene.contacts[point.contact].name);
    if (contact == step.tractions.end()) continue;
    const auto place = contact->second.find(point.nodes[0]);
    if (place == contact->second.end()) continue;
    t[point.multiplier] = -place->second[0];
    if (point.tangents == 1) t[point.multiplier + 1] = -place->second[1];
  }
  return t;
}

CaseResult answers_of(const verify::Certificate& certificate, const json& scene, std::shared_ptr<const Problem> problem,
                      const Method& method) {
  CaseResult result{.problem = std::move(problem), .method = method};
  const auto& responses = result.problem->model.scene.responses;
  const auto asked = verify::asked_times(scene);
  const auto is_asked = [&](double time) {
    return asked.empty() || std::ranges::any_of(asked, [&](double t) { return std::abs(t - time) <= 1e-9 * t; });
  };
  std::vector<const verify::Step*> steps;
  for (const auto& step : certificate.steps)
    if (is_asked(step.time)) steps.push_back(&step);
  result.trajectory.increments.resize(steps.size());
  for (std::size_t n = 0; n < steps.size(); ++n) {
    auto& increment = result.trajectory.increments[n];
    increment.time = steps[n]->time;
    increment.state.contact.traction = tractions_of(*steps[n], result.problem->model);
    StepResult& step = result.steps.emplace_back(StepResult{.increment = &increment});
    step.responses.setConstant(std::ssize(responses), NAN);
    for (std::size_t i = 0; i < responses.size(); ++i)
      if (const auto known = steps[n]->responses.find(responses[i].name); known != steps[n]->responses.end())
        step.responses[static_cast<Eigen::Index>(i)] = known->second;
  }
  return result;
}

/// {response: value} of a step; null of what was not measured.
json responses_of(const CaseResult& result, const StepResult& step) {
  json out = json::object();
  const auto& responses = result.problem->model.scene.responses;
  for (std::size_t i = 0; i < responses.size(); ++i) {
    const double value = step.responses[static_cast<Eigen::Index>(i)];
    out[responses[i].name] = std::isfinite(value) ? json(value) : json(nullptr);
  }
  return out;
}

/// As interface_json(), with what is known: places and tractions.
json interface_of(const CaseResult& result) {
  CaseResult whole = result;
  auto& state = whole.trajectory.increments.back().state;
  const auto& model = result.problem->model;
  const auto unknown = static_cast<Eigen::Index>(model.multiplier_count);
  state.contact.gap.setConstant(std::ssize(model.points), NAN);
  state.contact.state.resize(model.points.size());
  state.history.placement.setConstant(unknown, NAN);
  whole.steps.back().increment = &whole.trajectory.increments.back();
  json all = interface_json(whole);
  for (auto& [name, contact] : all.items())
    for (const char* part : {"gap", "slip", "state"}) contact.erase(part);
  return all;
}

}  // namespace

MeasuredPeer measured(const PeerSolution& peer, const json& scene, std::shared_ptr<const Problem> problem,
                      const Method& method) {
  auto certificate = certificate_of_peer(solution_frame(*problem, scene), peer.solution);
  auto result = answers_of(certificate, scene, std::move(problem), method);
  return {std::move(certificate), std::move(result)};
}

json row_of(const MeasuredPeer& peer) {
  const auto& [certificate, result] = peer;
  json row = {{"certificate", worst_of_certificate_json(certificate)},
              {"status", name_of(certificate.holds() ? Status::converged : Status::inaccurate)},
              {"warnings", json::array()},
              {"steps", json::array()}};
  row["message"] = certificate.holds() ? fmt::format("{}", fmt::join(certificate.remarks, "; "))
                                       : "its certificate does not hold: " + broken_law(row["certificate"]);
  for (const auto& step : result.steps)
    row["steps"].push_back({{"time", step.increment->time}, {"responses", responses_of(result, step)}});
  if (!result.steps.empty()) {
    row["responses"] = row["steps"].back()["responses"];
    row["interface"] = interface_of(result);
  }
  return row;
}

json errors_of(const verify::Certificate& certificate) {
  static const std::set<std::string> laws = {"equilibrium", "gap",   "tension",        "complementarity",
                                             "cone",        "stick", "slip direction", "dissipation"};
  json out = json::object();
  for (const auto& step : certificate.steps)
    for (const auto& finding : step.findings)
      if (laws.contains(finding.law) && std::isfinite(finding.value))
        out[finding.law] = std::max(out.value(finding.law, 0.0), finding.value);
  return out;
}

}  // namespace stickslip
