#include <algorithm>
#include <set>

#include "studies/sweep/closed_forms.hpp"
#include "studies/sweep/study.hpp"
#include "studies/sweep/study_reading.hpp"

namespace stickslip {
namespace {

using nlohmann::json;

// A scene that cannot be read is null: it has no names, and nothing is held against them.

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
  if (scene.is_null()) return {};
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

void check_result_name(const JsonNode& node, const std::string& name, const json& scene,
                       const std::vector<std::string>& names) {
  if (!scene.is_null() && std::find(names.begin(), names.end(), name) == names.end())
    node.error_at_key("the scene has no " + in_quotes(name) + ";" + suggestion(name, names) +
                      " allowed: " + listed(names));
}

/// Which inputs of the closed form a map of responses to quantities gives; none where it is at fault.
std::optional<std::set<std::string>> read_map(const JsonNode& map, const ClosedForm& form, const json& scene) {
  std::set<std::string> given;
  bool sound = map.is_map("quantities by response");
  for (const auto& [response, quantity] : sound ? map.members() : std::vector<std::pair<std::string, JsonNode>>{}) {
    check_result_name(quantity, response, scene, names_in(scene, "responses"));
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
  const json parameters = scene.is_null() ? json() : scene.value("parameters", json::object());
  for (const auto& [quantity, value] : inputs.members()) {
    const auto names = form.input_names();
    if (!form.has_input(quantity))
      value.error_at_key("is no input of " + form.name + ";" + suggestion(quantity, names) +
                         " allowed: " + listed(names));
    else if (!given.insert(quantity).second)
      value.error_at_key("is given by the map too");
    const json& content = value.value();
    if (content.is_string() && !scene.is_null() && !parameters.contains(content.get<std::string>()))
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
  const auto kind = read_kind(node, study_object("reference"));
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
        check_result_name(number, result, scene, result_names(scene));
        number.number(any_number);
      }
    if (value.value().is_object() && value.value().empty()) value.error("is empty; must give a response its number");
  } else if (name == "overkill") {
    reference.kind = Reference::Kind::overkill;
    reference.method = {"monolithic_al", node.place(), {}};
    if (!value.is_object(keys_of(study_object("overkill")))) return std::nullopt;
    const auto level = value.find("refine"), meshes = value.find("vary");
    if (!level && !meshes)
      value.error(
          R"(needs "refine", levels finer than the cell, or "vary", the meshes of one reference for all cells)");
    if (level) reference.refine = level->count(1, finest_level).value_or(1);
    if (meshes) reference.meshes = read_meshes(*meshes, scene);
  } else {
    reference.kind = Reference::Kind::method;
    const auto sweep = read_method_sweep(value, OptionLists::refused);
    if (!sweep) return std::nullopt;
    reference.method = *sweep;
  }
  return reference;
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

}  // namespace

std::vector<Reference> read_references(const JsonNode& list, const json& scene) {
  std::vector<Reference> references;
  if (!list.value().is_array()) {
    list.must_be("a list of references");
    return references;
  }
  std::set<json> before;
  for (const JsonNode& node : list.elements())
    if (!before.insert(node.value()).second)
      node.error("is a reference that the list has already");
    else if (auto reference = read_reference(node, scene))
      references.push_back(*std::move(reference));
  return references;
}

std::vector<std::string> read_errors(const JsonNode& list, const json& scene) {
  std::vector<std::string> patterns;
  if (!list.value().is_array()) {
    list.must_be("a list of patterns");
    return patterns;
  }
  const auto names = error_names(scene);
  for (const JsonNode& element : list.elements()) {
    const auto pattern = element.text();
    if (!pattern) continue;
    const bool known = *pattern == "kkt" || pattern->rfind("response:", 0) == 0 ||
                       pattern->rfind("sensitivity:", 0) == 0 || pattern->rfind("field:", 0) == 0;
    if (!known)
      element.must_be("\"kkt\", or begin with response:, sensitivity: or field:, as in \"response:*\"");
    else if (!scene.is_null() && !matches_something(*pattern, names))
      element.error("is " + in_quotes(*pattern) + ", which matches nothing in the scene;" +
                    suggestion(*pattern, names) + " allowed: " + listed(names) + ", or one of them cut short by a *");
    patterns.push_back(*pattern);
  }
  return patterns;
}

}  // namespace stickslip
