/// The study command: cells to rows to report.
#include <fmt/core.h>

#include <algorithm>
#include <filesystem>
#include <iostream>
#include <nlohmann/json.hpp>
#include <set>

#include "studies/atomic_file.hpp"
#include "studies/commands.hpp"
#include "studies/explain.hpp"
#include "studies/fields.hpp"
#include "studies/method_options.hpp"
#include "studies/progress.hpp"
#include "studies/provenance.hpp"
#include "studies/report/report.hpp"
#include "studies/simulation.hpp"
#include "studies/study.hpp"
#include "studies/study_reader.hpp"
#include "studies/version.hpp"

namespace stickslip {
namespace {

using nlohmann::json;
constexpr int done = 0, bad_input = 2;

/// What the cells of one variant of the scene share: the problem, its condensation, the runs they are measured against.
struct Variant {
  std::string key;
  std::shared_ptr<const Problem> problem;
  std::shared_ptr<Condensation<double>> condensation;
  double setup_seconds = 0;
  std::vector<CaseResult> references;  ///< of Reference::Kind::method
};

/// What a cell's id says of the program: a build of another commit does not take its results for its own.
std::string program_version() { return std::string(version::number) + "+" + std::string(version::git); }

std::string variant_key(const CellInput& cell) { return json{{"vary", cell.vary}, {"refine", cell.refine}}.dump(); }

/// A valid cell as input. pre: read_study and expand found no fault.
Input input_of(const CellInput& cell, MeshFiles& meshes) {
  Diagnostics diagnostics;
  auto input = read_scene(cell.document, std::string(name_of(cell.method)), diagnostics, meshes);
  if (!input) throw std::runtime_error("a cell of the study is not a valid scene:\n" + diagnostics.text());
  return *std::move(input);
}

/// Options of a method may hold slots of the scene, so each method has a scene of its own; they share meshes and
/// condensation, which do not depend on it.
std::shared_ptr<const Problem> problem_of(const Input& input) { return std::make_shared<const Problem>(input.scene); }

Variant make_variant(const Study& study, const CellInput& cell, MeshFiles& meshes) {
  Variant variant;
  variant.key = variant_key(cell);
  for (const auto& reference : study.references) {
    if (reference.kind != Reference::Kind::method) continue;
    const auto input = input_of(reference_cell(cell, reference, program_version(), meshes), meshes);
    const auto problem = problem_of(input);
    variant.references.push_back(run_case(problem, input.method, run_options(input), variant.condensation));
  }
  if (!variant.references.empty()) {
    variant.problem = variant.references.front().problem;
    variant.setup_seconds = variant.references.front().trajectory.seconds.setup;
  }
  return variant;
}

/// Smallest seconds of `repeat` runs, entry by entry: noise only adds.
json timed_cost(const CaseResult& first, const Input& input, Variant& variant, int repeat) {
  json cost = cost_json(first);
  for (int i = 1; i < repeat; ++i) {
    const auto again = run_case(first.problem, input.method, run_options(input), variant.condensation);
    const json other = cost_json(again);
    for (auto& [name, seconds] : cost["seconds"].items())
      seconds = std::min(seconds.get<double>(), other["seconds"][name].get<double>());
  }
  cost["seconds"]["setup"] = std::max(cost["seconds"]["setup"].get<double>(), variant.setup_seconds);
  return cost;
}

json only_asked(const Errors& errors, const std::vector<std::string>& patterns) {
  json out = json::object();
  for (const auto& [name, error] : errors)
    if (name.starts_with("field:") || asked_for(name, patterns))
      out[name] = std::isfinite(error) ? json(error) : json(nullptr);
  return out;
}

json row_of(const Study& study, const CellInput& cell, Variant& variant, MeshFiles& meshes, json& analytic) {
  const Input input = input_of(cell, meshes);
  const auto result = run_case(problem_of(input), input.method, run_options(input), variant.condensation);
  json errors = {{"enforcement", json::object()}, {"discretization", json::object()}};
  for (const auto& reference : variant.references)
    if (is_converged(reference.status()))
      errors["enforcement"].update(only_asked(enforcement_errors(result, reference), study.errors));
  for (const auto& reference : study.references) {
    if (reference.kind == Reference::Kind::method) continue;
    std::string fault;
    const auto values = reference_values(reference.entry, result, fault);
    errors["discretization"].update(only_asked(discretisation_errors(result, values), study.errors));
    if (!values.curves.is_null() && analytic.is_null() && is_converged(result.status()))
      analytic = {{"name", reference.entry.value("analytic", "")}, {"curves", values.curves}};
  }
  json row = {{"id", cell.id},
              {"label", cell.label},
              {"method", to_json(input.method)},
              {"regularisation", regularisation_json(result)},
              {"knobs", cell.knobs},
              {"vary", cell.vary},
              {"refine", cell.refine},
              {"status", name_of(result.status())},
              {"message", result.message()}};
  const json steps = steps_json(result);
  if (!steps.empty()) {
    if (asked_for("kkt", study.errors)) errors["kkt"] = steps.back()["kkt"];
    row["responses"] = steps.back()["responses"];
    if (steps.back().contains("sensitivities")) row["sensitivities"] = steps.back()["sensitivities"];
  }
  row["errors"] = errors;
  row["steps"] = json::array();
  for (const auto& step : steps)
    row["steps"].push_back({{"time", step["time"]},
                            {"status", step["status"]},
                            {"newton", step["newton"]},
                            {"augmentations", step["augmentations"]},
                            {"cutbacks", step["cutbacks"]},
                            {"history", step["history"]}});
  row["interface"] = interface_json(result);
  row["size"] = size_json(result);
  row["cost"] = timed_cost(result, input, variant, study.repeat);
  row["provenance"] = provenance(1);
  return row;
}

/// study.json: the study as given, and what the report says of the scene beside the rows.
json description(const Study& study, const StudyArguments& arguments, const CellInput& cell, const Variant& variant,
                 const json& analytic, MeshFiles& meshes) {
  json out = study.document.root();
  const Input input = input_of(cell, meshes);
  const auto problem = variant.problem ? variant.problem : problem_of(input);
  out["command"] = "stickslip study " + arguments.study + (arguments.output.empty() ? "" : " -o " + arguments.output);
  out["scene_title"] = problem->model.scene.title;
  out["scene_hash"] = fingerprint(canonical_text(input));
  out["explain"] = explain(input, *problem);
  out["analytic"] = analytic;
  int elements = 0;
  for (const auto& body : problem->model.bodies) elements += body.mesh.element_count();
  out["mesh"] = {{"nodes", problem->model.node_count}, {"elements", elements}};
  double size = 0;
  for (const auto& point : problem->model.points)
    if (point.mesh_size > 0) size = size == 0 ? point.mesh_size : std::min(size, point.mesh_size);
  if (size > 0) out["mesh"]["size_at_contact"] = size;
  if (!variant.references.empty()) out["size"] = size_json(variant.references.front());
  return out;
}

std::set<std::string> finished_cells(const std::filesystem::path& rows) {
  std::set<std::string> ids;
  if (!std::filesystem::exists(rows)) return ids;
  for (const auto& line : read_lines(rows)) {
    const json row = json::parse(line, nullptr, false);
    if (row.is_object() && row.contains("id")) ids.insert(row["id"].get<std::string>());
  }
  return ids;
}

}  // namespace

int study_command(const StudyArguments& arguments) {
  Diagnostics diagnostics;
  MeshFiles meshes;
  const auto study = read_study(arguments.study, diagnostics);
  std::vector<CellInput> cells;
  if (study) cells = expand(*study, program_version(), diagnostics, meshes);
  if (!study || diagnostics.has_errors() || cells.empty()) {
    std::cerr << diagnostics.text();
    return bad_input;
  }
  std::string checked;  // every variant becomes a model before anything is written
  for (const auto& cell : cells) {
    if (variant_key(cell) == checked) continue;
    checked = variant_key(cell);
    try {
      problem_of(input_of(cell, meshes));
    } catch (const ModelError& error) {
      std::cerr << Diagnostic{cell.document.place(error.pointer), error.pointer, error.what()}.text() << '\n';
      return bad_input;
    }
  }
  std::filesystem::path stem = std::filesystem::path(arguments.study).stem();
  if (stem.extension() == ".study") stem = stem.stem();
  const std::filesystem::path directory =
      arguments.output.empty() ? "results" / stem : std::filesystem::path(arguments.output);
  const auto rows = directory / "results.jsonl";
  if (!arguments.resume) std::filesystem::remove(rows);
  const auto finished = finished_cells(rows);
  json analytic = nullptr, picture = nullptr;
  int run = 0, failed = 0;  // of this call; with --resume those of earlier ones stand in the report
  Variant variant;
  {
    Progress progress(std::cerr, progress_style_of_stderr(), "cells", static_cast<long>(cells.size()));
    for (const auto& cell : cells) {
      if (finished.count(cell.id)) {
        progress.advance();
        continue;
      }
      ++run;
      if (variant.key != variant_key(cell)) variant = make_variant(*study, cell, meshes);
      const json row = row_of(*study, cell, variant, meshes, analytic);
      append_line(rows, row.dump());
      if (!row["status"].get<std::string>().starts_with("converged")) {
        ++failed;
        progress.note(fmt::format("{}: {} ({})", cell.label, row["status"].get<std::string>(),
                                  row["message"].get<std::string>()));
      }
      progress.advance();
    }
  }
  if (variant.problem) {
    picture = picture_json(variant.references.front());
    write_file_atomically(directory / "picture.json", picture.dump());
    write_fields(directory, variant.references.front(), 0);
  }
  if (finished.size() < cells.size() || !std::filesystem::exists(directory / "study.json"))
    write_file_atomically(directory / "study.json",
                          description(*study, arguments, cells.back(), variant, analytic, meshes).dump(2) + "\n");
  write_report(directory);
  fmt::print("{} cells, {} run now, {} of these without a converged result (kept as rows)\nreport: {}\n", cells.size(),
             run, failed, (directory / "report.html").string());
  return done;
}

}  // namespace stickslip
