#include "studies/report/records.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <set>
#include <sstream>
#include <utility>
#include <variant>

#include "studies/input/method_options.hpp"
#include "studies/io/atomic_file.hpp"
#include "studies/io/input_fault.hpp"
#include "studies/io/result_rows.hpp"
#include "studies/io/wording.hpp"
#include "studies/report/html.hpp"
#include "studies/report/labels.hpp"
#include "studies/report/look_up.hpp"
#include "studies/report/sample.hpp"

namespace stickslip::report {

using nlohmann::json;

namespace {

/// Magnitudes of the numbers of an object. What is not finite was written as null by JSON and is left out.
std::map<std::string, double> errors_at(const json& errors, const std::string& key) {
  std::map<std::string, double> out;
  for (const auto& [name, value] : object_at(errors, key).items())
    if (value.is_number() && std::isfinite(value.get<double>())) out[name] = std::abs(value.get<double>());
  return out;
}

Knob read_knob(const std::string& name, const json& value) {
  if (const json& absolute = at(value, "absolute"); absolute.is_number())
    return {name + " (absolute)", exact_number(absolute), absolute.get<double>()};
  if (value.is_number()) return {name, exact_number(value), value.get<double>()};
  return {name, plain(value), std::nullopt};
}

/// The parts at the end of a pointer, as many as tell it from the others and begin with a name.
std::string short_name(const std::string& pointer, const std::set<std::string>& all) {
  for (std::size_t slash = pointer.rfind('/'); slash != std::string::npos && slash > 0;
       slash = pointer.rfind('/', slash - 1)) {
    const std::string end = pointer.substr(slash);
    const auto has_it = [&](const std::string& other) { return other.ends_with(end); };
    if (std::isdigit(static_cast<unsigned char>(end[1])) == 0 && std::count_if(all.begin(), all.end(), has_it) == 1)
      return end.substr(1);
  }
  return pointer;
}

/// Appends a part to others, each after a comma.
void append(std::string& text, const std::string& part) { text += (text.empty() ? "" : ", ") + part; }

/// Pointers of linked lists whose values name a variant: the first list of texts or numbers that are all different, or
/// else all lists.
std::vector<std::string> telling_pointers(const json& lists) {
  std::vector<std::string> all;
  for (const auto& [pointer, values] : lists.items()) {
    const std::set<json> different(values.begin(), values.end());
    if (different.size() == values.size() &&
        std::none_of(values.begin(), values.end(), [](const json& value) { return value.is_structured(); }))
      return {pointer};
    all.push_back(pointer);
  }
  return all;
}

/// Whether what a pointer names changes a mesh: /bodies/NAME/mesh/...
bool makes_mesh(const std::string& pointer) {
  const std::string bodies = "/bodies/";
  if (!pointer.starts_with(bodies)) return false;
  const auto end_of_name = pointer.find('/', bodies.size());
  return end_of_name != std::string::npos && pointer.compare(end_of_name, 6, "/mesh/") == 0;
}

/// Says in each cell of which scene it is, of several, and what is varied: "friction = 0.3" of /contacts/sole/friction,
/// "meshes (gmsh = fine.msh)" of linked lists.
void name_scenes(std::vector<Cell>& cells, const json& description) {
  std::set<std::string> pointers;
  for (const auto& cell : cells)
    for (const auto& [pointer, unused] : object_at(cell.record, "vary").items()) pointers.insert(pointer);
  const auto named = [&](const std::string& pointer, const json& value) {
    return short_name(pointer, pointers) + " = " + (value.is_number() ? exact_number(value) : plain(value));
  };
  for (auto& cell : cells) {
    const json& varied = object_at(cell.record, "vary");
    cell.file = cell.scene = cell.beside = cell.mesh = text_at(cell.record, "scene");
    std::set<std::string> together;
    for (const auto& [name, lists] : linked_lists(description)) {
      std::string values;
      for (const auto& pointer : telling_pointers(lists))
        if (varied.contains(pointer)) append(values, named(pointer, varied[pointer]));
      bool of_mesh = false;
      for (const auto& [pointer, unused] : lists.items()) {
        together.insert(pointer);
        of_mesh = of_mesh || makes_mesh(pointer);
      }
      if (values.empty()) continue;
      append(cell.scene, name + " (" + values + ")");
      append(of_mesh ? cell.mesh : cell.beside, name + " (" + values + ")");
    }
    for (const auto& [pointer, value] : varied.items()) {
      if (together.count(pointer) > 0) continue;
      append(cell.scene, named(pointer, value));
      append(makes_mesh(pointer) ? cell.mesh : cell.beside, named(pointer, value));
    }
  }
}

Cell read_cell(json&& row) {
  Cell cell;
  cell.record = std::move(row);
  const json& record = cell.record;
  if (const json& method = at(record, "method"); method.is_object() && !method.empty())
    cell.family = method.begin().key();
  else if (method.is_string())
    cell.family = method.get<std::string>();
  for (const auto& [name, value] : object_at(record, "knobs").items()) cell.knobs.push_back(read_knob(name, value));
  cell.label = with_exact_numbers(text_at(record, "label"));
  if (cell.label.empty()) {
    cell.label = cell.family;
    for (const auto& knob : cell.knobs) cell.label += " " + knob.name + "=" + knob.text;
  }
  if (record.contains("peer")) cell.family = cell.label;
  if (cell.family.empty()) cell.family = cell.label.substr(0, cell.label.find(' '));
  cell.status = text_at(record, "status");
  cell.converged = cell.status == "converged" || cell.status == "converged_at_roundoff";
  cell.refine = static_cast<int>(number_at(record, "refine"));
  const json& errors = at(record, "errors");
  cell.enforcement = errors_at(errors, "enforcement");
  cell.discretization = errors_at(errors, "discretization");
  cell.kkt = errors_at(errors, "kkt");
  return cell;
}

/// Cost of one back-solve over one factorisation on each mesh, pooled over its cells: the response's alone, since
/// seconds.sensitivity does not tell the two apart. A mesh whose seconds are missing or zero gets none.
std::map<std::string, double> measured_ratio(const std::vector<Cell>& cells) {
  struct Sums {
    double factor_seconds = 0, factors = 0, back_seconds = 0, backs = 0;
  };
  std::map<std::string, Sums> sums;
  for (const auto& cell : cells) {
    const json& seconds = at(at(cell.record, "cost"), "seconds");
    Sums& s = sums[cell.mesh];
    s.factor_seconds += number_at(seconds, "factorization");
    s.back_seconds += number_at(seconds, "backsolve");
    s.factors += cell.count("factorizations") - cell.count("sensitivity_factorizations");
    s.backs += cell.count("backsolves");
  }
  std::map<std::string, double> ratio;
  for (const auto& [mesh, s] : sums)
    if (s.factor_seconds > 0 && s.factors > 0 && s.back_seconds > 0 && s.backs > 0)
      ratio[mesh] = (s.back_seconds / s.backs) / (s.factor_seconds / s.factors);
  return ratio;
}

void measure_work(Cell& cell, double ratio) {
  const json& seconds = at(at(cell.record, "cost"), "seconds");
  cell.sensitivity_work =
      cell.count("factorizations") + ratio * (cell.count("backsolves") + cell.count("sensitivity_backsolves"));
  cell.work =
      cell.count("factorizations") - cell.count("sensitivity_factorizations") + ratio * cell.count("backsolves");
  cell.sensitivity_seconds = number_at(seconds, "total");
  cell.seconds = cell.sensitivity_seconds - number_at(seconds, "sensitivity");
  const json& median = at(at(at(cell.record, "cost"), "timing"), "median");
  cell.median_sensitivity_seconds = number_at(median, "total");
  cell.median_seconds = cell.median_sensitivity_seconds - number_at(median, "sensitivity");
}

template <class Get>
std::vector<std::string> distinct(const std::vector<Cell>& cells, Get get) {
  std::vector<std::string> out;
  for (const auto& cell : cells)
    if (std::string value = get(cell); std::find(out.begin(), out.end(), value) == out.end()) out.push_back(value);
  return out;
}

std::string main_variant_of(const Study& study) {
  std::string best;
  long most = -1;
  for (const auto& variant : study.variants) {
    const long converged = std::count_if(study.cells.begin(), study.cells.end(),
                                         [&](const Cell& c) { return c.converged && c.variant == variant; });
    if (converged >= most) {
      most = converged;
      best = variant;
    }
  }
  return best;
}

/// The number that an option has in a run that does not sweep it: as used, or what "auto" stands for. None where it is
/// no number.
std::optional<double> option_as_used(const Cell& cell, const std::string& name) {
  const json* value = &object_at(at(cell.record, "method"), cell.family);
  std::istringstream keys(name);
  for (std::string key; std::getline(keys, key, '.');) value = &at(*value, key);
  if (value->is_number()) return value->get<double>();
  const auto method = default_method(cell.family);
  if (*value != "auto" || !method || (name != "stiffness" && name != "scale")) return std::nullopt;
  if (const json& automatic = at(cell.record, "automatic"); automatic.is_number()) return automatic.get<double>();
  return std::visit([](const auto& m) { return m.automatic_multiple.fixed; }, *method);
}

/// Gives runs of a method that leave out an option which others of it sweep, or say "auto", their place among them.
void complete_knobs(std::vector<Cell>& cells) {
  std::map<std::string, std::set<std::string>> swept;  // names of options with a number, by family
  for (const auto& cell : cells)
    for (const auto& knob : cell.knobs)
      if (knob.value) swept[cell.family].insert(knob.name);
  for (auto& cell : cells)
    for (const auto& name : swept[cell.family]) {
      const auto value = option_as_used(cell, name);
      const auto known =
          std::find_if(cell.knobs.begin(), cell.knobs.end(), [&](const Knob& knob) { return knob.name == name; });
      if (known != cell.knobs.end() && !known->value)
        known->value = value;
      else if (known == cell.knobs.end() && value)
        cell.knobs.push_back({name, exact_number(*value), value});
    }
}

json read_json(const std::filesystem::path& path) {
  if (!std::filesystem::exists(path)) return nullptr;
  json content = json::parse(read_file(path), nullptr, false);
  if (content.is_discarded()) throw InputFault(path.string() + ": is not JSON");
  return content;
}

}  // namespace

double Cell::count(const std::string& name) const { return number_at(at(at(record, "cost"), "counts"), name); }

Study read_study(const std::filesystem::path& directory) {
  Study study;
  study.description = read_json(directory / "study.json");
  study.picture = read_json(directory / "picture.json");

  if (!std::filesystem::exists(directory / "results.jsonl"))
    throw InputFault(exists(directory / "result.json")
                         ? directory.string() + ": holds a run and no study; its result is result.json"
                         : (directory / "results.jsonl").string() + ": there is no such file");
  StoredRows stored =
      read_rows(directory, [first = true](json& row) mutable { drop_bulk(row, std::exchange(first, false)); });
  study.faults = stored.faults();
  for (const auto& id : stored.order) {
    Cell cell = read_cell(std::move(stored.rows.at(id)));
    (cell.record.contains("peer") ? study.peers : study.cells).push_back(std::move(cell));
  }
  for (const json& id : array_at(study.description, "cells"))
    study.unrecorded += id.is_string() && stored.rows.count(id) == 0;

  name_scenes(study.cells, study.description);
  name_scenes(study.peers, study.description);
  std::set<int> levels;
  for (const auto& cell : study.cells) levels.insert(cell.refine);
  study.refined = levels.size() > 1;
  for (auto* cells : {&study.cells, &study.peers})
    for (auto& cell : *cells) {
      cell.variant = cell.scene;
      if (!study.refined) continue;
      append(cell.variant, fmt::format("mesh level {}", cell.refine));
      append(cell.mesh, fmt::format("mesh level {}", cell.refine));
    }
  study.ratio = measured_ratio(study.cells);
  for (auto& cell : study.cells) measure_work(cell, ratio_of(study.ratio, cell));
  study.families = distinct(study.cells, [](const Cell& c) { return c.family; });
  complete_knobs(study.cells);
  name_runs(study);
  study.variants = distinct(study.cells, [](const Cell& c) { return c.variant; });
  study.main_variant = main_variant_of(study);
  attach_curves(study, directory);
  return study;
}

Study read_run(const std::filesystem::path& directory) {
  Study study;
  json result = read_json(directory / "result.json");
  if (!result.is_object()) throw InputFault((directory / "result.json").string() + ": is no result of a run");
  study.picture = read_json(directory / "picture.json");
  study.certificate = read_json(directory / "certificate.json");
  study.description = {{"title", text_at(at(result, "scene"), "title")}};
  const json& steps = array_at(result, "steps");
  const auto solved =
      std::find_if(steps.rbegin(), steps.rend(), [](const json& step) { return step.contains("responses"); });
  if (solved != steps.rend())
    for (const char* part : {"responses", "sensitivities"}) {
      json values = object_at(*solved, part);
      result[part] = std::move(values);
    }
  result["errors"] = json::object();
  for (const char* part : {"interface", "film"})
    if (study.picture.is_object()) result[part] = at(study.picture, part);
  study.cells.push_back(read_cell(std::move(result)));
  study.families = {study.cells.front().family};
  name_runs(study);
  study.variants = {""};
  study.ratio = measured_ratio(study.cells);
  measure_work(study.cells.front(), ratio_of(study.ratio, study.cells.front()));
  return study;
}

std::vector<std::pair<std::string, json>> linked_lists(const json& description) {
  std::vector<std::pair<std::string, json>> linked;
  for (const auto& [name, lists] : object_at(description, "vary").items())
    if (lists.is_object()) linked.emplace_back(name, lists);
  return linked;
}

std::vector<const Cell*> main_cells(const Study& study) {
  std::vector<const Cell*> out;
  for (const auto& cell : study.cells)
    if (cell.variant == study.main_variant) out.push_back(&cell);
  return out;
}

Study of_scene(const Study& all, const std::string& file) {
  Study study = all;
  std::erase_if(study.cells, [&](const Cell& cell) { return cell.file != file; });
  study.variants = distinct(study.cells, [](const Cell& c) { return c.variant; });
  study.main_variant = main_variant_of(study);
  return study;
}

double ratio_of(const std::map<std::string, double>& ratio, const Cell& cell) {
  const auto found = ratio.find(cell.mesh);
  return found == ratio.end() ? 0 : found->second;
}

std::string family_name(const std::string& family) {
  const auto method = default_method(family);
  return method ? std::visit([](const auto& m) { return std::string(m.title); }, *method) : family;
}

std::string running_knob(const Study& study, const std::string& family) {
  std::map<std::string, std::set<std::string>> values;
  for (const auto& cell : study.cells)
    if (cell.family == family)
      for (const auto& knob : cell.knobs) values[knob.name].insert(knob.text);
  for (const char* preferred : {"stiffness", "tolerance", "scale"})
    if (const auto found = values.find(preferred); found != values.end() && found->second.size() > 1) return preferred;
  std::string best;
  std::size_t most = 1;
  for (const auto& [name, set] : values)
    if (set.size() > most) {
      most = set.size();
      best = name;
    }
  return best;
}

std::vector<std::string> knob_names(const Study& study) {
  std::vector<std::string> names;
  std::map<std::string, std::set<double>> values;
  for (const auto& cell : study.cells)
    for (const auto& knob : cell.knobs)
      if (knob.value) {
        if (values[knob.name].empty()) names.push_back(knob.name);
        values[knob.name].insert(*knob.value);
      }
  names.erase(std::remove_if(names.begin(), names.end(), [&](const auto& name) { return values[name].size() < 2; }),
              names.end());
  return names;
}

const Knob* find_knob(const Cell& cell, const std::string& name) {
  for (const auto& knob : cell.knobs)
    if (knob.name == name) return &knob;
  return nullptr;
}

namespace {

/// "the finer mesh", or which one mesh all cells have: "the common mesh (fine.msh, 1 level finer)".
std::string overkill_in_words(const json& overkill) {
  const json& meshes = object_at(overkill, "vary");
  if (meshes.empty()) return "the finer mesh";
  std::vector<std::string> parts;
  for (const auto& [pointer, value] : meshes.items()) {
    const std::string part =
        value.is_string() ? value.get<std::string>() : pointer.substr(pointer.rfind('/') + 1) + " = " + shown(value);
    if (std::find(parts.begin(), parts.end(), part) == parts.end()) parts.push_back(part);
  }
  if (const auto levels = static_cast<long>(number_at(overkill, "refine")); levels > 0)
    parts.push_back(counted(levels, "level") + " finer");
  return fmt::format("the common mesh ({})", fmt::join(parts, ", "));
}

}  // namespace

std::string discretization_reference(const Study& study) {
  std::set<std::string> kinds;
  for (const auto& entry : array_at(study.description, "reference")) {
    for (const auto& [key, words] : {std::pair{"analytic", "the closed form"}, {"values", "the given values"}})
      if (!at(entry, key).is_null()) kinds.insert(words);
    if (const json& overkill = at(entry, "overkill"); !overkill.is_null()) kinds.insert(overkill_in_words(overkill));
  }
  return kinds.size() == 1 ? *kinds.begin() : "the references";
}

bool is_against_meshes_alone(const Study& study) {
  const json& references = array_at(study.description, "reference");
  const auto has = [&](const char* key) {
    return std::any_of(references.begin(), references.end(), [&](const json& of) { return !at(of, key).is_null(); });
  };
  return has("overkill") && !has("analytic") && !has("values");
}

namespace {

/// Whether a run's ledger says that no contact had friction.
bool ran_without_friction(const Cell& cell) {
  const json& ledger = array_at(cell.record, "ledger");
  return std::any_of(ledger.begin(), ledger.end(),
                     [](const json& row) { return at(row, "effect") == "friction" && at(row, "on") == false; });
}

}  // namespace

bool is_frictionless(const Study& study) {
  if (!study.cells.empty() && std::all_of(study.cells.begin(), study.cells.end(), ran_without_friction)) return true;
  std::map<std::string, bool> touches;  // by contact
  for (const auto& point : array_at(study.picture, "contact")) {
    const std::string state = text_at(point, "state");
    if (state == "stick" || state == "slip") return false;
    touches[text_at(point, "name")] |= state == "closed";
  }
  const auto speaks_of_slip = [](const Cell& cell) {
    return std::any_of(cell.kkt.begin(), cell.kkt.end(),
                       [](const auto& measure) { return is_of_friction(measure.first) && measure.second != 0; });
  };
  return !touches.empty() && std::all_of(touches.begin(), touches.end(), [](const auto& one) { return one.second; }) &&
         std::none_of(study.cells.begin(), study.cells.end(), speaks_of_slip);
}

bool is_of_friction(const std::string& measure) {
  return measure == "cone" || measure == "slip_direction" || measure == "stick";
}

std::optional<double> worst(const std::map<std::string, double>& errors, const std::string& prefix) {
  std::optional<double> out;
  for (const auto& [name, value] : errors)
    if (name.rfind(prefix, 0) == 0) out = std::max(out.value_or(0), value);
  return out;
}

}  // namespace stickslip::report
