#include "studies/sweep/study_reader.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <set>
#include <system_error>

#include "studies/input/method_options.hpp"
#include "studies/io/json_node.hpp"
#include "studies/sweep/closed_forms.hpp"
#include "studies/sweep/study.hpp"

namespace stickslip {
namespace {

using nlohmann::json;

bool has(const std::vector<std::string>& names, const std::string& name) {
  return std::find(names.begin(), names.end(), name) != names.end();
}

constexpr int finest = 10;              ///< mesh level: a thousand times the cells each way
constexpr double most_cells = 100'000;  ///< of a study
constexpr int most_rounds = 1000;       ///< of the timing pass: the least of so many is as good as it gets

/// The values of a list, each once.
std::vector<PlacedValue> values_of(const JsonNode& list) {
  std::vector<PlacedValue> values;
  if (!list.value().is_array() || list.value().empty()) {
    list.must_be("a list of values");
    return values;
  }
  std::set<json> before;
  for (const JsonNode& element : list.elements()) {
    if (!before.insert(element.value()).second)
      element.error("is " + shown(element.value()) + ", which the list has already");
    else
      values.push_back({element.value(), element.place()});
  }
  return values;
}

/// What a list as an option's value means.
enum class Lists { swept, refused };

/// Options below a node, each with its values.
void collect_options(const JsonNode& node, const std::string& pointer, Lists lists, std::vector<Knob>& options) {
  for (const auto& [name, option] : node.members()) {
    const std::string below = child_pointer(pointer, name);
    const bool list = option.value().is_array();
    if (option.value().is_object() && !option.value().empty())
      collect_options(option, below, lists, options);
    else if (list && lists == Lists::swept)
      options.push_back({below, values_of(option)});
    else if (list)
      option.must_be(R"(one value; only lists in the "methods" of a study are swept)");
    else
      options.push_back({below, {{option.value(), option.place()}}});
  }
}

std::optional<MethodSweep> read_method_sweep(const JsonNode& node, Lists lists) {
  const auto kind = node.kind(method_names());
  if (!kind || !kind->second.is_map("the options of " + kind->first)) return std::nullopt;
  MethodSweep sweep{kind->first, kind->second.place(), {}};
  collect_options(kind->second, "", lists, sweep.options);
  return sweep;
}

/// The accuracies of the page's verdict; they stay in the study as given.
void check_accuracies(const JsonNode& node) {
  constexpr std::size_t most_columns = 6;
  const bool is_list = node.value().is_array() && !node.value().empty() && node.value().size() <= most_columns;
  if (!is_list) return node.must_be("a list of up to six relative errors, as in [1e-2, 1e-4, 1e-6]");
  constexpr Rule relative_error{"a number > 0 and < 1", [](double x) { return x > 0 && x < 1; }};
  for (const JsonNode& error : node.elements()) error.number(relative_error);
}

/// How many copies the error budget takes; 0: none is asked for.
int read_budget(const JsonNode& node) {
  constexpr int standard = 4, fewest = 2, most = 64;
  if (node.value().is_boolean()) return node.value().get<bool>() ? standard : 0;
  if (!node.value().is_object()) {
    node.must_be(R"(true, false, or {"copies": n})");
    return 0;
  }
  const auto copies = node.is_object({{}, {"copies"}}) ? node.find("copies") : std::nullopt;
  return copies ? copies->count(fewest, most).value_or(standard) : standard;
}

/// Keys of an object in the scene; none where there is no such object.
std::vector<std::string> names_in(const json& scene, const char* part) {
  std::vector<std::string> names;
  if (scene.contains(part))
    for (const auto& [name, unused] : scene.at(part).items()) names.push_back(name);
  return names;
}

/// Names that responses and objectives have in the scene, and their derivatives, "RESPONSE/PARAMETER"; in adjoint mode
/// responses have none.
std::vector<std::string> result_names(const json& scene) {
  const bool adjoint = scene.value("sensitivity", json::object()).value("mode", "") == "adjoint";
  std::vector<std::string> names, derivatives;
  for (const char* part : {"responses", "objectives"})
    for (const auto& name : names_in(scene, part)) {
      names.push_back(name);
      if (adjoint && std::string_view(part) == "responses") continue;
      for (const auto& parameter : names_in(scene, "parameters")) derivatives.push_back(name + "/" + parameter);
    }
  names.insert(names.end(), derivatives.begin(), derivatives.end());
  return names;
}

void check_result_name(const JsonNode& node, const std::string& name, const std::vector<std::string>& names) {
  if (!has(names, name))
    node.error_at_key("the scene has no " + in_quotes(name) + ";" + suggestion(name, names) +
                      " allowed: " + listed(names));
}

/// Which inputs of the closed form a map of responses to quantities gives; none where it is at fault.
std::optional<std::set<std::string>> read_map(const JsonNode& map, const ClosedForm& form, const json& scene) {
  std::set<std::string> given;
  bool sound = map.is_map("quantities by response");
  for (const auto& [response, quantity] : sound ? map.members() : std::vector<std::pair<std::string, JsonNode>>{}) {
    check_result_name(quantity, response, names_in(scene, "responses"));
    const auto role = quantity.choice(form.quantities());
    sound = sound && role;
    if (role && form.has_input(*role) && !given.insert(*role).second)
      quantity.error("is " + in_quotes(*role) + ", which another response gives already");
  }
  if (!sound) return std::nullopt;
  return given;
}

/// Adds the inputs that are given by a number, or as the parameter of the scene of this name.
void read_inputs(const JsonNode& inputs, const ClosedForm& form, const json& scene, std::set<std::string>& given) {
  if (!inputs.is_map("numbers, or names of parameters, by input of the closed form")) return;
  const json parameters = scene.value("parameters", json::object());
  for (const auto& [quantity, value] : inputs.members()) {
    const auto names = form.input_names();
    if (!form.has_input(quantity))
      value.error_at_key("is no input of " + form.name + ";" + suggestion(quantity, names) +
                         " allowed: " + listed(names));
    else if (!given.insert(quantity).second)
      value.error_at_key("is given by the map too");
    const json& content = value.value();
    if (content.is_string() && !parameters.contains(content.get<std::string>()))
      value.error("is " + shown(content) + ", but the scene has no parameter of this name");
    else if (!content.is_string() && !content.is_number())
      value.must_be("a number, or the name of a parameter of the scene");
    else if (const auto* input = form.find_input(quantity); input && content.is_number())
      value.number(input->rule);
  }
}

/// {"analytic": NAME, "map": {RESPONSE: QUANTITY}, "inputs": {QUANTITY: number or PARAMETER}}.
void read_analytic(const JsonNode& node, const JsonNode& form_node, const json& scene) {
  const auto name = form_node.choice(analytic_names());
  const auto map = node.find("map");
  if (!map) node.error(R"(the key "map" is missing: {RESPONSE: QUANTITY, ...})");
  if (!name || !map) return;
  const ClosedForm& form = *find_closed_form(*name);
  auto given = read_map(*map, form, scene);
  if (!given) return;
  if (const auto inputs = node.find("inputs")) read_inputs(*inputs, form, scene, *given);
  std::vector<std::string> missing;
  for (const auto& input : form.inputs)
    if (input.required && !input.of_contact && given->count(input.name) == 0) missing.push_back(input.name);
  if (!missing.empty())
    node.error(form.name + " lacks " + listed(missing) +
               R"(, each to be given by a response in "map", or in "inputs")");
}

std::optional<Reference> read_reference(const JsonNode& node, const json& scene) {
  const auto kind = node.kind({"analytic", "values", "method", "overkill"}, {}, {"map", "inputs"});
  if (!kind) return std::nullopt;
  const auto& [name, value] = *kind;
  Reference reference;
  reference.entry = node.value();
  if (name != "analytic")
    for (const char* key : {"map", "inputs"})
      if (const auto other = node.find(key)) other->error_at_key("belongs to analytic, not to " + name);
  if (name == "analytic") {
    read_analytic(node, value, scene);
  } else if (name == "values") {
    reference.kind = Reference::Kind::values;
    if (value.is_map("numbers by response, or by RESPONSE/PARAMETER"))
      for (const auto& [result, number] : value.members()) {
        check_result_name(number, result, result_names(scene));
        number.number(any_number);
      }
    if (value.value().is_object() && value.value().empty()) value.error("is empty; must give a response its number");
  } else if (name == "overkill") {
    reference.kind = Reference::Kind::overkill;
    reference.method = {"monolithic_al", node.place(), {}};
    if (const auto level = value.is_object({{"refine"}}) ? value.find("refine") : std::nullopt)
      reference.refine = level->count(1, finest).value_or(1);
  } else {
    reference.kind = Reference::Kind::method;
    const auto sweep = read_method_sweep(value, Lists::refused);
    if (!sweep) return std::nullopt;
    reference.method = *sweep;
  }
  return reference;
}

std::vector<Reference> read_references(const JsonNode& list, const json& scene) {
  std::vector<Reference> references;
  std::set<json> before;
  for (const JsonNode& node : list.elements())
    if (!before.insert(node.value()).second)
      node.error("is a reference that the list has already");
    else if (auto reference = read_reference(node, scene))
      references.push_back(*std::move(reference));
  return references;
}

/// The one of the pointers that names a part of what `pointer` names, or what that is a part of; "" where none does.
std::string overlapping(const std::set<std::string>& pointers, const std::string& pointer) {
  for (std::string around = pointer; !around.empty(); around.erase(around.rfind('/')))
    if (pointers.count(around) > 0) return around;
  const auto inside = pointers.lower_bound(pointer + "/");
  return inside != pointers.end() && inside->starts_with(pointer + "/") ? *inside : "";
}

std::vector<Knob> read_vary(const JsonNode& node, const json& scene) {
  std::vector<Knob> knobs;
  std::set<std::string> known;
  if (!node.is_map("lists of values by JSON pointer of the scene")) return knobs;
  for (const auto& [pointer, list] : node.members()) {
    if (pointer == "/method" || pointer.rfind("/method/", 0) == 0)
      list.error_at_key(R"(an option of a method is swept as a list in "methods")");
    else if (const std::string fault = pointer_fault(scene, pointer); !fault.empty())
      list.error_at_key(fault);
    else if (value_at(scene, pointer)->is_object())
      list.error_at_key("names an object; must name a number, a text or an array");
    else if (const std::string other = overlapping(known, pointer); !other.empty())
      list.error_at_key("overlaps " + other + ", which is varied too: one would overwrite the other");
    else if (known.insert(pointer).second)
      knobs.push_back({pointer, values_of(list)});
  }
  return knobs;
}

/// All names that errors may have in the scene.
std::vector<std::string> error_names(const json& scene) {
  std::vector<std::string> names{"kkt", "field:normal_traction", "field:tangential_traction"};
  for (const std::string& name : result_names(scene))
    names.push_back((name.find('/') == std::string::npos ? "response:" : "sensitivity:") + name);
  return names;
}

/// Whether a pattern says something of the scene: all of a kind, or some of the names. A parameter of each node of a
/// side has several names below its own.
bool matches_something(const std::string& pattern, const std::vector<std::string>& names) {
  if (pattern == "response:*" || pattern == "sensitivity:*" || pattern == "field:*") return true;
  return std::any_of(names.begin(), names.end(), [&](const std::string& name) {
    return asked_for(name, {pattern}) || pattern.starts_with(name + "/");
  });
}

void read_errors(const JsonNode& node, const json& scene, std::vector<std::string>& patterns) {
  if (!node.value().is_array()) return node.must_be("a list of patterns");
  const auto names = error_names(scene);
  for (const JsonNode& element : node.elements()) {
    const auto pattern = element.text();
    if (!pattern) continue;
    const bool known = *pattern == "kkt" || pattern->rfind("response:", 0) == 0 ||
                       pattern->rfind("sensitivity:", 0) == 0 || pattern->rfind("field:", 0) == 0;
    if (!known)
      element.must_be("\"kkt\", or begin with response:, sensitivity: or field:, as in \"response:*\"");
    else if (!matches_something(*pattern, names))
      element.error("is " + in_quotes(*pattern) + ", which matches nothing in the scene;" +
                    suggestion(*pattern, names) + " allowed: " + listed(names) + ", or one of them cut short by a *");
    patterns.push_back(*pattern);
  }
}

/// Calls f with one value of each sweep in turn, the last sweep's fastest.
template <class F>
void for_each_combination(const std::vector<Knob>& sweeps, F&& f) {
  std::vector<const PlacedValue*> chosen(sweeps.size());
  auto choose = [&](auto&& self, std::size_t i) -> void {
    if (i == sweeps.size()) return f(chosen);
    for (const PlacedValue& value : sweeps[i].values) {
      chosen[i] = &value;
      self(self, i + 1);
    }
  };
  choose(choose, 0);
}

/// How many combinations there are, in a double, which does not overflow.
double combinations(const std::vector<Knob>& sweeps) {
  double count = 1;
  for (const Knob& sweep : sweeps) count *= static_cast<double>(sweep.values.size());
  return count;
}

double cell_count(const Study& study) {
  double methods = 0;
  for (const MethodSweep& method : study.methods) methods += combinations(method.options);
  return static_cast<double>(study.refine.size()) * combinations(study.vary) * methods;
}

/// "/newton/tolerance" as "newton.tolerance".
std::string option_name(const std::string& pointer) {
  std::string name = pointer.substr(1);
  std::replace(name.begin(), name.end(), '/', '.');
  return name;
}

/// Puts a method with its options into the cell. The faults that follow are left to complete().
void set_method(CellInput& cell, const MethodSweep& method, const std::vector<const PlacedValue*>& chosen) {
  const std::string base = child_pointer("/method", method.method);
  cell.document.set("/method", {{method.method, json::object()}}, method.place);
  cell.label = method.method;
  cell.knobs = json::object();
  for (std::size_t i = 0; i < chosen.size(); ++i) {
    const Knob& option = method.options[i];
    const auto& [value, place] = *chosen[i];
    // an option within an object, as /scale/absolute, needs the object
    for (auto slash = option.pointer.find('/', 1); slash != std::string::npos;
         slash = option.pointer.find('/', slash + 1))
      if (const std::string outer = base + option.pointer.substr(0, slash); !value_at(cell.document.root(), outer))
        cell.document.set(outer, json::object(), place);
    cell.document.set(base + option.pointer, value, place);
    const std::string name = option_name(option.pointer);
    cell.label += " " + name + "=" + (value.is_string() ? value.get<std::string>() : shown(value));
    if (option.values.size() > 1) cell.knobs[name] = value;
  }
}

/// Puts the method of a reference into the cell, and its mesh level; false where an imported mesh has no finer one.
bool set_reference(CellInput& cell, const Reference& reference, Diagnostics& diagnostics) {
  std::vector<const PlacedValue*> chosen;
  for (const Knob& option : reference.method.options) chosen.push_back(&option.values.front());
  set_method(cell, reference.method, chosen);
  return refine_meshes(cell.document, reference.refine, reference.method.place, diagnostics);
}

/// Reads the cell's document and fills in what follows from it; false where it is at fault.
bool complete(CellInput& cell, const std::string& method, const std::string& program_version, Diagnostics& diagnostics,
              MeshFiles& mesh_files) {
  // Each of a study's methods drops the parameters that belong to another one; notes on that would be one a cell.
  Diagnostics own;
  auto input = read_scene(cell.document, method, own, mesh_files);
  for (const Diagnostic& error : own.errors()) diagnostics.error(error);
  if (!input) return false;
  cell.method = input->method;
  cell.canonical = canonical_text(*input);
  cell.id = cell_id(cell.canonical, program_version);
  return true;
}

}  // namespace

std::string cell_id(const std::string& canonical, const std::string& program_version) {
  return fingerprint(canonical + "\n" + program_version);
}

bool refine_meshes(JsonDocument& scene, int level, const Place& origin, Diagnostics& diagnostics) {
  auto finer = [&](json& count) {
    if (!count.is_number()) return;
    const double cells = count.get<double>() * (1 << level);
    constexpr double most = 1e15;  // beyond, the scene's reader has something to say; here only overflow matters
    if (cells == std::floor(cells) && std::abs(cells) < most)
      count = static_cast<long long>(cells);
    else
      count = cells;
  };
  JsonDocument result = scene;
  bool possible = true;
  const json bodies = level > 0 ? scene.root().value("bodies", json::object()) : json::object();
  for (const auto& [name, body] : bodies.items()) {
    const json* mesh = value_at(body, "/mesh");
    if (!mesh || !mesh->is_object()) continue;
    const std::string pointer = child_pointer("/bodies", name) + "/mesh";
    if (mesh->contains("gmsh")) {
      diagnostics.error(
          {origin, pointer, "refines " + pointer + ", an imported mesh, which cannot be; allowed: level 0"});
      possible = false;
    }
    for (const auto& [kind, generator] : mesh->items()) {
      if (!generator.is_object() || !generator.contains("cells")) continue;
      json cells = generator["cells"];
      if (cells.is_array())
        for (json& count : cells) finer(count);
      else
        finer(cells);
      result.set(child_pointer(pointer, kind) + "/cells", std::move(cells), origin);
    }
  }
  if (possible) scene = std::move(result);
  return possible;
}

std::optional<Study> read_study(const std::string& file, Diagnostics& diagnostics) {
  const std::size_t faults = diagnostics.error_count();
  auto document = JsonDocument::read(file, diagnostics);
  if (!document) return std::nullopt;
  Study study;
  study.document = *std::move(document);
  const JsonNode root(study.document, diagnostics);
  if (!root.is_object({{"scene"},
                       {"$schema", "title", "methods", "vary", "refine", "reference", "errors", "accuracy", "timing",
                        "error_budget"}}))
    return std::nullopt;
  if (const auto schema = root.find("$schema")) schema->text();
  if (const auto title = root.find("title")) study.title = title->text().value_or("");

  // what the rest is checked against
  const auto scene_node = root.find("scene");
  const auto scene_name = scene_node ? scene_node->text() : std::nullopt;
  if (!scene_name) return std::nullopt;
  const std::filesystem::path scene_path = (std::filesystem::path(file).parent_path() / *scene_name).lexically_normal();
  std::error_code unreadable;
  if (!std::filesystem::is_regular_file(scene_path, unreadable)) {
    scene_node->error("the scene file " + scene_path.string() + " cannot be read");
    return std::nullopt;
  }
  auto scene = JsonDocument::read(scene_path.string(), diagnostics);
  if (!scene) return std::nullopt;
  study.scene = *std::move(scene);
  const json& scene_root = study.scene.root();
  if (!scene_root.is_object()) {
    diagnostics.error({study.scene.place(""), "", "is " + shown(scene_root) + "; must be an object"});
    return std::nullopt;
  }

  if (const auto methods = root.find("methods")) {
    if (!methods->value().is_array() || methods->value().empty())
      methods->must_be("a list of methods, as in [{\"penalty\": {\"stiffness\": [10, 100]}}]");
    else
      for (const JsonNode& method : methods->elements())
        if (auto sweep = read_method_sweep(method, Lists::swept)) study.methods.push_back(*std::move(sweep));
  } else if (scene_root.contains("method")) {
    if (auto sweep = read_method_sweep(*JsonNode(study.scene, diagnostics).find("method"), Lists::refused))
      study.methods.push_back(*std::move(sweep));
  } else {
    root.error(R"(the key "methods" is missing, and the scene names no method)");
  }
  if (const auto vary = root.find("vary")) study.vary = read_vary(*vary, scene_root);
  study.refine = {{0, study.document.place("")}};
  if (const auto refine = root.find("refine")) {
    study.refine = values_of(*refine);
    for (const JsonNode& level : refine->value().is_array() ? refine->elements() : std::vector<JsonNode>{})
      level.count(0, finest);
  }
  if (const auto references = root.find("reference")) {
    if (references->value().is_array())
      study.references = read_references(*references, scene_root);
    else
      references->must_be("a list of references");
  }
  study.errors = {"response:*", "sensitivity:*", "kkt"};
  if (const auto errors = root.find("errors")) {
    study.errors.clear();
    read_errors(*errors, scene_root, study.errors);
  }
  if (const auto accuracy = root.find("accuracy")) check_accuracies(*accuracy);
  if (const auto timing = root.find("timing"); timing && timing->is_object({{}, {"repeat"}}))
    if (const auto repeat = timing->find("repeat")) study.repeat = repeat->count(1, most_rounds).value_or(0);
  if (const auto budget = root.find("error_budget")) study.budget_copies = read_budget(*budget);
  if (const double count = cell_count(study); count > most_cells)
    root.error(fmt::format("makes {:.0f} cells of all its lists; allowed: {:.0f} at most", count, most_cells));
  if (diagnostics.error_count() > faults) return std::nullopt;
  return study;
}

Diagnostic in_study(const Study& study, Diagnostic fault) {
  if (fault.place.source != study.document.file()) return fault;
  fault.pointer = fault.place.pointer;  // a value may be deeper in the cell's scene than in the list that it comes from
  while (!fault.pointer.empty() && !value_at(study.document.root(), fault.pointer))
    fault.pointer.erase(fault.pointer.rfind('/'));
  return fault;
}

std::vector<CellInput> expand(const Study& study, const std::string& program_version, Diagnostics& all_faults,
                              MeshFiles& mesh_files) {
  Diagnostics diagnostics;
  std::vector<CellInput> cells;
  std::set<std::string> ids;
  std::size_t again = 0;
  for (const auto& [level, level_place] : study.refine) {
    CellInput refined;
    refined.document = study.scene;
    refined.refine = level.get<int>();
    if (!refine_meshes(refined.document, refined.refine, level_place, diagnostics)) continue;
    for_each_combination(study.vary, [&](const std::vector<const PlacedValue*>& varied) {
      CellInput scene = refined;
      for (std::size_t i = 0; i < varied.size(); ++i) {
        scene.document.set(study.vary[i].pointer, varied[i]->value, varied[i]->place);
        scene.vary[study.vary[i].pointer] = varied[i]->value;
      }
      for (const MethodSweep& method : study.methods)
        for_each_combination(method.options, [&](const std::vector<const PlacedValue*>& chosen) {
          CellInput cell = scene;
          set_method(cell, method, chosen);
          if (!complete(cell, method.method, program_version, diagnostics, mesh_files)) return;
          if (ids.insert(cell.id).second)
            cells.push_back(std::move(cell));
          else
            ++again;
        });
    });
  }
  // a reference with faulty options would be found only when it is run
  if (!cells.empty())
    for (const Reference& reference : study.references)
      if (reference.kind == Reference::Kind::method || reference.kind == Reference::Kind::overkill) {
        // of the finest mesh, which a finer one may be too large for
        CellInput cell = *std::max_element(cells.begin(), cells.end(),
                                           [](const auto& a, const auto& b) { return a.refine < b.refine; });
        if (set_reference(cell, reference, diagnostics))
          complete(cell, reference.method.method, program_version, diagnostics, mesh_files);
      }
  for (const Diagnostic& fault : diagnostics.errors()) all_faults.error(in_study(study, fault));
  if (again > 0)
    all_faults.note(
        {{study.document.file()},
         "",
         fmt::format("{} of the {} cells that its lists make {} another and {} "
                     "left out (the same method and options, or a mesh that has no levels)",
                     again, again + cells.size(), again == 1 ? "equals" : "equal", again == 1 ? "is" : "are")});
  if (diagnostics.has_errors()) cells.clear();
  return cells;
}

CellInput reference_cell(const CellInput& cell, const Reference& reference, const std::string& program_version,
                         MeshFiles& mesh_files) {
  CellInput other = cell;
  Diagnostics none;
  set_reference(other, reference, none);
  complete(other, reference.method.method, program_version, none, mesh_files);
  return other;
}

}  // namespace stickslip
