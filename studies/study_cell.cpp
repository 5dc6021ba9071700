#include "studies/study_cell.hpp"

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <stdexcept>

#include "studies/film.hpp"
#include "studies/method_options.hpp"
#include "studies/provenance.hpp"
#include "studies/study.hpp"
#include "studies/version.hpp"
#include "studies/warnings.hpp"

namespace stickslip {
namespace {

using nlohmann::json;

RunOptions options_of(const Input& input) { return {input.linear_algebra, input.backend, {}, {}}; }

Regularisation& regularisation_of(Penalty& method) { return method.stiffness; }
Regularisation& regularisation_of(UzawaAL& method) { return method.scale; }
Regularisation& regularisation_of(MonolithicAL& method) { return method.scale; }

/// Whether a method runs as it does without any option; "auto" and the number it stands for are the same.
bool is_default(Method method) {
  std::visit(
      [](auto& m) {
        auto& rho = regularisation_of(m);
        if (rho.kind == Regularisation::Kind::relative && rho.value.value == m.automatic_multiple)
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

/// The steps without their bulk.
json brief(const json& steps) {
  json out = json::array();
  for (const auto& step : steps) {
    json kept = json::object();
    for (const char* name :
         {"time", "status", "newton", "augmentations", "cutbacks", "history", "contraction", "sensitivity_scheme"})
      if (step.contains(name)) kept[name] = step[name];
    out.push_back(std::move(kept));
  }
  return out;
}

}  // namespace

std::string variant_key(const CellInput& cell) { return json{{"vary", cell.vary}, {"refine", cell.refine}}.dump(); }

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
    variant_.condensation = condense(*variant_.problem, options_of(input));
  }
  for (const auto& reference : study_.references) {
    if (reference.kind == Reference::Kind::method)
      variant_.same_mesh.push_back(run(reference_cell(cell, reference, program_version(), meshes_)));
    if (reference.kind != Reference::Kind::overkill) continue;
    const auto fine = input_of(reference_cell(cell, reference, program_version(), meshes_), meshes_);
    std::shared_ptr<Condensation<double>> own;
    const auto result = run_case(problem_of(fine), fine.method, options_of(fine), own);
    variant_.overkill.push_back(is_converged(result.status()) ? values_of(result) : ReferenceValues{});
  }
  variant_.key = variant_key(cell);
}

CaseResult CellRunner::run(const CellInput& cell) {
  const auto input = input_of(cell, meshes_);
  return run_case(problem_of(input), input.method, options_of(input), variant_.condensation);
}

CaseResult CellRunner::showcase(std::size_t cell) {
  enter(cells_[cell]);
  return variant_.same_mesh.empty() ? run(cells_[cell]) : variant_.same_mesh.front();
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

/// Enforcement errors are against runs on the same mesh, discretisation errors against all other references. Where
/// several give an error of one name, the first in the study's list counts, and each is recorded by reference too.
json CellRunner::errors(const CaseResult& result) const {
  json all = {{"enforcement", json::object()}, {"discretization", json::object()}}, by_reference = json::array();
  auto same_mesh = variant_.same_mesh.begin();
  auto overkill = variant_.overkill.begin();
  for (const auto& reference : study_.references) {
    const bool enforcement = reference.kind == Reference::Kind::method;
    json given;
    if (enforcement) {
      const auto& other = *same_mesh++;
      if (is_converged(other.status())) given = only_asked(enforcement_errors(result, other), study_.errors);
    } else {
      const auto values =
          reference.kind == Reference::Kind::overkill ? *overkill++ : reference_values(reference.entry, result);
      given = only_asked(discretisation_errors(result, values), study_.errors);
    }
    fill_in(all[enforcement ? "enforcement" : "discretization"], given);
    by_reference.push_back({{"reference", reference.entry}, {"errors", given}});
  }
  if (study_.references.size() > 1) all["by_reference"] = by_reference;
  return all;
}

json CellRunner::row(std::size_t index) {
  const CellInput& cell = cells_[index];
  enter(cell);
  const auto result = run(cell);
  json row = {{"id", cell.id},
              {"label", cell.label},
              {"method", to_json(cell.method)},
              {"default", is_default(cell.method)},
              {"regularisation", regularisation_json(result)},
              {"knobs", cell.knobs},
              {"vary", cell.vary},
              {"refine", cell.refine},
              {"scene_hash", fingerprint(cell.canonical)},
              {"status", name_of(result.status())},
              {"message", result.message()},
              {"warnings", warnings_json(result)}};
  const json steps = steps_json(result);
  row["errors"] = errors(result);
  if (!steps.empty()) {
    if (asked_for("kkt", study_.errors)) row["errors"]["kkt"] = steps.back()["kkt"];
    row["responses"] = steps.back()["responses"];
    if (steps.back().contains("sensitivities")) row["sensitivities"] = steps.back()["sensitivities"];
  }
  if (const json objectives = objectives_json(result); !objectives.empty()) row["objectives"] = objectives;
  row["steps"] = brief(steps);
  row["film"] = film_json(result);
  row["interface"] = interface_json(result);
  row["size"] = size_json(result);
  row["cost"] = cost_json(result);
  row["cost"]["seconds"] = seconds_of(result);
  row["provenance"] = provenance(1);
  return row;
}

}  // namespace stickslip
