#include "studies/sweep/study_cell.hpp"

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <stdexcept>

#include "studies/input/method_options.hpp"
#include "studies/io/printing.hpp"
#include "studies/io/provenance.hpp"
#include "studies/run/certificate.hpp"
#include "studies/run/film.hpp"
#include "studies/run/ledger.hpp"
#include "studies/run/simulation.hpp"
#include "studies/run/solution_file.hpp"
#include "studies/run/warnings.hpp"
#include "studies/sweep/attempt.hpp"
#include "studies/sweep/measured_peer.hpp"
#include "studies/sweep/study.hpp"
#include "studies/version.hpp"

namespace stickslip {
namespace {

using nlohmann::json;

/// Whether a method runs as it does without any option; "auto" and the number it stands for are the same.
bool is_default(Method method, bool normals_turn) {
  std::visit(
      [&](auto& m) {
        auto& rho = m.regularisation();
        if (rho.kind == Regularisation::Kind::relative && rho.value.value == m.automatic_multiple.of(normals_turn))
          rho.kind = Regularisation::Kind::automatic;
      },
      method);
  return to_json(method) == to_json(*default_method(std::string(name_of(method))));
}

json only_asked(const Errors& errors, const std::vector<std::string>& patterns) {
  json out = json::object();
  for (const auto& [name, error] : errors)
    if (name.starts_with("field:") || asked_for(name, patterns))
      out[name] = std::isfinite(error) ? json(error) : json(nullptr);
  return out;
}

/// Adds what is not there yet.
void fill_in(json& errors, const json& more) {
  for (const auto& [name, error] : more.items())
    if (!errors.contains(name)) errors[name] = error;
}

std::size_t derivatives_in(const json& steps) {
  std::size_t n = 0;
  for (const auto& step : steps)
    if (const auto found = step.find("sensitivities"); found != step.end())
      for (const auto& by_parameter : *found) n += by_parameter.size();
  return n;
}

/// The steps without their bulk: states, margins, and derivatives where these are many. The last step's are in the row.
json brief(const json& steps) {
  constexpr std::size_t most_derivatives = 20'000;  // half a megabyte a row
  const bool few = derivatives_in(steps) <= most_derivatives;
  json out = json::array();
  for (const auto& step : steps) {
    json kept = json::object();
    for (const char* name : {"time", "status", "newton", "augmentations", "cutbacks", "history", "responses", "iterate",
                             "contraction", "sensitivity_scheme"})
      if (step.contains(name)) kept[name] = step[name];
    if (few && step.contains("sensitivities")) kept["sensitivities"] = step["sensitivities"];
    out.push_back(std::move(kept));
  }
  return out;
}

/// What a row says of its cell, however it went.
json head_of(const CellInput& cell, bool normals_turn) {
  json head = place_of(cell);
  head["id"] = cell.id;
  head["scene_hash"] = fingerprint(cell.canonical);
  if (cell.peer) {
    head["peer"] = {{"name", cell.peer->name}, {"file", cell.peer->file}};
    return head;
  }
  head["method"] = to_json(cell.method);
  head["default"] = is_default(cell.method, normals_turn);
  head["automatic"] = std::visit([&](const auto& m) { return m.automatic_multiple.of(normals_turn); }, cell.method);
  return head;
}

/// What verify says of a run's own solution, from what its files would hold.
json certificate_of_run(const CaseResult& result, const json& scene, const json& steps) {
  const SolutionFile file = solution_file(result, scene);
  if (file.text.empty()) return {{"left_out", file.left_out}};
  const json own = json::parse(file.text), answers = {{"status", name_of(result.status())}, {"steps", steps}};
  return worst_of_certificate_json(verify::certify(own.at("scene"), own.at("mesh"), own, answers));
}

}  // namespace

json place_of(const CellInput& cell) {
  json place = {{"label", cell.label}, {"knobs", cell.knobs}, {"vary", cell.vary}, {"refine", cell.refine}};
  if (!cell.scene.empty()) place["scene"] = cell.scene;
  return place;
}

std::string reference_hash(const Study& study) {
  json against = {{"errors", study.errors}, {"references", json::array()}};
  for (const Reference& reference : study.references) against["references"].push_back(reference.entry);
  return fingerprint(json_text(against));
}

std::string program_version() { return std::string(version::number) + "+" + std::string(version::git); }

Input input_of(const CellInput& cell, MeshFiles& meshes) {
  Diagnostics diagnostics;
  auto input = read_scene(cell.document, std::string(name_of(cell.method)), diagnostics, meshes);
  if (!input) throw std::runtime_error("a cell of the study is not a valid scene:\n" + diagnostics.text());
  return *std::move(input);
}

std::shared_ptr<const Problem> problem_of(const Input& input) { return std::make_shared<const Problem>(input.scene); }

void CellRunner::enter(const CellInput& cell) {
  if (variant_.key == variant_key(cell)) return;
  variant_ = {};
  const auto input = input_of(cell, meshes_);
  variant_.problem = problem_of(input);
  {
    const Stopwatch time(variant_.setup_seconds);
    variant_.condensation = condense(*variant_.problem, run_options(input));
  }
  run_references(cell);
  variant_.key = variant_key(cell);
}

/// A reference that throws gives no errors, as one that does not converge, and the rows say why.
void CellRunner::run_references(const CellInput& cell) {
  const auto note = [&](const Reference& reference, const Breakdown& breakdown) {
    variant_.fault += (variant_.fault.empty() ? "reference " : "; reference ") + json_text(reference.entry) + ": " +
                      breakdown.message;
  };
  for (const auto& reference : study_.references) {
    if (reference.kind == Reference::Kind::method) {
      auto& result = variant_.same_mesh.emplace_back();
      const auto breakdown =
          attempt([&] { result = run(reference_cell(cell, reference, program_version(), meshes_)); });
      if (breakdown) note(reference, *breakdown);
    }
    if (reference.kind != Reference::Kind::overkill) continue;
    auto& values = variant_.overkill.emplace_back();
    const auto breakdown = attempt([&] {
      const auto finer = reference_cell(cell, reference, program_version(), meshes_);
      if (const auto known = overkill_.find(finer.id); known != overkill_.end()) {
        values = known->second;
        return;
      }
      const auto fine = input_of(finer, meshes_);
      std::shared_ptr<Condensation<double>> own;
      ++runs_;
      const auto result = run_case(problem_of(fine), fine.method, run_options(fine), own);
      if (is_converged(result.status())) values = values_of(result);
      overkill_[finer.id] = values;
    });
    if (breakdown) note(reference, *breakdown);
  }
}

CaseResult CellRunner::run(const CellInput& cell) {
  const auto input = input_of(cell, meshes_);
  ++runs_;
  auto condensation = variant_.condensation;  // one that a method makes for itself is not the others'
  return run_case(problem_of(input), input.method, run_options(input), condensation);
}

CaseResult CellRunner::showcase(std::size_t cell) {
  enter(cells_[cell]);
  const auto& references = variant_.same_mesh;
  return references.empty() || !references.front() ? run(cells_[cell]) : *references.front();
}

json CellRunner::seconds_of(const CaseResult& result) const {
  json seconds = cost_json(result)["seconds"];
  seconds["setup"] = std::max(seconds["setup"].get<double>(), variant_.setup_seconds);
  return seconds;
}

json CellRunner::seconds(std::size_t cell) {
  enter(cells_[cell]);
  return seconds_of(run(cells_[cell]));
}

/// None of a run without a solution. Enforcement errors are against runs on the same mesh, discretisation errors
/// against all other references. Where several give an error of one name, the first in the study's list counts, and
/// each is recorded by reference too.
json CellRunner::errors(const CaseResult& result) const {
  json all = {{"enforcement", json::object()}, {"discretization", json::object()}}, by_reference = json::array();
  auto same_mesh = variant_.same_mesh.begin();
  auto overkill = variant_.overkill.begin();
  for (const auto& reference : study_.references) {
    const bool enforcement = reference.kind == Reference::Kind::method;
    json given = json::object();
    if (enforcement) {
      const auto& other = *same_mesh++;
      if (has_ended(result) && other && is_converged(other->status()))
        given = only_asked(enforcement_errors(result, *other), study_.errors);
    } else {
      const auto values =
          reference.kind == Reference::Kind::overkill ? *overkill++ : reference_values(reference.entry, result);
      if (has_ended(result)) given = only_asked(discretisation_errors(result, values), study_.errors);
    }
    fill_in(all[enforcement ? "enforcement" : "discretization"], given);
    by_reference.push_back({{"reference", reference.entry}, {"errors", given}});
  }
  if (study_.references.size() > 1) all["by_reference"] = by_reference;
  return all;
}

/// All that references other than runs on the same mesh say of a result; of one name, what the first of them says.
ReferenceValues CellRunner::reference_of(const CaseResult& result) const {
  ReferenceValues all;
  auto overkill = variant_.overkill.begin();
  for (const auto& reference : study_.references) {
    if (reference.kind == Reference::Kind::method) continue;
    ReferenceValues values =
        reference.kind == Reference::Kind::overkill ? *overkill++ : reference_values(reference.entry, result);
    all.responses.merge(values.responses);
    for (auto& [response, derivatives] : values.sensitivities) all.sensitivities[response].merge(derivatives);
  }
  return all;
}

/// By the strain, where there is no model to ask.
bool CellRunner::normals_turn(const CellInput& cell) const {
  return variant_.problem && variant_.key == variant_key(cell) ? variant_.problem->model.effects.normals_turn
                                                               : cell.document.root().value("strain", "") == "finite";
}

json CellRunner::row(std::size_t index) {
  json row;
  const auto breakdown = attempt([&] {
    row = measured_row(cells_[index]);
    row["reference_hash"] = reference_hash(study_);
  });
  if (!breakdown) return row;
  variant_ = {};  // it may be half made
  return failed_row(index, breakdown->status, breakdown->message);
}

json CellRunner::failed_row(std::size_t index, const std::string& status, const std::string& message) const {
  json row = head_of(cells_[index], normals_turn(cells_[index]));
  row["status"] = status;
  row["message"] = message;
  row["errors"] = {{"enforcement", json::object()}, {"discretization", json::object()}};
  row["steps"] = json::array();
  if (study_.budget_copies > 0) row["error_budget"] = no_budget(study_.budget_copies);
  row["provenance"] = provenance(1);
  return row;
}

json CellRunner::peer_row(const CellInput& cell) {
  const Input input = input_of(cell, meshes_);
  const MeasuredPeer peer = measured(*cell.peer, input.document, variant_.problem, input.method);
  json row = head_of(cell, normals_turn(cell));
  row.update(row_of(peer));
  row["errors"] = errors(peer.result);
  if (asked_for("kkt", study_.errors)) row["errors"]["kkt"] = errors_of(peer.certificate);
  row["provenance"] = provenance(1);
  return row;
}

json CellRunner::measured_row(const CellInput& cell) {
  enter(cell);
  if (cell.peer) return peer_row(cell);
  const auto result = run(cell);
  json row = head_of(cell, normals_turn(cell));
  row["regularisation"] = regularisation_json(result);
  row["status"] = name_of(result.status());
  row["message"] = result.message().empty() ? variant_.fault : result.message();
  row["warnings"] = warnings_json(result);
  const json steps = steps_json(result);
  row["errors"] = errors(result);
  if (study_.budget_copies > 0) row["error_budget"] = budgets_.of(cell, result);
  if (!steps.empty() && asked_for("kkt", study_.errors)) row["errors"]["kkt"] = steps.back()["kkt"];
  if (!steps.empty() && has_ended(result)) {
    row["responses"] = steps.back()["responses"];
    row["scales"] = scales_json(result);
    if (steps.back().contains("sensitivities")) row["sensitivities"] = steps.back()["sensitivities"];
  }
  if (const json objectives = objectives_json(result); !objectives.empty()) row["objectives"] = objectives;
  row["steps"] = brief(steps);
  if (!study_.solutions.empty())
    row["certificate"] = certificate_of_run(result, input_of(cell, meshes_).document, steps);
  row["film"] = film_json(result);
  row["interface"] = interface_json(result);
  row["size"] = size_json(result);
  row["ledger"] = repeatable_ledger_json(ledger(result));
  row["cost"] = cost_json(result);
  row["cost"]["seconds"] = seconds_of(result);
  row["provenance"] = provenance(1);
  return row;
}

}  // namespace stickslip
